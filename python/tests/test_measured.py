# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of a measured with a simulated water column, against closed forms of synthetic echoes."""

import csv

import netCDF4
import numpy as np
import pytest

import tubefoot
from tubefoot import _measured_echoes as echoes
from tubefoot import _measured_figures as figures
from tubefoot import measured

DEPTH_M, STEP_M, SAMPLES = 8.0, 0.03, 620
ANGLES = np.arange(-120, 121) * 0.5 + 0.1
RANGES = (np.arange(SAMPLES) + 0.5) * STEP_M
WIDTH_DEG = 1.5  # -3 dB width of the Gaussian beams
FULL_WIDTH_OF_A_DEVIATION = np.sqrt(8 * np.log(2))


def sectors_of(angles):
    return np.digitize(angles, [-45, 45])


def gaussian_fan(pings=2, slope_deg=0.0, pulse_m=0.0, level=lambda angle: np.ones_like(angle)):
    """Energies of Gaussian beams on a plane seabed: the power at a range is that of the beam at the seabed of this range."""
    fine = 8
    r = (np.arange(SAMPLES * fine) + 0.5) * STEP_M / fine
    away = np.degrees(np.arccos(np.minimum(DEPTH_M / r, 1)))
    side = np.where(ANGLES > slope_deg, 1, -1)[:, None]
    deviation = WIDTH_DEG / FULL_WIDTH_OF_A_DEVIATION
    power = np.exp(-(((side * away + slope_deg - ANGLES[:, None]) / deviation) ** 2) / 2) * (r > DEPTH_M)
    if pulse_m:
        x = np.arange(-4 * fine * 3, 4 * fine * 3 + 1) * STEP_M / fine
        pulse = np.exp(-((x * FULL_WIDTH_OF_A_DEVIATION / pulse_m) ** 2) / 2)
        power = np.array([np.convolve(beam, pulse / pulse.sum(), "same") for beam in power])
    energy = power.reshape(len(ANGLES), SAMPLES, fine).mean(axis=2) * level(ANGLES)[:, None]
    return np.repeat(energy[None], pings, axis=0)


def add_sensor(group, energy, /, recorded_m=None, **variables):
    """Writes the variables of a sensor of an echo file (docs/output-files.md)."""
    sizes = dict(zip(("ping", "beam", "sample"), energy.shape), bound=2, sector=3)
    for name, size in sizes.items():
        group.createDimension(name, size)
    values = {
        "energy": (("ping", "beam", "sample"), energy),
        "slant_range": (("sample",), RANGES[: energy.shape[2]]),
        "slant_range_bounds": (("sample", "bound"), RANGES[: energy.shape[2], None] + STEP_M * np.array([-0.5, 0.5])),
        "beam_azimuth": (("beam",), np.where(ANGLES < 0, -90, 90)),
        "beam_elevation": (("beam",), np.abs(ANGLES) - 90),
        "beam_sector": (("beam",), sectors_of(ANGLES)),
        "sector_frequency_khz": (("sector",), np.array([260, 320, 290])),
        "sector_pulse_length": (("sector",), np.full(3, 46e-6)),
    }
    if recorded_m is not None:
        for name, value in zip(("recorded_range_min", "recorded_range_max"), recorded_m):
            values[name] = (("ping", "beam"), np.full(energy.shape[:2], value))
    values.update(variables)
    for name, value in values.items():
        if value is not None:
            group.createVariable(name, "f8", value[0])[:] = value[1]
    group.sound_speed_m_s = 1500.0


def write_file(path, energy, /, modes=("mode-300",), **more):
    with netCDF4.Dataset(path, "w") as file:
        for mode in modes:
            add_sensor(file.createGroup(mode), energy, **more)
    return path


def speckled(energy, seed):
    return energy * np.random.default_rng(seed).exponential(size=energy.shape)


def rows_of(comparison, quantity, **where):
    return [row for row in comparison.rows if row["quantity"] == quantity and all(row[k] == v for k, v in where.items())]


def opened(path):
    file = echoes.open_file(str(path))
    return echoes.echoes_of(file, "mode-300", file["mode-300"])


