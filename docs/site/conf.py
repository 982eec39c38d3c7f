# SPDX-License-Identifier: GPL-3.0-or-later
"""Sphinx's settings of the documents' site. build.py calls Sphinx and says where the sources are."""
import os
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
SOURCES = pathlib.Path(os.environ.get("TUBEFOOT_SITE_SOURCES", HERE.parents[1])).resolve()
sys.path[:0] = [str(HERE), str(SOURCES / "python")]

project = "tubefoot"
copyright = "the authors of tubefoot, GPL-3.0-or-later"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton", "code_host", "api",
              "theme"]
root_doc = "index"
include_patterns = ["index.md", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "docs/notes/*.md", "validation/*.md",
                    "validation/reference/*.md", "validation/reference/*/*.md", "validation/results/*.md", "api/*.md", "api/python.rst"]

# Links are code_host's, so that they are read as on a code host, whatever MyST's version makes of them.
myst_all_links_external = True
myst_enable_extensions = ["dollarmath"]
suppress_warnings = ["myst.header"]  # the atlas begins with a comment
highlight_language = "none"
smartquotes = False  # --option stays what it is

# The module as it stands in python/tubefoot; what is compiled of it is not needed to read it.
autodoc_mock_imports = ["tubefoot._native"]
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
add_module_names = False

html_math_renderer = "mathml"
html_theme = "furo"
html_title = "tubefoot"
html_static_path = [str(HERE / "static")]
html_css_files = ["tubefoot.css"]
html_js_files = ["pictures.js"]
html_favicon = html_logo = str(HERE / "static/tubefoot.svg")
html_copy_source = html_show_sourcelink = False
html_use_index = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5d7a", "color-brand-content": "#0b6a8c"},
    "dark_css_variables": {"color-brand-primary": "#6cc4e0", "color-brand-content": "#6cc4e0"},
}
copybutton_selector = "div.highlight-sh pre, div.highlight-python pre, div.highlight-toml pre, div.highlight-cpp pre"
pygments_style = "friendly"
pygments_dark_style = "native"
