# SPDX-License-Identifier: GPL-3.0-or-later
"""The same leaves with noise: four frames, each with multiplicative normal noise and additive Rayleigh noise.

Source: holoocean_like.py, with MultSigma and AddSigma from the page about the imaging sonar.
"""
import numpy as np

import holoocean_like
from holoocean_like import OCTREE_MIN, PICTURE, declared, recipe  # noqa: F401
from known import Known

TITLE = "Octree leaves as in HoloOcean, with noise"
IDEAL = None
FRAMES, MULTIPLY_SIGMA, ADD_SHARE = 4, 0.1, 0.1


def add_sigma(scene):
    """So much of the strongest echo that there can be."""
    return ADD_SHARE * 0.1 * scene.mu.max()


def render(scene, sonar, path, tools):
    holoocean_like.render(scene, sonar, path, tools, OCTREE_MIN, FRAMES, add_sigma(scene), MULTIPLY_SIGMA)


def known(scene, sonar, truth):
    # In the measure of the page: the mean echo is the mean over the rows of what is lit in each.
    energy, angle = truth(), truth(angles=True)
    seen = angle > 0
    mean = np.where(seen, energy / np.where(seen, angle, 1), 0) * sonar.slant_range ** 2
    mean *= 10 ** (2 * scene.absorption_db_per_km * sonar.slant_range / 10000)
    lit = seen.any(axis=0)
    echo = (mean.sum(axis=0)[lit] / seen.sum(axis=0)[lit]).mean()
    floor = add_sigma(scene) * np.sqrt(np.pi / 2)
    return holoocean_like.known(scene, sonar, truth) + [
        Known("noise", float(10 * np.log10(floor / echo)), "dB re the mean echo", "mean of the Rayleigh noise, which is above 0", within=0.25)]
