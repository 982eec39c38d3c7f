#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the figures of the documents without drawing: figures_test.py [--self-test]

A figure is a PNG or SVG file in docs/figures, docs/gallery or docs/pictures. The test fails for a figure
- whose stored hash differs from that of its present inputs (docs/figures/stamp.py): `make figures FIGURES=--stale`,
- without a row in docs/figures/recipes.py, or a row without a figure,
- that no page shows,
for a page that shows a missing picture, and for a gallery picture whose command is not on the page. --self-test
damages copies and checks that each fault is found.
"""
import pathlib
import re
import shutil
import sys
import tempfile

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("figures", "gallery", "pictures")
sys.path.insert(0, str(ROOT / "docs/figures"))

import stamp  # noqa: E402
from recipes import FIGURES, Figure  # noqa: E402


def pages(root):
    return [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md")),
            *sorted((root / "validation").rglob("*.md"))]


def pictures_on(page, root):
    """(line, file) of the pictures that a page shows or links."""
    # The site's front page is copied to the top.
    folder = root if page == root / "docs/site/index.md" else page.parent
    for number, line in enumerate(page.read_text().splitlines(), 1):
        for words in re.findall(r'\]\(([^()\s]+\.(?:png|svg))\)|src="([^"]+\.(?:png|svg))"', line):
            name = words[0] or words[1]
            if "://" not in name:
                yield number, (folder / name).resolve()


def faults(root, figures, hash_of=stamp.hash_of):
    docs = root / "docs"
    rows = {docs / figure.name: figure for figure in figures}
    files = {file for folder in FOLDERS for file in (docs / folder).iterdir() if file.suffix in (".png", ".svg")}
    shown = set()
    for page in pages(root):
        for number, file in pictures_on(page, root):
            shown.add(file)
            if not file.is_file():
                yield f"{page.relative_to(root)}:{number}: the page shows {file.name}, which does not exist"
    for file in sorted(files - rows.keys()):
        yield f"{file.relative_to(root)}: no row in docs/figures/recipes.py"
    for file in sorted(rows.keys() - files):
        yield f"{file.relative_to(root)}: is in docs/figures/recipes.py, but was not drawn: make figures FIGURES=--stale"
    for file in sorted(files & rows.keys()):
        if file.resolve() not in shown:
            yield f"{file.relative_to(root)}: no page shows this figure"
        kept = stamp.read(file).get(stamp.HASH)
        if kept is None:
            yield f"{file.relative_to(root)}: contains no hash of its inputs: make figures FIGURES={rows[file].name}"
        elif kept != hash_of(rows[file]):
            yield f"{file.relative_to(root)}: its inputs have changed: make figures FIGURES=--stale"
    gallery = (docs / "gallery.md").read_text()
    for figure in figures:
        here = f"({figure.name})" in gallery or f'src="{figure.name}"' in gallery
        for command in figure.commands if here else ():
            if "_study " not in command and command not in gallery:
                yield f"docs/gallery.md: shows {figure.name} without its command: {command}"


class Copy:
    """A small copy of a tree of documents with one figure."""
    def __init__(self, folder):
        self.root = pathlib.Path(folder)
        for name in (*(f"docs/{part}" for part in FOLDERS), "validation"):
            (self.root / name).mkdir(parents=True)
        for page in ("README.md", "CONTRIBUTING.md"):
            (self.root / page).write_text("")
        self.page = self.root / "docs/gallery.md"
        self.page.write_text('<img src="gallery/one.png">\nrun one\n')
        self.figure = Figure("gallery/one.png", ("run one",), "out/one.png")
        self.file = self.root / "docs/gallery/one.png"
        source = next(file for folder in FOLDERS for file in sorted((ROOT / "docs" / folder).glob("*.png")))
        shutil.copy(source, self.file)
        stamp.write(self.file, self.file.read_bytes(), {stamp.HASH: "right"})

    def faults(self, figures=None):
        return list(faults(self.root, [self.figure] if figures is None else figures, lambda figure: "right"))


def self_test():
    def without_hash(copy):
        stamp.write(copy.file, copy.file.read_bytes(), {})

    def old_hash(copy):
        stamp.write(copy.file, copy.file.read_bytes(), {stamp.HASH: "wrong"})
    damages = [
        ("no fault", lambda copy: None, None, []),
        ("stale", old_hash, None, ["its inputs have changed"]),
        ("no hash", without_hash, None, ["contains no hash"]),
        ("no row", lambda copy: None, [], ["no row"]),
        ("not drawn", lambda copy: copy.file.unlink(), None, ["which does not exist", "was not drawn"]),
        ("not shown", lambda copy: copy.page.write_text("run one\n"), None, ["no page shows"]),
        ("no command", lambda copy: copy.page.write_text('<img src="gallery/one.png">'), None, ["without its command"]),
        ("missing picture", lambda copy: copy.page.write_text(copy.page.read_text() + "![x](gallery/two.png)"), None,
         ["which does not exist"]),
    ]
    wrong = 0
    for name, damage, figures, expected in damages:
        with tempfile.TemporaryDirectory() as folder:
            copy = Copy(folder)
            damage(copy)
            found = copy.faults(figures)
        if len(found) != len(expected) or not all(any(e in f for f in found) for e in expected):
            wrong += 1
            print(f"FAILED self-test '{name}': expected {expected}, found {found}")
    svg = pathlib.Path(tempfile.mkdtemp()) / "a.svg"
    stamp.write(svg, '<svg xmlns="x" width="1">\n</svg>\n', {stamp.HASH: "a", stamp.MADE_BY: "b: c"})
    if stamp.read(svg) != {stamp.HASH: "a", stamp.MADE_BY: "b: c"}:
        wrong += 1
        print(f"FAILED self-test: metadata of SVG {stamp.read(svg)}")
    shutil.rmtree(svg.parent)
    print(f"{len(damages) + 1} checks, {wrong} failures")
    return wrong


def main():
    if "--self-test" in sys.argv:
        sys.exit(1 if self_test() else 0)
    found = list(faults(ROOT, FIGURES))
    print("\n".join(f"FAILED {fault}" for fault in found))
    print(f"{len(FIGURES)} figures, {len(found)} failures")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
