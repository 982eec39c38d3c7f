#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Comments name pages and sections that exist: `docs/notes/signals.md, "Pulses"` or `..., section "Pulses"`.

Numbers of sections are left out in comments.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("geometry", "src", "sensors", "python", "tests", "validation", "scenes")
COMMENT = re.compile(r"(?:^[ \t]*(?://|#).*\n)+", re.MULTILINE)
PAGE = r"((?:docs|validation)/[\w/-]+\.md)"
SECTIONS = re.compile(PAGE + r'(?:,? \(?sections? |, |,? \()("[^"]+"(?:(?:, | and )"[^"]+")*)')


def headings(page):
    return {re.sub(r"^#+ (?:\d[\d.]* )?", "", line) for line in page.read_text().split("\n") if line.startswith("#")}


def faults(text, pages):
    """Yields a message for each page or section that comments of `text` name and that does not exist."""
    for comment in COMMENT.findall(text):
        words = re.sub(r"\s*\n\s*(?:///?<?|#)\s*", " ", comment)
        for page in sorted(set(re.findall(PAGE, words)) - set(pages)):
            yield f"there is no page {page}"
        for page, names in SECTIONS.findall(words):
            for name in re.findall(r'"([^"]+)"', names):
                if page in pages and name not in pages[page]:
                    yield f'{page} has no section "{name}"'


def self_test(pages):
    good = '// Source: docs/notes/signals.md, "Mirrors"\n// and "Moving\n// ends".\n'
    assert list(faults(good, pages)) == [], list(faults(good, pages))
    assert list(faults('/// See docs/absent.md.\n', pages)) == ["there is no page docs/absent.md"]
    assert list(faults('# docs/notes/signals.md, section "Cellar"\n', pages)) == ['docs/notes/signals.md has no section "Cellar"']


def main():
    pages = {str(page.relative_to(ROOT)): headings(page) for folder in ("docs", "validation") for page in (ROOT / folder).rglob("*.md")}
    self_test(pages)
    files = [file for folder in FOLDERS for file in (ROOT / folder).rglob("*")
             if file.suffix in (".cpp", ".hpp", ".py", ".toml") and file != pathlib.Path(__file__).resolve()]
    wrong = [f"{file.relative_to(ROOT)}: {fault}" for file in files for fault in faults(file.read_text(), pages)]
    print("\n".join(wrong) or f"the comments of {len(files)} files name pages and sections that exist")
    return 1 if wrong else 0


sys.exit(main())
