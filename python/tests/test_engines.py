# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines and sensors that are Python functions, and what they are compared and charted with."""

import json
import threading

import netCDF4
import numpy as np
import pytest

import tubefoot
from tubefoot._words import in_python


@tubefoot.sensor("centroids")
def centroids(history):
    """All of a footprint's energy in the sample of its centroid: binning = "centroid", by Lambert's law."""
    transmission = history.transmission
    ranges = np.linalg.norm(history.centroid_m, axis=1)
    mu = transmission.material_mu[transmission.material[history.facet]]
    loss = 10 ** (-2 * transmission.absorption_db_per_m * ranges / 10)
    energy = mu * np.sin(history.grazing_rad) ** 2 * history.area_m2 / ranges**4 * loss
    sample = np.searchsorted(transmission.range_edges_m, ranges, side="right") - 1
    inside = (sample >= 0) & (sample < transmission.energy_shape[1])
    total = np.zeros(transmission.energy_shape)
    np.add.at(total, (history.beam[inside], sample[inside]), energy[inside])
    return total


@tubefoot.engine("nothing")
def nothing(transmission):
    return np.zeros(transmission.energy_shape)


def test_a_sensor_in_numpy_is_the_built_in_binning(scene):
    built_in = tubefoot.run(scene, binning="centroid")
    own = tubefoot.run(scene, engine=centroids)
    for name in own:
        assert own[name].energy == pytest.approx(built_in[name].energy, rel=1e-9, abs=1e-30)
        assert own[name].energy.sum() > 0
    assert own["camera"].to_xarray().attrs["engine"] == "centroids"
    assert own.stats["engine"] == "centroids" and own.stats["pings"] == 5


def test_an_engine_sees_the_scene(scene):
    @tubefoot.engine("middle rays")
    @np.errstate(all="ignore")  # facets that a ray is parallel to
    def middle_rays(transmission):
        """The whole beam at the range of its middle ray, if that hits."""
        energy = np.zeros(transmission.energy_shape)
        corners = transmission.vertices_m[transmission.facets] - transmission.apex_m
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        for tube, beam in zip(transmission.tubes, transmission.beam_of_tube):
            ray = transmission.rays[tube].sum(axis=0)
            ray /= np.linalg.norm(ray)
            ranges = (corners[:, 0] * normal).sum(axis=1) / (normal @ ray)
            point = ranges[:, None, None] * ray
            sides = [((np.cross(corners[:, (k + 1) % 3] - corners[:, k], point[:, 0] - corners[:, k])) * normal).sum(1)
                     for k in range(3)]
            hit = np.where((np.min(sides, axis=0) >= 0) & (ranges > 0), ranges, np.inf).min()
            sample = np.searchsorted(transmission.range_edges_m, hit, side="right") - 1
            if 0 <= sample < energy.shape[1]:
                energy[beam, sample] += 1
        return energy
    exact, rough = tubefoot.run(scene), tubefoot.run(scene, engine=middle_rays)
    hit = rough["camera"].energy > 0
    assert hit.any(axis=2).all() and (exact["camera"].energy[hit] > 0).all()


def test_each_transmission_is_asked_for_once_with_its_ping(scene):
    asked = []

    @tubefoot.engine("asked")
    def engine(transmission):
        asked.append((transmission.sensor, transmission.ping, transmission.transmission))
        return np.full(transmission.energy_shape, 1.0 + transmission.ping)
    result = tubefoot.run(scene, engine=engine, threads=3)
    assert sorted(asked) == [("camera", p, 0) for p in range(3)] + [("side", p, 0) for p in range(2)]
    assert (result["camera"].energy == np.arange(1, 4)[:, None, None]).all()


def test_a_function_that_waits_for_another_thread_is_no_deadlock(scene):
    go = threading.Event()

    @tubefoot.engine("waits")
    def engine(transmission):
        assert go.wait(60)
        return np.zeros(transmission.energy_shape)
    threading.Timer(0.2, go.set).start()
    tubefoot.run(scene, engine=engine)


def test_transmissions_may_be_kept(scene):
    kept = []

    @tubefoot.engine("keeps")
    def engine(transmission):
        kept.append((transmission, transmission.facets, transmission.vertices_m))
        return np.zeros(transmission.energy_shape)
    tubefoot.run(scene, engine=engine)
    del scene
    assert all(facets.shape == (6, 3) and np.isfinite(vertices).all() for _, facets, vertices in kept)
    assert len(kept[0][0].history()) > 0