@pytest.mark.parametrize("slope_deg", [0, 3])
@pytest.mark.parametrize("pulse_m", [0, 0.08])
def test_a_gaussian_beam_has_its_extents(tmp_path, slope_deg, pulse_m):
    file = write_file(tmp_path / "a.nc", gaussian_fan(slope_deg=slope_deg, pulse_m=pulse_m))
    comparison = measured.compare_measured(file, file, resamples=20)
    for sector, (low, high) in ((1, (30, 40)), (0, (50, 58)), (2, (50, 58))):
        # Squares of Gaussian widths add: beam, pulse, and the running mean over 5 bins of 0.1 degrees.
        away = np.radians((low + high) / 2)
        rate = DEPTH_M * np.tan(away) / np.cos(away) * np.pi / 180
        mean = FULL_WIDTH_OF_A_DEVIATION * 0.5 / np.sqrt(12)
        width = np.sqrt(WIDTH_DEG**2 + mean**2 + (pulse_m / rate) ** 2)
        where = dict(sector=sector, angle_from_deg=low)
        got = {q: rows_of(comparison, q, **where)[0]["measured"] for q in ("extent_3db", "extent_10db", "equivalent_width")}
        assert got["extent_3db"] == pytest.approx(width, rel=0.02)
        assert got["extent_10db"] == pytest.approx(width * np.sqrt(np.log2(10)), rel=0.02)
        assert got["equivalent_width"] == pytest.approx(width * np.sqrt(np.pi / np.log(2)) / 2, rel=0.02)


def test_the_fitted_seabed_is_the_plane_despite_outliers(tmp_path):
    energy = gaussian_fan(slope_deg=3)
    energy[:, 40:44, 100] = 1e3  # a strong target at 3 m in four beams
    known = opened(write_file(tmp_path / "a.nc", energy))
    seabed = echoes.seabed_of(known)
    theta = np.radians(ANGLES - 3)
    good = (np.abs(ANGLES - 3) > 25) & (np.abs(ANGLES) < 55)
    assert np.allclose(seabed.range[0][good], DEPTH_M / np.cos(theta[good]), rtol=2e-3)
    assert np.allclose(seabed.rate[0][good], (DEPTH_M * np.abs(np.tan(theta)) / np.cos(theta) * np.pi / 180)[good], rtol=0.02)
    assert np.allclose(seabed.incidence[0][good], np.degrees(np.abs(theta))[good], atol=0.6)
    assert not seabed.valid[:, 40:44].any() and seabed.valid[:, 50:].all()


def test_local_planes_ignore_a_few_wrong_ranges():
    theta = np.radians(ANGLES - 2)
    ranges = DEPTH_M / np.cos(theta)
    wrong = np.isin(np.arange(len(ANGLES)), (30, 31, 90, 91, 92, 200))
    fit, rate = echoes._local_planes(ANGLES, np.where(wrong, 0.85 * ranges, ranges), ~np.isin(ANGLES, ANGLES[5:8]))
    away = np.abs(ANGLES) > 10
    assert np.allclose(fit[away], ranges[away], rtol=1e-4)
    assert np.allclose(rate[away], (ranges * np.tan(theta))[away], rtol=1e-2)


def test_identical_files_agree_everywhere(tmp_path):
    file = write_file(tmp_path / "a.nc", speckled(gaussian_fan(4), 1))
    comparison = measured.compare_measured(file, file, resamples=30)
    # A file that states no speckle predicts Rayleigh amplitudes instead of its own.
    statistics = ("intensity_moment", "k_inverse_shape", "exponential_distance")
    known = [row for row in comparison.rows
             if row["kind"] == "predicted" and row["overlap"] and row["quantity"] not in statistics]
    assert len(known) > 50 and {row["overlap"] for row in known} == {"yes"}
    assert all(row["measured"] == row["simulated"] for row in known)
    assert all(set(row) == set(measured.COLUMNS) for row in comparison.rows)
    assert all(row["measured_low"] >= 0 for row in comparison.rows if row["unit"] in ("degree", "m") and row["overlap"])
    assert all(row["ratio_db"] == pytest.approx(0, abs=1e-9) for row in comparison.material)
    for quantity in ("level_offset", "cosine_exponent"):
        assert [row["measured"] for row in rows_of(comparison, quantity)] == pytest.approx([0] * 3, abs=1e-6)
    assert comparison.notes == ["mode-300: less than 3 beams in some incidence bands, which have no rows: sector 0, 30 to 40 "
                                "degrees; sector 1, 50 to 58 degrees; sector 2, 30 to 40 degrees"]


