# SPDX-License-Identifier: GPL-3.0-or-later
"""A forward-looking sonar in a rasteriser, as Stonefish describes and publishes it.

Source: github.com/patrykcieslak/stonefish (class FLS; Library/shaders/sonarInput.frag, sonarOutput*.comp,
sonarPostprocess.comp). A few adjacent cameras share the beams of the fan. A sample has a range and the restitution
multiplied by cos(incidence). A bin is the mean of its samples multiplied by the gain. A 5 x 5 Gaussian of one bin, limits of
0 to 1 and 8 bits follow. The picture is PNG. Its columns are beams from port, its rows are bins, and row 0 is the farthest.
Not included: noise, and the pattern over several columns of samples per beam (here one column, the default).
"""
import numpy as np

import depth_buffer
import pictures
from known import Known, fan_edge_scallop, near_shadow, tangent

TITLE = "Depth buffer as in Stonefish"
PICTURE = "sonar.png"
VIEWS, ROWS = 3, 1024
IDEAL = f"1x{ROWS}"


def views_for(sonar):
    return VIEWS if sonar.beams % VIEWS == 0 else 1


def blurred(picture):
    """The Gaussian, 0 outside."""
    weights = np.exp(-np.arange(-2, 3) ** 2 / 2)
    kernel = np.outer(weights, weights) / weights.sum() ** 2
    around = np.pad(picture, 2)
    return sum(kernel[i, j] * around[i:i + picture.shape[0], j:j + picture.shape[1]] for i in range(5) for j in range(5))


def gain(scene):
    return 1 / scene.mu.max()


def render(scene, sonar, path, tools):
    ranges, cosines, strengths = np.moveaxis(depth_buffer.samples(scene, sonar, views_for(sonar), ROWS), 2, 0)
    beam = np.repeat(np.arange(sonar.beams), ROWS)
    sample = sonar.bin_of(np.where(np.isfinite(ranges), ranges, 0)).ravel()
    mean = gain(scene) * sonar.mean(beam, sample, (cosines * strengths).ravel())
    pictures.write_png(path, np.rint(255 * np.clip(blurred(mean), 0, 1)).T[::-1])


def declared(sonar):
    """Its 1 is 255 here; and even beams, which who does not know of the tangent believes: what it makes is to be measured."""
    return ["--profile", "stonefish", "--scale", "8bit", "--azimuths", "even"]


def recipe(scene, sonar):
    return [{"step": "mean", "least_share": 0.5}, {"step": "range-law", "exponent": 2, "absorption_db_per_km": scene.absorption_db_per_km},
            {"step": "gain", "factor": gain(scene)}, {"step": "blur", "beams": 1, "samples": 1, "size": 5},
            {"step": "clamp", "low": 0, "high": 1}, {"step": "quantise", "bits": 8}]


def known(scene, sonar, truth):
    views = views_for(sonar)
    return [tangent(sonar, views), fan_edge_scallop(scene, sonar, views), near_shadow(scene, sonar, truth),
            Known("8-bits", None, "levels", "8-bit picture")]
