# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of energies: central differences of whole runs, laws, reverse mode against forward mode, and SciPy."""

import copy
import subprocess
import warnings

import netCDF4
import numpy as np
import pytest

import tubefoot
from conftest import PROGRAM

# Steps are multiples of the grid unit of this scene, which is 2**-20 m.
KEYS = {
    "water": {"sound_speed_m_s": 1500.0, "absorption_db_per_km": 120.0},
    "materials": [{"name": "sand", "lambert_db": -27.0}, {"name": "steel", "lambert_db": -15.0}],
    "terrain": {"name": "bed", "kind": "fractal", "width_m": 14, "length_m": 14, "cell_m": 1.3, "rms_height_m": 0.2,
                "material": "sand"},
    "objects": [{"name": "block", "shape": "box", "size_m": [0.9, 0.5, 0.7], "position_m": [0.31, 3.07, 0.83],
                 "heading_deg": 25, "pitch_deg": 8, "roll_deg": 5, "material": "steel"}],
    "trajectory": {"kind": "fixed", "position_m": [0.02, 0.013, 2.51], "heading_deg": 3, "pitch_deg": 3, "roll_deg": 2},
    "sensors": [{"name": "camera", "kind": "imaging", "beams": 8, "horizontal_deg": 24, "vertical_deg": 25, "yaw_deg": 7,
                 "tilt_deg": 30, "roll_deg": 4, "range_min_m": 2, "range_max_m": 6, "samples": 30, "pings": 2,
                 "ping_interval_s": 1}],
}
STEP = 2.0**-13
NAMES = list(tubefoot.Scene.from_dict(KEYS).gradient_parameters())


def changed(section, index, key, change, component=None, keys=None):
    keys = copy.deepcopy(keys or KEYS)
    table = keys[section] if index is None else keys[section][index]
    if component is None:
        table[key] += change
    else:
        table[key][component] += change
    return keys


def at_sound_speed(speed):
    keys = changed("water", None, "sound_speed_m_s", speed - 1500)
    for key in ("range_min_m", "range_max_m"):
        keys["sensors"][0][key] *= speed / 1500
    return keys


def with_mu(material, change, keys):
    db = keys["materials"][material]["lambert_db"]
    return changed("materials", material, "lambert_db", 10 * np.log10(10**(db / 10) + change) - db, keys=keys)


def moves(keys, step):
    """Functions that change one parameter of a scene, and their steps. Positions move by `step`."""
    axes = tuple(enumerate(("east", "north", "up")))
    return {
        **{f"camera.position.{axis}": (lambda h, k=k: changed("trajectory", None, "position_m", h, k, keys), step)
           for k, axis in axes},
        **{f"block.position.{axis}": (lambda h, k=k: changed("objects", 0, "position_m", h, k, keys), step)
           for k, axis in axes},
        **{f"camera.mounting.{angle}": (lambda h, a=angle: changed("sensors", 0, a + "_deg", np.degrees(h), keys=keys), step / 4)
           for angle in ("yaw", "tilt", "roll")},
        "material.sand.mu": (lambda h: with_mu(0, h, keys), 1e-6),
        "material.steel.mu": (lambda h: with_mu(1, h, keys), 1e-5),
        "water.absorption": (lambda h: changed("water", None, "absorption_db_per_km", h, keys=keys), 0.1),
    }


MOVED = {
    **moves(KEYS, STEP),
    "water.sound_speed": (lambda h: at_sound_speed(1500 + h), 0.02),
}


@pytest.fixture(scope="module")
def scene():
    return tubefoot.Scene.from_dict(KEYS)


@pytest.fixture(scope="module")
def echoes(scene):
    return tubefoot.run(scene, gradient=NAMES)["camera"]


def energy_of(keys):
    return tubefoot.run(tubefoot.Scene.from_dict(keys))["camera"].energy


@pytest.mark.parametrize("name", MOVED)
def test_derivatives_are_central_differences_of_whole_runs(echoes, name):
    scene_of, step = MOVED[name]
    difference = (energy_of(scene_of(step)) - energy_of(scene_of(-step))) / (2 * step)
    derivative = echoes.gradient[name]
    assert np.abs(derivative).max() > 0
    # Directions of tubes are rounded to a grid, so that differences by angles have errors of their own.
    tolerance = 5e-4 if ".mounting." in name else 1e-6
    assert np.abs(difference - derivative).max() < tolerance * np.abs(derivative).max()