def test_wider_beams_do_not_overlap(tmp_path, monkeypatch):
    narrow = write_file(tmp_path / "a.nc", speckled(gaussian_fan(6), 1))
    monkeypatch.setitem(globals(), "WIDTH_DEG", 2.5)
    wide = write_file(tmp_path / "b.nc", speckled(gaussian_fan(6), 2))
    comparison = measured.compare_measured(wide, narrow, resamples=60)
    for row in rows_of(comparison, "extent_3db", sector=1):
        assert row["overlap"] == "no" and row["simulated_high"] < row["measured_low"]


def test_the_angular_response_is_fitted(tmp_path):
    def response(angle):
        cosine, lobe = np.cos(np.radians(angle)), 6 * np.exp(-(angle**2) / (2 * 4**2))
        return 5 * cosine**1.5 * 10 ** (lobe / 10)

    file = write_file(tmp_path / "a.nc", gaussian_fan(level=response))
    comparison = measured.compare_measured(file, write_file(tmp_path / "b.nc", gaussian_fan()), resamples=20,
                                           simulated_lambert_db=-20)
    fit = {q: rows_of(comparison, q, sector=1)[0] for q in
           ("level_offset", "cosine_exponent", "specular_level", "specular_width")}
    assert fit["level_offset"]["measured"] == pytest.approx(10 * np.log10(5), abs=0.15)
    assert fit["cosine_exponent"]["measured"] == pytest.approx(1.5, abs=0.1)
    assert fit["specular_level"]["measured"] == pytest.approx(6, abs=0.5)
    assert fit["specular_width"]["measured"] == pytest.approx(4, abs=0.5)
    assert {row["kind"] for row in fit.values()} == {"fitted"}
    for row in comparison.material:
        expected = 10 * np.log10(response(90 - row["grazing_deg"]))
        if 35 < row["grazing_deg"] < 70:
            assert row["ratio_db"] == pytest.approx(expected, abs=0.3)
        strength = -20 + 20 * np.log10(np.sin(np.radians(row["grazing_deg"]))) + row["ratio_db"]
        assert row["strength_db"] == pytest.approx(strength)
    assert not rows_of(comparison, "specular_level", sector=0)


@pytest.mark.parametrize("inverse_shape", [0, 0.5])
def test_the_samples_have_the_moment_of_their_distribution(tmp_path, inverse_shape):
    energy = speckled(gaussian_fan(30), 3)
    if inverse_shape:
        energy *= np.random.default_rng(4).gamma(1 / inverse_shape, inverse_shape, energy.shape)
    known = opened(write_file(tmp_path / "a.nc", energy))
    seabed = echoes.seabed_of(opened(write_file(tmp_path / "b.nc", gaussian_fan(30))))
    beams = figures.beams_in(known, 1, (30, 40))
    sums = {k: v.sum(axis=0) for k, v in figures.curve_sums(known, seabed, [(1, beams)])[0].items()}
    power = figures.curve(sums["angle_power"], sums["angle_count"])
    moment, inverse, distance = figures.sample_figures(
        {k: v.sum(axis=0) for k, v in figures.sample_sums(known, seabed, beams, power).items()})
    assert moment == pytest.approx(2 * (1 + inverse_shape), rel=0.06)
    assert inverse == pytest.approx(inverse_shape, abs=0.09)
    assert distance < 0.03 if not inverse_shape else distance > 0.05


