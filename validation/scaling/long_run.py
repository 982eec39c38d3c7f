#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory of a run of many pings, from the first ping to the last file: long_run.py PROGRAM FIGURE [PINGS].

A sidescan and a multibeam over a small bed; the program's memory is read from /proc twenty times a second.
Anonymous memory is what the program holds; pages of mapped files (libraries, and the store of pings on its
way to the disk) are the system's to take back.
"""
import pathlib
import subprocess
import sys
import tempfile
import time

import plot

SCENE = """
[water]
sound_speed_m_s = 1500
[[materials]]
name = "bed"
[[terrain]]
kind = "fractal"
width_m = 60
length_m = 120
cell_m = 1
rms_height_m = 0.2
[trajectory]
kind = "line"
start_m = [0, -50, 10]
end_m = [0, 50, 10]
[[sensors]]
pings = {pings}
ping_interval_s = {interval}
"""
SONARS = {
    "sidescan": 'name = "sidescan"\nkind = "sidescan"\nsamples = 1000\nrange_max_m = 25\n',
    "multibeam": 'name = "multibeam"\nkind = "multibeam"\nbeams = 64\nswath_deg = 120\nsamples = 256\nrange_max_m = 25\n',
}
MB = 2**20


class Watched:
    """A run and its memory: rows of seconds, pings done, anonymous and file pages in MB; when writing began."""
    def __init__(self, program, sonar, pings, folder):
        scene, out = folder / f"{sonar}.toml", folder / sonar
        scene.write_text(SCENE.format(pings=pings, interval=99 / pings) + SONARS[sonar])
        begin, self.rows, self.writing = time.monotonic(), [], None
        with (folder / "progress").open("w+") as progress:
            run = subprocess.Popen([program, "run", scene, "-o", out, "--threads", "2"], stdout=subprocess.DEVNULL,
                                   stderr=progress)
            while run.poll() is None:
                try:
                    status = dict(line.split(":", 1) for line in open(f"/proc/{run.pid}/status") if ":" in line)
                except OSError:
                    break
                if "RssAnon" in status:
                    anonymous, file = (int(status[key].split()[0]) / 1024 for key in ("RssAnon", "RssFile"))
                    self.rows.append((time.monotonic() - begin, anonymous, file))
                if self.writing is None and any(folder.glob(f".{sonar}.partial-*/echoes.nc")):
                    self.writing = time.monotonic() - begin
                time.sleep(0.05)
            if run.wait():
                progress.seek(0)
                raise RuntimeError(progress.read())
        self.store_mb = pings * (2 * 1000 if sonar == "sidescan" else 64 * 256) * 8 / MB
        self.files_mb = sum(file.stat().st_size for file in out.iterdir()) / MB

    def largest(self, column, phase):
        """Largest of a column after loading: while pings are simulated, or files written."""
        after = [row[column] for row in self.rows if (row[0] >= self.writing) == (phase == "writing")]
        return max(after)


def main():
    program, figure = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    most = int(sys.argv[3]) if len(sys.argv) > 3 else 10000
    counts, panels, peaks = [most // 100, most // 10, 3 * most // 10, most], [], {}
    print("| sonar | pings | energies | simulation: anonymous | file pages | writing: anonymous | file pages | files |")
    print("|---|---|---|---|---|---|---|---|")
    for sonar in SONARS:
        for pings in counts:
            with tempfile.TemporaryDirectory(prefix="tubefoot-long-") as scratch:
                run = Watched(program, sonar, pings, pathlib.Path(scratch))
            found = [run.largest(column, phase) for phase in ("simulation", "writing") for column in (1, 2)]
            peaks.setdefault(sonar, []).append(found)
            print(f"| {sonar} | {pings} | {run.store_mb:.0f} | " + " | ".join(f"{f:.0f}" for f in found)
                  + f" | {run.files_mb:.0f} |", flush=True)
        times = [row[0] for row in run.rows]
        lines = {"anonymous": (times, [row[1] for row in run.rows], {"line"}),
                 "file pages": (times, [row[2] for row in run.rows], {"line"}),
                 "start of writing": ([run.writing] * 2, [0, max(max(row[1:]) for row in run.rows)],
                                                    {"line", "dashes", "thin"})}
        highest = 1.9 * max(max(peak) for peak in peaks[sonar])
        panels.append(plot.panel(f"{sonar}, {most} pings: {run.store_mb:.0f} MB of energies", "seconds", "memory, MB",
                                 lines, limits=(0, None, 0, highest)))
        panels.append(plot.panel(f"{sonar}: largest memory against pings", "pings", "memory, MB", {
            name: (counts, [peak[column] for peak in peaks[sonar]])
            for name, column in (("anonymous, simulation", 0), ("anonymous, writing", 2),
                                 ("file pages, simulation", 1), ("file pages, writing", 3))},
            log=(True, False), limits=(None, None, 0, highest)))
    plot.sheet(figure, panels)


if __name__ == "__main__":
    main()
