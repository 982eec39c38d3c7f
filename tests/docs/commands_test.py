#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs every command of the documents: commands_test.py PROGRAM [PAGE...].

Commands are the lines of ```sh blocks and the indented lines that begin with the program. Each page is
followed from top to bottom in an empty folder, as a reader would who has the scenes there and the program
in build/release: files that it says to save are saved, and commands are run as they stand, but for two
things that keep this short. Scenes are copies in which a sensor of more than three pings has two. And what
installs, builds or takes minutes is listed in INSTEAD, with what runs in its place.

Fails if a command fails, if a file that it names with -o and the like, or that the page says to look at
(`out/...`), is not there, if output that does not depend on the shortened scenes differs from what the page
shows, if an option named anywhere on a page does not exist, or a target of make.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

SOURCES = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = "build/release/tubefoot"
BUILDS = "installs and builds: tried by make -n"

# command: (why it is not run, what is run instead)
INSTEAD = {
    "make demo": (BUILDS + "; what it runs at its end is run",
                  "make -n demo && build/release/tubefoot run scenes/wellhead/scene.toml -o out/wellhead"),
    "make test": (BUILDS, "make -n test"),
    "make python": (BUILDS, "make -n python"),
    "make install": (BUILDS + "; the tests Install.* install", "make -n install"),
    "make install PREFIX=$HOME/.local": (BUILDS + "; the tests Install.* install", "make -n install PREFIX=$HOME/.local"),
    "make package": (BUILDS + "; is the test Package.IsWhole", "make -n package"),
    "make wheel": (BUILDS + "; is the test Package.Wheel", "make -n wheel"),
    "python3 -m venv --system-site-packages there && there/bin/pip install --no-index build/tubefoot-*.whl": (
        "is the test Package.Wheel, into a folder", None),
    "sudo apt install ./build/tubefoot_0.2.0_amd64.deb": ("changes the machine; Package.IsWhole unpacks it", None),
    "cmake -S docs/examples/own-sonar -B build/own-sonar -DCMAKE_PREFIX_PATH=$HOME/.local": (
        "is the test Install.ServesAProgramOfOnesOwn", None),
    "cmake --build build/own-sonar && build/own-sonar/own_sonar": (
        "is the test Install.ServesAProgramOfOnesOwn", None),
    "tubefoot chart scenes/chart/*.toml scenes/wellhead/scene.toml -o out/chart": (
        "minutes", "tubefoot chart scenes/chart/flat-bed.toml -o out/chart --repeats 1 --seconds 0.01"),
    f"{PROGRAM} run scenes/channel/scene.toml -o out/channel": (
        "minutes", f"{PROGRAM} check scenes/channel/scene.toml"),
    f"{PROGRAM} coverage scenes/survey/scene.toml --pings 100:299 -o out/coverage": (
        "200 pings of a scene that is shortened here",
        f"{PROGRAM} coverage scenes/survey/scene.toml --pings 0:1 -o out/coverage"),
    "tubefoot advise scenes/wellhead/scene.toml --tolerance 0.5dB": (
        "minutes", "tubefoot advise scenes/chart/flat-bed.toml --tolerance 0.5dB"),
    "tubefoot run scenes/wellhead/scene.toml -o out --tolerance 0.5dB": (
        "minutes", "tubefoot run scenes/chart/flat-bed.toml -o out --tolerance 0.5dB"),
    f"{PROGRAM} run out/os02-a/scene.toml --pictures none -o out/os02-a-run": (
        "minutes", f"{PROGRAM} run out/os02-a/scene.toml --sensor mode-320-380-320 --pictures none -o out/os02-a-run"),
    "/usr/bin/python3 -m tubefoot.measured out/os02-a-measured.nc out/os02-a-run/echoes.nc --simulated-lambert-db -27 "
    "-o out/os02-a-compared": (
        "compares all modes", "/usr/bin/python3 -m tubefoot.measured out/os02-a-measured.nc out/os02-a-run/echoes.nc "
        "--simulated-lambert-db -27 --resamples 20 -o out/os02-a-compared"),
    "scenes/big-terrain/make_terrain.py": (
        "200 MB", "scenes/big-terrain/make_terrain.py --side 400 -o scenes/big-terrain/terrain"),
    f"{PROGRAM} run scenes/big-terrain/strip.toml -o out/strip": ("its strip is of the large bed", None),
    "(cat scene.toml; sha256sum wreck.obj track.csv) | sha256sum": (
        "names files that the reader has", "(cat scenes/survey/wrecks.toml; sha256sum scenes/survey/wreck.obj) | sha256sum"),
}
# `out/...` that a page mentions and its commands do not make: file, why
MADE_ELSEWHERE = {
    "out/drift.png": "make track-study",
}
# Pages whose Python is run by tests of their own.
PYTHON_ELSEWHERE = {"docs/python.md", "docs/footprints.md"}

failures = []


def fail(place, message):
    print(f"FAILED {place}: {message}", flush=True)
    failures.append(place)


def blocks_of(page):
    """(line, language, text, prose before) of every code block; indented commands have the language 'indented'."""
    lines, number, before = page.read_text().splitlines(), 0, []
    while number < len(lines):
        line = lines[number]
        fence = re.match(r"( *)```(\w*)", line)
        if fence:
            end = next(k for k in range(number + 1, len(lines)) if lines[k].strip() == "```")
            text = [text.removeprefix(fence[1]) for text in lines[number + 1:end]]
            yield number + 1, fence[2], "\n".join(text) + "\n", " ".join(before)
            number, before = end, []
        elif re.match(r"    (build/release/)?tubefoot ", line):
            yield number + 1, "indented", line.strip() + "\n", " ".join(before)
        elif line.strip():
            before.append(line)
        number += 1