def test_levels_of_water_and_arcs_are_those_of_the_file(tmp_path):
    energy = gaussian_fan(2)
    energy += 1e-4 * (RANGES < 7.6)
    energy[:, :, ::4] *= RANGES[::4] > 7.6  # a quarter is below the lowest code
    # 25 dB below the beam of the first return, in all beams
    first = np.abs(RANGES - DEPTH_M) < 0.1
    energy[:, :, first] = np.where(np.abs(ANGLES) < 2, 1, 10**-2.5)[:, None]
    beyond = np.where(RANGES > 17, 1e3, energy)  # must be ignored: not recorded
    file = write_file(tmp_path / "a.nc", beyond, recorded_m=(0.5, 17))
    comparison = measured.compare_measured(file, write_file(tmp_path / "b.nc", energy), resamples=20)
    for row in rows_of(comparison, "empty_fraction"):
        assert row["measured"] == pytest.approx(0.25, abs=0.01)
    # Peak 1 within one range bin of the seabed, for beams that the range bins resolve
    for row in rows_of(comparison, "water_level", sector=0):
        assert row["measured"] == pytest.approx(-41.25, abs=0.9)
        assert row["measured"] == pytest.approx(row["simulated"], abs=0.3)
    for row in rows_of(comparison, "arc"):
        if row["angle_from_deg"] >= 10:
            assert row["measured"] == pytest.approx(-25, abs=0.3)


@pytest.mark.parametrize("blocks", [6, 40])
def test_intervals_cover_the_mean(blocks):
    rng = np.random.default_rng(5)
    hits = []
    for _ in range(400):
        value, low, high = figures.intervals({"x": rng.gamma(4, 0.25, blocks), "n": np.ones(blocks)},
                                             lambda sums: sums["x"] / sums["n"], rng, 200)
        assert low <= value <= high
        hits.append(low[0] <= 1 <= high[0])
    assert 0.9 < np.mean(hits) < 0.98


def test_intervals_need_four_blocks():
    three = {"x": np.arange(3.0)}
    value, low, high = figures.intervals(three, lambda sums: sums["x"], np.random.default_rng(1), 50)
    assert value == 3 and np.isnan(low) and np.isnan(high)


def test_blocks_are_neighbouring_beams_of_one_side():
    beams = np.flatnonzero((np.abs(ANGLES) >= 30) & (np.abs(ANGLES) < 40))
    block = figures.blocks_of(ANGLES, beams, pings=2)
    assert (np.delete(block, beams) == -1).all() and set(block[beams]) == set(range(6))
    for k in range(6):
        mine = np.flatnonzero(block == k)
        assert (np.diff(mine) == 1).all() and 6 <= len(mine) <= 7 and len(set(np.sign(ANGLES[mine]))) == 1
    assert set(figures.blocks_of(ANGLES, beams, pings=5)[beams]) == set(range(4))
    assert set(figures.blocks_of(ANGLES, beams, pings=1000)[beams]) == {0, 1}


def test_crossings_are_interpolated_and_nearest_to_the_peak():
    x = np.arange(-5, 5.5)
    power = 10 ** (-np.abs([9, 1, 8, 4, 2, 0, 2, 4, 6, 8, 12]) / 10.0)
    assert figures.crossing_width(x, power, 3) == pytest.approx(3)
    assert np.isnan(figures.crossing_width(x, power, 20))
    assert np.isnan(figures.crossing_width(x, 0 * power, 3))


def test_received_data_take_the_place_of_energies(tmp_path):
    energy = gaussian_fan()
    with_received = write_file(tmp_path / "a.nc", energy, received=(("ping", "beam", "sample"), 2 * energy))
    comparison = measured.compare_measured(write_file(tmp_path / "b.nc", energy), with_received, resamples=20)
    assert rows_of(comparison, "level_offset", sector=1)[0]["measured"] == pytest.approx(-10 * np.log10(2))


