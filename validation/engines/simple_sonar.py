# SPDX-License-Identifier: GPL-3.0-or-later
"""simple_sonar_simulator itself, on the exported triangles.

Source: github.com/bottad/simple_sonar_simulator at 9a8699b6, prepared by real/build_simple_sonar; rays by trimesh. The known sizes follow
from sonar_simulator.py. Azimuths and elevations are the lower edges of their bins. A hit adds cos(incidence) / number of elevations
whatever the material is. Its bin and its int(7 (1 - cos) r / r_max) neighbours on either side receive it, with the weights of a Gaussian
that are not normalised. Ranges begin at 0. The picture is divided by its largest bin and truncated to 8 bits. Its Gaussian filter is off.
Rows are ranges from 0, and columns go from starboard to port.
"""
import numpy as np
import scipy.spatial.transform

import real_engine
from known import Known

TITLE = "simple_sonar_simulator"
URL = "https://github.com/bottad/simple_sonar_simulator"
PICTURE = "run_image_0000.png"
IDEAL = None
ELEVATIONS, SPREAD_BINS = 256, 7


def build():
    return real_engine.built("simple_sonar", "TUBEFOOT_SIMPLE_SONAR_SOURCE", "TUBEFOOT_TRIMESH_SOURCE")


def version():
    return real_engine.version(build())


def bins(sonar):
    return int(round(sonar.edges[-1] / sonar.step))


def render(scene, sonar, path, tools):
    folder = path.parent / "simulator"
    real_engine.call([tools.program, "export", scene.path, "--to", "obj", "--pings", sonar.ping, "-o", folder])
    attitude = np.stack([sonar.axes[:, 1], -sonar.axes[:, 0], sonar.axes[:, 2]], axis=1)  # x forward, y port, z up
    angles = scipy.spatial.transform.Rotation.from_matrix(attitude).as_euler("xyz", degrees=True)
    pose = f"  - position: {list(map(float, sonar.apex))}\n    rotation_euler: {list(map(float, angles))}\n"
    (folder / "poses.yaml").write_text(f"poses:\n{2 * pose}total_time: 1.0\ntimesteps: 2\n")
    (folder / "sonar.yaml").write_text(
        f"v_fov: {np.degrees(sonar.height):.12g}\nh_fov: {np.degrees(2 * sonar.half_fan):.12g}\nmax_range: {sonar.edges[-1]:.12g}\n"
        f"azimuth_bins: {sonar.beams}\nrange_bins: {bins(sonar)}\nelevation_bins: {ELEVATIONS}\n")
    (folder / "run.yaml").write_text(
        f"name: run\nnormalize: true\nsmoothing_sigma: null\ntrajectory_file: poses.yaml\nsonar_config_file: sonar.yaml\n"
        f"scene_file: scene.obj\noutput_folder: {path.parent}\n")
    real_engine.call([build() / "simple_sonar_images", "run.yaml"], cwd=folder)


def declared(sonar):
    """Ranges from 0, of which the reference has a part."""
    return ["--order", "range-first", "--flip-beams", "--scale", "8bit", "--ranges", f"0:{sonar.edges[-1]:.9g}", "--resample"]


def unit(strengths):
    """Its numbers have no unit: each picture is divided by its largest bin."""
    return 1


def recipe(scene, sonar):
    return [{"step": "range-law", "exponent": 2, "absorption_db_per_km": scene.absorption_db_per_km},
            {"step": "normalise", "by": "largest", "over": "image"}]


def spread(sonar, ranges, cosine):
    """Neighbours on each side that a hit spreads to, and the sum of their weights and its own."""
    number = np.floor((1 - cosine) * ranges / sonar.edges[-1] * SPREAD_BINS)
    offsets = np.arange(-SPREAD_BINS, SPREAD_BINS + 1)
    weights = np.exp(-0.5 * (offsets / (number[:, None] + 1e-5)) ** 2)
    return number, np.where(np.abs(offsets) <= number[:, None], weights, 0).sum(axis=1)


def known(scene, sonar, truth):
    lit = (truth() > 0).any(axis=0)
    ranges = sonar.slant_range[lit]
    result = [Known("beam-shift", -0.5, "beams", "rays at the starboard edge of each beam instead of its middle"),
              Known("8-bits", None, "levels", "8-bit picture of few hits"),
              Known("level", None, "dB", "divided by its own largest bin, with values truncated to whole numbers", may=True)]
    if scene.has_flat_bed() and len(ranges):
        cosine = np.clip(sonar.apex[2] / ranges, 0, 1)
        number, gains = spread(sonar, ranges, cosine)
        law = np.polyfit(np.log(ranges), np.log(gains), 1)[0]
        result += [Known("range-law", float(law), "power of range", "echoes of the seabed are spread over more bins at larger ranges, each with nearly "
                         "the full echo", within=0.5),
                   Known("range-spread", float(number.max()), "bins at the largest range", "spread that grows with range and incidence", within=0.5)]
    if len(set(scene.mu)) > 1:
        decibels = 10 * np.log10(scene.mu.max() / scene.mu.min())
        result.append(Known("material-levels", float(decibels), "dB", "all materials return the same"))
    return result
