# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program and reads what its runs cost."""
import json
import os
import pathlib
import re
import resource
import subprocess
import tempfile
import time

import numpy

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"
# src/run/checkpoint/packed_ping.hpp: a packed ping begins with a header (group, ping, number of bytes after the header, checksums).
# PingCounts follows; its seconds stand behind five counts.
HEAD_BYTES, SECONDS_AT = 32, 72


def with_pings(scene, pings, folder):
    """A copy of a shipped scene, named files included, in which every sensor has `pings` pings."""
    text = (SCENES / scene).read_text()
    text = re.sub(r"^pings = \d+", f"pings = {pings}", text, flags=re.M)
    text = re.sub(r'^(file|profile_file) = "([^"]+)"', lambda m: f'{m[1]} = "{((SCENES / scene).parent / m[2]).resolve()}"',
                  text, flags=re.M)
    path = folder / pathlib.Path(scene).name
    path.write_text(text)
    return path


def ping_seconds(store, stats):
    """Visibility and echo seconds, [ping][2], of all pings of an open store: they are kept with each ping's energies."""
    data = store.read()
    if data[:16] != b"tubefoot pings 6":
        raise RuntimeError(f"{store.name}: this script does not support this checkpoint format (src/run/checkpoint/ping_file.cpp)")
    at, pings = 32 + int.from_bytes(data[16:24], "little"), {}
    while at < len(data):
        group, ping, size = (int.from_bytes(data[at + k:at + k + 8], "little") for k in (0, 8, 16))
        pings[group, ping] = numpy.frombuffer(data, numpy.float64, 2, at + SECONDS_AT)
        at += HEAD_BYTES + size
    seconds = numpy.array([pings[key] for key in sorted(pings)])
    told = [stats["seconds"][k] for k in ("visibility_of_all_pings", "echo_of_all_pings")]
    if not numpy.allclose(seconds.sum(axis=0), told, rtol=1e-6):
        raise RuntimeError(f"{store.name}: the seconds of the pings do not add up to those of stats.json; "
                           "has PingCounts changed (src/run/checkpoint/ping_counts.hpp)?")
    return seconds


def opened_when_there(file, process):
    """A file that a process makes, as soon as it does."""
    while True:
        try:
            return open(file, "rb")
        except FileNotFoundError:
            if process.poll() is not None:
                raise RuntimeError(f"the process ended without {file.name}: {process.communicate()[1]}") from None
            time.sleep(0.001)


def sent_bytes(program, scene):
    """Of a ping, in the mean, as ranks send it to each other: what a run keeps that has one part, head included."""
    with tempfile.TemporaryDirectory(prefix="tubefoot-scaling-") as scratch:
        done = subprocess.run([str(program), "run", str(scene), "-o", f"{scratch}/run", "--shard", "1/1", "--quiet"],
                              check=True, capture_output=True, text=True)
        pings = int(re.search(r"(\d+) pings", done.stdout)[1])
        return pathlib.Path(f"{scratch}/run.part-1-of-1").stat().st_size / pings


class Run:
    """One run: stats.json, the seconds of each ping, and the processor seconds of all its processes."""
    def __init__(self, program, scene, options=(), ranks=None):
        with tempfile.TemporaryDirectory(prefix="tubefoot-scaling-") as scratch:
            out = pathlib.Path(scratch) / "run"
            # The run takes this file away at its end; whoever has it open keeps it.
            partial = out.with_name("run.partial")
            start = [] if ranks is None else ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none",
                                              "-n", str(ranks)]
            before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            process = subprocess.Popen([*start, str(program), "run", str(scene), "-o", str(out), "--quiet", *options],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            kept = opened_when_there(partial, process)
            errors = process.communicate()[1]
            self.wall = time.monotonic() - begin
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            if process.returncode:
                raise RuntimeError(f"{scene}: exit code {process.returncode}\n{errors}")
            self.processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            self.stats = json.loads((out / "stats.json").read_text())
            self.seconds = self.stats["seconds"]
            with kept:
                self.pings = ping_seconds(kept, self.stats)
                self.store_bytes = os.fstat(kept.fileno()).st_size
            self.file_bytes = sum(file.stat().st_size for file in out.iterdir())
