# SPDX-License-Identifier: GPL-3.0-or-later
"""Stonefish with its default settings: 8 bits, and noise of 2.5 % per beam and of 0.035 per bin.

Source: as above. The scenario parser uses these settings if the scenario does not name others. The noise is added before the blur and
the limits, so its mean in a shadow is above 0.
"""
import numpy as np

import stonefish
from known import Known
from stonefish import LICENCE, URL, declared as floats_declared, unit, version  # noqa: F401
from stonefish_like import gain

TITLE = "Stonefish with its default noise, 8 bits"
PICTURE = "sonar.png"
IDEAL = None
BEAM_NOISE, BIN_NOISE = 0.025, 0.035


def render(scene, sonar, path, tools):
    specs, ranges, _ = stonefish.settings(sonar)
    chosen = {**specs, "output_format": "uint8"}, ranges, {"multiplicative": BEAM_NOISE, "additive": BIN_NOISE}
    stonefish.picture_of(scene, sonar, chosen, path, tools)


def declared(sonar):
    return [*floats_declared(sonar), "--scale", "8bit"]


def recipe(scene, sonar):
    return stonefish.recipe(scene, sonar) + [{"step": "quantise", "bits": 8}]


def mean_echo(scene, sonar, truth):
    """Mean of the picture without noise over its rows, and in each row over the bins with an echo."""
    energy, angle = truth(), truth(angles=True)
    seen = angle > 0
    mean = np.where(seen, energy / np.where(seen, angle, 1), 0) * sonar.slant_range ** 2
    mean *= gain(scene) * 10 ** (2 * scene.absorption_db_per_km * sonar.slant_range / 10000)
    lit = seen.any(axis=0)
    return (mean.sum(axis=0)[lit] / seen.sum(axis=0)[lit]).mean()


def known(scene, sonar, truth):
    # The mean of the positive part of a normal distribution, whose deviation the Gaussian of 5 x 5 bins reduces.
    weights = np.exp(-np.arange(-2, 3) ** 2 / 2)
    weights /= weights.sum()
    floor = BIN_NOISE * (weights**2).sum() / np.sqrt(2 * np.pi)
    return stonefish.known(scene, sonar, truth) + [
        Known("noise", float(10 * np.log10(floor / mean_echo(scene, sonar, truth))), "dB re the mean echo",
              "mean of the positive part of the noise"),
        Known("8-bits", None, "levels", "8-bit picture"),
        Known("speckle", None, "", "normal noise per beam and per bin", may=True)]