def test_the_command_writes_its_files_and_replaces_only_those(tmp_path, capsys):
    modes = ("mode-200", "mode-300")
    mine = str(write_file(tmp_path / "a.nc", speckled(gaussian_fan(3), 1), modes=modes))
    other = str(write_file(tmp_path / "b.nc", speckled(gaussian_fan(2), 2), modes=modes[1:]))
    out = tmp_path / "out"
    call = [mine, other, "-o", str(out), "--resamples", "20", "--seed", "3"]
    assert measured.main(call) == 0
    printed = capsys.readouterr().out
    assert "seed 3" in printed and "intervals overlap for" in printed
    assert "only the measured file has 'mode-200': no rows" in printed
    names = {"table.csv", "report.md", "fitted_material.csv", ".tubefoot-files",
             *(f"mode-300-{name}.png" for name in ("fan", "extent", "response"))}
    assert {p.name for p in out.iterdir()} == names
    table = list(csv.DictReader((out / "table.csv").open()))
    assert tuple(table[0]) == measured.COLUMNS and {row["mode"] for row in table} == {"mode-300"}
    assert {row["kind"] for row in table} == {"fitted", "predicted"}
    report = (out / "report.md").read_text()
    assert "## extent_3db" in report and "## What does not agree" in report
    before = {p.name: p.read_bytes() for p in out.iterdir()}
    (out / "old.png").write_text("a picture of an earlier comparison")
    with (out / ".tubefoot-files").open("a") as file:
        file.write("old.png\n")
    assert measured.main(call) == 0
    assert {p.name: p.read_bytes() for p in out.iterdir()} == before
    (out / "mine.txt").write_text("precious")
    assert measured.main(call) == 1
    assert "contains 'mine.txt', which tubefoot did not write" in capsys.readouterr().err
    assert (out / "mine.txt").read_text() == "precious" and (out / "table.csv").exists()
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / ".tubefoot-files").write_text("echoes.nc\n")
    file = write_file(tmp_path / "run" / "echoes.nc", gaussian_fan(), modes=modes)
    assert measured.main([mine, str(file.parent), "-o", str(file.parent)]) == 1
    assert "contains the input file" in capsys.readouterr().err and file.exists()


@pytest.mark.parametrize("change, message", [
    (dict(slant_range_bounds=None), "sensor 'mode-300' has no variable 'slant_range_bounds'"),
    (dict(energy=None), "sensor 'mode-300' has no variable 'energy'"),
    (dict(beam_elevation=(("beam",), np.abs(ANGLES) - 89)), "differs in the angles of the beams in degrees of number"),
    (dict(beam_sector=(("beam",), np.full(len(ANGLES), 3))), "'beam_sector' of sensor 'mode-300' refers to sector 3"),
    (dict(beam_sector=(("ping",), np.zeros(2))), "has the dimensions ('ping',): expected ('beam',)"),
    (dict(slant_range=(("sample",), RANGES + 0.01)), "differs in the ranges of the bins in m of number"),
    (dict(energy=(("ping", "beam", "sample"), np.zeros((2, len(ANGLES), SAMPLES)))), "shows no seabed echo"),
])
def test_wrong_files_are_rejected(tmp_path, change, message):
    mine = write_file(tmp_path / "a.nc", gaussian_fan())
    other = write_file(tmp_path / "b.nc", gaussian_fan(), **change)
    with pytest.raises(tubefoot.InputError) as error:
        measured.compare_measured(mine, other, resamples=20)
    assert message in str(error.value) and str(other) in str(error.value) and "\n" not in str(error.value)


def test_files_and_sensors_that_do_not_exist_are_named(tmp_path):
    mine = write_file(tmp_path / "a.nc", gaussian_fan())
    other = write_file(tmp_path / "b.nc", gaussian_fan()[:, :, :500], modes=("mode-200", "mode-300"))
    (tmp_path / "text.nc").write_text("no file of this kind")
    for arguments, more, message in (
            ((mine, tmp_path / "none.nc"), {}, "none.nc: the file does not exist"),
            ((mine, tmp_path / "text.nc"), {}, "text.nc: the file is not a netCDF-4 file"),
            ((mine, other), dict(sensor="mode-200"), "no common sensor 'mode-200': the measured file has 'mode-300', the "
             "simulated file has 'mode-200', 'mode-300'"),
            ((mine, other), {}, "differs in the number of range bins: 500 instead of 620")):
        with pytest.raises(tubefoot.InputError, match=message):
            measured.compare_measured(*arguments, resamples=20, **more)
    for wrong in (dict(resamples=19), dict(seed=-1), dict(resamples=20.5)):
        with pytest.raises(tubefoot.UsageError):
            measured.compare_measured(mine, mine, **wrong)
