# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known to be wrong in an engine, by construction."""
import dataclasses

import numpy as np

import depth_buffer


@dataclasses.dataclass
class Known:
    fault: str          # as `tubefoot compare --diagnose` names it
    size: float | None  # as it follows from the construction; None: a size does not follow
    unit: str
    why: str
    may: bool = False   # follows from the construction, but may be too small to matter
    within: float = 0.25  # part of the size that the size found may be off


def tangent(sonar, views):
    """Beams even in the tangent: how far they are off at most, in beams."""
    off = np.abs(depth_buffer.column_azimuths(sonar, views) - sonar.azimuth).max() / sonar.width
    return Known("tangent-spacing", float(off), "beams at most", f"{views} camera{'s' * (views > 1)}, columns equidistant in the tangent",
                 may=bool(off < 0.08))


def fan_edge_scallop(scene, sonar, views):
    """Nothing where no flat bed is; else how far the near edge of a flat bed is off, crest to trough, in samples: a camera's lower side is a plane, and not
    a cone of even elevation."""
    if not scene.has_flat_bed():
        return Known("scalloped-edge", None, "samples", "the lower side of a camera view is a plane", may=True)
    depth = sonar.apex[2]
    local = np.concatenate([depth_buffer.column_azimuths(sonar, views)[k * sonar.beams // views:(k + 1) * sonar.beams // views]
                            - middle for k, (middle, _) in enumerate(depth_buffer.views_of(sonar, views))])
    lower = np.arctan(np.tan(sonar.height / 2) * np.cos(local))
    true_range, its_range = (-depth / sonar.directions(sonar.azimuth, -angle)[:, 2] for angle in (sonar.height / 2, lower))
    off = (its_range - true_range) / sonar.step
    return Known("scalloped-edge", float(off.max() - off.min()), "samples", "the lower side of a camera view is a plane",
                 may=bool(off.max() - off.min() < 0.5), within=0.5)


def near_shadow(scene, sonar, truth):
    """Bins in the shadow of objects that lie nearer than the picture, one beam and two samples within its edges."""
    def is_near(triangles):
        # The middle of a curved strip may be nearer than all of its points.
        offsets = triangles - sonar.apex
        return max(np.linalg.norm(offsets.mean(axis=(0, 1))), np.linalg.norm(offsets, axis=2).min()) < sonar.edges[0]

    near = [name for k, name in enumerate(scene.objects) if is_near(scene.triangles[scene.owner == k])]
    if not near:
        return Known("near-clipping", 0, "bins", "no object is nearer than the picture", may=True)
    shadow = (truth() == 0) & (truth(without=near) > 0)
    beams, samples = shadow.shape
    around = np.pad(shadow, ((1, 1), (2, 2)))
    inside = np.all([around[i:i + beams, j:j + samples] for i in range(3) for j in range(5)], axis=0)
    return Known("near-clipping", float(inside.sum()), "bins", f"{', '.join(near)}: the near plane removes these objects, or the engine does not search for them")
