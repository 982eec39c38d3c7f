# SPDX-License-Identifier: GPL-3.0-or-later
"""Stonefish itself: its parser reads the exported scenario, and its forward-looking sonar (FLS) renders the picture.

Source: github.com/patrykcieslak/stonefish at b21eb8e1 (version 1.6.0), built by real/build_stonefish. Numbers are 32-bit floats, and noise is off.
The known sizes follow from OpenGLFLS.cpp and flsOutput.comp. A fan of F degrees consists of ceil(F / 20) camera views side by side.
A sample has a range and the restitution multiplied by cos(incidence). A bin is the mean of its samples, of which the upper and the
lower fifth of the view are tapered. A 5 x 5 Gaussian of one bin and limits of 0 to 1 follow.
"""
import math
import xml.etree.ElementTree as xml

import numpy as np

import known as faults
import real_engine
from known import Known
from stonefish_like import gain

TITLE = "Stonefish, floats without noise"
URL, LICENCE = "https://github.com/patrykcieslak/stonefish", "GPL-3.0-or-later"
PICTURE = "sonar.npy"
IDEAL = "1x1024"
LARGEST_VIEW_DEG, ROWS_PER_DEGREE_AND_BIN, MOST_ROWS = 20, 0.1, 2048


def version():
    return real_engine.version(real_engine.built("stonefish", "TUBEFOOT_STONEFISH_SOURCE"))


def views_of(sonar):
    """(first beam, beams, middle azimuth, half width) of each view, as the constructor of OpenGLFLS computes them."""
    fan = 2 * sonar.half_fan
    number = math.ceil(round(math.degrees(fan), 9) / LARGEST_VIEW_DEG)
    beams = [math.floor(sonar.beams / number + 0.5)] * (number - 1)
    beams.append(sonar.beams - sum(beams))
    width = max(beams) / sonar.beams * fan
    first = np.cumsum([0] + beams[:-1])
    return [(int(k), n, -sonar.half_fan + k / sonar.beams * fan + width / 2, width / 2) for k, n in zip(first, beams)]


def columns(sonar):
    """Azimuth of each beam, and its azimuth from the middle of its view."""
    local = []
    views = views_of(sonar)
    widest = max(n for _, n, _, _ in views)
    for _, number, _, half in views:
        local.append(np.arctan(((np.arange(number) + 0.5) / widest * 2 - 1) * np.tan(half)))
    middles = np.repeat([middle for _, _, middle, _ in views], [n for _, n, _, _ in views])
    return middles + np.concatenate(local), np.concatenate(local)


def settings(sonar):
    """What the scenario says of the FLS: attributes of specs, settings and noise."""
    return ({"beams": sonar.beams, "bins": sonar.samples, "output_format": "float32"},
            {"range_min": sonar.edges[0], "range_max": sonar.edges[-1]}, {"multiplicative": 0, "additive": 0})


def write_scenario(path, chosen):
    """The exported scenario with other attributes of its FLS."""
    tree = xml.parse(path)
    sensor = next(node for node in tree.getroot().iter("sensor") if node.get("type") == "fls")
    for name, attributes in zip(("specs", "settings", "noise"), chosen):
        for key, value in attributes.items():
            sensor.find(name).set(key, value if isinstance(value, str) else f"{value:.12g}")
    tree.write(path, encoding="utf-8", xml_declaration=True)
    return sensor.get("name")


def picture_of(scene, sonar, chosen, path, tools):
    program = real_engine.built("stonefish", "TUBEFOOT_STONEFISH_SOURCE") / "stonefish_images"
    folder = path.parent / "scenario"
    real_engine.call([tools.program, "export", scene.path, "--to", "stonefish", "--pings", sonar.ping, "-o", folder])
    name = write_scenario(folder / "scene.scn", chosen)
    done = real_engine.call(["xvfb-run", "-a", "-s", "-screen 0 320x240x24", program, folder / "scene.scn", path.parent / "images"],
                            env=real_engine.without_graphics_card())
    (path.parent / "stonefish.log").write_text(done.stdout + done.stderr)
    (path.parent / "images" / f"{name}-0000{path.suffix}").rename(path)


def render(scene, sonar, path, tools):
    picture_of(scene, sonar, settings(sonar), path, tools)


def declared(sonar):
    return ["--profile", "stonefish", "--azimuths", "even"]


def unit(strengths):
    """Strength mu of the material with restitution 1: the export gives it to the strongest one of a scene."""
    return max(strengths)


def recipe(scene, sonar):
    return [{"step": "mean", "least_share": 0.5}, {"step": "range-law", "exponent": 2, "absorption_db_per_km": scene.absorption_db_per_km},
            {"step": "gain", "factor": gain(scene)}, {"step": "blur", "beams": 1, "samples": 1, "size": 5},
            {"step": "clamp", "low": 0, "high": 1}]


def taper(place):
    """Weight of a sample at this part of the height of a view, 0 at its lower edge."""
    step = lambda low, high: (lambda t: t * t * (3 - 2 * t))(np.clip((place - low) / (high - low), 0, 1))
    return step(0, 0.2) * (1 - step(0.8, 1))


def lower_edge(sonar):
    """Elevation of the lower side of the view at each beam."""
    return -np.arctan(np.tan(sonar.height / 2) * np.cos(columns(sonar)[1]))


def near_plane(sonar):
    """Depth of the near plane of each view."""
    return sonar.edges[0] * np.cos(max(views_of(sonar)[0][3], sonar.height / 2))


def clipped_below(sonar, local, elevation):
    """Range up to which the near plane removes surfaces in this direction from the middle of a view. At the corners of a view, it is larger
    than the first range of the picture, because the depth of the plane takes only one of the two angles into account."""
    return near_plane(sonar) / (np.cos(local) * np.cos(elevation))


def corner(sonar, truth):
    half = views_of(sonar)[0][3]
    farthest = clipped_below(sonar, half, np.arctan(np.tan(sonar.height / 2) * np.cos(half)))
    begin = truth()[:, sonar.edges[:-1] < farthest]
    return Known("near-returns-missing", None if (begin > 0).any() else 0, "m",
                 f"the corners of each view are clipped up to {farthest:.3f} m", may=True)


def tangent(sonar):
    off = float(np.abs(columns(sonar)[0] - sonar.azimuth).max() / sonar.width)
    number = len(views_of(sonar))
    return Known("tangent-spacing", off, "beams at most", f"{number} camera view{'s' * (number > 1)}, columns equidistant in the tangent",
                 may=off < 0.08)


def scallop(scene, sonar):
    if not scene.has_flat_bed():
        return Known("scalloped-edge", None, "samples", "the lower side of a camera view is a plane", may=True)
    true_range, its_range = (-sonar.apex[2] / sonar.directions(sonar.azimuth, elevation)[:, 2]
                             for elevation in (-sonar.height / 2, lower_edge(sonar)))
    off = (its_range - true_range) / sonar.step
    return Known("scalloped-edge", float(np.ptp(off)), "samples", "the lower side of a camera view is a plane",
                 may=bool(np.ptp(off) < 0.5), within=0.5)


def known(scene, sonar, truth):
    return [tangent(sonar), scallop(scene, sonar), faults.near_shadow(scene, sonar, truth), corner(sonar, truth),
            Known("vertical-pattern", None, "", "samples in the upper and the lower fifth of a view are tapered to 0"),
            Known("range-law", None, "power of range", "the taper, on a bed whose elevation determines its range", may=True),
            Known("level", None, "dB", "the taper lowers the mean level", may=True)]