def commands_of(text):
    """Commands of a block: lines, joined where one goes on (a backslash, a here-document); without comments."""
    command, until = "", None
    for line in text.splitlines():
        command += line + "\n"
        here = re.search(r"<<'?(\w+)'?", line)
        if until is None and here:
            until = here[1]
        if until is not None and line != until or line.endswith("\\"):
            continue
        until = None
        command = re.sub(r"\s+# .*", "", command.strip("\n")) if "\n" not in command.strip("\n") else command
        if command.strip():
            yield command.strip()
        command = ""


def is_synopsis(command):
    return "[-" in command or re.search(r"\b(SCENE|RESULT)\b", command) is not None


class Help:
    """Options that the program has, by subcommand."""
    def __init__(self, program):
        self.program, self.known = program, {}

    def options(self, subcommand):
        if subcommand not in self.known:
            shown = subprocess.run([self.program, subcommand, "--help"], capture_output=True, text=True)
            self.known[subcommand] = set(re.findall(r"--?[a-z][a-z-]*", shown.stdout)) if shown.returncode == 0 else None
        return self.known[subcommand]

    def check(self, place, command):
        words = re.match(r"(?:build/release/)?tubefoot +([a-z]+(?:-[a-z]+)*)(.*)", command, re.S)
        if not words:
            return
        options = self.options(words[1])
        if options is None:
            fail(place, f"no subcommand {words[1]}")
            return
        for option in re.findall(r"(?<![\w-])--?[a-z][a-z-]*", words[2]):
            if option not in options:
                fail(place, f"'tubefoot {words[1]}' has no option {option}")


def shortened_scenes(folder):
    """Copies the scenes; returns the files in which pings were taken away."""
    shutil.copytree(SOURCES / "scenes", folder, ignore=shutil.ignore_patterns("terrain"))  # 200 MB, if made
    changed = set()
    for scene in folder.rglob("*.toml"):
        text = scene.read_text()
        short = re.sub(r"^pings = (\d+)", lambda n: "pings = 2" if int(n[1]) > 3 else n[0], text, flags=re.M)
        if short != text:
            scene.write_text(short)
            changed.add(str(scene.relative_to(folder.parent)))
    return changed


def outputs_of(command):
    return re.findall(r"(?:^|\s)(?:-o|--output|--png|--json|--html|--rationals|--picture|>>?) +([\w./-]+)", command)


def comparable(text):
    """Lines of output without what is never the same twice."""
    return [re.sub(r" in [\d.]+ s\b", " in ? s", line).rstrip() for line in text.splitlines()]


