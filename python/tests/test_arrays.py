# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays with a mask, with values that are not a number and with infinite ones, wherever the module takes arrays."""

import numpy as np
import pytest

import tubefoot
from conftest import FACETS, VERTICES, equal_energies

HIDDEN = 1e127  # what lies behind a mask


def masked(values, *index):
    values = np.ma.array(values, copy=True)
    values[index] = HIDDEN if values.dtype.kind in "fc" else 1
    values[index] = np.ma.masked
    return values


def test_masked_heights_are_holes(folder, keys):
    def built(heights):
        keys["terrain"] = {"material": "sand", "heights": heights, "cell_m": 10, "origin_m": (-10, -15)}
        return tubefoot.run(tubefoot.Scene.from_dict(keys, base=folder))
    holes = np.zeros((4, 3))
    holes[3, 2] = np.nan
    expected = built(holes)
    for heights in (masked(np.zeros((4, 3)), 3, 2), masked(np.zeros((4, 3), int), 3, 2), list(masked(np.zeros((4, 3)), 3, 2)),
                    np.ma.array(np.zeros((4, 3), np.float32), mask=np.isnan(holes))):
        assert equal_energies(built(heights), expected)
    assert not equal_energies(built(np.zeros((4, 3))), expected)


HOLE = np.array([[0, 0], [0, np.nan]])
ENDLESS = np.array([[0, 0, 0], [0, 0, -np.inf]])
TEXT_OF_HOLE = "1 of 4 heights are holes, the first in row 1, column 1: expected adjacent heights that form a facet"


@pytest.mark.parametrize("terrain, text", [
    ({"heights": HOLE}, "terrain.heights: " + TEXT_OF_HOLE),
    ({"heights": masked(np.zeros((2, 2)), 1, 1)}, "terrain.heights: " + TEXT_OF_HOLE),
    ({"heights": HOLE * np.nan}, "terrain.heights: 4 of 4 heights are holes, the first in row 0, column 0: "),
    ({"heights": ENDLESS}, "terrain.heights: row 1, column 2 is -inf: expected metres, or nan for a hole"),
    ({"heights": np.zeros((2, 2)), "origin_m": (0, np.nan)},
     "terrain.origin_m: expected finite numbers, but element 1 is nan"),
    ({"heights": np.zeros((2, 2)), "origin_m": (0,)}, r"terrain.origin_m: expected \(east, north\), not"),
    ({"heights": np.zeros((2, 2)), "origin_m": np.ma.array([0, 1], mask=[True, False])},
     "terrain.origin_m: element 0 is masked: "),
])
def test_heights_that_make_no_terrain_are_named_by_row_and_column(folder, keys, terrain, text):
    keys["terrain"] = {"material": "sand", "cell_m": 10, **terrain}
    with pytest.raises(tubefoot.UsageError, match=text):
        tubefoot.Scene.from_dict(keys, base=folder)


@pytest.mark.parametrize("wrong, text", [
    ({"vertices": masked(VERTICES, 2, 1)}, "objects[0].vertices: row 2, column 1 is masked: "),
    ({"vertices": list(masked(VERTICES, 2, 1))}, "objects[0].vertices: row 2, column 1 is masked: "),
    ({"facets": masked(FACETS, 3, 0)}, "objects[0].facets: row 3, column 0 is masked: "),
    ({"vertices": np.where(VERTICES == 4, np.inf, VERTICES)},
     "objects[0].vertices: expected finite numbers, but row 2, column 1 is inf"),
])
def test_meshes_are_whole(folder, keys, wrong, text):
    keys["objects"][0] = {"name": "thing", "material": "steel", "vertices": VERTICES, "facets": FACETS, **wrong}
    with pytest.raises(tubefoot.UsageError) as error:
        tubefoot.Scene.from_dict(keys, base=folder)
    assert str(error.value).startswith(text)


@pytest.mark.parametrize("value, text", [
    (masked([0.0, 1, 2], 1), "trajectories[0].end_m: element 1 is masked: "),
    ([0, np.ma.masked, 2], "trajectories[0].end_m[1]: it is masked: "),
])
def test_keys_are_not_masked(folder, keys, value, text):
    keys["trajectories"][0]["end_m"] = value
    with pytest.raises(tubefoot.UsageError) as error:
        tubefoot.Scene.from_dict(keys, base=folder)
    assert str(error.value).startswith(text)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_keys_that_are_no_number_are_named(folder, keys, value):
    keys["trajectories"][0]["end_m"] = np.array([0, value, 2])
    with pytest.raises(tubefoot.InputError) as error:
        tubefoot.Scene.from_dict(keys, base=folder)
    assert error.value.key == "trajectories[0].end_m"