def of_all_factors():
    """A scene with a scattering model, beam patterns and a micro-texture."""
    keys = copy.deepcopy(KEYS)
    keys["materials"][0] = {"name": "sand", "law": "gsab", "specular_db": -12, "specular_width_deg": 15, "oblique_db": -27,
                            "reflectivity": [{"kind": "perlin", "wavelength_m": 1.5, "octaves": 1}]}
    keys["sensors"][0] |= {"beams": 4, "samples": 12, "pings": 1, "transmit_pattern": "gaussian",
                           "transmit_beam_width_deg": 20, "receive_pattern": "line", "receive_aperture_m": 0.02}
    return keys


def test_derivatives_include_models_patterns_and_textures():
    names = ["camera.position.up", "camera.mounting.tilt", "block.position.north", "water.absorption", "material.steel.mu"]
    keys = of_all_factors()
    scene = tubefoot.Scene.from_dict(keys)
    echoes = tubefoot.run(scene, gradient=names)["camera"]

    for name, place, step in (("camera.position.up", ("trajectory", None, "position_m", STEP, 2), STEP),
                              ("camera.mounting.tilt", ("sensors", 0, "tilt_deg", np.degrees(STEP), None), STEP),
                              ("block.position.north", ("objects", 0, "position_m", STEP, 1), STEP)):
        section, index, key, change, component = place
        difference = (energy_of(changed(section, index, key, change, component, keys))
                      - energy_of(changed(section, index, key, -change, component, keys))) / (2 * step)
        derivative = echoes.gradient[name]
        tolerance = 3e-5 if ".mounting." in name else 1e-6
        assert np.abs(difference - derivative).max() < tolerance * np.abs(derivative).max(), name
    weights = np.random.default_rng(39).normal(size=echoes.energy.shape)
    gradient = scene.gradient(weights)
    for name in names:
        parts = weights * echoes.gradient[name]
        assert gradient[name] == pytest.approx(parts.sum(), rel=0, abs=1e-6 * np.abs(parts).sum()), name
    with pytest.raises(tubefoot.UsageError, match="no parameter 'material.sand.mu'"):
        tubefoot.run(scene, gradient=["material.sand.mu"])


MODELS = [{"name": "sand", "law": "gsab", "specular_db": -14.0, "specular_width_deg": 12.0, "oblique_db": -25.0,
           "oblique_exponent": 1.7, "transition_db": -21.0, "transition_width_deg": 25.0},
          {"name": "steel", "law": "table", "table_grazing_deg": [8.0, 31.0, 52.0, 66.0], "table_db": [-30.0, -22.0, -20.0, -19.0]}]


def test_derivatives_by_the_keys_of_scattering_models():
    keys = {**KEYS, "materials": MODELS}
    scene = tubefoot.Scene.from_dict(keys)
    names = [name for name in scene.gradient_parameters() if name.startswith("material.")]
    assert len(names) == 6 + 2 * 4
    echoes = tubefoot.run(scene, gradient=names)["camera"]
    reverse = scene.gradient(np.ones_like(echoes.energy))
    for name in names:
        _, material, key, *number = name.split(".")
        m, step = [of["name"] for of in MODELS].index(material), 1e-4
        both = [energy_of(changed("materials", m, key, h, int(number[0]) if number else None, keys)) for h in (step, -step)]
        derivative = echoes.gradient[name]
        assert np.abs(derivative).max() > 0, name
        assert np.abs((both[0] - both[1]) / (2 * step) - derivative).max() < 1e-6 * np.abs(derivative).max(), name
        assert reverse[name] == pytest.approx(derivative.sum(), rel=1e-10), name


