# SPDX-License-Identifier: GPL-3.0-or-later
"""A multibeam sonar from a depth camera, as DAVE (nps_uw_multibeam_sonar) describes it.

Sources: github.com/Field-Robotics-Lab/nps_uw_multibeam_sonar, and W.-S. Choi et al., "Physics-based modelling and
simulation of multibeam echosounder perception", Frontiers in Robotics and AI 2021. Every pixel of one depth camera is a
scatterer with a random phase. Its amplitude depends on incidence, area and spreading. A bin is the modulus of the sum with
a gain, and at most 255. The picture has the numbers of the message as NPY, sample-major, with the beams in the reverse order
of its list of directions. Not included: beam pattern, and the shape of the pulse in frequency.
"""
import numpy as np

import depth_buffer
from known import Known, fan_edge_scallop, near_shadow, tangent

TITLE = "Depth camera and phases as in DAVE"
PICTURE = "message.npy"
ROWS = 1024
IDEAL = f"1x{ROWS}"


def render(scene, sonar, path, tools):
    ranges, cosines, strengths = np.moveaxis(depth_buffer.samples(scene, sonar, 1, ROWS), 2, 0)
    # The solid angle of a pixel of a plane picture: flat over the cube of its distance.
    across, up = np.tan(depth_buffer.column_azimuths(sonar, 1))[:, None], np.tan(sonar.height / 2)
    place = ((np.arange(ROWS) + 0.5) / ROWS * 2 - 1)[None, :] * up
    pixel = 2 * np.tan(sonar.half_fan) / sonar.beams * 2 * up / ROWS
    solid_angle = pixel / (1 + across ** 2 + place ** 2) ** 1.5
    seen = np.where(np.isfinite(ranges), ranges, 1)
    loss = 10 ** (-2 * scene.absorption_db_per_km * seen / 10000)
    amplitude = np.sqrt(strengths * cosines * solid_angle * loss) / seen
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, amplitude.shape)
    beam = np.repeat(np.arange(sonar.beams), ROWS)
    sample = sonar.bin_of(np.where(np.isfinite(ranges), ranges, 0)).ravel()
    real, _ = sonar.summed(beam, sample, (amplitude * np.cos(phase)).ravel())
    imaginary, _ = sonar.summed(beam, sample, (amplitude * np.sin(phase)).ravel())
    modulus = np.hypot(real, imaginary)
    loud = np.quantile(modulus[modulus > 0], 0.995)
    np.save(path, np.minimum(255, np.rint(255 * modulus / loud)).T[:, ::-1].astype(np.uint8))


def declared(sonar):
    """As its message says it, beams in the order of the directions, which the profile knows better; and amplitudes as they are,
    for the recipe brings the truth to amplitudes."""
    return ["--profile", "dave", "--no-flip-beams", "--scale", "8bit"]


def recipe(scene, sonar):
    return [{"step": "amplitude"}, {"step": "normalise", "by": "largest", "over": "image"}]


def known(scene, sonar, truth):
    return [Known("mirror", None, "", "beams in the reverse order of the list of directions"),
            tangent(sonar, 1), fan_edge_scallop(scene, sonar, 1), near_shadow(scene, sonar, truth),
            Known("8-bits", None, "levels", "8-bit numbers"),
            Known("clamped", None, "% of the bins with an echo", "the largest 0.5 % are all 255"),
            Known("level", None, "dB", "arbitrary gain", may=True),
            Known("speckle", None, "of the energy", "random phases", may=True)]
