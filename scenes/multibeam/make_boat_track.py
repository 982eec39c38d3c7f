#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the track of a boat that rolls, pitches and yaws: python3 scenes/multibeam/make_boat_track.py

  boat-track.csv  24 s at 2.5 m/s to the north; roll 8 degrees and 4 s, pitch 3 degrees and 5 s, yaw 2 degrees and 7 s

The motions are sines with these amplitudes and periods. The script needs only the standard library of Python and writes
the same file on every machine. The repository contains the file."""
import math
import pathlib

STEP_S, DURATION_S, SPEED_M_S = 0.05, 24, 2.5


def sine(amplitude_deg, period_s, phase, time_s):
    return amplitude_deg * math.sin(2 * math.pi * time_s / period_s + phase)


rows = ["time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg"]
for k in range(round(DURATION_S / STEP_S) + 1):
    t = k * STEP_S
    heave = 0.3 * math.sin(2 * math.pi * t / 4.5)
    rows.append(f"{t:.2f},0,{SPEED_M_S * t - 30:.4f},{heave - 1:.4f},{sine(2, 7, 0.5, t):.4f},"
                f"{sine(3, 5, 1.0, t):.4f},{sine(8, 4, 0.0, t):.4f}")
(pathlib.Path(__file__).parent / "boat-track.csv").write_text("\n".join(rows) + "\n")
