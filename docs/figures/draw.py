#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the figures of the documents: draw.py PROGRAM [NAME...] [--stale] [--list].

NAME is a file below docs/, or a pattern such as 'gallery/robot-*'. Without names, all figures are drawn. --stale draws
only those whose inputs have changed since they were drawn. --list prints each figure with its state. recipes.py has the
table of figures; stamp.py defines inputs and metadata.
"""
import argparse
import fnmatch
import importlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import stamp  # noqa: E402
from recipes import FIGURES  # noqa: E402


class Tools:
    """What drawing functions use: the program, folders of their own, the tutorial's scene."""
    def __init__(self, program, work):
        self.program, self.work, self.root, self.done = program, work, stamp.ROOT, set()
        self.tutorial = stamp.first_scene("docs/tutorial.md")
        (work / "build/release").mkdir(parents=True)
        (work / "out").mkdir()
        (work / "scenes").symlink_to(stamp.ROOT / "scenes")
        for name in ("tubefoot", "tubefoot_track_study", "tubefoot_refraction_study"):
            (work / "build/release" / name).symlink_to(program.parent / name if name != "tubefoot" else program)
        version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout
        self.version = ", ".join(version.splitlines()[:2])

    def folder(self, name):
        folder = self.work / "drawn" / name
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def tubefoot(self, *arguments):
        subprocess.run([self.program, *map(str, arguments), "--quiet"], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)

    def shell(self, command, folder, again=False):
        """Runs a command, once per folder unless `again`."""
        if (command, folder) in self.done and not again:
            return
        with_module = dict(os.environ, PYTHONPATH=str(self.program.resolve().parent / "python"))  # as after make python
        done = subprocess.run(["sh", "-c", command], cwd=folder, env=with_module, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True)
        if done.returncode:
            sys.exit(f"{command}\n{done.stdout[-3000:]}")
        self.done.add((command, folder))

    def follow(self, figure):
        """A folder in which the steps of a page have run."""
        folder = self.work / "pages" / figure.follows.replace("/", "-")
        if not folder.exists():
            (folder / "out").mkdir(parents=True)
            for name in ("scenes", "build"):
                (folder / name).symlink_to(self.work / name)
        for number, step in enumerate(stamp.page_steps(figure.follows, figure.picture)):
            if (figure.follows, number) in self.done:
                continue
            if step[0] == "run":
                self.shell(step[1], folder, again=True)
            else:
                (folder / step[1]).write_text(step[2])
            self.done.add((figure.follows, number))
        return folder


def reduced(picture, width, work):
    """The bytes of a PNG, with 8 bits per colour and at most `width` pixels wide."""
    file = work / "reduced.png"
    size = ["--resize", f"{width}x0"] if width else []
    subprocess.run(["oiiotool", picture, "--nosoftwareattrib", *size, "-d", "uint8", "--compression", "zip:9", "-o", file],
                   check=True)
    return file.read_bytes()


def draw(figure, tools):
    target = stamp.DOCS / figure.name
    words = {stamp.HASH: stamp.hash_of(figure), stamp.MADE_BY: tools.version}
    for name, text in figure.files:
        (tools.work / name).write_text(text)
    folder = tools.follow(figure) if figure.follows and not figure.draw else tools.work
    for command in figure.commands:
        tools.shell(command, tools.work)
    if not figure.draw:
        stamp.write(target, reduced(folder / figure.picture, figure.width, tools.work), words)
        return
    module, function = figure.draw.split(":")
    function = getattr(importlib.import_module(module), function)
    if target.suffix == ".svg":
        stamp.write(target, function(tools) if function.__code__.co_argcount else function(), words)
        return
    drawn = tools.work / "drawn.png"
    function(tools, drawn)
    stamp.write(target, reduced(drawn, figure.width, tools.work), words)


def state_of(figure):
    path = stamp.DOCS / figure.name
    if not path.exists():
        return "missing"
    return "present" if stamp.read(path).get(stamp.HASH) == stamp.hash_of(figure) else "stale"


def chosen(names, figures):
    if not names:
        return figures
    picked = [f for f in figures if any(fnmatch.fnmatch(f.name, name.removeprefix("docs/")) for name in names)]
    if not picked:
        sys.exit(f"no figure matches {' '.join(names)}: --list prints all names")
    return picked


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--stale", action="store_true", help="draw only figures that are missing or stale")
    parser.add_argument("--list", action="store_true", help="print the figures and their states")
    options = parser.parse_args()
    figures = chosen(options.names, FIGURES)
    if options.list:
        print("\n".join(f"{state_of(figure):8} {figure.name}" for figure in figures))
        return
    if options.stale:
        figures = [figure for figure in figures if state_of(figure) != "present"]
    with tempfile.TemporaryDirectory(prefix="tubefoot-figures-") as name:
        tools = Tools(options.program.resolve(), pathlib.Path(name))
        before = sum(os.times()[:4])
        try:
            for figure in figures:
                draw(figure, tools)
                now = sum(os.times()[:4])
                print(f"{now - before:6.1f} s  {figure.name}", flush=True)
                before = now
        finally:
            if "raster" in sys.modules:
                sys.modules["raster"].Browser.close()
            shutil.rmtree(tools.work / "out", ignore_errors=True)
    print(f"{len(figures)} figures, {sum(os.times()[:4]):.0f} s of one core")


if __name__ == "__main__":
    main()
