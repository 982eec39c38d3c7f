#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts violations of the style rules, which may only become fewer: style_test.py [--update]

The corpora are documents (docs, README), comments and messages (string literals of C++ with five words or more).
Counted in each: sentences of more than 25 words, of more than 40 words, sentences that open with a noun clause, and the
words that docs/glossary.md avoids; in identifiers only these words. tests/docs/style_counts.json has the permitted counts.
The test fails where a count is larger. It names the files with most of the violations. --update lowers the permitted counts.
--self-test checks the counting itself.
"""
import collections
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
COUNTS = pathlib.Path(__file__).with_name("style_counts.json")
# The texts of these files are part of the published suite, whose bytes do not change (validation/reference/v2/SHA256SUMS).
PUBLISHED = ("src/suite/aspects.cpp", "src/suite/scenes_of_beams.cpp", "src/suite/scenes_of_ways.cpp")
AREAS = ("geometry", "src", "sensors", "python", "validation", "tests")
LONG, VERY_LONG = 25, 40
NOUN_CLAUSE = re.compile(r"(?:Of|What|Who|Whoever|Whose|Beside|Where)\s")


def documents(root):
    for page in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        if page.name != "glossary.md":  # names the words that it avoids
            yield page, prose(page.read_text())


def prose(markdown):
    """The sentences of a page, without code blocks, tables, headings and addresses of links."""
    text = re.sub(r"```.*?```|<[^>]*>", "", markdown, flags=re.S)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    paragraph = []
    for line in [*text.split("\n"), ""]:
        item = re.match(r"\s*(?:[-*]|\d+\.) ", line)
        if line.strip() and not item and not line.startswith(("|", "#", "    ", "!")):
            paragraph.append(line.strip())
            continue
        yield from sentences(" ".join(paragraph))
        paragraph = [line[item.end():].strip()] if item else []


def sentences(paragraph):
    for sentence in re.split(r"(?<=[.!?])\s+(?=[A-Z`\"\[(*])", paragraph):
        if len(sentence.split()) >= 4:
            yield sentence


def sources(root):
    return [file for area in AREAS for file in sorted((root / area).rglob("*")) if file.suffix in (".cpp", ".hpp")]


def comments(text):
    """The sentences of comments. Each list item has its own sentences; indented lines outside of items are formulas."""
    block, in_item = [], False
    for line in [*text.split("\n"), ""]:
        comment = re.match(r"\s*//+<? ?(.*)", line)
        if comment and "SPDX" not in line:
            item = re.match(r" *[-*] ", comment[1])
            formula = not item and not in_item and comment[1].startswith("  ")
            if item or formula:
                yield from sentences(" ".join(block))
                block = []
            in_item = bool(item) or (in_item and comment[1].startswith("  "))
            if not formula:
                block.append(comment[1][item.end():] if item else comment[1])
        elif block:
            yield from sentences(" ".join(block))
            block, in_item = [], False
        if trailing := re.search(r"\S.*?\s///?<? (.*)", line):
            yield trailing[1]


def messages(text):
    for literal in re.findall(r'"((?:[^"\\\n]|\\.){25,})"', text):
        if len(literal.split()) >= 5:
            yield literal


def identifiers(text):
    code = re.sub(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"', " ", text)
    for name in re.findall(r"[A-Za-z_]\w{2,}", code):
        yield re.sub(r"(?<=[a-z0-9])(?=[A-Z])|_+", " ", name).lower()


def avoided(glossary):
    """A pattern of the words in the table of docs/glossary.md; what stands in parentheses is an explanation."""
    section = glossary.split("## Words to avoid")[1]
    rows = [re.sub(r"\(.*?\)", "", row) for row in re.findall(r"^\| ([^|]+) \|", section, re.M)[1:]]
    forms = {form.strip().replace("_", " ") for row in rows for form in row.split(",")}
    return re.compile(r"\b(?:" + "|".join(sorted(map(re.escape, forms))) + r")\b")


def count(root):
    words = avoided((root / "docs/glossary.md").read_text())
    counts, worst = {}, collections.defaultdict(collections.Counter)

    def add(corpus, kind, file, number=1):
        counts[f"{corpus}: {kind}"] = counts.get(f"{corpus}: {kind}", 0) + number
        worst[f"{corpus}: {kind}"][str(file.relative_to(root))] += number

    def judge(corpus, file, found):
        for sentence in found:
            length = len(sentence.split())
            if corpus != "messages":
                add(corpus, f"over {LONG} words", file, int(length > LONG))
                add(corpus, "noun-clause openings", file, int(bool(NOUN_CLAUSE.match(sentence))))
            add(corpus, f"over {VERY_LONG} words", file, int(length > VERY_LONG))
            add(corpus, "avoided words", file, len(words.findall(sentence.lower())))

    for page, found in documents(root):
        judge("documents", page, found)
    for file in sources(root):
        text = file.read_text(errors="replace")
        judge("comments", file, comments(text))
        if file.relative_to(root).as_posix() not in PUBLISHED:
            judge("messages", file, messages(text))
        for name in identifiers(text):
            add("identifiers", "avoided words", file, len(words.findall(name)))
    return counts, worst


def self_test():
    long = "Word " * 25 + "word."
    assert list(prose(f"# A b c d\n\n| a b c d e |\n\nOne two three four. {long}\n\n- An item of a list.\n\n```\na b c d e\n```\n")) == [
        "One two three four.", long, "An item of a list."]
    assert list(prose("See [this page here](a b c).")) == ["See this page here."]
    assert list(comments("// What this is, is this.\nint a;  ///< of a thing\n// Two lines\n// are one sentence.\n")) == [
        "What this is, is this.", "of a thing", "Two lines are one sentence."]
    assert list(comments("// The columns of a file are\n// - time of the ping,\n//   in seconds;\n// - all of the rest.\n// Every row has\n"
                         "//   a = b + c + d\n// in this plain text.\n")) == [
        "The columns of a file are", "time of the ping,   in seconds;", "all of the rest.", "in this plain text."]
    assert list(messages('f("a message of five words here", "short")')) == ["a message of five words here"]
    assert "shot ends" in identifiers("ShotEnds a;") and "view bounds" in identifiers("view_bounds")
    pattern = avoided("## Words to avoid\n\n| form | use |\n|---|---|\n| apart (receiver) | x |\n| heard, hears | y |\n")
    assert pattern.findall("it hears what is apart; apartment") == ["hears", "apart"]


def main():
    self_test()
    if sys.argv[1:] == ["--self-test"]:
        return 0
    counts, worst = count(ROOT)
    permitted = json.loads(COUNTS.read_text()) if COUNTS.exists() else {}
    if sys.argv[1:] == ["--update"]:
        lower = {kind: min(number, permitted.get(kind, number)) for kind, number in sorted(counts.items())}
        COUNTS.write_text(json.dumps(lower, indent=2) + "\n")
        return 0
    failed = 0
    for kind, number in sorted(counts.items()):
        print(f"{kind}: {number}, permitted {permitted.get(kind, 0)}")
        if number > permitted.get(kind, 0):
            failed = 1
            print("  most of them: " + ", ".join(f"{file} ({n})" for file, n in worst[kind].most_common(5)))
        elif number < permitted.get(kind, 0):
            print("  fewer than permitted: tests/docs/style_test.py --update lowers the limit")
    return failed


if __name__ == "__main__":
    sys.exit(main())
