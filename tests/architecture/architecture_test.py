#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the modules of docs/architecture.md with the source: architecture_test.py

docs/architecture.md has the only table of modules and permitted includes. The test fails for
- a source file in a folder that is not a module, and a module without files;
- an #include of a module that the row of the including module does not list;
- a row that lists a module further down in the table (an include upwards), and a permission without use;
- a source file of more than 600 lines, and a test of more than 750;
- tests in a folder that corresponds to no module;
- two types with one name in one namespace, which the linker would confuse;
- a missing source file that a document names, and more than 25 files in the steps of a ping.
With --self-test it checks small trees, each with one of these faults.
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
# Test helpers, separate programs, and scripts.
WITHOUT_MODULE = {"tests"} | {f"tests/{name}" for name in (
    "determinism", "docs", "fixtures", "fixtures/geometry", "fixtures/world", "fuzz", "architecture", "mathematics", "mpi", "packaging", "prove", "sanitizers",
    "validation", "viewer")}


def code_in(folder):
    return sorted(file for file in folder.rglob("*") if file.suffix in (".cpp", ".hpp"))


class Architecture:
    """The tables of docs/architecture.md."""

    def __init__(self, root):
        self.page = root / "docs/architecture.md"
        self.modules = {}  # in the order of the table: (line, names of modules that it may include)
        self.walk = []
        head = None
        for number, line in enumerate(self.page.read_text().splitlines(), 1):
            if not line.startswith("|"):
                head = None
                continue
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if head is None:
                head = cells
            elif head[0] == "module" and head[-1] == "may include" and not line.startswith("|--"):
                module, may = re.search(r"`([^`]+)`", cells[0]), re.findall(r"`([^`]+)`", cells[-1])
                self.modules[module[1]] = (number, may)
            elif head[0] == "step" and not line.startswith("|--"):
                self.walk += re.findall(r"`([^`]+)`", cells[1])

    def named(self, pattern):
        """The modules that a word of a cell names: `geometry/*` names all modules of geometry."""
        if pattern.endswith("/*"):
            return [module for module in self.modules if module.startswith(pattern[:-1])]
        return [pattern] if pattern in self.modules else []


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


def faults(root):
    architecture, found = Architecture(root), []
    page = architecture.page.relative_to(root)
    order = {module: number for number, module in enumerate(architecture.modules)}
    may = {}
    for module, (line, patterns) in architecture.modules.items():
        may[module] = set()
        for pattern in patterns:
            meant = architecture.named(pattern)
            if not meant:
                found.append(f"{page}:{line}: `{module}` may include `{pattern}`, which is not a module of the table")
            for other in meant:
                if order[other] > order[module]:
                    found.append(f"{page}:{line}: `{module}` may include `{other}`, which stands below it: move shared "
                                 "code into a module above both")
                may[module].add(other)
        if not [file for file in (root / module).glob("*") if file.suffix in (".cpp", ".hpp")]:
            found.append(f"{page}:{line}: the module `{module}` has no files: remove its row")

    used = {module: set() for module in architecture.modules}
    for file in [file for area in AREAS for file in code_in(root / area)]:
        name, module = file.relative_to(root), str(file.parent.relative_to(root))
        if module not in architecture.modules:
            found.append(f"{name}:1: {module} is not a module of {page}: move the file into a module, or add a row "
                         "with the content of the new module and what it may include")
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
            used[module].add(other)
            if other != module and other not in may[module]:
                where = "not a module" if other not in order else "upwards" if order[other] > order[module] else "not in its row"
                found.append(f'{name}:{number}: {module} includes "{include[1]}" of {other} ({where}): move shared code '
                             f"into a module that it may include, or move the file; the table is in {page}")
        lines = text.count("\n")
        if lines > LONGEST:
            found.append(f"{name}:{LONGEST}: {lines} lines, {LONGEST} is the limit: split it by purpose")
    for module, (line, patterns) in architecture.modules.items():
        for pattern in patterns:
            if architecture.named(pattern) and not used[module] & set(architecture.named(pattern)):
                found.append(f"{page}:{line}: `{module}` includes nothing of `{pattern}`: remove it from the row")

    for file in code_in(root / "tests"):
        name, folder = file.relative_to(root), str(file.parent.relative_to(root))
        lines = file.read_text().count("\n")
        if lines > LONGEST_TEST:
            found.append(f"{name}:{LONGEST_TEST}: {lines} lines, {LONGEST_TEST} is the limit for a test: split it by subject")
        module_path = folder.removeprefix("tests/")
        areas = {str(pathlib.PurePosixPath(module).parents[0]) for module in architecture.modules} | set(architecture.modules)
        if folder not in WITHOUT_MODULE and not {module_path, "src/" + module_path} & areas:
            found.append(f"{name}:1: {folder} corresponds to no module of {page}: move the test to the folder of its module")

    types = {}
    for file in [file for area in [*AREAS, "tests", "validation", "python/native"] for file in code_in(root / area)]:
        for name, number in types_in(file):
            first = types.setdefault(name, file)
            if first != file:
                found.append(f"{file.relative_to(root)}:{number}: {name} is also a type in {first.relative_to(root)}: rename "
                             "one of them, or put it into an unnamed namespace")

    for document in [root / "README.md", *sorted((root / "docs").glob("*.md"))]:
        lines = document.read_text().splitlines() if document.exists() else []
        for number, line in enumerate(lines, 1):
            for path in NAMED.findall(line):
                if path not in MADE and not any((root / (path + end)).exists() for end in ("", ".hpp", ".cpp")):
                    found.append(f"{document.relative_to(root)}:{number}: {path} is not there")
    if len(architecture.walk) > LONGEST_WALK:
        found.append(f"{page}: {len(architecture.walk)} files are named in the steps of a ping, {LONGEST_WALK} is the limit")
    return found