def test_what_a_function_raises_comes_out_and_leaves_nothing(scene, folder):
    @tubefoot.engine("broken")
    def broken(transmission):
        raise ZeroDivisionError("mine")
    before = sorted(folder.iterdir())
    with pytest.raises(ZeroDivisionError, match="mine"):
        tubefoot.run(scene, engine=broken, output=folder / "out")
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("energy, text", [
    (np.zeros((3, 3)), r"returned an array of shape \(3, 3\), expected \(beams, samples\) = \("),
    (None, "returned an array of shape"),
    ("negative", "negative or not finite"),
    ("nan", "negative or not finite"),
    ("complex", "returned complex128, expected float64"),
])
def test_energies_that_are_none(scene, energy, text):
    @tubefoot.engine("odd")
    def odd(transmission):
        value = {"negative": -1.0, "nan": np.nan, "complex": 1j}.get(energy) if isinstance(energy, str) else None
        return energy if value is None else np.full(transmission.energy_shape, value)
    with pytest.raises(ValueError, match="engine 'odd' .*" + text):
        tubefoot.run(scene, engine=odd)


def test_engines_that_are_none(scene):
    with pytest.raises(tubefoot.UsageError, match="not function"):
        tubefoot.run(scene, engine=lambda transmission: None)
    with pytest.raises(tubefoot.UsageError, match="built-in"):
        tubefoot.run(scene, engine=nothing, tolerance=1e-3)
    with pytest.raises(tubefoot.UsageError, match="needs a name"):
        tubefoot.engine("")(lambda transmission: None)


@pytest.fixture
def two_receivers(folder):
    text = (folder / "scene.toml").read_text().replace('kind = "sidescan"', 'kind = "interferometric"\nbaseline_m = 0.05')
    (folder / "two.toml").write_text(text)
    return tubefoot.load(folder / "two.toml")


@tubefoot.sensor("two centroids")
def two_centroids(history):
    """binning = "centroid" of two receivers: each by its own range, and their product where samples are the same."""
    transmission = history.transmission
    if transmission.receiver_baseline_m is None:
        return centroids(history)
    at, baseline = history.centroid_m, transmission.receiver_baseline_m[history.beam]
    ranges = np.linalg.norm(at, axis=1)
    upper, lower = np.linalg.norm(at - baseline / 2, axis=1), np.linalg.norm(at + baseline / 2, axis=1)
    mu = transmission.material_mu[transmission.material[history.facet]]
    loss = 10 ** (-2 * transmission.absorption_db_per_m * ranges / 10)
    energy = mu * np.sin(history.grazing_rad) ** 2 * history.area_m2 / ranges**4 * loss
    product = energy * np.exp(2j * np.pi * 1000 * transmission.frequency_khz / transmission.sound_speed_m_s * (upper - lower))
    total = np.zeros(transmission.energy_shape)
    sample = [np.searchsorted(transmission.range_edges_m, (ranges + own) / 2, side="right") - 1 for own in (upper, lower)]
    inside = [(k >= 0) & (k < transmission.energy_shape[-1]) for k in sample]
    for channel in (0, 1):
        heard = inside[channel]
        np.add.at(total[channel], (history.beam[heard], sample[channel][heard]), energy[heard])
    both = inside[0] & (sample[0] == sample[1])
    for channel, part in ((2, product.real), (3, product.imag)):
        np.add.at(total[channel], (history.beam[both], sample[0][both]), part[both])
    return total


def test_two_receivers_in_numpy_are_the_built_in_binning(two_receivers):
    built_in, own = (tubefoot.run(two_receivers, **how) for how in ({"binning": "centroid"}, {"engine": two_centroids}))
    assert own["side"].energy.sum() > 0 and np.abs(own["side"].cross.imag).sum() > 0
    for name in own:
        assert own[name].energy == pytest.approx(built_in[name].energy, rel=1e-9, abs=1e-30)
    largest = own["side"].energy.max()
    assert own["side"].energy_lower == pytest.approx(built_in["side"].energy_lower, rel=1e-9, abs=1e-30)
    assert np.abs(own["side"].cross - built_in["side"].cross).max() < 1e-9 * largest
    assert own["camera"].energy_lower is None


@pytest.mark.parametrize("channels, text", [
    ((1, 1, 1.01, 0), r"engine 'odd': invalid covariance in beam 0 and sample 0 of transmission 0 of ping \d of sensor 'side': its magnitude .* more than"),
    ((1, 1, 0.8, -0.8), "more than the geometric mean"),
    ((0, 1, 0.1, 0), "more than the geometric mean"),
    ((1, -1, 0, 0), "negative or not finite"),
    ((1, 1, np.nan, 0), "negative or not finite"),
    (None, r"expected \(channels, beams, samples\) = \(4, "),
])
def test_channels_that_no_two_receivers_have(two_receivers, channels, text):
    @tubefoot.engine("odd")
    def odd(transmission):
        if transmission.receiver_baseline_m is None:
            return np.zeros(transmission.energy_shape)
        if channels is None:
            return np.zeros(transmission.energy_shape[1:])
        return np.ones(transmission.energy_shape) * np.array(channels, dtype=float)[:, None, None]
    with pytest.raises(ValueError, match=text):
        tubefoot.run(two_receivers, engine=odd)


