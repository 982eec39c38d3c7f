# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages that are written for code hosts, read as those show them.

Links go to files and to headings by the names that code hosts give them; ```math blocks are formulas; <img> is a
picture like any other. docs/index.md is the tree at the left: its headings, and the first link of each entry below
them. A link that leads nowhere is a warning at its line.
"""
import os
import pathlib
import re
import shutil
import urllib.parse

from docutils import nodes
from docutils.utils.math import latex2mathml
from sphinx.util import logging

log = logging.getLogger(__name__)
IMAGE = re.compile(r"<img\s[^>]*>")
# A function's name, with its exponent or base, before what it is of without brackets.
FUNCTION = re.compile(r"(<mo>&ApplyFunction;</mo>|<msu[bp]>\s*<mi>[a-z]{2,}</mi>\s*<m[in]>[^<]*</m[in]>\s*</msu[bp]>)"
                      r"(?=\s*<m(?:i|sub)>)")
NAMED = re.compile(r'<a id="([^"]+)">(</a>)?')


def slug(heading):
    """The anchor that code hosts give a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


class Anchors:
    """Of the headings of a page, in their order: -1, -2 after one that was there before."""
    def __init__(self):
        self.seen = {}

    def next(self, heading):
        anchor = slug(heading)
        self.seen[anchor] = self.seen.get(anchor, -1) + 1
        return anchor + (f"-{self.seen[anchor]}" if self.seen[anchor] else "")


def navigation(app, docname, source):
    """Writes the navigation tree, which docs/index.md lists by headings, into the landing page.

    Notes and validation pages are reached by links only: they are orphans for Sphinx.
    """
    if docname.startswith(("docs/notes/", "validation/")):
        source[0] = "---\norphan: true\n---\n" + source[0]
    if docname != app.config.root_doc:
        return
    rows = []
    for line in (pathlib.Path(app.srcdir) / "docs/index.md").read_text().splitlines():
        heading = re.match(r"## +(.*)", line)
        entry = re.match(r"[-*] \[([^\]]*)\]\(([^)]*)\.md\)", line)
        if heading:
            rows += ["```"] * bool(rows) + ["", "```{toctree}", ":hidden:", f":caption: {heading[1]}", ""]
        elif entry:
            rows.append(f"{entry[1]} <{os.path.normpath('docs/' + entry[2])}>")
    rows += ["```", "", "```{toctree}", ":hidden:", ":caption: Interfaces", "", "api/python", "api/index",
             "All documents <docs/index>", "```"]
    source[0] += "\n".join(rows) + "\n"


def pictures(app, doctree):
    """HTML that is nothing but pictures."""
    for raw in list(doctree.findall(nodes.raw)):
        html = raw.astext()
        images = [picture(tag, raw) for tag in IMAGE.findall(html)]
        if images and not re.sub(r"</?p>|\s", "", IMAGE.sub("", html)):
            inline = isinstance(raw.parent, nodes.TextElement)
            images = [part for image in images for part in (image, nodes.Text(" "))][:-1]
            raw.parent.replace(raw, images if inline else nodes.paragraph("", "", *images, classes=["pictures"]))


def picture(tag, raw):
    values = dict(re.findall(r'(\w+)="([^"]*)"', tag))
    image = nodes.image(uri=values["src"], **{name: values[name] for name in ("alt", "width") if name in values})
    image.source, image.line = raw.source, raw.line
    return image


def headings_and_formulas(app, doctree):
    """Anchors as on a code host, before the table of contents is made of them."""
    anchors, names = Anchors(), set()
    for section in doctree.findall(nodes.section):
        anchor = anchors.next(section.next_node(nodes.title).astext())
        section["ids"] = [anchor] + [name for name in section["ids"] if name != anchor]
        names.add(anchor)
    for raw in list(doctree.findall(nodes.raw)):
        if name := NAMED.match(raw.astext()):
            if name[1] in names:
                raw.parent.remove(raw)
            names.add(name[1])
    if not hasattr(app.env, "anchors_of_pages"):
        app.env.anchors_of_pages = {}
    app.env.anchors_of_pages[app.env.docname] = names
    for block in list(doctree.findall(nodes.literal_block)):
        if block.get("language") == "math":
            formula = nodes.math_block(block.astext(), block.astext(), nowrap=True, number=None)
            formula.source, formula.line = block.source, block.line
            block.replace_self(formula)


def resolve(app, doctree, docname):
    for link in doctree.findall(nodes.reference):
        uri = link.get("refuri", "")
        if uri and not link.get("internal") and not re.match(r"[a-z]+:", uri):
            try:
                link["refuri"], title = target(app, docname, uri)
                link["internal"] = True
                if title and re.fullmatch(r"[\w./-]+\.md", link.astext()):
                    link.children = [nodes.Text(title)]
            except LookupError as error:
                log.warning("%s", error.args[0], location=link)


def target(app, docname, uri):
    """What a link of a page is on the site; the title of the page that it leads to."""
    path, _, anchor = urllib.parse.unquote(uri).partition("#")
    file = os.path.normpath(os.path.join(os.path.dirname(docname), path)) if path else docname + ".md"
    place = pathlib.Path(app.srcdir) / file
    if file.startswith("..") or not place.exists():
        raise LookupError(f"no such file: {uri}")
    if place.is_dir():
        raise LookupError(f"a folder, which has no page: {uri}")
    page = os.path.splitext(file)[0]
    if page in app.env.all_docs:
        if anchor and anchor not in app.env.anchors_of_pages[page]:
            raise LookupError(f"no such heading: {uri}")
        return app.builder.get_relative_uri(docname, page) + (f"#{anchor}" if anchor else ""), app.env.titles[page].astext()
    copy = f"files/{file}.txt"  # .txt: so that a browser shows it
    (pathlib.Path(app.outdir) / copy).parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(place, pathlib.Path(app.outdir) / copy)
    return os.path.relpath(copy, os.path.dirname(docname) or "."), None


def set_formula(self, node, block):
    """MathML, which browsers set by themselves: nothing to load."""
    text = node.astext()
    try:
        if re.sub(r"\\.", "", text).count("{") != re.sub(r"\\.", "", text).count("}"):
            raise SyntaxError("braces that do not match")
        mathml = FUNCTION.sub(r'\1<mspace width="0.17em"/>', latex2mathml.tex2mathml(text))
    except SyntaxError as error:
        log.warning("a formula that is none: %s", error, location=node)
        raise nodes.SkipNode from None
    wide = mathml.replace("<math ", '<math display="block" ', 1)
    self.body.append(f'<div class="math">{wide}</div>' if block else mathml)
    raise nodes.SkipNode


def setup(app):
    app.connect("source-read", navigation)
    app.connect("doctree-read", pictures, priority=100)
    app.connect("doctree-read", headings_and_formulas, priority=100)
    app.connect("doctree-resolved", resolve)
    app.add_html_math_renderer("mathml", (lambda self, node: set_formula(self, node, False), None),
                               (lambda self, node: set_formula(self, node, True), None))
    return {"parallel_read_safe": False, "parallel_write_safe": False}
