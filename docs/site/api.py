# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of the interfaces: the headers that are installed, one page per module of docs/architecture.md, and the Python module."""
import collections
import os
import re

import headers
from code_host import Anchors
from docutils import nodes

AREAS = ("geometry", "src", "sensors")
PYTHON = """\
Python module
=============

.. automodule:: tubefoot
   :members:
   :imported-members:
"""
LEAD = """\
# C++ headers

This page lists the headers that an installed tubefoot offers to C++ programs ([guide](../docs/installation.md#your-own-program)), by
the modules of [the architecture](../docs/architecture.md). Each page shows public declarations without bodies. All names are in the
namespace `tubefoot`. Begin with [the example](../docs/examples/own-sonar/main.cpp), which defines a sonar and an engine.

| module | content |
|---|---|
"""


def prose(lines):
    """A comment as Markdown: code stays, all else means itself; laws stand out."""
    text = "\n".join(lines)
    parts = re.split(r"(`[^`]*`)", text)
    parts[::2] = [re.sub(r"([\\*_<>\[\]#|$~])", r"\\\1", part) for part in parts[::2]]
    text = "".join(parts)
    text = re.sub(r"\(?docs/((?:notes/)?[\w-]+)\.md\)?", lambda page: page[0].replace(f"docs/{page[1]}.md", f"[{page[1]}](../docs/{page[1]}.md)"), text)
    text = re.sub(r"^(\d+)\. ", r"\1\\. ", text, flags=re.M)
    return re.sub(r"^(Law [A-Z]\d+ \([^)]*\):)", r"\n**\1**", text, flags=re.M)


def page_name(module):
    return "api/" + module.replace("/", "-")


def write_pages(sources, site):
    """Pages of all modules below a folder of sources, into site/api; returns the types with their pages."""
    content_of = dict(re.findall(r"^\| `([\w/]+)` \| (.*?) \|", (sources / "docs/architecture.md").read_text(), re.M))
    modules = collections.defaultdict(list)
    for top in AREAS:
        for file in sorted((sources / top).rglob("*.hpp")):
            modules[file.parent.relative_to(sources).as_posix()].append(file)
    modules = {module: modules[module] for module in sorted(modules, key=lambda module: (list(content_of).index(module) if module in content_of else len(content_of)))}
    places = collections.defaultdict(set)
    (site / "api").mkdir(parents=True, exist_ok=True)
    for module, files in modules.items():
        anchors, page = Anchors(), [f"# {module}", "", content_of.get(module, "").capitalize() + ".", ""]
        anchors.next(module)
        for file in files:
            page += page_of(file, sources, anchors, page_name(module), places)
        (site / f"{page_name(module)}.md").write_text("\n".join(page))
    listing = "".join(f"| [{module}]({os.path.basename(page_name(module))}.md) | {content_of.get(module, '')} |\n" for module in modules)
    tree = "\n".join(f"{module} <{os.path.basename(page_name(module))}>" for module in modules)
    (site / "api/index.md").write_text(f"{LEAD}{listing}\n```{{toctree}}\n:hidden:\n\n{tree}\n```\n")
    (site / "api/python.rst").write_text(PYTHON)
    return {name: next(iter(where)) for name, where in places.items() if len(where) == 1}


def page_of(file, sources, anchors, page, places):
    path = file.relative_to(sources).as_posix()
    anchors.next(file.name)
    rows = [f"## {file.name}", "", f"`#include \"{path.removeprefix('src/')}\"` · [the file](../{path})", ""]
    for entry in headers.declared(file.read_text()):
        if entry.names:
            title = ", ".join(entry.names[:3]) + (" ..." if len(entry.names) > 3 else "")
            anchor = anchors.next(title)
            for name in entry.types:
                places[name].add((page, anchor))
            rows += ["### " + re.sub(r"([*_<>\[\]|~])", r"\\\1", title), ""]
        rows += [prose(entry.comment), ""]
        if entry.declarations:
            rows += ["```cpp", entry.text, "```", ""]
    return rows


def link_types(app, page, template, context, doctree):
    """Names of types in declarations lead to where they are content_of."""
    types = app.config.tubefoot_types
    if not page.startswith("api/") or not types or "body" not in context:
        return

    def link(span):
        where = types.get(span[2])
        if not where:
            return span[0]
        uri = f"{app.builder.get_relative_uri(page, where[0])}#{where[1]}"
        return f'<a class="type" href="{uri}">{span[0]}</a>'

    context["body"] = re.sub(r'<span class="(n|nf|kt)">(\w+)</span>', link, context["body"])


def short_in_the_tree(app, env):
    """Declarations are in the contents at the right of their own page; in the tree of all pages they would only take time."""
    env.declarations = {}
    for page in env.tocs:
        if page.startswith("api/") and page != "api/index":
            env.declarations[page] = env.tocs[page].deepcopy()
            for contents in list(env.tocs[page].findall(nodes.bullet_list))[1:]:
                if contents.parent:
                    contents.parent.remove(contents)


def contents_of_a_page(app, page, template, context, doctree):
    """Before the theme looks at them: all of its own."""
    if page in app.env.declarations:
        exchange(app, page)
        contents = app.env.tocs[page].deepcopy()
        for link in contents.findall(nodes.reference):
            link["refuri"] = link["anchorname"] or "#"
        context["toc"] = app.builder.render_partial(contents)["fragment"]


def contents_of_the_next_page(app, page, template, context, doctree):
    if page in app.env.declarations:
        exchange(app, page)


def exchange(app, page):
    app.env.tocs[page], app.env.declarations[page] = app.env.declarations[page], app.env.tocs[page]


def docstring(app, what, name, thing, options, lines):
    """docs/sensors.md in a docstring of the module is a link; what an array is comes before what is in it."""
    lines[:] = [re.sub(r"(?<![`/\w])docs/((?:notes/)?[\w-]+)\.md", r":doc:`/docs/\1`", line) for line in lines]
    kind = next((line for line in lines if line.startswith(":type:")), None)
    if what == "property" and kind:  # "(N,) float64: what it is" has been taken apart
        lines.remove(kind)
        lines[0] = f"{kind.removeprefix(':type: ')}: {lines[0]}"


def not_made_by_users(app, what, name, thing, options, signature, returned):
    """Constructors from what is compiled are nobody's business."""
    return ("", returned) if what == "class" and "_native." in (signature or "") else None


def setup(app):
    app.add_config_value("tubefoot_types", {}, "html")
    app.connect("env-updated", short_in_the_tree)
    app.connect("html-page-context", contents_of_a_page, priority=400)
    app.connect("html-page-context", contents_of_the_next_page, priority=600)
    app.connect("html-page-context", link_types)
    app.connect("autodoc-process-docstring", docstring, priority=600)  # after napoleon
    app.connect("autodoc-process-signature", not_made_by_users)
    return {"parallel_read_safe": False, "parallel_write_safe": False}