def test_rotations_of_patterns_alone():
    names = [f"camera.patterns.{axis}" for axis in "xyz"]
    ideal = tubefoot.run(tubefoot.Scene.from_dict(KEYS), gradient=names)["camera"]
    assert all(not ideal.gradient[name].any() for name in names)
    sensor = {**KEYS["sensors"][0], "transmit_pattern": "gaussian", "transmit_pattern_angle": "elevation",
              "transmit_beam_width_deg": 9.0}
    scene = tubefoot.Scene.from_dict({**KEYS, "sensors": [sensor]})
    echoes = tubefoot.run(scene, gradient=names)["camera"]
    reverse = scene.gradient(np.ones_like(echoes.energy))
    for name in names:
        assert reverse[name] == pytest.approx(echoes.gradient[name].sum(), rel=1e-8, abs=1e-12 * echoes.energy.sum())
    assert echoes.gradient["camera.patterns.x"].any()
    assert reverse["camera.patterns.x"] == pytest.approx(reverse.sonars["camera"].patterns.sum(axis=0)[0])


def test_derivatives_with_a_separate_receiver():
    keys = copy.deepcopy(KEYS)
    keys["sensors"][0] |= {"receiver_arm_m": [1.25, -0.125, 0.25], "pings": 1}
    scene = tubefoot.Scene.from_dict(keys)
    echoes = tubefoot.run(scene, gradient=NAMES)["camera"]
    reverse = scene.gradient(np.ones_like(echoes.energy))
    for name in NAMES:
        size = np.abs(echoes.gradient[name]).sum()
        assert reverse[name] == pytest.approx(echoes.gradient[name].sum(), rel=0, abs=1e-9 * size), name
    small = STEP / 4  # a corner near the border of a range bin makes the error of larger steps exceed the tolerance
    for name, place, step in (("camera.position.up", ("trajectory", None, "position_m", small, 2), small),
                              ("camera.mounting.tilt", ("sensors", 0, "tilt_deg", np.degrees(STEP), None), STEP),
                              ("block.position.north", ("objects", 0, "position_m", small, 1), small)):
        section, index, key, change, component = place
        both = [energy_of(changed(section, index, key, sign * change, component, keys)) for sign in (1, -1)]
        derivative = echoes.gradient[name]
        assert np.abs(derivative).max() > 0, name
        tolerance = 5e-4 if ".mounting." in name else 1e-6
        assert np.abs((both[0] - both[1]) / (2 * step) - derivative).max() < tolerance * np.abs(derivative).max(), name
    with pytest.raises(tubefoot.UsageError, match="no step is proven"):
        tubefoot.run(scene, gradient=["camera.position.up"], gradient_steps=True)
    keys["sensors"][0] |= {"transmit_pattern": "gaussian", "transmit_beam_width_deg": 20}
    with pytest.raises(tubefoot.UsageError, match="separate receiver and beam patterns"):
        tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["camera.position.up"])


def box_below(distance):
    """A level box whose top is this distance below the sonar."""
    box = {"name": "block", "shape": "box", "size_m": [0.9, 0.5, 0.5], "position_m": [0.31, 3.07, 1.75 - distance], "material": "steel"}
    keys = changed("trajectory", None, "position_m", -0.51, 2, {**KEYS, "objects": [box]})
    keys["trajectory"] |= {"pitch_deg": 0, "roll_deg": 0}
    keys["sensors"][0] |= {"tilt_deg": 5, "roll_deg": 0, "range_min_m": 1}
    return tubefoot.Scene.from_dict(keys)


def test_steps_end_where_a_facet_is_seen_from_its_side():
    distance = 2.0**-8
    names = ["camera.position.up", "block.position.up", "water.absorption"]
    result = tubefoot.run(box_below(distance), gradient=names, gradient_steps=True)
    steps = result["camera"].gradient_step
    assert set(steps) == set(names[:2])  # absorption moves no point
    down, up = steps["camera.position.up"]
    assert down.shape == up.shape == (2, 8)
    assert (down > 0).all() and (up > 0).all()
    # Beams see the top as long as the sonar is above it. The certificate may end earlier.
    assert 0.01 * distance < down.min() <= distance * (1 + 1e-12)
    assert steps["block.position.up"][1].min() <= distance * (1 + 1e-12)
    assert not any("one-sided" in warning for warning in result.stats["warnings"])


