#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the documents as a site: build.py OUTPUT writes OUTPUT/html/index.html.

The pages are written for a repository browser. Doxygen wants other links and other names for headings, so
it reads copies: line by line the same, with links between pages as references, and an anchor on every
heading, named as repository browsers name it. The tree at the left is docs/index.md: its headings and their
lists of links. Afterwards every link and picture of the result is looked up; a broken one fails the build,
as does any warning.
"""
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse
from xml.sax.saxutils import quoteattr

SOURCES = pathlib.Path(__file__).resolve().parents[2]
PAGES = ["README.md", "docs/*.md", "validation/*.md", "validation/reference/*/README.md"]
HEADERS = ["geometry", "sensors", "src"]
PICTURES = ["docs/pictures", "docs/gallery", "docs/figures", "validation/pictures"]
LINK = re.compile(r"\]\(([^()\s]+)\)")  # its text may begin a line earlier
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^()\s]+)\)")
NAMED = re.compile(r'<a id="([^"]+)"></a>$')
IMAGE = re.compile(r'<img src="([^"]+)"')
CODE = re.compile(r"(`+)(.+?)\1")


class BrokenLink(Exception):
    pass


def slug(heading):
    """The anchor that repository browsers give a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def page_name(page):
    """docs/scene-file.md -> scene-file; others keep their folders: validation-atlas, README."""
    relative = page.relative_to(SOURCES).with_suffix("")
    parts = relative.parts[1:] if relative.parts[0] == "docs" else relative.parts
    return "-".join(parts)


def lines_of(page):
    """(line, whether it is code) of a page: fenced or, after an empty line, indented by four."""
    fenced, indented, before = False, False, ""
    for line in page.read_text().splitlines():
        if re.match(r"\s*```", line):
            fenced = not fenced
            yield line, True
        else:
            indented = (line.startswith("    ") and (indented or not before.strip())
                        and not re.match(r"\s+([-*|]|\d+\.) ", line))
            yield line, fenced or indented
        before = line


def headings_of(page):
    """(level, text, anchor), with -1, -2 after an anchor that was there before."""
    seen = {}
    for line, code in lines_of(page):
        heading = None if code else re.match(r"(#+) +(.*?) *$", line)
        if heading:
            anchor = slug(heading[2])
            seen[anchor] = seen.get(anchor, -1) + 1
            yield len(heading[1]), heading[2], anchor + (f"-{seen[anchor]}" if seen[anchor] else "")


