# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of energies in stratified water: central differences of whole runs, laws, and rejected combinations."""

import copy
import subprocess

import numpy as np
import pytest

import tubefoot
import test_gradient
from conftest import PROGRAM
from test_gradient import moves

# No facet is cut, because the limits of the refinement are large. Apparent positions are rounded to the grid, which is
# therefore fine.
SPEED, GRADIENT, SURFACE = 1500.0, 2.0, 6.0
KEYS = {
    "run": {"grid_exponent": 26},
    "water": {"profile": "gradient", "sound_speed_m_s": SPEED, "gradient_per_s": GRADIENT, "profile_bottom_m": 12,
              "surface_height_m": SURFACE, "absorption_db_per_km": 120.0, "refraction_gap_m": 1000,
              "refraction_tolerance_db": 10},
    "materials": [{"name": "sand", "lambert_db": -27.0}, {"name": "steel", "lambert_db": -15.0}],
    "terrain": {"name": "bed", "kind": "fractal", "width_m": 14, "length_m": 14, "cell_m": 2.6, "rms_height_m": 0.2,
                "material": "sand"},
    "objects": [{"name": "block", "shape": "box", "size_m": [0.9, 0.5, 0.7], "position_m": [0.31, 3.07, 0.83],
                 "heading_deg": 25, "pitch_deg": 8, "roll_deg": 5, "material": "steel"}],
    "trajectory": {"kind": "fixed", "position_m": [0.02, 0.013, 2.51], "heading_deg": 3, "pitch_deg": 3, "roll_deg": 2},
    "sensors": [{"name": "camera", "kind": "imaging", "beams": 8, "horizontal_deg": 24, "vertical_deg": 25, "yaw_deg": 7,
                 "tilt_deg": 30, "roll_deg": 4, "range_min_m": 2, "range_max_m": 6, "samples": 30, "pings": 2,
                 "ping_interval_s": 1}],
}
STEP = 2.0**-12


def with_times_of(before, keys):
    """Scales the ranges so that range bins remain intervals of time. The sound speed at the sonar is the reference."""
    def reference(of):
        water = of["water"]
        return water["sound_speed_m_s"] + water["gradient_per_s"] * (SURFACE - of["trajectory"]["position_m"][2])

    for key in ("range_min_m", "range_max_m"):
        keys["sensors"][0][key] *= reference(keys) / reference(before)
    return keys


MOVED = moves(KEYS, STEP)
OF_SOUND_SPEED = {"water.sound_speed": ("sound_speed_m_s", 0.125), "water.gradient_per_s": ("gradient_per_s", 0.03125)}
NAMES = list(tubefoot.Scene.from_dict(KEYS).gradient_parameters())


@pytest.fixture(scope="module")
def scene():
    return tubefoot.Scene.from_dict(KEYS)


@pytest.fixture(scope="module")
def echoes(scene):
    return tubefoot.run(scene, gradient=NAMES)["camera"]


def energy_of(keys, base="."):
    return tubefoot.run(tubefoot.Scene.from_dict(with_times_of(KEYS, keys), base))["camera"].energy


@pytest.mark.parametrize("name", MOVED)
def test_derivatives_are_central_differences_of_whole_runs(echoes, name):
    scene_of, step = MOVED[name]
    difference = (energy_of(scene_of(step)) - energy_of(scene_of(-step))) / (2 * step)
    derivative = echoes.gradient[name]
    assert np.abs(derivative).max() > 0
    # Directions of tubes are rounded to a grid, so that differences by angles have errors of their own.
    tolerance = 5e-4 if ".mounting." in name else 3e-5
    assert np.abs(difference - derivative).max() < tolerance * np.abs(derivative).max()


@pytest.mark.parametrize("name", OF_SOUND_SPEED)
def test_derivatives_by_the_sound_speed_are_central_differences_of_whole_runs(name):
    # The factor of a facet averages the absorption at the reference speed, which the run keeps and the difference changes.
    keys = copy.deepcopy(KEYS)
    keys["water"]["absorption_db_per_km"] = 0.0
    key, step = OF_SOUND_SPEED[name]
    derivative = tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=[name])["camera"].gradient[name]
    difference = (energy_of(test_gradient.changed("water", None, key, step, keys=keys))
                  - energy_of(test_gradient.changed("water", None, key, -step, keys=keys))) / (2 * step)
    assert np.abs(difference - derivative).max() < 3e-5 * np.abs(derivative).max()


def test_derivatives_do_not_change_energies(scene, echoes):
    assert (tubefoot.run(scene)["camera"].energy == echoes.energy).all()


