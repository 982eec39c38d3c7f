#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the documents as a site: build.py OUTPUT [SOURCES] writes OUTPUT/html/index.html.

Sphinx reads the pages where they stand, through links in OUTPUT/pages, beside the pages of the interfaces that are
made there (api.py). Any warning fails the build, and so does what the finished site cannot reach, or would load over
the network.
"""
import html.parser
import os
import pathlib
import re
import shutil
import sys
import urllib.parse

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))

LOADED = {("img", "src"), ("script", "src"), ("link", "href"), ("iframe", "src"), ("source", "src"), ("video", "src")}
OF_NO_FILE = {"canonical", "index", "next", "prev", "search", "author", "copyright"}  # <link>s that load nothing


class Addresses(html.parser.HTMLParser):
    """What a page points to, what it loads, and what in it may be pointed to."""
    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.names = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        for name, value in attributes:
            if value and (name == "id" or (tag == "a" and name == "name")):
                self.names.add(value)
            elif value and name in ("href", "src"):
                self.links.append(value)
                if (tag, name) in LOADED and values.get("rel") not in OF_NO_FILE:
                    self.loaded.append(value)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)


def faults(site):
    """Links and pictures of the site that lead nowhere, and what it would load over the network."""
    pages = {file.resolve(): Addresses(file.read_text()) for file in site.rglob("*.html")}
    for file, page in sorted(pages.items()):
        name = file.relative_to(site)
        yield from (f"{name}: loads {link} over the network" for link in page.loaded
                    if re.match(r"([a-z]+:)?//", link))
        for link in page.links:
            address = urllib.parse.urlsplit(link)
            if address.scheme or address.netloc:
                continue
            path = urllib.parse.unquote(address.path)
            target = pathlib.Path(os.path.normpath(file.parent / path)) if path else file
            if not target.is_file():
                yield f"{name}: nothing at {link}"
            elif address.fragment and target in pages and urllib.parse.unquote(address.fragment) not in pages[target].names:
                yield f"{name}: no such place: {link}"
    for file in sorted(site.rglob("*.css")):
        for link in re.findall(r"""(?:url\(|@import )\s*["']?([^"')\s]+)""", file.read_text()):
            if re.match(r"([a-z]+:)?//", link):
                yield f"{file.relative_to(site)}: loads {link} over the network"
            elif not re.match(r"data:|#", link) and not (link[0] != "/" and (file.parent / link).is_file()):
                yield f"{file.relative_to(site)}: nothing at {link}"


def folder_of_links(sources, pages):
    """What Sphinx reads: the sources by their own paths, the landing page at the top."""
    shutil.rmtree(pages, ignore_errors=True)
    pages.mkdir(parents=True)
    for entry in sources.iterdir():
        if not entry.name.startswith(".") and entry.name not in ("build", "out"):
            (pages / entry.name).symlink_to(entry)
    (pages / "index.md").symlink_to(sources / "docs/site/index.md")


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: build.py OUTPUT [SOURCES]")
    try:
        import furo, myst_parser, sphinx_copybutton  # noqa: F401, E401
        from sphinx.application import Sphinx
        from sphinx.errors import SphinxError
    except ImportError as error:
        print(f"Skipped: {error} (tools/setup documents installs what the site is made with)")
        sys.exit(77)
    import api
    output = pathlib.Path(sys.argv[1]).resolve()
    sources = pathlib.Path(sys.argv[2]).resolve() if len(sys.argv) == 3 else HERE.parents[1]
    os.environ["TUBEFOOT_SITE_SOURCES"] = str(sources)
    pages, site = output / "pages", output / "html"
    folder_of_links(sources, pages)
    types = api.write_pages(sources, pages)
    shutil.rmtree(site, ignore_errors=True)
    try:
        sphinx = Sphinx(pages, HERE, site, output / "doctrees", "html", {"tubefoot_types": types}, status=None,
                        freshenv=True, warningiserror=True, keep_going=True)
        sphinx.build(force_all=True)
    except SphinxError as error:
        sys.exit(f"{error.category}: {error}")
    found = list(faults(site))
    if found:
        print("\n".join(found), file=sys.stderr)
    if sphinx.statuscode or found:
        sys.exit("the site is not whole: see above")
    print(f"{len(sphinx.env.all_docs)} pages: {site}/index.html")


if __name__ == "__main__":
    main()