def test_one_sided_derivatives_are_reported():
    with pytest.warns(tubefoot.SceneWarning, match="camera.position.up: no step is proven"):
        result = tubefoot.run(box_below(0), gradient=["camera.position.up"], gradient_steps=True)
    down, up = result["camera"].gradient_step["camera.position.up"]
    assert (down == 0).any() and (up[down == 0] == 0).all()
    assert any("one-sided" in warning for warning in result.stats["warnings"])


def test_steps_need_parameters(scene):
    with pytest.raises(tubefoot.UsageError, match="gradient_steps needs gradient"):
        tubefoot.run(scene, gradient_steps=True)


def test_steps_are_in_files(tmp_path):
    scene = box_below(2.0**-8)
    result = tubefoot.run(scene, gradient=["camera.position.up"], gradient_steps=True, output=tmp_path / "out")
    with netCDF4.Dataset(tmp_path / "out/echoes.nc") as file:
        for k, sense in enumerate(("backward", "forward")):
            variable = file[f"gradient_{sense}_step.camera.position.up"]
            assert variable.dimensions == ("ping", "beam") and variable.units == "m"
            assert (variable[:] == result["camera"].gradient_step["camera.position.up"][k]).all()
    read = tubefoot.open(tmp_path / "out/echoes.nc")["camera"]
    assert (read.gradient_step["camera.position.up"][1] == result["camera"].gradient_step["camera.position.up"][1]).all()


def test_a_scene_without_lambert_materials_has_derivatives():
    keys = of_all_factors()
    keys["materials"][1] = {**keys["materials"][0], "name": "steel"}
    scene = tubefoot.Scene.from_dict(keys)
    with warnings.catch_warnings():
        warnings.simplefilter("error", tubefoot.SilenceWarning)
        gradient = scene.gradient(np.ones((1, 4, 12)))
    assert not gradient.mu and gradient["water.absorption"] < 0
    with pytest.raises(tubefoot.UsageError, match='"line" of sensor \'camera\' depends on the wavelength'):
        tubefoot.run(scene, gradient=["water.sound_speed"])


def test_ambiguous_names_are_rejected():
    keys = copy.deepcopy(KEYS)
    keys["objects"][0]["name"] = "camera"
    with pytest.raises(tubefoot.UsageError, match="parameter of a sensor and of an object"):
        tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["camera.position.up"])
    keys["objects"][0]["name"] = "a/b"
    with pytest.raises(tubefoot.UsageError, match="cannot contain '/'"):
        tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["a/b.position.up"])


def test_reverse_mode_reports_progress(scene):
    said = []
    scene.gradient(np.ones((2, 8, 30)), progress=lambda done, all_: said.append((done, all_)))
    assert said and said[-1][1] == 2


def test_references_enclose_derivatives(scene, echoes):
    names = ["camera.position.up", "block.rotation.z", "material.sand.mu", "water.sound_speed"]
    reference = tubefoot.reference(scene, gradient=names)["camera"]
    for name in names:
        derivative, bound = reference.gradient[name], reference.gradient_bound[name]
        largest = np.abs(derivative).max()
        assert 0 < bound.max() < 1e-13 * largest
        assert np.abs(derivative - echoes.gradient[name]).max() < 1e-10 * largest
    assert not echoes.gradient_bound


@pytest.mark.parametrize("section, index, reason", [("materials", 0, "Lambert's law"), ("sensors", 0, "beam patterns")])
def test_references_without_certified_derivatives_are_rejected(section, index, reason):
    keys = copy.deepcopy(KEYS)
    keys[section][index] = of_all_factors()[section][index]
    with pytest.raises((tubefoot.UsageError, tubefoot.InputError), match=reason):
        tubefoot.reference(tubefoot.Scene.from_dict(keys), gradient=["water.absorption"])


def test_derivatives_do_not_change_energies(scene, echoes):
    assert list(echoes.gradient) == NAMES
    assert (tubefoot.run(scene)["camera"].energy == echoes.energy).all()


