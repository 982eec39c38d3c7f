# SPDX-License-Identifier: GPL-3.0-or-later
"""Terrain that is read by tiles: transmissions, footprints and engines of one's own see what they see of the whole."""

import numpy as np
import pytest

import tubefoot

COLUMNS, ROWS = 150, 140  # 3 x 3 tiles

KEYS = {
    "materials": [{"name": "sand"}],
    "objects": [{"name": "box", "shape": "box", "size_m": [1, 1, 1], "position_m": [2, 3, 0.3]}],
    "trajectories": [{"kind": "line", "start_m": [-20, -15, 6], "end_m": [20, 18, 6], "speed_m_s": 2}],
    "sensors": [{"name": "side", "kind": "sidescan", "samples": 40, "range_min_m": 2, "range_max_m": 12, "pings": 3,
                 "ping_interval_s": 10}],
    "run": {"terrain_cache_mb": 0},
}


@pytest.fixture
def scenes(tmp_path):
    """The same scene, loaded whole and by tiles."""
    row, column = np.mgrid[:ROWS, :COLUMNS]
    heights = 0.4 * np.sin(column / 5) + 0.3 * np.cos(row / 4 + column / 9)
    rows = "\n".join(" ".join(f"{h:.4f}" for h in line) for line in heights)
    (tmp_path / "bed.asc").write_text(f"ncols {COLUMNS}\nnrows {ROWS}\nxllcorner -37.5\nyllcorner -35\ncellsize 0.5\n{rows}\n")
    bed = {"name": "bed", "kind": "raster", "file": str(tmp_path / "bed.asc"), "material": "sand"}
    return [tubefoot.Scene.from_dict({**KEYS, "terrain": [{**bed, "load": load}]}) for load in ("whole", "tiles")]


@tubefoot.sensor("corners")
def corners(history):
    """Energies by what footprints are of, and by what that is called."""
    transmission = history.transmission
    total = np.zeros(transmission.energy_shape)
    places = np.abs(transmission.vertices_m[transmission.facets[history.facet]]).sum(axis=(1, 2))
    sample = np.searchsorted(transmission.range_edges_m, history.range_min_m, side="right") - 1
    heard = (sample >= 0) & (sample < transmission.energy_shape[1])
    weights = history.area_m2 * places + transmission.base_facet[history.facet] + transmission.material_mu[transmission.material[history.facet]]
    np.add.at(total, (history.beam[heard], sample[heard]), weights[heard])
    return total


def test_a_transmission_meets_what_it_meets_of_the_whole(scenes):
    whole, tiles = (tubefoot.history(scene, "side", ping=1) for scene in scenes)
    assert len(whole) > 100
    assert len(tiles.transmission.facets) < len(whole.transmission.facets)
    for name in ("tube", "area_m2", "centroid_m", "normal", "range_min_m", "pieces", "corners_m", "occluders"):
        assert getattr(tiles, name).tobytes() == getattr(whole, name).tobytes(), name
    assert (whole.transmission.base_facet == np.arange(len(whole.transmission.facets))).all()
    for name in ("facet", "occluder_facets"):
        assert (tiles.transmission.base_facet[getattr(tiles, name)] == getattr(whole, name)).all()
    assert (tiles.transmission.vertices_m[tiles.transmission.facets[tiles.facet]] == whole.transmission.vertices_m[whole.transmission.facets[whole.facet]]).all()


def test_footprints_and_engines_of_ones_own(scenes):
    whole, tiles = (tubefoot.footprints(scene, "side") for scene in scenes)
    assert len(whole["facet"]) > 100
    for name in ("facet", "base_facet", "energy_j", "area_m2"):
        assert tiles[name].tobytes() == whole[name].tobytes(), name
    energies = [tubefoot.run(scene, engine=corners)["side"].energy for scene in scenes]
    assert energies[0].sum() > 0
    assert energies[0].tobytes() == energies[1].tobytes()
    trials = [tubefoot.chart(scene, [corners], repeats=1) for scene in scenes]
    assert trials[0][0]["l1_error"] == trials[1][0]["l1_error"] > 0
