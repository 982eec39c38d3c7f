# SPDX-License-Identifier: GPL-3.0-or-later
"""A patch test: recovers errors of roll, pitch, heading and latency from soundings of the same seabed on several lines.

[processing] plants the errors. The estimates use only the soundings that the sonar writes, the planned lines and the draught. The
order of the steps is that of the IHO Manual on Hydrography (C-13): latency, pitch, roll, heading.
"""

import csv
import pathlib
import tempfile

import numpy as np
import tubefoot

SONAR_UP_M, SEABED_UP_M, SLOPE_DEG = -2.0, -20.0, 15.0
SLOW_M_S, FAST_M_S = 2.0, 6.0
DISTANCE_M = 36.0  # between the parallel lines, whose outer beams meet in the middle
LENGTH_M = 24.0


def lines(slow_only=False):
    """The lines by name: easting, course (1: north, -1: south) and speed."""
    both = {"north": (0.0, 1, SLOW_M_S), "south": (0.0, -1, SLOW_M_S)}
    return both if slow_only else both | {"fast": (0.0, 1, FAST_M_S), "parallel": (DISTANCE_M, 1, SLOW_M_S)}


def scene(errors, slope_deg, of_lines):
    """The scene of lines over a plane that rises to the north."""
    trajectories, sensors = [], []
    for name, (east, course, speed) in of_lines.items():
        end = course * LENGTH_M / 2
        trajectories.append({"name": name, "kind": "line", "speed_m_s": speed, "start_m": [east, -end, SONAR_UP_M],
                             "end_m": [east, end, SONAR_UP_M]})
        sensors.append({"name": name, "kind": "multibeam", "trajectory": name, "beams": 41, "swath_deg": 120,
                        "beam_across_deg": 1, "along_track_deg": 1, "samples": 3000, "range_min_m": 5, "range_max_m": 65,
                        "first_ping_s": 1, "ping_interval_s": 2 / speed, "pings": 9})
    return tubefoot.Scene.from_dict({
        "georeference": {"origin_lat_lon_deg": [59, 10]},
        "water": {"sound_speed_m_s": 1500},
        "materials": [{"name": "sand", "lambert_db": -25}],
        "terrain": {"name": "seabed", "kind": "flat", "width_m": 400, "length_m": 160, "centre_m": [0, 0, SEABED_UP_M],
                    "slope_deg": slope_deg, "slope_heading_deg": 180},
        "trajectories": trajectories, "sensors": sensors,
        "processing": {"latency_s": errors["latency_s"],
                       "attitude_bias_deg": [errors["heading_deg"], errors["pitch_deg"], errors["roll_deg"]]}},
        name="patch-test")


def soundings(folder, name):
    """Beam, east, north and up of the soundings in a file of the sonar."""
    with open(pathlib.Path(folder) / f"{name}-soundings.csv", newline="") as file:
        rows = [[float(row[key]) for key in ("beam", "east_m", "north_m", "up_m")] for row in csv.DictReader(file)]
    return np.array(rows).T


def measured(errors, slope_deg, of_lines):
    """The soundings of all lines by name."""
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "out"
        tubefoot.run(scene(errors, slope_deg, of_lines), output=output)
        return {name: soundings(output, name) for name in of_lines}


def nadir_north_m(line, up_m):
    """Northing at which the middle beam meets a height, from a straight fit of its profile."""
    beam, _, north, up = line
    middle = beam == 20
    return np.polyval(np.polyfit(up[middle], north[middle], 1), up_m)


def without_roll(line, roll_rad, line_east_m):
    """The soundings of a northward line after a rotation about the track that removes the roll error."""
    beam, east, north, up = line
    x, z = east - line_east_m, up - SONAR_UP_M
    return np.array([beam, line_east_m + np.cos(roll_rad) * x - np.sin(roll_rad) * z, north,
                     SONAR_UP_M + np.cos(roll_rad) * z + np.sin(roll_rad) * x])


def overlap_north_m(line, east_m, up_m):
    """Northing at which the soundings near an easting meet a height, from a plane fit."""
    _, east, north, up = line
    near = np.abs(east - east_m) < 6
    design = np.column_stack([np.ones(near.sum()), up[near] - up_m, east[near] - east_m])
    return np.linalg.lstsq(design, north[near], rcond=None)[0][0]


def estimated(flat, slope):
    """The errors, from the soundings of a level seabed and of a slope."""
    # Latency: a line at two speeds. Soundings lag by speed times latency.
    lag_m = nadir_north_m(slope["north"], SEABED_UP_M) - nadir_north_m(slope["fast"], SEABED_UP_M)
    latency_s = lag_m / (FAST_M_S - SLOW_M_S)
    # Pitch: a line in both directions. Without latency, soundings are ahead by the depth times tan(pitch).
    ahead_m = (nadir_north_m(slope["north"], SEABED_UP_M) - nadir_north_m(slope["south"], SEABED_UP_M)) / 2 \
        + SLOW_M_S * latency_s
    pitch_rad = np.arctan(ahead_m / (SONAR_UP_M - SEABED_UP_M))
    # Roll: a line in both directions over a level seabed. The slope to starboard is that of the seabed minus tan(roll).
    to_east = [np.polyfit(flat[name][1], flat[name][3], 1)[0] for name in ("north", "south")]
    roll_rad = np.arctan((to_east[1] - to_east[0]) / 2)
    # Heading: two parallel lines. Outer soundings to starboard lag, and those to port lead.
    between = [overlap_north_m(without_roll(slope[name], roll_rad, east), DISTANCE_M / 2, SEABED_UP_M)
               for name, east in (("north", 0.0), ("parallel", DISTANCE_M))]
    heading_rad = np.arcsin((between[1] - between[0]) / DISTANCE_M)
    return {"latency_s": latency_s, "pitch_deg": np.degrees(pitch_rad), "roll_deg": np.degrees(roll_rad),
            "heading_deg": np.degrees(heading_rad)}


def patch_test(errors):
    """The errors that a patch test finds if these errors are planted."""
    return estimated(measured(errors, 0, lines(slow_only=True)), measured(errors, SLOPE_DEG, lines()))


if __name__ == "__main__":
    planted = {"latency_s": 0.25, "pitch_deg": -0.8, "roll_deg": 1.3, "heading_deg": 0.7}
    for name, value in patch_test(planted).items():
        print(f"{name:12} planted {planted[name]:8.4f}   found {value:8.4f}")
