#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""validation/worlds/run.py SOURCES [--program build/release/tubefoot] [--worlds PROJECT ...] [--page FILE]

Imports each world of some projects and prints a table: what import-scene reads, what it leaves out, and whether `check`
accepts the scene. SOURCES is a folder of checkouts, one folder per project. Every folder there that contains models is a
folder of --model-path. --worlds: the projects whose worlds are imported; by default all. --page writes the table into a
page, between two comments."""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

BEGIN, END = "<!-- begin: run.py -->", "<!-- end: run.py -->"
HEAD = ("| world | `<include>` read | objects | sonars | facets | `check` | notes | left out |\n"
        "|---|---|---|---|---|---|---|---|\n")
# Notes on parts that are left out, and a short name of the kind of each.
KINDS = [(r"model '(.+?)' of Gazebo Fuel is not on this computer", "Fuel model {}"),
         (r"<include> of '(?:model://)?(.+?)' is left out", "include {}"),
         (r"'(?:model://|file://)?(.+?)' is left out: (?:there is no|give the folder|the file lies)", "file {}"),
         (r"does not read the shape <(\w+)>", "<{}>"),
         (r"sensor '.+?' is left out: tubefoot does not read sensors of type '(.*?)'", "sensor {}"),
         (r"sensor '(.+?)' is left out", "sensor {}"),
         (r"<(\w+) ?'?.*?'?> .*is left out: its pose", "<{}>"),
         (r"^left out: \d+ x <(.+?)>", "<{}>"),
         (r"'(.+?)' is left out", "{}")]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sources", type=pathlib.Path)
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path("build/release/tubefoot"))
    parser.add_argument("--worlds", nargs="+", metavar="PROJECT")
    parser.add_argument("--page", type=pathlib.Path)
    return parser.parse_args()


def model_folders(sources):
    """The folders that contain folders of models."""
    models = {file.parent for name in ("model.config", "model.sdf") for file in sources.rglob(name)}
    return sorted({model.parent for model in models})


def worlds_of(sources, projects):
    for project in projects:
        if not (sources / project).is_dir():
            sys.exit(f"{sources / project}: there is no such project: expected one of "
                     f"{', '.join(sorted(folder.name for folder in sources.iterdir() if folder.is_dir()))}")
        found = sorted((sources / project).rglob("*.world"))
        if not found:
            sys.exit(f"{sources / project}: contains no *.world")
        yield from ((project, world) for world in found)


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True)


def left_out(notes):
    """The kinds of parts that are left out, each once, with their numbers."""
    kinds = {}
    for note in notes:
        if "left out" not in note and "not on this computer" not in note:
            continue
        for pattern, name in KINDS:
            if match := re.search(pattern, note):
                kind = name.format(match[1])
                count = re.match(r"left out: (\d+) x", note)
                kinds[kind] = kinds.get(kind, 0) + (int(count[1]) if count else 1)
                break
    return [kind if count == 1 else f"{kind} ({count})" for kind, count in sorted(kinds.items())]


def row_of(program, world, models, folder):
    path = [part for model in models for part in ("--model-path", model)]
    made = run(program, "import-scene", world, *path, "-o", folder)
    notes = made.stderr.splitlines()
    read = re.search(r"(\d+) of (\d+) <include>", made.stderr)
    includes = f"{read[1]} of {read[2]}" if read else "none"
    if made.returncode != 0:
        missing = sorted(set(re.findall(r"<uri>\s*https?://[^<]*/models/([^</]*?)\s*</uri>", world.read_text())))
        if "has no geometry" not in made.stderr or not missing:
            sys.exit(f"{world}: {made.stderr}")
        return [includes, "0", "0", "0", "-", "-",
                "everything: " + ", ".join(f"`Fuel model {name}`" for name in missing)], False
    text = (folder / "scene.toml").read_text()
    example = any("no sonar was found" in note for note in notes)
    checked = run(program, "check", folder / "scene.toml")
    facets = re.search(r"^facets\s+(\d+)", checked.stdout, flags=re.M)
    sonars = 0 if example else text.count("[[sensors]]")
    return [includes, str(text.count("[[objects]]")), str(sonars), facets[1] if facets else "-",
            "accepted" if checked.returncode == 0 else "rejected", str(len(notes)),
            ", ".join(f"`{kind}`" for kind in left_out(notes)) or "nothing"], checked.returncode == 0


def main():
    options = arguments()
    models = model_folders(options.sources.resolve())
    projects = options.worlds or sorted(folder.name for folder in options.sources.iterdir() if folder.is_dir())
    table, accepted, count = HEAD, 0, 0
    with tempfile.TemporaryDirectory() as scratch:
        for number, (project, world) in enumerate(worlds_of(options.sources, projects)):
            cells, good = row_of(options.program, world, models, pathlib.Path(scratch) / str(number))
            table += f"| {project}/{world.stem} | " + " | ".join(cells) + " |\n"
            accepted, count = accepted + good, count + 1
            print(f"{project}/{world.name}: {', '.join(cells)}", file=sys.stderr, flush=True)
    summary = f"`import-scene` reads and `check` accepts {accepted} of {count} worlds.\n\n"
    if options.page:
        text = options.page.read_text()
        before, after = text.split(BEGIN)[0], text.split(END)[1]
        options.page.write_text(f"{before}{BEGIN}\n\n{summary}{table}\n{END}{after}")
    else:
        print(summary + table)
    return 0 if accepted == count else 1


if __name__ == "__main__":
    sys.exit(main())
