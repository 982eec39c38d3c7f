# SPDX-License-Identifier: GPL-3.0-or-later
"""Hashes of the inputs of figures, and the metadata of PNG and SVG files that keep them.

The hash covers the recipe, all files that the recipe or its scenes name, the sources of drawing functions, and the code
blocks of a page that the recipe follows. Comments and titles of scene files are no inputs. The program is not an input: its revision is recorded besides the hash.
"""
import hashlib
import json
import pathlib
import re
import struct
import sys
import tomllib
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS, HERE = ROOT / "docs", pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT / "tests/docs"))
from commands_test import blocks_of, commands_of  # noqa: E402

HASH, MADE_BY = "tubefoot-inputs-sha256", "tubefoot-made-by"
SHARED = {"geometry_drawings": ("sheet.py",), "sensor_drawings": ("sheet.py",), "viewer_shots": ("raster.py",),
          "result_drawings": ("sheet.py", "raster.py", "geometry_drawings.py")}


def files_of_scene(scene, known):
    """Adds a scene and the files that it names, of presets too."""
    if scene in known or not scene.is_file():
        return
    known.add(scene)
    if scene.suffix != ".toml":
        return
    text = scene.read_text()
    for word in re.findall(r'"([^"\n]+)"', text):
        for file in (scene.parent / word, ROOT / "scenes/presets" / f"{word}.toml"):
            if file.is_file() and file.stat().st_size < 1 << 27:
                files_of_scene(file.resolve(), known)


def page_steps(page, picture):
    """What the reader of a page saves and runs: ("save", name, text) or ("run", command). Ends with the command that
    writes the picture, if the page names its folder or file."""
    steps, last = [], 0
    for _, language, text, before in blocks_of(ROOT / page):
        saved = re.search(r"[Ss]ave this as `([\w.-]+)`[^`]*$", before)
        if language == "sh":
            for command in commands_of(text):
                if not command.startswith(("make", "sudo")):
                    steps.append(("run", command))
                    if re.search(rf"(-o|--png) {re.escape(picture.rsplit('/', 1)[0])}(?![\w./-])", command) or (
                            f"--png {picture}" in command):
                        last = len(steps)
        elif saved:
            steps.append(("save", saved[1], text))
    return steps[:last] if last else steps


def inputs_of(figure):
    """Files that a figure depends on, without those of a page that it follows."""
    known = set()
    for name in figure.inputs:
        files_of_scene((ROOT / name).resolve(), known)
    for command in figure.commands:
        for word in re.findall(r"scenes/[\w./-]+\w", command):
            files_of_scene((ROOT / word).resolve(), known)
    if figure.draw:
        module = figure.draw.split(":")[0]
        known.update(HERE / name for name in (f"{module}.py", *SHARED[module]))
    return sorted(known)


def content_of(file):
    """The bytes of a file; the keys of a scene file without its title."""
    if file.suffix != ".toml":
        return file.read_bytes()
    keys = tomllib.loads(file.read_text())
    keys.pop("title", None)
    return json.dumps(keys, sort_keys=True, default=str).encode()


def hash_of(figure):
    digest = hashlib.sha256()

    def add(*words):
        for word in words:
            digest.update(word.encode() + b"\0")
    add(figure.draw, figure.picture, str(figure.width), *figure.commands, *(part for file in figure.files for part in file))
    for file in inputs_of(figure):
        add(str(file.relative_to(ROOT)), hashlib.sha256(content_of(file)).hexdigest())
    if figure.follows and not figure.draw:
        for step in page_steps(figure.follows, figure.picture):
            add(*step)
    elif figure.follows:
        add(first_scene(figure.follows))
    return digest.hexdigest()


def first_scene(page):
    """The first scene that a page lets its reader save."""
    return next(text for _, language, text, _ in blocks_of(ROOT / page) if language == "toml")


def chunks(data):
    at = 8
    while at < len(data):
        [length] = struct.unpack(">I", data[at:at + 4])
        yield data[at + 4:at + 8], data[at + 8:at + 8 + length]
        at += 12 + length


def write(path, data, words):
    """Writes a PNG or SVG with words (a dictionary) as its only metadata."""
    if path.suffix == ".svg":
        lines = "\n".join(f"{key}: {value}" for key, value in words.items())
        begin = re.match(r"<svg[^>]*>\n", data)
        path.write_text(data[:begin.end()] + f"<metadata>\n{lines}\n</metadata>\n" + data[begin.end():])
        return

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    out = [b"\x89PNG\r\n\x1a\n"]
    for kind, body in chunks(data):
        if kind in (b"IHDR", b"PLTE", b"tRNS", b"IDAT", b"IEND"):
            out.append(chunk(kind, body))
        if kind == b"IHDR":
            out += [chunk(b"tEXt", f"{key}\0{value}".encode("latin-1")) for key, value in words.items()]
    path.write_bytes(b"".join(out))


def read(path):
    """The metadata of a figure, as a dictionary; empty without any."""
    if path.suffix == ".svg":
        block = re.search(r"<metadata>\n(.*?)\n</metadata>", path.read_text(), re.S)
        return dict(line.split(": ", 1) for line in block[1].splitlines()) if block else {}
    return dict(body.decode("latin-1").split("\0", 1) for kind, body in chunks(path.read_bytes()) if kind == b"tEXt")