class Site:
    def __init__(self, output):
        self.output, self.html = output, output / "html"
        self.pages = sorted(page for pattern in PAGES for page in SOURCES.glob(pattern))
        self.headings = {page: {anchor for _, _, anchor in headings_of(page)} for page in self.pages}
        self.anchors = {page: headings | {name[1] for line, code in lines_of(page) if (name := NAMED.match(line))}
                        for page, headings in self.headings.items()}
        self.files = set()

    def reference(self, page):
        return "mainpage" if page_name(page) == "index" else "page-" + page_name(page)

    def target(self, page, link):
        """A link of a page, as Doxygen wants it."""
        if re.match(r"[a-z]+:", link):
            return link
        path, _, anchor = link.partition("#")
        file = (page.parent / path).resolve() if path else page
        if not file.exists() or SOURCES not in file.parents:
            raise BrokenLink(f"no such file: {link}")
        if file in self.anchors:
            if anchor and anchor not in self.anchors[file]:
                raise BrokenLink(f"no such heading: {link}")
            return "@ref " + (f"{page_name(file)}-{anchor}" if anchor else self.reference(file))
        if file.is_dir():
            raise BrokenLink(f"a folder, which has no page: {link}")
        relative = file.relative_to(SOURCES)
        self.files.add(relative)
        return f"files/{relative}.txt"

    def picture(self, page, link):
        file = (page.parent / link).resolve()
        if not file.exists():
            raise BrokenLink(f"no such picture: {link}")
        return str(file.relative_to(SOURCES))

    def prose(self, page, line):
        """A line outside code, with what is between backticks left alone."""
        line = IMAGE.sub(lambda image: f'<img src="{self.picture(page, image[1])}"', line)
        line = PICTURE.sub(lambda image: f'<img src="{self.picture(page, image[2])}" alt="{image[1]}">', line)
        kept = []
        def keep(code):
            kept.append(code[0])
            return f"\0{len(kept) - 1}\0"
        line = LINK.sub(lambda link: f"]({self.target(page, link[1])})", CODE.sub(keep, line))
        return re.sub(r"\0(\d+)\0", lambda number: kept[int(number[1])], line)

    def copy_of(self, page):
        headings, result = headings_of(page), []
        for number, (line, code) in enumerate(lines_of(page), 1):
            try:
                if code:
                    result.append(line)
                elif re.match(r"#+ ", line):
                    level, text, anchor = next(headings)
                    mark = self.reference(page) if level == 1 else f"{page_name(page)}-{anchor}"
                    result.append(f"{'#' * level} {text} {{#{mark}}}")
                elif name := NAMED.match(line):
                    result.append("" if name[1] in self.headings[page] else f"@anchor {page_name(page)}-{name[1]}")
                else:
                    result.append(self.prose(page, line))
            except BrokenLink as error:
                sys.exit(f"{page.relative_to(SOURCES)}:{number}: {error}")
        return "\n".join(result) + "\n"

    def layout(self):
        """The tree at the left: docs/index.md, a branch for each heading, then the code."""
        page, open_branch = SOURCES / "docs/index.md", False
        rows = ['<doxygenlayout version="1.0"><navindex>', '<tab type="mainpage" visible="yes" title="tubefoot"/>']
        for line, code in lines_of(page):
            heading = re.match(r"##+ +(.*)", line)
            entry = re.match(r"[-*] \[([^\]]*)\]\(([^)]*)\)", line)
            if heading:
                rows += ["</tab>"] * open_branch + [f'<tab type="usergroup" visible="yes" title={quoteattr(heading[1])}>']
                open_branch = True
            elif entry:
                url = self.target(page, entry[2])
                rows.append(f'<tab type="user" visible="yes" url={quoteattr(url)} title={quoteattr(entry[1])}/>')
        entries = re.findall(r"^[-*] \[[^\]]*\]\(([^)]*)\)", page.read_text(), re.M)
        listed = {(page.parent / entry).resolve() for entry in entries}
        for left_out in [other for other in self.pages if other not in listed and other != page]:
            sys.exit(f"{page.relative_to(SOURCES)} does not list {left_out.relative_to(SOURCES)}")
        rows += ["</tab>"] * open_branch
        rows += ['<tab type="usergroup" visible="yes" title="The code">',
                 '<tab type="namespacelist" visible="yes" title="Namespaces"/>',
                 '<tab type="classlist" visible="yes" title="Classes"/>',
                 '<tab type="filelist" visible="yes" title="Files"/>', "</tab></navindex></doxygenlayout>"]
        return "\n".join(rows) + "\n"

    def write(self):
        shutil.rmtree(self.output, ignore_errors=True)
        copies = self.output / "pages"
        copies.mkdir(parents=True)
        for page in self.pages:
            (copies / f"{page_name(page)}.md").write_text(self.copy_of(page))
        (self.output / "layout.xml").write_text(self.layout())
        settings = (SOURCES / "docs/site/Doxyfile").read_text()
        inputs = [copies] + [SOURCES / folder for folder in HEADERS]
        settings += "\n".join([
            "INPUT = " + " ".join(f'"{path}"' for path in inputs), f'OUTPUT_DIRECTORY = "{self.output}"',
            f'FILTER_PATTERNS = "*.hpp=sed -E -f {SOURCES}/docs/site/placeholders.sed"',
            f'STRIP_FROM_PATH = "{SOURCES}" "{copies}"', f'LAYOUT_FILE = "{self.output}/layout.xml"',
            f'HTML_EXTRA_STYLESHEET = "{SOURCES}/docs/site/style.css"', ""])
        (self.output / "Doxyfile").write_text(settings)
        if subprocess.run(["doxygen", str(self.output / "Doxyfile")]).returncode:
            sys.exit("doxygen warned: see above")
        for folder in PICTURES:
            if (SOURCES / folder).is_dir():
                shutil.copytree(SOURCES / folder, self.html / folder, ignore=shutil.ignore_patterns("*.py"))
        for file in self.files:
            (self.html / "files" / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(SOURCES / file, self.html / "files" / f"{file}.txt")


class Addresses(html.parser.HTMLParser):
    """What a page points to, and what in it may be pointed to."""
    def __init__(self):
        super().__init__()
        self.links, self.names = [], set()

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if value and (name == "id" or (tag == "a" and name == "name")):
                self.names.add(value)
            elif value and name in ("href", "src"):
                self.links.append(value)


def broken_links(folder):
    """Links and pictures of the site that lead nowhere, or over the network by themselves."""
    pages = {}
    for file in folder.rglob("*.html"):
        pages[file.resolve()] = Addresses()
        pages[file.resolve()].feed(file.read_text(errors="replace"))
    for file, page in sorted(pages.items()):
        for link in page.links:
            address = urllib.parse.urlsplit(link)
            if address.scheme or link.startswith("javascript"):
                continue
            path = urllib.parse.unquote(address.path)
            target = pathlib.Path(os.path.normpath(file.parent / path)) if path else file
            if not target.exists():
                yield f"{file.name}: nothing at {link}"
            elif address.fragment == "nested-classes":  # Doxygen 1.9.4 links to this of classes that hide theirs
                continue
            elif address.fragment and target in pages and address.fragment not in pages[target].names:
                yield f"{file.name}: no such place: {link}"


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: build.py OUTPUT")
    if not shutil.which("doxygen"):
        print("Skipped: doxygen is not installed (apt install doxygen)")
        sys.exit(77)
    site = Site(pathlib.Path(sys.argv[1]).resolve())
    site.write()
    broken = list(broken_links(site.html))
    if broken:
        sys.exit("\n".join(broken))
    print(f"{len(site.pages)} pages: {site.html}/index.html")


if __name__ == "__main__":
    main()
