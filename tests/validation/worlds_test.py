#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""worlds_test.py PROGRAM (--small | [SOURCES])

--small tests validation/worlds/run.py on two small worlds with known answers. Otherwise the test imports the worlds of other
projects, and compares the table with the page validation/worlds.md. SOURCES, or the variable TUBEFOOT_WORLD_SOURCES, is the
folder of checkouts that the page describes. Without this folder the test is skipped with the exit code 77."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT, PAGE = ROOT / "validation/worlds/run.py", ROOT / "validation/worlds.md"
SHAPE = ("<link name='l'><pose>0 0 {} 0 0 0</pose><visual name='v'><geometry>{}</geometry></visual></link>")
SPHERE, MAP = "<sphere/>", "<heightmap><uri>h.png</uri></heightmap>"


def write(file, text):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def include(uri):
    return f"<include><uri>{uri}</uri></include>"


def world(inside):
    return f"<sdf version='1.6'><world name='w'>{inside}</world></sdf>"


def table(program, sources, *options):
    """The rows of the table, by world, and whether all worlds were accepted."""
    made = subprocess.run([sys.executable, str(SCRIPT), str(sources), "--program", str(program), *options],
                          capture_output=True, text=True)
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in made.stdout.splitlines()
            if line.startswith("| ") and "/" in line.split("|")[1]]
    return {row[0]: row[1:] for row in rows}, made.returncode == 0


def small_worlds(program):
    with tempfile.TemporaryDirectory() as scratch:
        sources = pathlib.Path(scratch)
        write(sources / "library/models/rock/model.sdf",
              f"<sdf version='1.6'><model name='rock'>{SHAPE.format(0, SPHERE)}</model></sdf>")
        write(sources / "mine/worlds/good.world",
              world(include("model://rock") + include("model://gone") + "<actor name='a'/><actor name='b'/>"
                    + "<model name='m'>" + SHAPE.format(5, MAP) + SHAPE.format(9, SPHERE) + "</model>"))
        write(sources / "mine/worlds/empty.world",
              world(include("https://fuel.gazebosim.org/1.0/Someone/models/Far Away")))
        rows, accepted = table(program, sources, "--worlds", "mine")
        assert not accepted, "an empty world is no success"
        good, empty = rows["mine/good"], rows["mine/empty"]
        assert good[0] == "1 of 2" and good[1:3] == ["2", "0"] and good[4] == "accepted", good
        assert good[6] == "`<actor> (2)`, `<heightmap>`, `include gone`", good
        assert empty[0] == "0 of 1" and empty[6] == "everything: `Fuel model Far Away`", empty


def worlds_of_others(program, sources):
    spec = importlib.util.spec_from_file_location("run", SCRIPT)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    page = PAGE.read_text().split(script.BEGIN)[1].split(script.END)[0]
    rows, _ = table(program, sources, "--worlds", "dave", "nps_uw_multibeam_sonar")
    assert len(rows) == 26, f"{len(rows)} worlds, expected 26"
    for name, cells in rows.items():
        line = f"| {name} | " + " | ".join(cells) + " |"
        assert line in page, f"{PAGE.name} has another row than\n{line}"


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    if sys.argv[2:] == ["--small"]:
        small_worlds(program)
        return 0
    sources = sys.argv[2] if len(sys.argv) > 2 else os.environ.get("TUBEFOOT_WORLD_SOURCES")
    if not sources or not pathlib.Path(sources).is_dir():
        print("Skipped: set TUBEFOOT_WORLD_SOURCES to the folder of checkouts that validation/worlds.md describes")
        return 77
    worlds_of_others(program, pathlib.Path(sources))
    return 0


if __name__ == "__main__":
    sys.exit(main())
