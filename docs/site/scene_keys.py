#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/scene-keys.md from the keys that the program knows: scene_keys.py PROGRAM [--check].

--check compares the page with the keys of the program instead, and fails where they differ.
"""
import json
import pathlib
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parents[1] / "scene-keys.md"
HEAD = """# Keys of scene files

This page lists all keys of scene files with type, unit, default, range and meaning, for users who write scenes. The program
prints the same list. A name selects a section, a kind or a key:

```sh
build/release/tubefoot keys multibeam
build/release/tubefoot keys frequency_khz
```

A script makes this page from the output of `tubefoot keys --json`. [Scenes](scenes.md) explains coordinates, angles and files.

## Conventions of the tables

- Single brackets, as in `[water]`, mark a section that occurs at most once. Double brackets, as in `[[sensors]]`, mark a section
  with any number of entries.
- Keys below a heading such as `kind = "flat"` are valid only in entries of this kind.
- The type `number` accepts integers. Infinity and not-a-number are errors. A `file` is a file name relative to the folder of the
  scene file.
- The default applies if the key is omitted. A key without a default value is **required**, or has the default **none** and is
  then not set. Some meanings state how the program computes a value that is not set.
- A single range applies to every number of an array. Several ranges, separated by semicolons, apply to the numbers one by one.
- A prefix such as "munk:" in a meaning names a value of the key that selects a model, a profile or a mode. The text after the
  prefix applies to this value.
"""


def cell(text):
    return text.replace("|", "\\|") or "-"


def table(keys):
    lines = ["| key | type | unit | default | range | meaning |", "|---|---|---|---|---|---|"]
    for key in keys:
        meaning = key["meaning"]
        if "former_name" in key:
            meaning += f" The former name `{key['former_name']}` is deprecated."
        default = f"**{key['default']}**" if key["default"] == "required" else key["default"]
        cells = [f"`{key['name']}`", *map(cell, (key["type"], key["unit"], default, key["range"], meaning))]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def page(program):
    said = subprocess.run([program, "keys", "--json"], capture_output=True, text=True, check=True).stdout
    text = HEAD
    for section in json.loads(said)["sections"]:
        if section["kind"]:
            heading = f"### `{section['kind']}`"
        else:
            heading = f"## `{section['section']}`" if section["section"] else "## Above all sections"
        text += f"\n{heading}\n\n{section['meaning']}\n"
        if section["keys"]:
            text += "\n" + table(section["keys"])
    return text


def main():
    program, *rest = sys.argv[1:]
    made = page(program)
    if rest == ["--check"]:
        if PAGE.read_text() != made:
            sys.exit(f"{PAGE.name} differs from the keys of the program: run {pathlib.Path(__file__).name} PROGRAM")
        return
    PAGE.write_text(made)


if __name__ == "__main__":
    main()
