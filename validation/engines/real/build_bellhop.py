#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds BELLHOP or bellhopcxx from a folder of its sources: build_bellhop.py SOURCES OUTPUT.

SOURCES is a work tree or a git directory of BELLHOP (Fortran; needs gfortran) or of bellhopcxx (C++; needs cmake and
libglm-dev). The script reads it only. It builds a copy in the folder OUTPUT and prints the path of the program. The last
line of OUTPUT/version.txt names the revision, if git knows it. Exit code 77: SOURCES is neither of the two."""

import io
import pathlib
import shutil
import subprocess
import sys
import tarfile

FORTRAN, CXX = "Bellhop/bellhop.f90", "include/bhc/bhc.hpp"
# Parts of a git directory that the programs need. Manuals and tests, which may be absent, are left out.
PARTS = {FORTRAN: ("Bellhop/*.f90", "Bellhop/Makefile", "misc"), CXX: ("CMakeLists.txt", "config", "include", "src")}
# Features of bellhopcxx that the comparison does not use and that cost most of its time to compile.
UNUSED = ("ENABLE_CUDA", "BUILD_EXAMPLES", "DIM_ENABLE_3D", "DIM_ENABLE_NX2D", "INFL_ENABLE_CERVENY_RAYCEN",
          "INFL_ENABLE_CERVENY_CART", "INFL_ENABLE_GEOM_RAYCEN", "INFL_ENABLE_SGB", "RUN_ENABLE_TL", "RUN_ENABLE_EIGENRAYS",
          "SSP_ENABLE_N2LINEAR", "SSP_ENABLE_CUBIC", "SSP_ENABLE_PCHIP", "SSP_ENABLE_QUAD", "SSP_ENABLE_HEXAHEDRAL",
          "SSP_ENABLE_ANALYTIC")


def git(folder, *words):
    done = subprocess.run(["git", "-C", str(folder), *words], capture_output=True)
    return done.stdout if done.returncode == 0 else b""


def copy(sources, copied):
    """Copies the sources and returns FORTRAN or CXX, or None if they are neither."""
    if (sources / "HEAD").is_file() and (sources / "objects").is_dir():
        names = git(sources, "ls-tree", "-r", "--name-only", "HEAD").decode().split("\n")
        kind = next((k for k in (FORTRAN, CXX) if k in names), None)
        if kind:
            wanted = [n for n in names if any(pathlib.PurePath(n).match(p) or n.startswith(p + "/") for p in PARTS[kind])]
            archive = git(sources, "archive", "HEAD", *wanted)
            tarfile.open(fileobj=io.BytesIO(archive)).extractall(copied)
        return kind
    kind = next((k for k in (FORTRAN, CXX) if (sources / k).is_file()), None)
    if kind:
        shutil.copytree(sources, copied, ignore=shutil.ignore_patterns(".git", "glm", "tests", "test", "bin"))
    return kind


def run(*words, folder):
    done = subprocess.run([str(w) for w in words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"build_bellhop.py: {words[0]} failed in {folder}:\n{done.stdout[-3000:]}")


def build_fortran(copied):
    flags = "FFLAGS=-O2 -std=gnu -w -I../misc"
    run("make", "FC=gfortran", flags, "all", folder=copied / "misc")
    run("make", "FC=gfortran", flags, "bellhop.exe", folder=copied / "Bellhop")
    return copied / "Bellhop" / "bellhop.exe"


def build_cxx(copied):
    for file in copied.glob("config/**/CMakeLists.txt"):
        # The stated version is that of the developers. Debian 12 has 3.25, which suffices.
        file.write_text(file.read_text().replace("VERSION 3.27", "VERSION 3.15"))
    # The configuration installs a git hook, and fails without the file of the hook.
    (copied / "clang-format.hook").write_text("#!/bin/sh\n")
    (copied / ".git" / "hooks").mkdir(parents=True)
    (copied / ".git" / "hooks" / "pre-commit").write_text("#!/bin/sh\n")
    run("cmake", "-S", ".", "-B", "built", *[f"-DBHC_{name}=OFF" for name in UNUSED], folder=copied)
    run("cmake", "--build", "built", "--target", "bellhopcxx2d", folder=copied)
    return copied / "bin" / "bellhopcxx2d"


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: build_bellhop.py SOURCES OUTPUT")
    sources, output = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    copied = output / "sources"
    if copied.exists():
        shutil.rmtree(copied)
    output.mkdir(parents=True, exist_ok=True)
    kind = copy(sources, copied)
    if not kind:
        print(f"build_bellhop.py: {sources} contains neither {FORTRAN} nor {CXX}: expected the sources of BELLHOP or "
              "bellhopcxx", file=sys.stderr)
        return 77
    program = (build_fortran if kind == FORTRAN else build_cxx)(copied)
    known = (sources / ".git").exists() or (sources / "HEAD").is_file()
    revision = git(sources, "log", "-1", "--format=%h of %ad", "--date=short").decode().strip() if known else ""
    (output / "version.txt").write_text(f"{'BELLHOP' if kind == FORTRAN else 'bellhopcxx'}\n{revision or 'unknown'}\n")
    print(program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