def test_the_uniform_change_of_a_table_is_the_sum_of_its_points(tmp_path, echoes):
    (tmp_path / "profile.csv").write_text("depth_m,sound_speed_m_s\n0,1500\n2.25,1504.5\n4,1508\n12,1524\n")
    keys = copy.deepcopy(KEYS)
    keys["water"] = {"profile": "table", "profile_file": "profile.csv",
                     **{key: KEYS["water"][key] for key in ("surface_height_m", "absorption_db_per_km", "refraction_gap_m",
                                                            "refraction_tolerance_db")}}
    table = tubefoot.Scene.from_dict(keys, tmp_path)
    names = [f"water.profile.{k}" for k in range(4)]
    assert [name for name in table.gradient_parameters() if name.startswith("water.")] == [
        "water.sound_speed", *names, "water.absorption"]
    result = tubefoot.run(table, gradient=["water.sound_speed", *names])["camera"]
    by = [result.gradient[name] for name in names]
    for whole, parts in ((result.gradient["water.sound_speed"], sum(by)),
                         (echoes.gradient["water.sound_speed"], sum(by)),
                         (echoes.gradient["water.gradient_per_s"], 2.25 * by[1] + 4 * by[2] + 12 * by[3])):
        assert np.abs(parts).max() > 0
        assert np.abs(whole - parts).max() < 1e-6 * np.abs(parts).max()


def test_reverse_mode_is_the_weighted_sum_of_forward_mode(scene, echoes):
    weights = np.random.default_rng(5).normal(size=echoes.energy.shape)
    gradient = scene.gradient(weights)
    for name in NAMES:
        parts = weights * echoes.gradient[name]
        assert gradient[name] == pytest.approx(parts.sum(), rel=0, abs=1e-9 * np.abs(parts).sum()), name


def test_vertices_of_cut_facets_move_with_the_facets(scene):
    keys = copy.deepcopy(KEYS)
    keys["water"] |= {"refraction_gap_m": 1e-4}
    cut = tubefoot.Scene.from_dict(keys)
    result = tubefoot.run(cut, gradient=["block.position.up", "block.rotation.x", "camera.position.up"])

    def facets(of):
        return of.stats["refraction"]["apparent_facets"]

    assert facets(result) > 4 * facets(tubefoot.run(scene))
    for name, (section, index, component) in {"block.position.up": ("objects", 0, 2),
                                              "camera.position.up": ("trajectory", None, 2)}.items():
        runs = [tubefoot.run(tubefoot.Scene.from_dict(
            with_times_of(keys, test_gradient.changed(section, index, "position_m", h, component, keys)))) for h in (STEP, -STEP)]
        assert facets(runs[0]) == facets(runs[1]) == facets(result)
        difference = (runs[0]["camera"].energy - runs[1]["camera"].energy) / (2 * STEP)
        derivative = result["camera"].gradient[name]
        assert np.abs(difference - derivative).max() < 5e-5 * np.abs(derivative).max(), name
    weights = np.random.default_rng(6).normal(size=result["camera"].energy.shape)
    gradient = cut.gradient(weights)
    for name, derivative in result["camera"].gradient.items():
        parts = weights * derivative
        assert gradient[name] == pytest.approx(parts.sum(), rel=0, abs=1e-8 * np.abs(parts).sum()), name


@pytest.mark.parametrize("change, reason", [
    (lambda keys: keys["sensors"][0].update(receiver_arm_m=[0, 0.5, 0]), "separate receiver need straight rays"),
    (lambda keys: keys.update(sea_surface={"height_m": SURFACE, "loss_db": 1}, paths={"order": 2}, run={}),
     "derivatives of paths via mirrors need straight rays"),
])
def test_combinations_without_derivatives_are_rejected(change, reason):
    keys = copy.deepcopy(KEYS)
    change(keys)
    with pytest.raises(tubefoot.UsageError, match=reason):
        tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["water.absorption"])


def test_requests_without_derivatives_are_rejected(scene):
    with pytest.raises(tubefoot.UsageError, match="certified derivatives need straight rays"):
        tubefoot.reference(scene, gradient=["water.absorption"])
    with pytest.raises(tubefoot.UsageError, match="no step is proven in stratified water"):
        tubefoot.run(scene, gradient=["camera.position.up"], gradient_steps=True)


def test_patterns_that_depend_on_the_wavelength_have_no_derivative_by_the_profile():
    keys = copy.deepcopy(KEYS)
    keys["sensors"][0] |= {"receive_pattern": "line", "receive_aperture_m": 0.02}
    with pytest.raises(tubefoot.UsageError, match="water.gradient_per_s.*depends on the wavelength"):
        tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["water.gradient_per_s"])