def test_rotations_about_own_axes_are_those_of_mounting_angles(echoes):
    # roll is the last of the mounting angles, and turns the sonar about its own forward axis
    assert echoes.gradient["camera.rotation.y"] == pytest.approx(echoes.gradient["camera.mounting.roll"], rel=1e-9, abs=1e-20)
    roll = np.radians(4)
    tilt = -np.cos(roll) * echoes.gradient["camera.rotation.x"] - np.sin(roll) * echoes.gradient["camera.rotation.z"]
    largest = np.abs(echoes.gradient["camera.mounting.tilt"]).max()
    assert np.abs(tilt - echoes.gradient["camera.mounting.tilt"]).max() < 1e-9 * largest


def test_an_object_of_no_visible_edge_has_no_derivatives():
    keys = copy.deepcopy(KEYS)
    keys["objects"][0]["position_m"] = [0.31, -3.07, 0.83]
    hidden = tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["block.position.east", "block.rotation.z"])["camera"]
    assert not any(values.any() for values in hidden.gradient.values())


def test_mu_scales_the_energies_of_its_material(echoes):
    scaled = sum(mu * echoes.gradient[f"material.{name}.mu"] for name, mu in (("sand", 10**-2.7), ("steel", 10**-1.5)))
    assert scaled == pytest.approx(echoes.energy, rel=1e-9)


def test_reverse_mode_is_the_weighted_sum_of_forward_mode(scene, echoes):
    weights = np.random.default_rng(38).normal(size=echoes.energy.shape)
    gradient = scene.gradient(weights)
    for name in NAMES:
        parts = weights * echoes.gradient[name]
        assert gradient[name] == pytest.approx(parts.sum(), rel=0, abs=1e-9 * np.abs(parts).sum() + 1e-30), name
    block, bed, camera = gradient.components["block"], gradient.components["bed"], gradient.sonars["camera"]
    assert bed.position is None and block.vertices_m.shape == block.by_vertex.shape == (8, 3)
    assert camera.position.shape == camera.mounting.shape == (2, 3)
    assert block.position == pytest.approx(block.by_vertex.sum(axis=0))
    # a common translation of scene and sonar changes nothing
    everything = bed.by_vertex.sum(axis=0) + block.position + camera.position.sum(axis=0)
    assert np.abs(everything).max() < 1e-9 * np.abs(bed.by_vertex).sum()
    assert {k: scene.gradient({"camera": weights})[k] for k in NAMES} == {k: gradient[k] for k in NAMES}


def test_weights_must_fit_and_be_finite(scene, echoes):
    weights = np.ones(echoes.energy.shape)
    with pytest.raises(tubefoot.UsageError, match=r"'camera'.*pings, beams, range bins.*\(1, 8, 30\)"):
        scene.gradient(weights[:1])
    with pytest.raises(tubefoot.UsageError, match="'camera'.*479? numbers|'camera'.*expected 2 x 8 x 30"):
        scene.gradient(weights[:, :, :-1])
    weights[1, 2, 3] = np.nan
    with pytest.raises(tubefoot.UsageError, match="'camera'.*finite.*1, 2, 3 is nan"):
        scene.gradient(weights)
    with pytest.raises(tubefoot.UsageError, match="no sensor 'cam'.*'camera'"):
        scene.gradient({"cam": weights})


def test_a_sonar_that_receives_nothing_is_reported():
    keys = copy.deepcopy(KEYS)
    keys["sensors"][0]["tilt_deg"] = -60
    up = tubefoot.Scene.from_dict(keys)
    with pytest.warns(tubefoot.SilenceWarning):
        assert not tubefoot.run(up, gradient=["water.absorption"])["camera"].gradient["water.absorption"].any()
    with pytest.warns(tubefoot.SilenceWarning, match="derivatives are 0"):
        assert up.gradient(np.ones((2, 8, 30)))["water.absorption"] == 0


def test_unknown_parameters_name_similar_ones(scene):
    with pytest.raises(tubefoot.UsageError, match="did you mean 'camera.position.east'.*block.rotation.x|y|z"):
        tubefoot.run(scene, gradient=["camera.positon.east"])
    with pytest.raises(tubefoot.UsageError, match="material.sand.mu"):
        tubefoot.run(scene, gradient=["material.sand.lambert_db"])
    with pytest.raises(tubefoot.UsageError, match="list of names"):
        tubefoot.run(scene, gradient="water.absorption")


