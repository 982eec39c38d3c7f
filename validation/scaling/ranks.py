# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs on one and two ranks, and what rank 0 spends on each ping that another one computed."""
import itertools
import json
import pathlib
import re
import subprocess
import tempfile
import threading
import time

import numpy

from runs import SCENES, Run, sent_bytes, with_pings

# Pings of 2 x `samples` energies: cheap ones, of two facets, for which what rank 0 does is most of what is done;
# or dear ones, while which it mostly sleeps and looks for messages.
LINE = """
[water]
sound_speed_m_s = 1500
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 200
length_m = 200
cell_m = {cell}
[trajectory]
kind = "line"
start_m = [0, -80, 10]
end_m = [0, 80, 10]
[[sensors]]
name = "sidescan"
kind = "sidescan"
pings = {pings}
ping_interval_s = {interval}
samples = {samples}
range_max_m = 80
along_track_deg = {along}
"""
CHEAP_PINGS = {"cell": 0, "along": 0.5}
DEAR_PINGS = {"cell": 1, "along": 40}
# Two lengths whose files are written, in which all that has a largest size (waterfalls of 1500 to 3000 rows) has it.
WRITTEN_PINGS = {"sidescan": (3000, 6000), "multibeam": (100, 300), "camera": (20, 60), "paths": (3000, 6000)}
LEAD_RANKS = 5  # most results come from others; rank 0's own wake it less often
HEAD = 8 + 1  # of a result's message, before the packed ping: length and letter (src/run/ranks/rank_notes.cpp)


def camera(folder, pings):
    """The camera of the well head alone, on the same way in `pings` pings."""
    path = with_pings("wellhead/scene.toml", pings, folder)
    text = path.read_text().split('[[sensors]]\nname = "sidescan"')[0]
    path.write_text(re.sub(r"ping_interval_s = .*", f"ping_interval_s = {20 / pings:g}", text))
    return path


