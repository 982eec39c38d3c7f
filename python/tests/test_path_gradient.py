# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of energies of paths over mirrors: central differences of whole runs, reverse mode, and errors."""

import copy

import numpy as np
import pytest

import tubefoot
from test_gradient import KEYS, changed

STEP = 2.0**-11  # a multiple of the grid unit, and much larger than the rounding of images
SAMPLES = 6  # few corners lie near the borders of long range bins


def under_a_surface():
    """The block is a mirror. The sonar sees the sea surface, the seabed, the block and a post."""
    keys = copy.deepcopy(KEYS)
    keys["materials"][1]["specular_loss_db"] = 2.0
    # The image in an upright mirror is exact.
    keys["objects"] = [{"name": "block", "shape": "box", "size_m": [0.9, 0.5, 1.7], "position_m": [0.31, 3.07, 0.83],
                        "material": "steel"},
                       {"name": "post", "shape": "box", "size_m": [0.12, 0.2, 0.5], "position_m": [0.16, 2.4, 1.1],
                        "heading_deg": 12, "material": "sand"}]
    keys["sea_surface"] = {"height_m": 3.25, "loss_db": 1.0, "rms_roughness_m": 2e-4}
    keys["paths"] = {"order": 3}
    keys["sensors"][0] |= {"beams": 3, "vertical_deg": 80, "tilt_deg": 8, "range_max_m": 9, "samples": SAMPLES, "pings": 1,
                           "frequency_khz": 200.0}
    return keys


def energy_of(keys):
    return tubefoot.run(tubefoot.Scene.from_dict(keys))["camera"].energy


def at_sound_speed(keys, change):
    keys = changed("water", None, "sound_speed_m_s", change, keys=keys)
    for key in ("range_min_m", "range_max_m"):
        keys["sensors"][0][key] *= 1 + change / 1500
    return keys


MOVED = {
    "camera.position.east": (lambda keys, h: changed("trajectory", None, "position_m", h, 0, keys), STEP),
    "camera.position.up": (lambda keys, h: changed("trajectory", None, "position_m", h, 2, keys), STEP),
    "camera.mounting.tilt": (lambda keys, h: changed("sensors", 0, "tilt_deg", np.degrees(h), keys=keys), STEP / 4),
    "block.position.north": (lambda keys, h: changed("objects", 0, "position_m", h, 1, keys), 4 * STEP),
    "post.position.up": (lambda keys, h: changed("objects", 1, "position_m", h, 2, keys), STEP),
    "water.absorption": (lambda keys, h: changed("water", None, "absorption_db_per_km", h, keys=keys), 0.1),
    "water.sound_speed": (at_sound_speed, 0.1),
}


@pytest.mark.parametrize("variant", [{}, {"only_order": 2}, {"receiver_arm_m": [0.25, -0.125, 0.375]}])
def test_derivatives_are_central_differences_of_whole_runs(variant):
    keys = under_a_surface()
    keys["paths" if "only_order" in variant else "sensors"] = (
        {**keys["paths"], **variant} if "only_order" in variant else [keys["sensors"][0] | variant])
    echoes = tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=list(MOVED))["camera"]
    assert np.array_equal(echoes.energy, energy_of(keys))
    for name, (scene_of, step) in MOVED.items():
        a, b, c, d = (energy_of(scene_of(keys, k * step)) for k in (1, -1, 2, -2))
        difference = (8 * (a - b) - (c - d)) / (12 * step)
        derivative = echoes.gradient[name]
        assert np.abs(derivative).max() > 0, name
        # Facets end at the plane of a mirror in points of the grid. This limits the differences.
        assert np.abs(difference - derivative).max() < 6e-5 * np.abs(derivative).max(), name


@pytest.mark.parametrize("separate", [False, True])
def test_reverse_mode_agrees_with_forward_mode(separate):
    keys = under_a_surface()
    if separate:
        keys["sensors"][0]["receiver_arm_m"] = [0.25, -0.125, 0.375]
    scene = tubefoot.Scene.from_dict(keys)
    names = list(scene.gradient_parameters())
    echoes = tubefoot.run(scene, gradient=names)["camera"]
    weights = np.random.default_rng(7).normal(size=echoes.energy.shape)
    reverse = scene.gradient(weights)
    for name in names:
        parts = weights * echoes.gradient[name]
        assert reverse[name] == pytest.approx(parts.sum(), rel=0, abs=1e-8 * np.abs(parts).sum() + 1e-20), name


def test_paths_change_derivatives():
    keys = under_a_surface()
    names = ["camera.position.up", "block.position.north"]
    direct = tubefoot.run(tubefoot.Scene.from_dict({**keys, "paths": {"order": 3, "only_order": 1}}), gradient=names)["camera"]
    whole = tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=names)["camera"]
    for name in names:
        assert np.abs(whole.gradient[name] - direct.gradient[name]).max() > 1e-3 * np.abs(direct.gradient[name]).max()


@pytest.mark.parametrize("section, change, options, reason", [
    ("paths", {"scatterings": 2}, {}, "treats patches as points"),
    ("sensors", {"transmit_pattern": "gaussian", "transmit_beam_width_deg": 20}, {}, "paths via mirrors and beam patterns"),
    ("sensors", {}, {"gradient_steps": True}, "paths via mirrors, for which no step is proven")])
def test_combinations_without_derivatives_are_rejected(section, change, options, reason):
    keys = under_a_surface()
    keys[section] = [keys[section][0] | change] if section == "sensors" else keys[section] | change
    with pytest.raises((tubefoot.UsageError, tubefoot.InputError), match=reason):
        tubefoot.run(tubefoot.Scene.from_dict(keys), gradient=["camera.position.up"], **options)


def test_references_have_no_derivatives_of_paths():
    scene = tubefoot.Scene.from_dict(under_a_surface())
    with pytest.raises((tubefoot.UsageError, tubefoot.InputError), match="no certified derivatives"):
        tubefoot.reference(scene, gradient=["water.absorption"])
