# SPDX-License-Identifier: GPL-3.0-or-later
"""Stonefish with a near plane close to the sonar: the picture begins there, and the bins of the reference are a part of it.

Source: as above. `range_min` of an FLS is both the first range of the picture and the distance of the near plane, so this is the only way
to keep objects that are nearer than the range gate. The bins have the size of those of the reference.
"""
import math

import stonefish
from known import Known
from stonefish import IDEAL, LICENCE, PICTURE, URL, recipe, unit, version  # noqa: F401

TITLE = "Stonefish, floats without noise, near plane at the sonar"
LEAST_RANGE_M = 0.02


def near(sonar):
    """The smallest range that Stonefish permits and that is a whole number of bins from the first range."""
    return sonar.edges[0] - sonar.step * math.floor((sonar.edges[0] - LEAST_RANGE_M) / sonar.step)


def render(scene, sonar, path, tools):
    specs, ranges, noise = stonefish.settings(sonar)
    bins = round((sonar.edges[-1] - near(sonar)) / sonar.step)
    stonefish.picture_of(scene, sonar, ({**specs, "bins": bins}, {**ranges, "range_min": near(sonar)}, noise), path, tools)


def declared(sonar):
    return [*stonefish.declared(sonar), "--ranges", f"{near(sonar):.9g}:{sonar.edges[-1]:.9g}", "--resample"]


def known(scene, sonar, truth):
    clipping = Known("near-clipping", 0, "bins", "the near plane is in front of all objects", may=True)
    return [clipping if k.fault == "near-clipping" else k for k in stonefish.known(scene, sonar, truth)]
