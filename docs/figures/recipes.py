# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of all figures of the documents: output file, inputs and how it is made.

A figure is a picture that commands write (`picture`, reduced to `width` pixels), or the result of a function
(`draw`, "module:function"). Commands run in a folder that has scenes/, the program as build/release/tubefoot, and out/.
`files` are written into that folder first. `follows` is a page whose saved files and commands run first, up to the
command that writes the picture. Scene files of commands, and the files that they name, are inputs by themselves.
"""
import dataclasses

TUBEFOOT = "build/release/tubefoot"


@dataclasses.dataclass(frozen=True)
class Figure:
    name: str  # file below docs/
    commands: tuple = ()
    picture: str = ""
    width: int = 0  # 0: as it is
    draw: str = ""
    inputs: tuple = ()  # files besides those that the commands name
    follows: str = ""
    files: tuple = ()  # (name, text)


def run(scene, folder, options=""):
    return f"{TUBEFOOT} run scenes/{scene} -o out/{folder}" + (f" {options}" if options else "")


def drawn(name, function, *inputs, follows=""):
    return Figure(name, draw=function, inputs=inputs, follows=follows)


def pictures_of(commands, folder, **names):
    """Figures gallery/NAME.png from pictures of one folder: name = (file, width)."""
    commands = (commands,) if isinstance(commands, str) else tuple(commands)
    return [Figure(f"gallery/{name.replace('_', '-')}.png", commands, f"out/{folder}/{file}.png", width)
            for name, (file, width) in names.items()]


WELLHEAD = (run("wellhead/scene.toml", "wellhead"),)
TRACK_STUDY = ("build/release/tubefoot_track_study scenes/textures/track.toml out/track.png out/drift.png",)
WINDOW_SCENE = """title = "A range gate of 60 to 65 m"

[[materials]]
name = "sand"

[[terrain]]
kind = "fractal"
material = "sand"
width_m = 60
length_m = 40
cell_m = 0.5
rms_height_m = 0.4
hurst = 0.8
largest_wavelength_m = 20

[trajectory]
kind = "fixed"
position_m = [0, 0, 3]
heading_deg = 30

