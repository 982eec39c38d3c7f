# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of the interfaces: the headers that are installed, a page a room of docs/house.md, and the Python module."""
import collections
import os
import re

import headers
from code_host import Anchors
from docutils import nodes

ROOMS = ("geometry", "src", "sensors")
PYTHON = """\
Python module
=============

.. automodule:: tubefoot
   :members:
   :imported-members:
"""
LEAD = """\
# C++ headers

What an installed tubefoot gives a program of one's own ([how](../docs/packaging.md#a-program-of-your-own)), by the rooms of
[the house](../docs/house.md): each header with what it declares, without bodies and what is private. All of it is in the
namespace `tubefoot`. Begin with [an example](../docs/examples/own-sonar/main.cpp), a sonar and an engine of one's own.

| room | what it holds |
|---|---|
"""


def prose(lines):
    """A comment as Markdown: code stays, all else means itself; laws stand out."""
    text = "\n".join(lines)
    parts = re.split(r"(`[^`]*`)", text)
    parts[::2] = [re.sub(r"([\\*_<>\[\]#|$~])", r"\\\1", part) for part in parts[::2]]
    text = "".join(parts)
    text = re.sub(r"\(?docs/([\w-]+)\.md\)?", lambda page: page[0].replace(f"docs/{page[1]}.md", f"[{page[1]}](../docs/{page[1]}.md)"), text)
    text = re.sub(r"^(\d+)\. ", r"\1\\. ", text, flags=re.M)
    return re.sub(r"^(Law [A-Z]\d+ \([^)]*\):)", r"\n**\1**", text, flags=re.M)


def page_name(room):
    return "api/" + room.replace("/", "-")


def write_pages(sources, site):
    """Pages of all rooms below a folder of sources, into site/api; returns the types, where they are told."""
    told = dict(re.findall(r"^\| `([\w/]+)` \| (.*?) \|", (sources / "docs/house.md").read_text(), re.M))
    rooms = collections.defaultdict(list)
    for top in ROOMS:
        for file in sorted((sources / top).rglob("*.hpp")):
            rooms[file.parent.relative_to(sources).as_posix()].append(file)
    rooms = {room: rooms[room] for room in sorted(rooms, key=lambda room: (list(told).index(room) if room in told else len(told)))}
    places = collections.defaultdict(set)
    (site / "api").mkdir(parents=True, exist_ok=True)
    for room, files in rooms.items():
        anchors, page = Anchors(), [f"# {room}", "", told.get(room, "").capitalize() + ".", ""]
        anchors.next(room)
        for file in files:
            page += page_of(file, sources, anchors, page_name(room), places)
        (site / f"{page_name(room)}.md").write_text("\n".join(page))
    listing = "".join(f"| [{room}]({os.path.basename(page_name(room))}.md) | {told.get(room, '')} |\n" for room in rooms)
    tree = "\n".join(f"{room} <{os.path.basename(page_name(room))}>" for room in rooms)
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
    """Names of types in declarations lead to where they are told."""
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
    lines[:] = [re.sub(r"(?<![`/\w])docs/([\w-]+)\.md", r":doc:`/docs/\1`", line) for line in lines]
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
