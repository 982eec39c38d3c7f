#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Certified derivatives of small scenes: answers.py FILE writes them anew.

Each answer encloses the derivative of the energy of each beam and range bin: the true value lies within `bound` of
`value`. It needs the Python module (make python).
"""
import json
import pathlib
import sys

import numpy
import tubefoot

WATER = {"sound_speed_m_s": 1500, "absorption_db_per_km": 100}
MATERIALS = [{"name": "sand", "lambert_db": -27}, {"name": "steel", "lambert_db": -15}]
SENSOR = {"name": "sonar", "kind": "imaging", "beams": 4, "horizontal_deg": 24, "vertical_deg": 30, "tilt_deg": 30,
          "samples": 8, "range_min_m": 2, "range_max_m": 6}
BED = {"name": "bed", "kind": "fractal", "width_m": 14, "length_m": 14, "cell_m": 1.3, "rms_height_m": 0.2, "material": "sand"}
BOX = {"name": "box", "shape": "box", "size_m": [0.9, 0.5, 0.7], "position_m": [0.31, 3.07, 0.83], "heading_deg": 25,
       "pitch_deg": 8, "roll_deg": 5, "material": "steel"}
POSE = {"kind": "fixed", "position_m": [0.02, 0.013, 2.51], "heading_deg": 3}
WALL = {"name": "wall", "material": "sand", "position_m": [0.1, 3, 0], "heading_deg": 12, "vertices": numpy.array(
    [[-1.0, 0, 0], [1, 0, 0], [1, 0, 0.5], [-1, 0, 0.5]]), "facets": numpy.array([[0, 1, 2], [0, 2, 3]])}
FLAT = {"name": "seabed", "kind": "flat", "width_m": 40, "length_m": 40, "material": "sand"}

SCENES = {  # name: (terrain, objects, parameters)
    "shadow of a wall": (FLAT, [WALL], ["sonar.position.up", "sonar.rotation.x", "wall.position.north", "wall.rotation.z",
                                        "material.sand.mu", "water.sound_speed"]),
    "box over rough terrain": (BED, [BOX], ["sonar.position.east", "sonar.position.up", "sonar.mounting.tilt",
                                            "box.position.up", "box.rotation.x", "material.steel.mu", "water.absorption"]),
}


def scene(name):
    terrain, objects, _ = SCENES[name]
    return tubefoot.Scene.from_dict({"water": WATER, "materials": MATERIALS, "terrain": terrain, "objects": objects,
                                     "trajectory": POSE, "sensors": [SENSOR]}, name=name)


def answers(name):
    """{parameter: {"units": ..., "value": [beam][range bin], "bound": the same}}."""
    own = scene(name)
    sonar = tubefoot.reference(own, gradient=SCENES[name][2])["sonar"]
    units = own.gradient_parameters()
    return {key: {"units": units[key][0], "value": sonar.gradient[key][0].tolist(),
                  "bound": sonar.gradient_bound[key][0].tolist()} for key in SCENES[name][2]}


if __name__ == "__main__":
    pathlib.Path(sys.argv[1]).write_text(json.dumps({name: answers(name) for name in SCENES}) + "\n")