class Follower:
    """Follows pages."""
    def __init__(self, program, scratch):
        self.program, self.scratch, self.help = program, scratch, Help(program)
        self.changed = shortened_scenes(scratch / "scenes")
        self.made = {}  # command that needs nothing but scenes -> (folder where it ran, its output)
        self.used = set()
        self.environment = dict(os.environ, PATH=f"{scratch / 'bin'}:{os.environ['PATH']}",
                                PYTHONPATH=str(program.resolve().parent / "python"))  # as after make python
        (scratch / "bin").mkdir()
        (scratch / "bin/tubefoot").symlink_to(program)

    def folder_for(self, name):
        folder = self.scratch / "pages" / name.replace("/", "-")
        (folder / "build/release").mkdir(parents=True)
        (folder / PROGRAM).symlink_to(self.program)
        (folder / "scenes").symlink_to(self.scratch / "scenes")
        (folder / "Makefile").symlink_to(SOURCES / "Makefile")
        (folder / "out").mkdir()
        return folder

    def run(self, place, command, folder):
        """Output of a command, or None if it was not run or failed."""
        outputs = outputs_of(command)
        again = self.made.get(command)
        if again:
            for output in outputs:
                source = again[0] / output
                (shutil.copytree if source.is_dir() else shutil.copyfile)(source, folder / output)
            return again[1]
        begin = sum(os.times()[2:4])
        done = subprocess.run(["sh", "-c", command], cwd=folder, env=self.environment, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
        print(f"{sum(os.times()[2:4]) - begin:6.1f} s  {place}: {command.splitlines()[0]}", flush=True)
        if done.returncode:
            fail(place, f"exit code {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-3000:]}")
            return None
        for output in outputs:
            if not (folder / output).exists():
                fail(place, f"wrote no {output}")
        words = [word for word in shlex.split(command.split("\n")[0]) if "/" in word or "." in word]
        if "tubefoot " in command and all(w.startswith(("scenes/", PROGRAM)) or w in outputs for w in words):
            self.made[command] = (folder, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def follow(self, page):
        name = str(page.relative_to(SOURCES))
        folder = self.folder_for(name)
        shortened, shown, comparing, outputs = set(), None, False, []
        for number, language, text, before in blocks_of(page):
            place = f"{name}:{number}"
            saved = re.search(r"[Ss]ave this as `([\w.-]+)`[^`]*$", before)
            if language in ("sh", "indented"):
                shown, comparing = "", True
                for command in commands_of(text):
                    self.help.check(place, command)
                    if is_synopsis(command):
                        continue
                    run, why = command, ""
                    if command in INSTEAD:
                        why, run = INSTEAD[command]
                        self.used.add(command)
                        print(f"        {place}: not run: {command} ({why})")
                    short = (command in INSTEAD or any(scene in command for scene in self.changed)
                             or any(re.search(re.escape(path) + r"(?![\w-])", command) for path in shortened))
                    if short:
                        shortened.update(outputs_of(command))
                        comparing = False
                    output = self.run(place, run, folder) if run else None
                    if output is None:
                        comparing = False
                    shown += output or ""
                    outputs += outputs_of(run) if run else []
            elif language == "text" and shown is not None and not before:
                for path in re.findall(r"^wrote ([\w./-]+)", text, re.M):
                    if not (folder / path).exists():
                        fail(place, f"the page shows 'wrote {path}', which is not there")
                if comparing:
                    have = set(comparable(shown))
                    for line in comparable(text):
                        if line.strip() not in ("", "...") and line not in have:
                            fail(place, f"output that is not so: {line}\n{shown}")
                shown = None
            elif saved:
                (folder / saved[1]).write_text(text)
            elif language == "python" and name not in PYTHON_ELSEWHERE:
                fail(place, "Python that no test runs: let the page say 'Save this as' and run it")
            if language not in ("sh", "indented", "text"):
                shown = None
        self.mentions(page, name, folder, outputs)

    def mentions(self, page, name, folder, outputs):
        """What is named in running text: files to look at, options, targets of make."""
        targets = set(re.findall(r"^([a-z-]+):", (SOURCES / "Makefile").read_text(), re.M))
        fenced = False
        for number, line in enumerate(page.read_text().splitlines(), 1):
            if re.match(r" *```", line):
                fenced = not fenced
            for code in [] if fenced else re.findall(r"`([^`]+)`", line):
                place = f"{name}:{number}"
                path = re.fullmatch(r"out/[\w./-]+\.\w+", code)
                if path and code not in MADE_ELSEWHERE and any(o == code or code.startswith(o + "/") for o in outputs):
                    if not (folder / code).exists():
                        fail(place, f"no {code} after the page's commands")
                elif path and outputs and code not in MADE_ELSEWHERE and ".partial" not in code:
                    fail(place, f"no command of the page makes {code}")
                self.help.check(place, code)
                target = re.match(r"make ([a-z-]+)", code)
                if target and target[1] not in targets:
                    fail(place, f"make has no target {target[1]}")


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    every = [SOURCES / "README.md", *sorted((SOURCES / "docs").glob("*.md"))]
    pages = [SOURCES / page for page in sys.argv[2:]] or every
    with tempfile.TemporaryDirectory(prefix="tubefoot-docs-") as scratch:
        follower = Follower(program, pathlib.Path(scratch))
        for page in pages:
            follower.follow(page)
        if pages == every:
            for command in INSTEAD.keys() - follower.used:
                fail("INSTEAD", f"listed, but on no page: {command}")
    user, system = os.times()[2:4]
    print(f"{len(pages)} pages, {user + system:.0f} s of one core, {len(failures)} failures")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