def test_signals_that_are_as_alike_as_can_be(two_receivers):
    @tubefoot.engine("alike")
    def alike(transmission):
        return np.ones(transmission.energy_shape) * ([1.0] if transmission.receiver_baseline_m is None else np.array([4, 1, 1.2, -1.6])[:, None, None])
    result = tubefoot.run(two_receivers, engine=alike)["side"]
    assert (result.energy == 4).all() and (result.energy_lower == 1).all() and (result.cross == 1.2 - 1.6j).all()


def test_an_output_of_ones_own_engine_is_read_by_compare(scene, folder, program):
    tubefoot.run(scene, output=folder / "exact")
    tubefoot.run(scene, engine=centroids, output=folder / "own")
    with netCDF4.Dataset(folder / "own" / "echoes.nc") as file:
        assert file.engine == "centroids" and file.scene_hash == scene.hash
    said = json.loads(program("compare", folder / "exact/echoes.nc", folder / "own/echoes.nc", "--json", "-"))
    ours = tubefoot.compare(folder / "exact/echoes.nc", folder / "own/echoes.nc")
    assert ours == said and said["sensors"][0]["l1_error"] > 0
    # Results that were never written compare as their files do.
    memory = tubefoot.compare(tubefoot.run(scene), tubefoot.run(scene, engine=centroids))
    assert memory["sensors"] == said["sensors"]
    mixed = tubefoot.compare(folder / "exact/echoes.nc", tubefoot.run(scene, engine=centroids), sensor="side", worst=2)
    assert [s["name"] for s in mixed["sensors"]] == ["side"] and len(mixed["sensors"][0]["worst_bins"]) == 2
    bound = tubefoot.compare(tubefoot.reference(scene, 1e-6), tubefoot.run(scene))["sensors"][0]["within_bound"]
    assert 0 < bound["bound_l1"] <= 1e-6 and bound["share_of_bins"] > 0.9


def test_what_does_not_go_together_is_not_compared(scene, folder, keys, program):
    tubefoot.run(scene, output=folder / "a")
    keys["sensors"][0]["beams"] = 9
    other = tubefoot.Scene.from_dict(keys, base=folder)
    tubefoot.run(other, output=folder / "b")
    said = program("compare", folder / "a/echoes.nc", folder / "b/echoes.nc", fails=True)
    with pytest.raises(tubefoot.InputError) as error:
        tubefoot.compare(folder / "a/echoes.nc", folder / "b/echoes.nc")
    assert str(error.value) == in_python(said) and "any_scene=True" in str(error.value)
    with pytest.raises(tubefoot.InputError, match="candidate"):
        tubefoot.compare(tubefoot.run(scene), tubefoot.run(other))


def test_charts_have_ones_own_engines_beside_the_built_in_ones(folder, scene):
    steps = []
    rows = tubefoot.chart(scene, ["tube", centroids, nothing], output=folder / "chart", repeats=1,
                          progress=lambda done, total: steps.append((done, total)))
    assert steps[-1] == (10, 10)
    by_engine = {}
    for row in rows:
        by_engine.setdefault(row["engine"], []).append(row)
    assert by_engine["nothing"][0]["l1_error"] == 1 and by_engine["nothing"][0]["rays"] == 0
    built_in = by_engine["tubes, centroid"][0]
    own = by_engine["centroids"][0]
    assert own["l1_error"] == pytest.approx(built_in["l1_error"], rel=1e-6)
    assert 0 < own["l1_error"] < 2  # of energy in other samples, in which it misses and is too much
    assert own["seconds"] > 0 and own["processor_seconds"] > 0 and own["setting"] == "Python"
    assert own["instructions"] is None or own["instructions"] > 0
    page = (folder / "chart" / "index.html").read_text()
    table = (folder / "chart" / "chart.csv").read_text()
    assert "centroids" in page and "centroids,Python" in table and "tubes, exact cuts" in page
    name = rows[0]["scene"]
    assert (folder / "chart" / f"{name}-l1.svg").exists() and (folder / "chart" / f"{name}-rms-db.png").exists()


def test_a_chart_that_is_stopped_leaves_nothing(folder, scene):
    def stop(done, total):
        raise InterruptedError
    before = sorted(folder.iterdir())
    with pytest.raises(InterruptedError):
        tubefoot.chart(scene, ["tube", "ray"], output=folder / "chart", progress=stop)
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("engines, text", [
    (["tubes"], "engines: 'tubes' is not 'tube' or 'ray': did you mean 'tube'?"),
    ("tubes", "engines: 'tubes' is not 'tube' or 'ray': did you mean 'tube'?"),
    ([], "a chart needs at least one scene and one engine"),
    ([nothing, nothing], "two engines have the same name: nothing, nothing"),
])
def test_charts_that_are_none(scene, engines, text):
    with pytest.raises(tubefoot.UsageError) as error:
        tubefoot.chart(scene, engines)
    assert str(error.value) == text
