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
HEAD = """# Commands and options

This page lists all options of all commands, for users who know what a command does. A script makes it from the help of the program:

```sh
build/release/tubefoot help run
```

## Conventions

- `--sensor` selects one sensor. `--pings A:B` selects pings of each sensor, and `--beams` selects one or more ranges `A:B`, separated by
  commas. Pings and beams are numbered from 0, and a range includes A and B. Selected energies equal those of the whole run bit for bit.
- With `--beams`, `run` writes only the echo file, because pictures and sonar files need complete pings.
- `-o` names the file or folder to write. It appears when it is complete. A failed command leaves nothing there.
- Former names of commands and options work with a warning.
- After the first interrupt signal, a command stops within about a second. A second signal stops it immediately. A command that waits
  for a library or for the operating system ends 5 s after the first signal. `run --resume` continues an interrupted run.
- After a tenth of the work, the program shows the remaining time. If the files need at least 10 s of writing time or 1 GB of disk
  space, `check` and `run` print an estimate.

| exit status | meaning |
|---|---|
| 0 | success |
| 1 | the run failed |
| 2 | the input or the command line is wrong |
| 3 | a comparison found a larger error than allowed |
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