def scenes(folder, quick=False):
    """{name: scene file}: a sidescan's line, a multibeam's over the real grid, a camera's
    way, and a line with multiples of surface and bed."""
    few = 5 if quick else 1
    found = {"sidescan": with_pings("survey/scene.toml", 500 // few, folder)}
    (folder / "bed").mkdir()
    found["multibeam"] = with_pings("multibeam/real-grid.toml", 300 // few, folder / "bed")
    (folder / "camera").mkdir()
    found["camera"] = camera(folder / "camera", 60 // few)
    found["paths"] = with_pings("paths/shallow-water.toml", 30 // few, folder)
    return found


def least(runs, of):
    return min(of(run) for run in runs)


def measure(program, folder, rounds, quick=False):
    """{scene: {...}}: least seconds of interleaved rounds by one process with a thread, one with two, two ranks
    with one each; and of each ping, the least of all rounds of the one with a thread."""
    found = {}
    settings = {"1 process, 1 thread": (None, "1"), "1 process, 2 threads": (None, "2"), "2 ranks, 1 thread each": (2, "1")}
    for name, scene in scenes(folder, quick).items():
        runs = {setting: [] for setting in settings}
        for _ in range(rounds):
            for setting, (ranks, threads) in settings.items():
                runs[setting].append(Run(program, scene, ["--threads", threads], ranks))
        alone = runs["1 process, 1 thread"]
        row = found[name] = {"settings": {}, "scene_bytes": input_bytes(scene)}
        for setting, done in runs.items():
            row["settings"][setting] = {
                "simulation": least(done, lambda r: r.seconds["simulation"]), "total": least(done, lambda r: r.seconds["total"]),
                "wall": least(done, lambda r: r.wall), "processor": least(done, lambda r: r.processor)}
        row["pings"] = numpy.min([run.pings.sum(axis=1) for run in alone], axis=0)
        row["load"] = least(alone, lambda r: r.seconds["load"] + r.seconds["tree"])
        row["write"], row["write_fixed"] = writing(program, scene, WRITTEN_PINGS[name], rounds, quick)
        # Beside the pings themselves: touching the store's pages, sums, warnings.
        row["besides"] = least(alone, lambda r: r.seconds["simulation"] - r.pings.sum()) / len(row["pings"])
        row["store_bytes"] = alone[0].store_bytes / len(row["pings"])
        row["sent_bytes"] = HEAD + sent_bytes(program, scene)
        row["file_bytes"] = alone[0].file_bytes / len(row["pings"])
        print(f"{name}: {len(row['pings'])} pings measured", flush=True)
    return found


def of_length(scene, pings):
    """A copy beside the scene, of its line in so many pings, and of the ordinary echo alone."""
    text = scene.read_text()
    before = int(re.search(r"^pings = (\d+)", text, re.M)[1])
    text = re.sub(r"^pings = .*", f"pings = {pings}", text, flags=re.M)
    text = re.sub(r"^ping_interval_s = (.*)", lambda m: f"ping_interval_s = {float(m[1]) * (before - 1) / pings:.9g}", text, flags=re.M)
    path = scene.with_name(f"{pings}-" + scene.name)
    path.write_text(re.sub(r"^order = .*", "order = 1", text, flags=re.M))
    return path


def writing(program, scene, lengths, rounds, quick):
    """Seconds of one thread to write the files of a run: what grows with pings, a ping, and what does not (headers, and
    pictures that have reached their largest size in the shorter of two lengths). What is written was computed before."""
    def seconds(pings):
        path = of_length(scene, pings)
        with tempfile.TemporaryDirectory(prefix="tubefoot-writing-", dir=scene.parent) as out:
            command = [str(program), "run", str(path), "-o", f"{out}/run", "--quiet"]
            subprocess.run([*command, "--shard", "1/1"], check=True, capture_output=True)
            command[1] = "join"
            subprocess.run([*command, "--threads", "1"], check=True, capture_output=True)
            return json.loads(pathlib.Path(f"{out}/run/stats.json").read_text())["seconds"]["write"]
    short, whole = (pings // (5 if quick else 1) for pings in lengths)
    least_short, least_whole = (min(seconds(pings) for _ in range(rounds)) for pings in (short, whole))
    each = max(0.0, (least_whole - least_short) / (whole - short))
    return each, max(0.0, least_whole - each * whole)


def input_bytes(scene):
    files = [scene, *(pathlib.Path(f) for f in re.findall(r'file = "([^"]+)"', scene.read_text()))]
    return sum((scene.parent / file).stat().st_size for file in files)


class MainThread(threading.Thread):
    """Watches the main thread of rank 0, which only sees to messages while pings are simulated: processor seconds
    and sleeps from when the store has its size until files are being written."""
    def __init__(self, folder):
        super().__init__(daemon=True)
        self.folder, self.over, self.begin, self.end = folder, False, None, None

    def rank_0(self):
        for environment in pathlib.Path("/proc").glob("[0-9]*/environ"):
            try:
                if (b"OMPI_COMM_WORLD_RANK=0\0" in environment.read_bytes()
                        and str(self.folder).encode() in environment.with_name("cmdline").read_bytes()):
                    return environment.parent.name
            except OSError:
                pass  # a process that has ended, or another user's
        return None

    def run(self):
        process = None
        while process is None and not self.over:
            process = self.rank_0()
        thread = pathlib.Path(f"/proc/{process}/task/{process}")
        while not self.over:
            try:
                seconds = int((thread / "schedstat").read_text().split()[0]) / 1e9
                sleeps = int(re.search(r"^voluntary_ctxt_switches:\s*(\d+)", (thread / "status").read_text(), re.M)[1])
            except OSError:
                return  # it has ended
            if any(self.folder.glob(".run.tubefoot-*/echoes.nc")):
                return
            if (self.folder / "run.partial").exists():
                self.end = numpy.array([seconds, sleeps])
                self.begin = self.end if self.begin is None else self.begin
            time.sleep(0.002)


def lead_run(program, folder, samples, pings, kind):
    """A run on LEAD_RANKS ranks: bytes of a ping and of its message, results, seconds and sleeps of rank 0's main
    thread."""
    with tempfile.TemporaryDirectory(prefix="tubefoot-lead-", dir=folder) as scratch:
        scratch = pathlib.Path(scratch)
        scene = scratch / "line.toml"
        scene.write_text(LINE.format(pings=pings, interval=150 / pings, samples=samples, **kind))
        message = HEAD + sent_bytes(program, scene)
        watch = MainThread(scratch)
        watch.start()
        # Open MPI counts the bytes that ranks send each other.
        subprocess.run(["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n", str(LEAD_RANKS),
                        "--mca", "pml_monitoring_enable", "1", "--mca", "pml_monitoring_enable_output", "3",
                        "--mca", "pml_monitoring_filename", str(scratch / "sent"),
                        str(program), "run", str(scene), "-o", str(scratch / "run"), "--threads", "1", "--quiet"],
                       check=True, capture_output=True)
        watch.over = True
        watch.join()
        sent = sum(int(re.search(rf"^E\t{rank}\t0\t(\d+) bytes", (scratch / f"sent.{rank}.prof").read_text(), re.M)[1])
                   for rank in range(1, LEAD_RANKS))
    seconds, sleeps = (float(v) for v in watch.end - watch.begin)
    return {"bytes": 2 * samples * 8, "sent": message, "results": sent / message, "seconds": seconds, "sleeps": sleeps}


def lead_cost(program, folder, rounds, quick=False):
    """{"runs": [...], "once", "message", "byte", "sleep": seconds each}: what best explains the cheapest runs'
    seconds. `once` is what a run begins and ends with."""
    runs = []
    for samples, pings, kind in ((64, 1000, DEAR_PINGS), (64, 24000, CHEAP_PINGS), (1024, 16000, CHEAP_PINGS),
                                 (8192, 6000, CHEAP_PINGS), (65536, 900, CHEAP_PINGS)):
        tries = [lead_run(program, folder, samples, pings // (5 if quick else 1), kind) for _ in range(rounds)]
        runs.append(min(tries, key=lambda run: run["seconds"] / run["results"]))
        print("rank 0:", runs[-1], flush=True)
    rows = numpy.array([[1, r["results"], r["results"] * r["sent"], r["sleeps"]] for r in runs])
    found = least_squares_from_0(rows, numpy.array([r["seconds"] for r in runs]))
    return {"runs": runs, **dict(zip(("once", "message", "byte", "sleep"), map(float, found)))}


def least_squares_from_0(rows, seconds):
    """Least squares of relative errors, no number below 0: of few unknowns, all choices of those that are not 0."""
    relative, best = rows / seconds[:, None], None
    for wanted in itertools.product((False, True), repeat=rows.shape[1]):
        if not any(wanted):
            continue
        found = numpy.zeros(rows.shape[1])
        found[list(wanted)] = numpy.linalg.lstsq(relative[:, wanted], numpy.ones(len(seconds)), rcond=None)[0]
        error = numpy.square(relative @ found - 1).sum()
        if (found >= 0).all() and (best is None or error < best[0]):
            best = error, found
    return best[1]
