#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws are numbered where they are stated, once ("Law V3 (order): ..."), and quoted by the tests that show them.

No law is without a test; neither a test nor a page quotes a law that is not there. Prints which test shows which law.
"""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).parents[2]
STATED = re.compile(r"\bLaw ([A-Z]\d+) \(([^)]+)\):")
# "Law V3", "Laws A1, A2 and A8", "Laws A1 to A4"
QUOTED = re.compile(r"\bLaws? ([A-Z]\d+(?:(?:, | and | to )[A-Z]\d+)*)")
TEST = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+), (\w+)\)", re.MULTILINE)


def files(*patterns):
    return sorted(path for pattern in patterns for path in ROOT.glob(pattern))


def numbers(words):
    """All laws of a quotation, ranges filled in."""
    found, previous = [], None
    for joint, law in re.findall(r"(^|, | and | to )([A-Z]\d+)", words):
        if joint == " to ":
            found += [f"{law[0]}{k}" for k in range(int(previous[1:]) + 1, int(law[1:]))]
        found.append(law)
        previous = law
    return found


def test_at(text, place):
    """The test that a place is in, or that the comment there stands before."""
    next_test = TEST.search(text, place)
    if next_test and not re.search(r"^[^/\s]", text[text.rfind("\n", 0, place) + 1 : next_test.start()], re.MULTILINE):
        return ".".join(next_test.groups())
    before = [match for match in TEST.finditer(text, 0, place)]
    return ".".join(before[-1].groups()) if before else None


stated, shown, wrong = {}, collections.defaultdict(set), []
for path in files("geometry/**/*.hpp", "src/**/*.hpp", "sensors/**/*.hpp"):
    for law, title in STATED.findall(path.read_text()):
        if law in stated:
            wrong.append(f"{path.relative_to(ROOT)}: law {law} is stated in {stated[law][1]} too")
        stated[law] = title, path.relative_to(ROOT)

for path in files("tests/**/*.cpp"):
    text = path.read_text()
    for quote in QUOTED.finditer(text):
        test = test_at(text, quote.start())
        for law in numbers(quote.group(1)):
            if law not in stated:
                wrong.append(f"{path.relative_to(ROOT)}: there is no law {law}")
            elif test is None:
                wrong.append(f"{path.relative_to(ROOT)}: law {law} is quoted before no test")
            else:
                shown[law].add(test)

for path in files("docs/*.md", "validation/*.md", "geometry/**/*.[ch]pp", "src/**/*.[ch]pp"):
    for words in QUOTED.findall(path.read_text()):
        wrong += [f"{path.relative_to(ROOT)}: there is no law {law}" for law in numbers(words) if law not in stated]

wrong += [f"{stated[law][1]}: no test shows law {law} ({stated[law][0]})" for law in stated if law not in shown]
for law in sorted(stated, key=lambda law: (law[0], int(law[1:]))):
    print(f"{law:4} {stated[law][0]:24} {stated[law][1]}: {', '.join(sorted(shown[law]))}")
print(f"{len(stated)} laws, {len(set().union(*shown.values()) if shown else [])} tests")
print("\n".join(wrong))
sys.exit(1 if wrong or len(stated) < 40 else 0)
