# SPDX-License-Identifier: GPL-3.0-or-later
"""Embree in a simple ray engine.

This engine does not reproduce a single simulator, but properties of several: one ray per beam and elevation step from the
middle of the beam (point cloud of OceanSim, github.com/umfieldrobotics/OceanSim; RaycastingScene tutorial of Open3D), scene
and rays in floats, the range of the first hit rounded to the nearest bin number, the mean of strength x cos(incidence) over
the hits of a bin, division by the largest bin, and 8 bits. Embree computes rays and tree (hurried_rays.cpp). The picture is
PNG with ranges in rows, nearest first, and azimuths from port in columns.
"""
import ctypes

import numpy as np

import pictures
from known import Known

TITLE = "Embree in a simple ray engine"
PICTURE = "rays.png"
ELEVATIONS = 1024
IDEAL = None


def first_hits(library, triangles, apex, directions):
    """Ranges and triangles that rays meet first, in floats."""
    function = ctypes.CDLL(str(library)).hurried_first_hits
    of = lambda kind: np.ctypeslib.ndpointer(kind, flags="C_CONTIGUOUS")
    function.argtypes = [of(np.float32), ctypes.c_size_t, of(np.float32), of(np.float32), ctypes.c_size_t, of(np.float32),
                         of(np.uint32)]
    corners = np.ascontiguousarray(triangles, np.float32)
    rays = np.ascontiguousarray(directions, np.float32).reshape(-1, 3)
    distances, hits = np.empty(len(rays), np.float32), np.empty(len(rays), np.uint32)
    failed = function(corners, len(triangles), np.ascontiguousarray(apex, np.float32), rays, len(rays), distances, hits)
    if failed:
        raise RuntimeError(f"Embree failed, error {failed}")
    return distances, hits


def render(scene, sonar, path, tools):
    elevation = ((np.arange(ELEVATIONS) + 0.5) / ELEVATIONS - 0.5) * sonar.height
    rays = sonar.directions(sonar.azimuth[:, None], elevation[None, :]).reshape(-1, 3)
    distances, hits = first_hits(tools.hurried_rays, scene.triangles, sonar.apex, rays)
    met = np.isfinite(distances)
    hits = hits[met]
    cosine = np.abs((scene.normal[hits] * rays[met]).sum(axis=1))
    beam = np.repeat(np.arange(sonar.beams), ELEVATIONS)[met]
    sample = np.rint((distances[met] - np.float32(sonar.edges[0])) / np.float32(sonar.step)).astype(int)  # the slip
    mean = sonar.mean(beam, sample, scene.mu[hits] * cosine)
    pictures.write_png(path, np.rint(255 * mean.T / mean.max()))


def declared(sonar):
    return ["--order", "range-first", "--scale", "8bit"]


def recipe(scene, sonar):
    return [{"step": "mean", "least_share": 0.5}, {"step": "range-law", "exponent": 2, "absorption_db_per_km": scene.absorption_db_per_km},
            {"step": "normalise", "by": "largest", "over": "image"}, {"step": "quantise", "bits": 8}]


def known(scene, sonar, truth):
    return [Known("half-sample", 0.5, "samples", "rounded bin numbers: echoes in the farther half of a bin go to the next bin"),
            Known("8-bits", None, "levels", "8-bit picture"),
            Known("level", None, "dB", "normalised by its own largest bin, which has few rays", may=True)]