@pytest.mark.parametrize("value, text", [
    (np.ma.masked, "engine 'odd' returned a masked value in beam 3 and sample 5 of transmission 0 of ping 1 of sensor 'camera': "),
    (-1, "engine 'odd' returned energies that are negative or not finite: -1.0 in beam 3 and sample 5 of transmission 0 of ping 1 "),
    (np.nan, "engine 'odd' returned energies that are negative or not finite: nan in beam 3 and sample 5 of transmission 0 of ping 1 "),
    (np.inf, "engine 'odd' returned energies that are negative or not finite: inf in beam 3 and sample 5 of transmission 0 of ping 1 "),
])
def test_an_engines_energies_are_named_by_beam_and_sample(scene, value, text):
    @tubefoot.engine("odd")
    def odd(transmission):
        energy = np.ma.array(np.full(transmission.energy_shape, HIDDEN))
        if transmission.ping == 1:
            energy[3, 5] = value
        return energy
    with pytest.raises(ValueError) as error:
        tubefoot.run(scene, engine=odd, sensor="camera")
    assert str(error.value).startswith(text)


def test_an_engine_may_return_a_masked_array_that_hides_nothing(scene):
    @tubefoot.engine("whole")
    def whole(transmission):
        return np.ma.ones(transmission.energy_shape)
    assert (tubefoot.run(scene, engine=whole)["camera"].energy == 1).all()


def test_pings_are_not_chosen_through_a_mask(scene):
    camera = tubefoot.run(scene)["camera"]
    for pings in (masked(np.array([0, 1, 2]), 2), np.ma.array([True, True, True], mask=[False, False, True])):
        with pytest.raises(tubefoot.UsageError, match="pings: element 2 is masked: "):
            camera[pings]
    with pytest.raises(tubefoot.UsageError, match="pings: expected a whole number, not masked"):
        tubefoot.footprints(scene, "camera", np.ma.array([0, 1], mask=[False, True]))


SIGNALS = dict(targets=[[0.0, 20, 0], [1, 21, 0]], strengths=[1.0, 2], receivers=[[0.0, 0, 0]], transmitter=[0.0, 0, 0],
               ping_times=[0.0, 1], track_times=[0.0, 2], positions=[[0.0, 0, 0], [1, 0, 0]],
               attitudes=[[1.0, 0, 0, 0], [1, 0, 0, 0]])
RECORD = dict(waveform=tubefoot.Waveform(95e3, 105e3, 1e-3), baseband_frequency=100e3, sample_rate=20e3, samples=100,
              first_sample=0.02)


@pytest.mark.parametrize("name", SIGNALS)
@pytest.mark.parametrize("value", [np.nan, np.inf, np.ma.masked])
def test_arrays_of_signals_are_whole(name, value):
    wrong = np.ma.array(SIGNALS[name], complex if name == "strengths" else float)
    place = "row 0, column 2" if wrong.ndim == 2 else "element 1"
    wrong[(0, 2) if wrong.ndim == 2 else 1] = value
    tubefoot.point_signals(**SIGNALS, **RECORD)
    with pytest.raises(tubefoot.UsageError, match=f"^{name}: .*{place} is "):
        tubefoot.point_signals(**{**SIGNALS, name: wrong}, **RECORD)


@pytest.mark.parametrize("name, more", [
    ("directions", {}), ("weights", {"directions": [[0, 1, 0]]}), ("reference", {"directions": [[0, 1, 0]]}),
])
def test_arrays_of_beams_are_whole(name, more):
    signals = tubefoot.point_signals(**SIGNALS, **RECORD)
    wrong = {"directions": masked([[0.0, 1, 0]], 0, 2), "weights": masked([1.0], 0), "reference": [0, 0, np.nan]}[name]
    with pytest.raises(tubefoot.UsageError, match=f"^{name}: "):
        signals.beams(**{**more, name: wrong})
    with pytest.raises(tubefoot.UsageError, match="^ping_weights: element 1 is masked: "):
        signals.back_projected((0, 19, 0), (1, 0, 0), (0, 1, 0), 2, 2, ping_weights=masked([1.0, 1], 1))
