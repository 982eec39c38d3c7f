# SPDX-License-Identifier: GPL-3.0-or-later
"""A seabed of heights before a sonar, for the examples of PyTorch and JAX."""

import numpy as np
import tubefoot

CELL_M = 0.5


def scene(heights):
    """The scene for heights in metres: rows from south to north, columns from west to east."""
    rows, columns = heights.shape
    return tubefoot.Scene.from_dict({
        "water": {"sound_speed_m_s": 1500, "absorption_db_per_km": 0},
        "materials": [{"name": "sand"}],
        "terrain": {"name": "seabed", "heights": np.asarray(heights, float), "cell_m": CELL_M, "origin_m": (0, 0),
                    "material": "sand"},
        "trajectory": {"kind": "fixed", "position_m": [(columns - 1) * CELL_M / 2 + 0.07, -2.03, 2.5]},
        "sensors": [{"name": "sonar", "kind": "imaging", "beams": 8, "horizontal_deg": 60, "vertical_deg": 40,
                     "tilt_deg": 35, "samples": 24, "range_min_m": 2, "range_max_m": 8}]}, name="heights")


def energies(heights):
    """Energies in J/m² of shape (pings, beams, range bins)."""
    return np.array(tubefoot.run(scene(heights))["sonar"].energy)


def by_heights(heights, weights):
    """The derivatives of the sum of weight times energy by the heights."""
    seabed = scene(heights).gradient(weights).components["seabed"]
    slope = np.zeros(heights.shape)
    column, row = np.rint(seabed.vertices_m[:, :2].T / CELL_M).astype(int)
    slope[row, column] = seabed.by_vertex[:, 2]
    return slope
