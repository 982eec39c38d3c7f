# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the engines of others from folders that the environment names, and runs them."""
import functools
import os
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent


class Absent(ImportError):
    """No sources of this engine are here."""


def call(words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **options)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done


@functools.lru_cache
def built(name, variable, *further):
    """The folder of an engine that real/build_NAME builds from the folder that the environment variable names. An engine that is built
    already is not built again: remove its folder after a change of the sources."""
    source = os.environ.get(variable)
    if not source:
        raise Absent(f"{variable} does not name a folder with its sources")
    build = pathlib.Path(os.environ.get("TUBEFOOT_ENGINES_BUILD", "build/engines")).resolve() / name
    if not (build / "version").exists():
        call([HERE / "real" / f"build_{name}", source, build, *(os.environ[v] for v in further if v in os.environ)])
    return build


def version(build):
    return (build / "version").read_text().strip()


def without_graphics_card():
    """Mesa's rasteriser: the same picture on every machine."""
    return {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}
