#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/command-reference.md from the help of the program: command_reference.py PROGRAM [--check].

--check compares the page with the help of the program instead, and fails where they differ.
"""
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parents[1] / "command-reference.md"
HEAD = """# Reference of commands and options

This page lists all options of all commands, for users who know what a command does. [Commands](commands.md) explains the
commands with examples. A script makes this page from the help of the program:

```sh
build/release/tubefoot help run
```
"""


def help_of(program, *words):
    return subprocess.run([program, "help", *words], capture_output=True, text=True, check=True).stdout


def page(program):
    listed = help_of(program).split("Subcommands:\n")[1].split("\n\n")[0]
    commands = re.findall(r"^  (\S+)", listed, re.M)
    if len(commands) < 10:
        sys.exit(f"{program} help: only {len(commands)} commands are listed")
    text = HEAD
    for command in commands:
        said = help_of(program, command)
        said = re.sub(r"\n{3,}", "\n\n", said).rstrip()
        text += f"\n## {command}\n\n```text\n{said}\n```\n"
    return text


def main():
    program, *rest = sys.argv[1:]
    made = page(program)
    if rest == ["--check"]:
        if PAGE.read_text() != made:
            sys.exit(f"{PAGE.name} differs from the help of the program: run {pathlib.Path(__file__).name} PROGRAM")
        return
    PAGE.write_text(made)


if __name__ == "__main__":
    main()