def test_models_patterns_and_textures_have_derivatives():
    keys = copy.deepcopy(KEYS)
    keys["materials"][0] = {"name": "sand", "law": "gsab", "specular_db": -12, "specular_width_deg": 15, "oblique_db": -27,
                            "reflectivity": [{"kind": "perlin", "wavelength_m": 1.5, "octaves": 1}]}
    keys["sensors"][0] |= {"beams": 4, "samples": 12, "pings": 1, "transmit_pattern": "gaussian",
                           "transmit_beam_width_deg": 20, "receive_pattern": "gaussian", "receive_beam_width_deg": 6}
    keys["water"]["absorption_db_per_km"] = 0.0
    names = ["camera.position.up", "camera.patterns.z", "material.sand.oblique_db", "water.sound_speed"]
    echoes = tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=names)["camera"]
    for name, place, step in (("camera.position.up", ("trajectory", None, "position_m", STEP, 2), STEP),
                              ("material.sand.oblique_db", ("materials", 0, "oblique_db", 1e-3, None), 1e-3),
                              ("water.sound_speed", ("water", None, "sound_speed_m_s", 0.125, None), 0.125)):
        section, index, key, change, component = place
        difference = (energy_of(test_gradient.changed(section, index, key, change, component, keys))
                      - energy_of(test_gradient.changed(section, index, key, -change, component, keys))) / (2 * step)
        derivative = echoes.gradient[name]
        assert np.abs(difference - derivative).max() < 3e-5 * np.abs(derivative).max(), name
    assert np.abs(echoes.gradient["camera.patterns.z"]).max() > 0
    weights = np.random.default_rng(8).normal(size=echoes.energy.shape)
    gradient = tubefoot.Scene.from_dict(keys).gradient(weights)
    for name in names:
        parts = weights * echoes.gradient[name]
        assert gradient[name] == pytest.approx(parts.sum(), rel=0, abs=1e-6 * np.abs(parts).sum()), name


def test_a_facet_with_several_rays_has_no_derivative(tmp_path):
    # The layer above the sonar turns rays downwards, so that several rays lead to the seabed.
    (tmp_path / "profile.csv").write_text("depth_m,sound_speed_m_s\n0,1550\n20,1500\n60,1500\n")
    water = {"surface_height_m": 40, "profile": "table", "profile_file": "profile.csv", "absorption_db_per_km": 0}
    keys = {"water": water, "materials": {"name": "bed"},
            "terrain": {"kind": "flat", "width_m": 1000, "length_m": 1000},
            "trajectory": {"kind": "fixed", "position_m": [0, 0, 20]},
            "sensors": {"name": "beam", "kind": "imaging", "beams": 1, "horizontal_deg": 1.5, "vertical_deg": 100,
                        "samples": 20, "range_min_m": 250, "range_max_m": 410}}
    several = tubefoot.Scene.from_dict(keys, tmp_path)
    for name in ("beam.position.up", "material.bed.mu"):
        with pytest.raises(tubefoot.InputError, match="several rays lead to a visible facet"):
            tubefoot.run(several, gradient=[name])
    with pytest.raises(tubefoot.InputError, match="several rays lead to a visible facet"):
        several.gradient(np.ones((1, 1, 20)))
    one = tubefoot.Scene.from_dict({**keys, "water": {**water, "refraction_turns": 0}}, tmp_path)
    assert np.abs(tubefoot.run(one, gradient=["beam.position.up"])["beam"].gradient["beam.position.up"]).max() > 0


def test_fits_without_an_update_reject_changes_of_the_times_of_range_bins(echoes):
    tubefoot.EnergyFit(KEYS, ["block.position.up"], echoes.energy)
    for name in ("camera.position.up", "water.sound_speed"):
        with pytest.raises(tubefoot.UsageError, match=f"{name} can change the sound speed"):
            tubefoot.EnergyFit(KEYS, [name], echoes.energy)


def test_the_help_lists_the_parameters_of_the_profile(tmp_path):
    (tmp_path / "profile.csv").write_text("depth_m,sound_speed_m_s\n0,1500\n12,1524\n")
    (tmp_path / "scene.toml").write_text("""
[water]
profile = "table"
profile_file = "profile.csv"
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 10
length_m = 10
[trajectory]
kind = "fixed"
position_m = [0, 0, -2]
[[sensors]]
name = "camera"
kind = "imaging"
""")
    words = ["run", tmp_path / "scene.toml", "--gradient", "help", "-o", tmp_path / "out"]
    help_text = subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=True).stdout
    assert "water.profile.0|1" in help_text and "water.sound_speed" in help_text