HEAD = "# Architecture\n\n| module | may include |\n|---|---|\n"
ROWS = "| `geometry` | |\n| `src/low` | |\n| `src/high` | `src/low` |\n"
FAULTS = {
    "src/low/a.hpp:2: src/low includes \"high/b.hpp\" of src/high (upwards)":
        {"src/low/a.hpp": '#pragma once\n#include "high/b.hpp"\n'},
    "src/low/e.hpp:3: tubefoot::Thing is also a type in src/high/b.hpp":
        {"src/high/b.hpp": "#pragma once\nnamespace tubefoot {\nstruct Thing {\n};\n}  // namespace tubefoot\n",
         "src/low/e.hpp": "#pragma once\nnamespace tubefoot {\nclass Thing : Other {\n};\n}  // namespace tubefoot\n"},
    "src/high/c.cpp:1: src/high includes \"geometry/d.hpp\" of geometry (not in its row)":
        {"src/high/c.cpp": '#include "geometry/d.hpp"\n'},
    "src/attic/e.cpp:1: src/attic is not a module": {"src/attic/e.cpp": "\n"},
    "src/low/f.cpp:1: \"low/gone.hpp\" is not there": {"src/low/f.cpp": '#include "low/gone.hpp"\n'},
    "src/low/long.cpp:600: 601 lines": {"src/low/long.cpp": "\n" * 601},
    "tests/low/long_test.cpp:750: 751 lines": {"tests/low/long_test.cpp": "\n" * 751},
    "tests/middle/a_test.cpp:1: tests/middle corresponds to no module": {"tests/middle/a_test.cpp": "\n"},
    "docs/architecture.md:6: `src/low` may include `src/high`, which stands below it": {
        "docs/architecture.md": (HEAD + "| `geometry` | |\n| `src/low` | `src/high` |\n| `src/high` | `src/low` |\n")},
    "docs/architecture.md:5: the module `geometry` has no files": {"geometry/d.hpp": None},
    "docs/architecture.md:7: `src/high` includes nothing of `src/low`": {"src/high/b.hpp": "#pragma once\n"},
    "docs/architecture.md:9: src/low/gone.cpp is not there": {"docs/architecture.md": HEAD + ROWS + "\n`src/low/gone.cpp`\n"},
    "26 files are named in the steps of a ping": {
        "docs/architecture.md": HEAD + ROWS + "\n| step | file |\n|---|---|\n" + "| 1 | `src/low/a.hpp` |\n" * 26},
}
FAULTLESS = {
    "docs/architecture.md": HEAD + ROWS,
    "src/low/a.hpp": "#pragma once\n", "src/high/b.hpp": '#pragma once\n#include "low/a.hpp"\n',
    "geometry/d.hpp": "#pragma once\n", "tests/low/a_test.cpp": "\n", "sensors/.keep": "",
}


def faults_of(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder).resolve()
        for name, text in files.items():
            if text is not None:
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
        return faults(root)


def main():
    if sys.argv[1:] == ["--self-test"]:
        failures = [f"a tree without faults is rejected: {fault}" for fault in faults_of(FAULTLESS)]
        for expected, files in FAULTS.items():
            said = faults_of(FAULTLESS | files)
            if not any(expected in line for line in said):
                failures.append(f"not seen: {expected}; said: {said}")
        print("\n".join(failures) or f"{len(FAULTS)} trees with faults, each rejected")
        sys.exit(1 if failures else 0)
    found = faults(SOURCES)
    architecture = Architecture(SOURCES)
    print("\n".join(found) or f"{len(architecture.modules)} modules, none includes upwards; a ping passes {len(architecture.walk)} files")
    sys.exit(1 if found or len(architecture.modules) < 20 or len(architecture.walk) < 10 else 0)


if __name__ == "__main__":
    main()