[[sensors]]
name = "camera"
kind = "imaging"
horizontal_deg = 70
vertical_deg = 16
tilt_deg = 22
range_min_m = 60
range_max_m = 65
"""

FIGURES = [
    # Drawings of geometry and of keys.
    drawn("figures/beam-geometry.svg", "geometry_drawings:beam_geometry"),
    drawn("figures/axes.svg", "geometry_drawings:axes"),
    *(drawn(f"figures/sensor-{kind}.svg", f"sensor_drawings:{kind}") for kind in (
        "didson", "imaging", "multibeam", "sidescan", "interferometric", "scanning", "echosounder", "array")),
    # Drawings of results.
    drawn("figures/scattering-models.svg", "result_drawings:scattering_models"),
    drawn("figures/sampling-comparison.png", "result_drawings:sampling_comparison", "scenes/wellhead/scene.toml"),
    drawn("figures/closure.svg", "result_drawings:closure", follows="docs/tutorial.md"),
    drawn("figures/footprints-in-plan.svg", "result_drawings:plan_of_a_fan", follows="docs/tutorial.md"),
    drawn("pictures/footprints-wellhead.png", "result_drawings:footprints_in_plan", "scenes/wellhead/scene.toml"),
    # The tutorial and the first pictures of the documents.
    Figure("figures/tutorial-low.png", picture="out/low/camera-0000.png", width=500, follows="docs/tutorial.md"),
    Figure("figures/tutorial-high.png", picture="out/high/camera-0000.png", width=500, follows="docs/tutorial.md"),
    Figure("pictures/camera-0000.png", WELLHEAD, "out/wellhead/camera-0000-received.png", 800),
    Figure("pictures/sidescan.png", WELLHEAD, "out/wellhead/sidescan-received.png", 1200),
    # The gallery.
    *pictures_of(WELLHEAD, "wellhead", wellhead_camera_0=("camera-0000", 600), wellhead_camera_1=("camera-0001", 600),
                 wellhead_camera_2=("camera-0002", 600),
                 wellhead_sidescan_south=("sidescan-south", 720), wellhead_sidescan_north=("sidescan-north", 720),
                 wellhead_scene=("scene", 1300)),
    *pictures_of(run("wellhead/mesh.toml", "mesh"), "mesh", wellhead_mesh_camera=("camera-0000", 620),
                 wellhead_mesh_depth=("multibeam-depth", 760)),
    *pictures_of(run("wellhead/crosstalk.toml", "with"), "with", wellhead_crosstalk=("camera-0000-received", 640)),
    *pictures_of(run("wellhead/plain.toml", "without"), "without", wellhead_plain=("camera-0000-received", 640)),
    *pictures_of(run("signals/rail.toml", "rail"), "rail", signals_rail=("rail-aperture", 1200)),
    *pictures_of(run("signals/multibeam.toml", "elements"), "elements", signals_elements=("multibeam-signals", 760),
                 signals_beams=("multibeam-beams", 640)),
    *pictures_of(run("signals/fringes.toml", "fringes"), "fringes", signals_fringes=("swath-interferogram", 900)),
    *pictures_of(run("signals/lloyd.toml", "lloyd"), "lloyd", signals_lloyd=("string-signals", 900)),
    *pictures_of(run("textures/beds.toml", "beds"), "beds", beds_sidescan=("sidescan", 640)),
    *pictures_of(run("textures/sands.toml", "sands"), "sands", sands_sidescan=("sidescan", 640)),
    *(Figure(f"gallery/{name}.png", TRACK_STUDY, f"out/{name}.png", width) for name, width in (("track", 800), ("drift", 1000))),
    *pictures_of(run("survey/scene.toml", "survey"), "survey", survey_sidescan=("sidescan", 760),
                 survey_mosaic=("sidescan-mosaic", 640)),
    *pictures_of(run("survey/wrecks.toml", "wrecks"), "wrecks", wrecks_depth=("multibeam-depth", 700),
                 wrecks_camera=("camera-sequence", 1000)),
    *pictures_of(f"{TUBEFOOT} coverage scenes/survey/wrecks.toml --sensor multibeam -o out/coverage", "coverage",
                 wrecks_coverage=("coverage", 720)),
    *pictures_of(run("robot/scene.toml", "robot"), "robot", robot_scan=("scan-0000", 760), robot_ahead=("ahead-0000", 760)),
    *pictures_of(run("swimmer/scene.toml", "swimmer"), "swimmer", swimmer_camera=("camera-sequence", 1000)),
    *pictures_of(run("sea-surface/scene.toml", "sea-surface"), "sea-surface", sea_surface_sonar=("sonar-sequence", 1200)),
    *pictures_of(run("crosstalk/scene.toml", "crosstalk"), "crosstalk", crosstalk_side_lobes=("side-lobes-0000", 600),
                 crosstalk_ideal=("ideal-0000", 600)),
    *pictures_of(run("channel/camera.toml", "ghosts"), "ghosts", channel_camera=("camera-0000", 640)),
    *pictures_of(run("channel/scene.toml", "channel"), "channel", channel_sidescan=("sidescan", 1000)),
    *pictures_of(run("multibeam/scene.toml", "multibeam"), "multibeam", multibeam_depth=("multibeam-depth", 900)),
    *pictures_of(run("interferometric/scene.toml", "interferometric"), "interferometric",
                 interferometric_phase=("swath-phase", 1100)),
    *pictures_of(run("paths/shallow-water.toml", "shallow-water"), "shallow-water",
                 paths_sidescan_multiples=("sidescan", 800)),
    *pictures_of(("sed 's/^order = 3/order = 1/' scenes/paths/shallow-water.toml > out/single.toml",
                  f"{TUBEFOOT} run out/single.toml -o out/single"), "single", paths_sidescan_single=("sidescan", 800)),
    *pictures_of(("sed '/^\\[paths\\]/,$d; s|\"bowl.obj\"|\"../scenes/paths/bowl.obj\"|' scenes/paths/bowl.toml > out/once.toml",
                  f"{TUBEFOOT} run out/once.toml -o out/once"), "once", paths_bowl_once=("camera-0000", 640)),
    *pictures_of(run("paths/bowl.toml", "bowl"), "bowl", paths_bowl_twice=("camera-0000", 640)),
    *pictures_of(run("real-grid/sidescan-line.toml", "line"), "line", real_grid_mosaic=("sidescan-mosaic", 800)),
    *pictures_of(run("seabed/laws.toml", "laws"), "laws", laws_sidescan=("sidescan", 800)),
    # Pictures of other pages.
    *(Figure(f"pictures/shadow-{borders}.png", (run("shadows/wall.toml", "wall"),), f"out/wall/{borders}-0000.png", 620)
      for borders in ("sharp", "fresnel")),
    Figure("pictures/material-patches.png", (run("seabed/patches.toml", "patches"),), "out/patches/sidescan-mosaic.png", 700),
    Figure("pictures/fish-before-wreck.png", (run("fish-before-wreck/scene.toml", "fish"),), "out/fish/sonar-0000.png", 900),
    Figure("pictures/labels-imaging.png", (run("imaging/scene.toml", "labelled", "--labels"),),
           "out/labelled/sonar-labels-0000.png", 1200),
    Figure("pictures/refraction.png", ("build/release/tubefoot_refraction_study scenes/refraction/scene.toml out/refraction.png",),
           "out/refraction.png", 900),
    *(Figure(f"pictures/target-strength-{model}.png",
             (f"{TUBEFOOT} strength scenes/betssi/{model}.obj --frequencies {frequencies} --azimuths 0:180:{step} "
              f"--compare scenes/betssi/{model}.csv -o out/{model}",), f"out/{model}/strength.png", 1300)
      for model, frequencies, step in (("m3", "1kHz", 0.6), ("m5a", "1kHz,3kHz,10kHz", 0.2), ("m5b", "1kHz,3kHz,10kHz", 0.2))),
    Figure("pictures/wrong-profile.png", (run("processing/wrong-profile.toml", "wrong-profile"),),
           "out/wrong-profile/multibeam-depth.png", 1200),
    Figure("pictures/scene-window.png", (f"{TUBEFOOT} check window.toml --png out/window.png",), "out/window.png", 1300,
           files=(("window.toml", WINDOW_SCENE),)),
    *(Figure(f"pictures/measured-{kind}.png", picture=f"out/os02-a-compared/mode-260-320-290-{kind}.png", width=1300,
             follows="docs/measured.md") for kind in ("fan", "extent")),
    Figure("pictures/howto-validate.png", picture="out/mine.png", width=1300, follows="docs/engine-validation.md"),
    Figure("pictures/viewer.png", (*WELLHEAD, f"{TUBEFOOT} view out/wellhead -o out/wellhead.html --sensor camera"),
           draw="viewer_shots:viewer"),
    Figure("pictures/chart-wellhead.png", (f"{TUBEFOOT} chart scenes/wellhead/scene.toml -o out/chart --repeats 1 --seconds 3",),
           "out/chart/wellhead-rms-db.png", 1000),
]