@pytest.mark.parametrize("option, reason", [({"engine": "ray"}, "rays"), ({"binning": "centroid"}, "exact cuts"),
                                            ({"arithmetic": "double"}, "exact names"), ({"tolerance": 0.1}, "tolerance")])
def test_settings_without_derivatives_are_rejected(scene, option, reason):
    with pytest.raises(tubefoot.UsageError, match=reason):
        tubefoot.run(scene, gradient=["water.absorption"], **option)


@pytest.mark.parametrize("section, keys, reason", [
    ("paths", {"scatterings": 2, "order": 2}, "patches as points")])
def test_scenes_without_derivatives_are_rejected(section, keys, reason):
    scene = tubefoot.Scene.from_dict({**KEYS, section: keys})
    for compute in (lambda: tubefoot.run(scene, gradient=["water.absorption"]), lambda: scene.gradient(np.ones((2, 8, 30)))):
        with pytest.raises((tubefoot.UsageError, tubefoot.InputError), match=reason):
            compute()


def test_an_object_that_shares_a_vertex_cannot_move_alone():
    keys = copy.deepcopy(KEYS)
    for section in ("terrain", "objects"):
        keys[section] = [{"name": section, "vertices": [[-5, 1, 0], [5, 1, 0], [0, 8, 0.1]], "facets": [[0, 1, 2]],
                          "material": "sand"}]
    keys["objects"][0]["vertices"] = [[-5, 1, 0], [0, 4, 0], [0, 4, 1]]
    scene = tubefoot.Scene.from_dict(keys)
    with pytest.raises(tubefoot.UsageError, match="'objects' has a vertex in common"):
        tubefoot.run(scene, gradient=["objects.position.up"])
    assert scene.gradient(np.ones((2, 8, 30))).components["objects"].position is None


def test_files_of_the_command_contain_the_same_derivatives(scene, echoes, tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(scene.to_toml())
    asked = ["run", file, "--quiet", "--pictures", "none", "--gradient", "camera.position.up,block.rotation.z"]

    def program(*words):
        return subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True).stdout

    program(*asked, "-o", tmp_path / "whole")
    for shard in ("1/2", "2/2"):
        program(*asked, "-o", tmp_path / "joined", "--shard", shard)
    program("join", file, "-o", tmp_path / "joined", "--pictures", "none")
    assert (tmp_path / "whole/echoes.nc").read_bytes() == (tmp_path / "joined/echoes.nc").read_bytes()
    with netCDF4.Dataset(tmp_path / "whole/echoes.nc") as data:
        for name, units in (("camera.position.up", "J m-2 m-1"), ("block.rotation.z", "J m-2 rad-1")):
            variable = data["gradient." + name]
            assert variable.units == units and (variable[:] == echoes.gradient[name]).all()
    opened = tubefoot.open(tmp_path / "whole")["camera"]
    assert (opened.gradient["block.rotation.z"] == echoes.gradient["block.rotation.z"]).all()
    assert echoes[1:].gradient["water.absorption"].shape == (1, 8, 30)
    listed = program("run", file, "-o", tmp_path / "none", "--gradient", "help")
    assert "camera.mounting.yaw|tilt|roll" in listed and not (tmp_path / "none").exists()


def test_scipy_recovers_parameters():
    scipy_optimize = pytest.importorskip("scipy.optimize")
    truth = {"block.position.north": 3.0812, "camera.mounting.tilt": np.radians(30.2), "water.sound_speed": 1501.3,
             "water.absorption": 131.0}
    first = tubefoot.EnergyFit(KEYS, list(truth), np.zeros((2, 8, 30)))
    measured = tubefoot.run(first.scene(list(truth.values())))["camera"].energy
    fit = tubefoot.EnergyFit(KEYS, list(truth), {"camera": measured}, sigma=1e-3 * measured.max())
    found = scipy_optimize.least_squares(fit.residuals, fit.initial, fit.jacobian, x_scale="jac")
    assert found.x == pytest.approx(list(truth.values()), rel=1e-4)
    value, gradient = fit.half_squares(fit.initial)
    residuals = fit.residuals(fit.initial)
    assert value == pytest.approx(residuals @ residuals / 2)
    assert gradient == pytest.approx(fit.jacobian(fit.initial).T @ residuals, rel=1e-8)


