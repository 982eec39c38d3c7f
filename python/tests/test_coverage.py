# SPDX-License-Identifier: GPL-3.0-or-later
"""What pings see of a scene, and which settings are advised: as the commands say."""

import csv
import json

import numpy as np
import pytest

import tubefoot


def test_columns_are_the_commands_table(scene, folder, program):
    program("coverage", folder / "scene.toml", "-o", folder / "facets.csv")
    coverage = tubefoot.coverage(folder / "scene.toml")
    rows = list(csv.DictReader((folder / "facets.csv").open()))
    assert coverage.rows == len(rows) > 2
    for name in coverage:
        if name.endswith("_index"):
            continue
        assert coverage[name].tolist() == [float(row[name]) for row in rows], name
        assert not coverage[name].flags.writeable
    assert coverage.component.tolist() == [row["component"] for row in rows]
    assert coverage.material.tolist() == [row["material"] for row in rows]
    assert set(coverage.component) == {"terrain", "thing"} or "thing" in coverage.component


def test_shares_add_up(scene):
    coverage = tubefoot.coverage(scene)
    for row, facet in enumerate(coverage["facet"]):
        own = coverage.depth_facet == facet
        assert coverage.depth_share[own].sum() == pytest.approx(1, abs=1e-12)
        assert coverage["mean_pings"][row] == pytest.approx(
            (coverage.depth_share[own] * coverage.depth_pings[own]).sum(), abs=1e-12)
    assert sum(coverage.area_by_pings_m2.values()) == pytest.approx(coverage["area_m2"].sum())
    assert coverage["seen_m2"].sum() == pytest.approx(sum(m2 for n, m2 in coverage.area_by_pings_m2.items() if n))
    assert coverage.pings == [("camera", 0), ("camera", 1), ("camera", 2), ("side", 0), ("side", 1)]
    assert coverage.facets_of_scene == 6
    assert (coverage["shadow_share"] > 0).any()  # behind the thing


def test_sensor_and_pings_choose(scene):
    assert tubefoot.coverage(scene, "camera", range(1, 3)).pings == [("camera", 1), ("camera", 2)]
    one = tubefoot.coverage(scene, "camera", 0)
    assert one.pings == [("camera", 0)] and one["most_pings"].max() == 1
    assert one["seen_m2"].sum() < tubefoot.coverage(scene)["seen_m2"].sum()


def test_a_folder_is_the_commands_byte_by_byte(scene, folder, program):
    program("coverage", folder / "scene.toml", "--sensor", "camera", "-o", folder / "command")
    coverage = tubefoot.coverage(scene, "camera", output=folder / "module")
    names = sorted(p.name for p in (folder / "command").iterdir() if not p.name.startswith("."))
    assert names == ["coverage.glb", "coverage.gpkg", "coverage.png", "coverage.vtp", "depths.csv", "facets.csv"]
    for name in names:
        if name != "coverage.gpkg":
            assert (folder / "module" / name).read_bytes() == (folder / "command" / name).read_bytes(), name
    coverage.picture().save(folder / "plan.png")
    assert (folder / "plan.png").read_bytes() == (folder / "command" / "coverage.png").read_bytes()
    assert "data:image/png" in coverage._repr_html_()


def test_pings_that_see_nothing(folder):
    (folder / "up.toml").write_text((folder / "scene.toml").read_text().replace("tilt_deg = 30", "tilt_deg = -40", 1))
    nothing = tubefoot.coverage(folder / "up.toml", "camera")
    assert nothing.rows == 0 and nothing["seen_m2"].shape == (0,) and "<img" not in nothing._repr_html_()
    with pytest.raises(tubefoot.UsageError, match="nothing to draw"):
        nothing.picture()


def test_places_that_cannot_be_written(scene, folder):
    for place, text in [("facets.xls", "unknown suffix"), ("", "output: the name is empty")]:
        with pytest.raises(tubefoot.UsageError, match=text):
            tubefoot.coverage(scene, output=place and folder / place)
    with pytest.raises(tubefoot.UsageError):
        tubefoot.coverage(scene, output=folder / "scene.toml" / "x.csv")


def without_seconds(advice):
    if isinstance(advice, dict):
        return {k: without_seconds(v) for k, v in advice.items() if k not in ("seconds", "cheapest", "options", "holds")}
    return [without_seconds(v) for v in advice] if isinstance(advice, list) else advice


def test_advice_is_the_commands(scene, folder, program):
    said = json.loads(program("advise", folder / "scene.toml", "--tolerance", "1e-3", "--json", "-", "--pings", 2))
    advice = tubefoot.advise(scene, "1e-3", trial_pings=2)
    exact, told = advice["candidates"][0], said["candidates"][0]
    assert without_seconds(exact) == without_seconds(told)
    for key in ("scene", "scene_hash", "tolerance", "measure", "confidence", "sensors", "silent_sensors"):
        assert advice[key] == said[key], key
    assert exact["options"] == {"engine": "tube", "arithmetic": "fixed", "binning": "exact"}
    assert told["options"] == "--engine tube --arithmetic fixed --binning exact"
    rays = [c["options"] for c in advice["candidates"] if c["options"]["engine"] == "ray"]
    assert rays and all(isinstance(o["rays_per_beam"], int) for o in rays)


def test_advised_options_make_a_run_that_holds(scene):
    advice = tubefoot.advise(scene, "50%", trial_pings=2)
    assert advice["cheapest"]["holds"]
    result = tubefoot.run(scene, **advice["cheapest"]["options"])
    for figures in tubefoot.compare(tubefoot.run(scene), result)["sensors"]:
        assert figures["l1_error"] <= 0.5
    with pytest.raises(tubefoot.UsageError, match="pings: expected 2 or more, not 1"):
        tubefoot.advise(scene, "50%", trial_pings=1)
