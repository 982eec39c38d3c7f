#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rooms of docs/house.md are those of the tree, and no file includes what its room may not: house_test.py

docs/house.md has the only table of rooms and of who may include whom. Fails for
- a source file in a folder that is no room, and a room without files;
- an #include of a room that the including one may not include, or of no room;
- a room that may include one below it in the table (upwards), and a permission that nobody uses;
- a source file longer than 600 lines, and a test longer than 750;
- tests in a folder that mirrors no room;
- two types of one name in one namespace: the linker would mix up what the compiler makes of them
- source that a document names and that is not there, and a walk of a ping of more than 25 files.
With --teeth it holds itself against little trees that break one of these each.
"""
import pathlib
import re
import sys
import tempfile

SOURCES = pathlib.Path(__file__).resolve().parents[2]
AREAS = ["geometry", "src", "sensors"]
LONGEST, LONGEST_TEST = 600, 750
# Source that a document names: a path to a file or a folder, with or without an ending.
NAMED = re.compile(r"(?<![\w/.:-])((?:geometry|src|sensors|tests|validation|python/native)/[\w/-]*\w(?:\.\w+)?)(?![\w*]|\.\{)")
LONGEST_WALK = 25
MADE = {"validation/advise.md"}  # by make advise-study, for who asks
# Helpers of tests, programs of their own, and what is no C++.
NO_MIRRORS = {"tests"} | {f"tests/{name}" for name in (
    "determinism", "docs", "fixtures", "fixtures/geometry", "fixtures/world", "fuzz", "house", "mathematics", "mpi", "packaging", "prove", "sanitizers",
    "validation", "viewer")}


def code_in(folder):
    return sorted(file for file in folder.rglob("*") if file.suffix in (".cpp", ".hpp"))


class House:
    """The tables of docs/house.md."""

    def __init__(self, root):
        self.page = root / "docs/house.md"
        self.rooms = {}  # in the table's order: (line, names of what it may include)
        self.walk = []
        head = None
        for number, line in enumerate(self.page.read_text().splitlines(), 1):
            if not line.startswith("|"):
                head = None
                continue
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if head is None:
                head = cells
            elif head[0] == "room" and head[-1] == "may include" and not line.startswith("|--"):
                room, may = re.search(r"`([^`]+)`", cells[0]), re.findall(r"`([^`]+)`", cells[-1])
                self.rooms[room[1]] = (number, may)
            elif head[0] == "step" and not line.startswith("|--"):
                self.walk += re.findall(r"`([^`]+)`", cells[1])

    def named(self, pattern):
        """The rooms that a cell's word stands for: `geometry/*` is every one of geometry."""
        if pattern.endswith("/*"):
            return [room for room in self.rooms if room.startswith(pattern[:-1])]
        return [pattern] if pattern in self.rooms else []


DEFINED = re.compile(r"(?:struct|class|enum class|enum|union) (\w+)(?: final)?(?: :(?!:)[^;]*)?(?: \{.*)?$")


def types_in(file):
    """Full names of the types that a file defines outside of unnamed namespaces, with their lines."""
    spaces = []
    for number, line in enumerate(file.read_text().splitlines(), 1):
        if opened := re.match(r"(?:inline )?namespace\s*([\w:]*)\s*\{", line):
            spaces.append(opened[1])
        elif line.startswith("}  // namespace"):
            del spaces[-1:]
        elif "" not in spaces and (defined := DEFINED.match(line)):
            yield "::".join([*spaces, defined[1]]), number


def wrongs(root):
    house, found = House(root), []
    page = house.page.relative_to(root)
    order = {room: number for number, room in enumerate(house.rooms)}
    may = {}
    for room, (line, patterns) in house.rooms.items():
        may[room] = set()
        for pattern in patterns:
            meant = house.named(pattern)
            if not meant:
                found.append(f"{page}:{line}: `{room}` may include `{pattern}`, which is no room of the table: name one")
            for other in meant:
                if order[other] > order[room]:
                    found.append(f"{page}:{line}: `{room}` may include `{other}`, which stands below it: what both need "
                                 "belongs into a room above both")
                may[room].add(other)
        if not [file for file in (root / room).glob("*") if file.suffix in (".cpp", ".hpp")]:
            found.append(f"{page}:{line}: the room `{room}` has no files: leave it out of the table")

    used = {room: set() for room in house.rooms}
    for file in [file for area in AREAS for file in code_in(root / area)]:
        name, room = file.relative_to(root), str(file.parent.relative_to(root))
        if room not in house.rooms:
            found.append(f"{name}:1: {room} is no room of {page}: put the file into one, or give the table a row that says "
                         "what the new room holds and may include")
            continue
        text = file.read_text()
        for number, line in enumerate(text.splitlines(), 1):
            include = re.match(r'\s*#\s*include\s+"([^"]+)"', line)
            if not include:
                continue
            target = next((base / include[1] for base in (file.parent, root, root / "src") if (base / include[1]).is_file()),
                          None)
            if target is None:
                found.append(f'{name}:{number}: "{include[1]}" is not there: write its path from the top, or from src')
                continue
            other = str(target.resolve().parent.relative_to(root.resolve()))
            used[room].add(other)
            if other != room and other not in may[room]:
                where = "no room" if other not in order else "upwards" if order[other] > order[room] else "not in its row"
                found.append(f'{name}:{number}: {room} includes "{include[1]}" of {other} ({where}): move what it needs of '
                             f"that into a room that it may include, or move the file; the table is in {page}")
        lines = text.count("\n")
        if lines > LONGEST:
            found.append(f"{name}:{LONGEST}: {lines} lines, {LONGEST} are the most: it has several purposes, give each a file")
    for room, (line, patterns) in house.rooms.items():
        for pattern in patterns:
            if house.named(pattern) and not used[room] & set(house.named(pattern)):
                found.append(f"{page}:{line}: `{room}` includes nothing of `{pattern}`: take it out of its row")

    for file in code_in(root / "tests"):
        name, folder = file.relative_to(root), str(file.parent.relative_to(root))
        lines = file.read_text().count("\n")
        if lines > LONGEST_TEST:
            found.append(f"{name}:{LONGEST_TEST}: {lines} lines, {LONGEST_TEST} are the most for a test: split it by subject")
        mirrored = folder.removeprefix("tests/")
        areas = {str(pathlib.PurePosixPath(room).parents[0]) for room in house.rooms} | set(house.rooms)
        if folder not in NO_MIRRORS and not {mirrored, "src/" + mirrored} & areas:
            found.append(f"{name}:1: {folder} mirrors no room of {page}: put the test where what it tests lies")

    types = {}
    for file in [file for area in [*AREAS, "tests", "validation", "python/native"] for file in code_in(root / area)]:
        for name, number in types_in(file):
            first = types.setdefault(name, file)
            if first != file:
                found.append(f"{file.relative_to(root)}:{number}: {name} is another type in {first.relative_to(root)}: give "
                             "one of them another name, or put it into an unnamed namespace")

    for document in [root / "README.md", *sorted((root / "docs").glob("*.md"))]:
        lines = document.read_text().splitlines() if document.exists() else []
        for number, line in enumerate(lines, 1):
            for path in NAMED.findall(line):
                if path not in MADE and not any((root / (path + end)).exists() for end in ("", ".hpp", ".cpp")):
                    found.append(f"{document.relative_to(root)}:{number}: {path} is not there")
    if len(house.walk) > LONGEST_WALK:
        found.append(f"{page}: {len(house.walk)} files are named on the way of a ping, {LONGEST_WALK} are the most")
    return found