def test_fits_set_keys_of_scattering_models():
    keys = {**KEYS, "materials": MODELS}
    names = ["material.sand.specular_width_deg", "material.steel.table_db.1", "material.sand.oblique_exponent"]
    fit = tubefoot.EnergyFit(keys, names, np.zeros((2, 8, 30)))
    assert list(fit.initial) == [12.0, -22.0, 1.7]
    moved = tubefoot.EnergyFit({**keys, "materials": [{**MODELS[0], "specular_width_deg": 12.5, "oblique_exponent": 1.8},
                                                      {**MODELS[1], "table_db": [-30.0, -21.5, -20.0, -19.0]}]}, names,
                               np.zeros((2, 8, 30)))
    assert (fit.residuals([12.5, -21.5, 1.8]) == moved.residuals(moved.initial)).all()
    assert MODELS[1]["table_db"] == [-30.0, -22.0, -20.0, -19.0]
    assert fit.half_squares(fit.initial)[1] == pytest.approx(fit.jacobian(fit.initial).T @ fit.residuals(fit.initial), rel=1e-8)


def test_fits_say_what_they_cannot_set():
    measured = np.zeros((2, 8, 30))
    with pytest.raises(tubefoot.UsageError, match="'camera.rotation.x' is no key.*update"):
        tubefoot.EnergyFit(KEYS, ["camera.rotation.x"], measured)
    with pytest.raises(tubefoot.UsageError, match="did you mean 'camera.mounting.tilt'"):
        tubefoot.EnergyFit(KEYS, ["camera.mountng.tilt"], measured)
    with pytest.raises(tubefoot.UsageError, match="expected 1 numbers"):
        tubefoot.EnergyFit(KEYS, ["water.absorption"], measured).residuals([1, 2])
    with pytest.raises(tubefoot.UsageError, match=r"\(2, 8, 29\), expected \(2, 8, 30\)"):
        tubefoot.EnergyFit(KEYS, ["water.absorption"], measured[..., 1:]).residuals([120])
    upright = copy.deepcopy(KEYS)
    upright["objects"][0] |= {"pitch_deg": 0, "roll_deg": 0}

    def turned(x):
        keys = copy.deepcopy(upright)
        keys["objects"][0]["heading_deg"] -= np.degrees(x[0])
        return keys
    own = tubefoot.EnergyFit(upright, ["block.rotation.z"], measured, initial=[0], update=turned)
    assert own.jacobian([0]).shape == (480, 1)


# A box and a rough seabed before a short array. Its pulse has flanks, so that signals have derivatives.
ARRAY_KEYS = {
    "water": {"sound_speed_m_s": 1500.0, "absorption_db_per_km": 20.0},
    "materials": [{"name": "sand", "lambert_db": -27.0}, {"name": "steel", "smooth": True, "reflection": 0.8}],
    "terrain": {"kind": "flat", "width_m": 12, "length_m": 12, "material": "sand"},
    "objects": [{"name": "block", "shape": "box", "size_m": [0.9, 0.5, 0.7], "position_m": [0.31, 3.07, 0.83],
                 "heading_deg": 25, "pitch_deg": 8, "roll_deg": 5, "material": "steel"}],
    "trajectory": {"kind": "fixed", "position_m": [0.02, 0.013, 1.51], "heading_deg": 3, "pitch_deg": 3, "roll_deg": 2},
    "scatterers": {"spacing_m": 0.1},
    "sensors": [{"name": "array", "kind": "array", "frequency_khz": 20, "pulse_length_us": 400, "pulse_taper": 1,
                 "sampling_frequency_khz": 20, "range_min_m": 2, "range_max_m": 4.5, "horizontal_deg": 40, "vertical_deg": 40,
                 "yaw_deg": 4, "tilt_deg": 20, "roll_deg": 2, "receivers": 3, "receiver_spacing_m": [0.05, 0, 0], "signal_tolerance": 1e-6}],
}


