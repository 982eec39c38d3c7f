# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays in Python that count their hits, as in simple_sonar_simulator.

Source: github.com/bottad/simple_sonar_simulator (sonar_sim/sonar_simulator.py), with the cell locator of VTK instead of
that of trimesh. Azimuths and elevations are the lower edges of their bins, from -fov/2 without the last edge. A hit adds 1
divided by the number of elevations, at any incidence. Ranges begin at 0. The picture is divided by its largest bin,
multiplied by 255 and truncated to whole numbers. It is PNG with ranges from 0 in rows, and the starboard-most beam in
column 0 (azimuths increase to port).
"""
import functools

import numpy as np

import pictures
from known import Known

TITLE = "Rays that count, as in simple_sonar_simulator"
PICTURE = "run_image_0000.png"
ELEVATIONS = 1024
IDEAL = None


def first_ranges(triangles, apex, rays, farthest):
    """Distance to what each ray meets first, or infinity."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    points, cells, mesh = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(triangles.reshape(-1, 3)), deep=True))
    numbers = np.arange(3 * len(triangles)).reshape(-1, 3)
    cells.SetCells(len(triangles), numpy_to_vtkIdTypeArray(
        np.ascontiguousarray(np.insert(numbers, 0, 3, axis=1).ravel().astype(np.int64)), deep=True))
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(mesh)
    locator.BuildLocator()
    distance, place, inside, part = vtk.reference(0.0), [0.0] * 3, [0.0] * 3, vtk.reference(0)
    result = np.full(len(rays), np.inf)
    for k, end in enumerate(apex + farthest * rays):
        if locator.IntersectWithLine(apex, end, 1e-9, distance, place, inside, part):
            result[k] = distance.get() * farthest
    return result


@functools.lru_cache(maxsize=1)
def counts(scene, sonar):
    """Hits over the number of elevations: rows from range 0, columns from starboard."""
    azimuth = -sonar.half_fan + np.arange(sonar.beams) * sonar.width  # to port
    elevation = -sonar.height / 2 + np.arange(ELEVATIONS) / ELEVATIONS * sonar.height
    rays = sonar.directions(-azimuth[:, None], elevation[None, :]).reshape(-1, 3)
    farthest = sonar.edges[-1]
    distances = first_ranges(scene.triangles, sonar.apex, rays, 1.001 * farthest)
    bins = int(round(farthest / sonar.step))
    met = distances < farthest
    row = (distances[met] / farthest * bins).astype(int)
    column = np.repeat(np.arange(sonar.beams), ELEVATIONS)[met]
    return np.bincount(row * sonar.beams + column, minlength=bins * sonar.beams).reshape(bins, sonar.beams) / ELEVATIONS


def render(scene, sonar, path, tools):
    picture = counts(scene, sonar)
    pictures.write_png(path, (255 * picture / picture.max()).astype(np.uint8))


def declared(sonar):
    """Ranges from 0, of which the reference has a part."""
    return ["--order", "range-first", "--flip-beams", "--scale", "8bit", "--ranges", f"0:{sonar.edges[-1]:.9g}", "--resample"]


def recipe(scene, sonar):
    return [{"step": "count", "points_per_sr": ELEVATIONS / (sonar.width * sonar.height)},
            {"step": "normalise", "by": "largest", "over": "image"}]


def known(scene, sonar, truth):
    exact = counts(scene, sonar)
    exact = exact[int(round(sonar.edges[0] / sonar.step)):] / exact.max()
    cut = np.floor(255 * exact) / 255
    # What cutting off leaves of each range, and its power of range.
    rows = exact.sum(axis=1) > 0
    kept, weights = cut.sum(axis=1)[rows] / exact.sum(axis=1)[rows], exact.sum(axis=1)[rows]
    law = np.polyfit(np.log(sonar.slant_range[rows]), np.log(np.maximum(kept, 1e-3)), 1, w=np.sqrt(weights))[0]
    return [Known("range-law", float(law), "power of range", "truncation to whole numbers removes most of the energy of bins with few hits",
                  may=bool(abs(law) < 0.1), within=0.5),
            Known("beam-shift", -0.5, "beams", "rays at the starboard edge of each beam instead of its middle"),
            Known("8-bits", None, "levels", "8-bit picture of whole counts"),
            Known("level", None, "dB", "divided by its own largest bin, with values truncated to whole numbers", may=True),
            Known("shadow-sides", None, "beams", "", may=True)]
