#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""wheel_test.py BUILD SOURCES: packs the wheel, installs it with pip into a folder, and runs a scene with it, where no
library is taken from the system that the wheel has, and the energies are those of the module as it was built."""
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

BUILD, SOURCES = map(pathlib.Path, sys.argv[1:])
for tool, missing in (("patchelf", not shutil.which("patchelf")),
                      ("python3-pip", subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode)):
    if missing:
        print(f"{tool} is not installed")
        sys.exit(77)

wrong = []


def hold(true, words):
    if not true:
        wrong.append(words)


def wheel_of(build, folder):
    return subprocess.run([SOURCES / "tools/wheel", build, folder], capture_output=True, text=True)


RUN = """
import hashlib, os, sys
sys.path.insert(0, sys.argv[1])
import tubefoot
result = tubefoot.run(tubefoot.load(sys.argv[2]))
print(hashlib.sha256(result["camera"].energy.tobytes()).hexdigest())
for file in sorted({line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}):
    print(file)
"""


def run_with(folder, scene, where):
    """The hash of a scene's energies, and the libraries that were loaded for it."""
    done = subprocess.run([sys.executable, "-c", RUN, folder, scene], cwd=where, capture_output=True, text=True,
                          env={"PATH": "/usr/bin", "HOME": str(where)})
    if done.returncode:
        sys.exit(f"with the module in {folder}: {done.stderr}")
    digest, *files = done.stdout.split()
    return digest, [pathlib.Path(file) for file in files]


with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch).resolve()
    (folder / "empty/python/tubefoot").mkdir(parents=True)
    refused = wheel_of(folder / "empty", folder / "none")
    hold(refused.returncode and "has no Python module" in refused.stderr and not (folder / "none").exists(),
         f"a build without a module is packed: {refused}")

    made = wheel_of(BUILD, folder / "wheel")
    if made.returncode:
        sys.exit(made.stderr)
    (wheel,) = (folder / "wheel").iterdir()
    version = "{}{}".format(*sys.version_info[:2])
    system = sysconfig.get_platform().replace("-", "_")
    hold(re.fullmatch(rf"tubefoot-\d+\.\d+\.\d+-cp{version}-cp{version}-{system}\.whl", wheel.name), wheel.name)

    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        (record,) = (name for name in names if name.endswith(".dist-info/RECORD"))
        info = record.removesuffix("RECORD")
        recorded = dict(line.split(",", 1) for line in archive.read(record).decode().splitlines())
        hold(set(recorded) == names, f"RECORD has {set(recorded) ^ names} too much or not")
        for name in names - {record}:
            digest = base64.urlsafe_b64encode(hashlib.sha256(archive.read(name)).digest()).rstrip(b"=").decode()
            hold(recorded[name] == f"sha256={digest},{archive.getinfo(name).file_size}", f"RECORD is wrong about {name}")
        # Whose each library is, and its licence.
        rows = dict(line.split("\t") for line in archive.read(info + "libraries.txt").decode().splitlines())
        carried = {name.removeprefix("tubefoot/") for name in names if name.startswith(("tubefoot/lib/", "tubefoot/share/"))}
        hold(set(rows) == carried, f"libraries.txt and the wheel differ by {set(rows) ^ carried}")
        for package, _ in (row.split() for row in rows.values()):
            hold(f"{info}licenses/{package}" in names, f"no licence of {package}")
        hold(f"{info}licenses/tubefoot" in names, "no licence of tubefoot")

    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--no-compile", "--target",
                    folder / "site", wheel], check=True, env={**os.environ, "PIP_ROOT_USER_ACTION": "ignore"})
    scene = SOURCES / "scenes/chart/sphere-on-plane.toml"
    digest, loaded = run_with(folder / "site", scene, folder)
    native, _ = run_with(BUILD / "python", scene, folder)
    hold(digest == native, "the wheel's module computes other energies than the build's")
    mine = {name.removeprefix("lib/") for name in rows}
    hold(any(file.name.startswith("libgdal") and folder in file.parents for file in loaded), "its GDAL is not used")
    # What the interpreter itself had loaded before is there already: of its own package or one of its base.
    before = set(subprocess.run([sys.executable, "-c", "import numpy, hashlib, ssl, ctypes, zlib, bz2, lzma\n"
                                 "print(*{l.split()[-1] for l in open('/proc/self/maps') if '.so' in l})"],
                                capture_output=True, text=True, check=True).stdout.split())
    for file in loaded:
        hold(folder in file.parents or str(file) in before or not any(file.name.startswith(name) for name in mine),
             f"{file} is loaded, and the wheel has it")

print("\n".join(wrong) or f"the wheel carries {len(rows)} files that it needs, and computes as the build does")
sys.exit(bool(wrong))