def array_pressure(keys):
    # Without the seabed, whose speckle does not move with the sonar.
    keys = copy.deepcopy(keys)
    keys["materials"][0].update({"smooth": True, "reflection": 1e-12})
    return tubefoot.run(tubefoot.Scene.from_dict(keys))["array"].signals.pressure


ARRAY_MOVED = {
    **{f"array.position.{axis}": (lambda h, k=k: changed("trajectory", None, "position_m", h, k, keys=ARRAY_KEYS), STEP)
       for k, axis in enumerate(("east", "north", "up"))},
    **{f"block.position.{axis}": (lambda h, k=k: changed("objects", 0, "position_m", h, k, keys=ARRAY_KEYS), STEP)
       for k, axis in enumerate(("east", "north", "up"))},
    **{f"array.mounting.{angle}": (lambda h, a=angle: changed("sensors", 0, a + "_deg", np.degrees(h), keys=ARRAY_KEYS),
                                   STEP) for angle in ("yaw", "tilt", "roll")},
    "water.absorption": (lambda h: changed("water", None, "absorption_db_per_km", h, keys=ARRAY_KEYS), 1.0),
}


@pytest.mark.parametrize("name", list(ARRAY_MOVED))
def test_signals_equal_central_differences(name):
    """The derivatives of complex pressures include those of their phases."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        signals = tubefoot.run(tubefoot.Scene.from_dict(ARRAY_KEYS), gradient=[name])["array"].signals
        move, step = ARRAY_MOVED[name]
        a, b, c, d = (array_pressure(move(share * step)) for share in (1, -1, 2, -2))
    difference = (8 * (a - b) - (c - d)) / (12 * step)
    derivative = signals.gradient[name]
    assert derivative.shape == signals.pressure.shape and derivative.dtype == complex
    # Directions of tubes are rounded to a grid, so that differences by angles have errors of their own.
    tolerance = 2e-3 if ".mounting." in name else 2e-5
    assert np.abs(derivative - difference).max() < tolerance * np.abs(difference).max()


def test_files_of_signals_contain_derivatives(tmp_path):
    scene = tubefoot.Scene.from_dict(ARRAY_KEYS)
    names = ["array.position.up", "water.sound_speed", "material.sand.mu"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = tubefoot.run(scene, gradient=names)
        signals = result["array"].signals
        assert list(signals.gradient) == names[:2]
        signals.write(tmp_path / "signals.nc")
    with netCDF4.Dataset(tmp_path / "signals.nc") as file:
        for name in names[:2]:
            parts = file["pressure_gradient." + name][:]
            assert np.array_equal(parts[..., 0] + 1j * parts[..., 1], signals.gradient[name])
        assert file["pressure_gradient.array.position.up"].units == "W^(1/2) m-1"
        assert file["pressure_gradient.water.sound_speed"].units == "W^(1/2) m-1 s"


@pytest.mark.parametrize("key, value, reason", [
    ("pulse_taper", 0, "no flanks"), ("receiver_arm_m", [0.5, 0, 0], "separate receiver"),
])
def test_signals_without_derivatives_have_a_reason(key, value, reason):
    keys = copy.deepcopy(ARRAY_KEYS)
    keys["sensors"][0][key] = value
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["water.absorption"])
    assert any("signals have none" in warning and reason in warning for warning in result.warnings)
    assert result["array"].signals.gradient == {}
    assert "water.absorption" in result["array"].gradient


def test_derivatives_of_signals_ignore_what_the_run_does_not_contain():
    """A material that no facet has, and a sensor that is not selected, change nothing."""
    keys = copy.deepcopy(ARRAY_KEYS)
    keys["materials"].append({"name": "unused", "smooth": True, "roughness_m": 0.001})
    keys["sensors"].append({**keys["sensors"][0], "name": "other", "pulse_taper": 0})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = tubefoot.run(tubefoot.Scene.from_dict(keys), sensor="array", gradient=["water.absorption"])
    assert list(result["array"].signals.gradient) == ["water.absorption"]
    assert not any("signals have none" in warning for warning in result.warnings)