HEAD = "# House\n\n| room | may include |\n|---|---|\n"
ROWS = "| `geometry` | |\n| `src/low` | |\n| `src/high` | `src/low` |\n"
TEETH = {
    "src/low/a.hpp:2: src/low includes \"high/b.hpp\" of src/high (upwards)":
        {"src/low/a.hpp": '#pragma once\n#include "high/b.hpp"\n'},
    "src/low/e.hpp:3: tubefoot::Thing is another type in src/high/b.hpp":
        {"src/high/b.hpp": "#pragma once\nnamespace tubefoot {\nstruct Thing {\n};\n}  // namespace tubefoot\n",
         "src/low/e.hpp": "#pragma once\nnamespace tubefoot {\nclass Thing : Other {\n};\n}  // namespace tubefoot\n"},
    "src/high/c.cpp:1: src/high includes \"geometry/d.hpp\" of geometry (not in its row)":
        {"src/high/c.cpp": '#include "geometry/d.hpp"\n'},
    "src/attic/e.cpp:1: src/attic is no room": {"src/attic/e.cpp": "\n"},
    "src/low/f.cpp:1: \"low/gone.hpp\" is not there": {"src/low/f.cpp": '#include "low/gone.hpp"\n'},
    "src/low/long.cpp:600: 601 lines": {"src/low/long.cpp": "\n" * 601},
    "tests/low/long_test.cpp:750: 751 lines": {"tests/low/long_test.cpp": "\n" * 751},
    "tests/middle/a_test.cpp:1: tests/middle mirrors no room": {"tests/middle/a_test.cpp": "\n"},
    "docs/house.md:6: `src/low` may include `src/high`, which stands below it": {
        "docs/house.md": (HEAD + "| `geometry` | |\n| `src/low` | `src/high` |\n| `src/high` | `src/low` |\n")},
    "docs/house.md:5: the room `geometry` has no files": {"geometry/d.hpp": None},
    "docs/house.md:7: `src/high` includes nothing of `src/low`": {"src/high/b.hpp": "#pragma once\n"},
    "docs/house.md:9: src/low/gone.cpp is not there": {"docs/house.md": HEAD + ROWS + "\n`src/low/gone.cpp`\n"},
    "26 files are named on the way of a ping": {
        "docs/house.md": HEAD + ROWS + "\n| step | file |\n|---|---|\n" + "| 1 | `src/low/a.hpp` |\n" * 26},
}
SOUND = {
    "docs/house.md": HEAD + ROWS,
    "src/low/a.hpp": "#pragma once\n", "src/high/b.hpp": '#pragma once\n#include "low/a.hpp"\n',
    "geometry/d.hpp": "#pragma once\n", "tests/low/a_test.cpp": "\n", "sensors/.keep": "",
}


def wrongs_of(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder).resolve()
        for name, text in files.items():
            if text is not None:
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
        return wrongs(root)


def main():
    if sys.argv[1:] == ["--teeth"]:
        failures = [f"a sound house is refused: {wrong}" for wrong in wrongs_of(SOUND)]
        for expected, files in TEETH.items():
            said = wrongs_of(SOUND | files)
            if not any(expected in line for line in said):
                failures.append(f"not seen: {expected}; said: {said}")
        print("\n".join(failures) or f"{len(TEETH)} broken houses, each refused")
        sys.exit(1 if failures else 0)
    found = wrongs(SOURCES)
    house = House(SOURCES)
    print("\n".join(found) or f"{len(house.rooms)} rooms, none includes upwards; a ping is {len(house.walk)} files")
    sys.exit(1 if found or len(house.rooms) < 20 or len(house.walk) < 10 else 0)


if __name__ == "__main__":
    main()
