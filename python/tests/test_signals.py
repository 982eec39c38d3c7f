# SPDX-License-Identifier: GPL-3.0-or-later
"""Signals of elements: arrays without copies, files, beams and back-projection against NumPy's own."""

import netCDF4
import numpy as np
import pytest
import xarray

import tubefoot

FREQUENCY, SPEED = 100e3, 1500.0
WAVELENGTH = SPEED / FREQUENCY
TARGETS = np.array([[3.0, 1, -20], [-6, 2, -21]])
STRENGTHS = np.array([1, 0.3 - 0.4j])
RECEIVERS = np.c_[(np.arange(8) - 3.5) * WAVELENGTH / 2, np.zeros(8), np.zeros(8)]


@pytest.fixture
def signals():
    return tubefoot.point_signals(
        TARGETS, STRENGTHS, receivers=RECEIVERS, waveform=tubefoot.Waveform(95e3, 105e3, 2e-3, 1.0),
        baseband_frequency=FREQUENCY, sample_rate=40e3, samples=400, first_sample=0.024, ping_times=[0, 0.5, 1],
        track_times=[0, 2], positions=[[0, 0, 0], [0, 1, 0]])


def pulse(t):
    """Complex baseband of the waveform, time factor exp(-i omega t)."""
    envelope = (1 - np.cos(2 * np.pi * t / 2e-3)) / 2 / np.sqrt(2e-3 * 3 / 8)
    phase = 2 * np.pi * ((95e3 - FREQUENCY) * t + 0.5 * 5e6 * t**2)
    return np.where((t >= 0) & (t <= 2e-3), envelope, 0) * np.exp(-1j * phase)


def test_points_are_the_closed_form(signals):
    expected = np.zeros((3, 8, 400), complex)
    t = 0.024 + np.arange(400) / 40e3
    for target, strength in zip(TARGETS, STRENGTHS):
        for p, north in enumerate([0, 0.25, 0.5]):
            place = np.array([0, north, 0])
            out, home = np.linalg.norm(target - place), np.linalg.norm(target - place - RECEIVERS, axis=1)[:, None]
            delay = (out + home) / SPEED
            expected[p] += strength / (out * home) * pulse(t - delay) * np.exp(2j * np.pi * FREQUENCY * delay)
    assert signals.pressure == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert signals.sample_times == pytest.approx(t, abs=1e-15) and list(signals.ping_times) == [0, 0.5, 1]
    assert signals.positions[:, 1] == pytest.approx([0, 0.25, 0.5]) and (signals.attitudes == [1, 0, 0, 0]).all()
    assert (signals.receivers == RECEIVERS).all() and (signals.transmitter == 0).all()
    assert signals.waveform == (95e3, 105e3, 2e-3, 1) and signals.stop_and_hop and not signals.is_matched_filtered


def test_arrays_are_the_programs_memory_and_live_as_long_as_they_are_held(signals):
    pressure = signals.pressure
    assert pressure.dtype == np.complex128 and not pressure.flags.writeable and not pressure.flags.owndata
    assert signals.pressure.__array_interface__["data"] == pressure.__array_interface__["data"]
    before = pressure.copy()
    del signals
    assert (pressure == before).all()


def test_a_file_is_read_by_xarray_and_comes_back(signals, tmp_path):
    signals.write(tmp_path / "signals.nc")
    with xarray.open_dataset(tmp_path / "signals.nc") as file:
        assert file.pressure.dims == ("ping", "receiver", "sample", "complex")
        values = np.ascontiguousarray(file.pressure.values).view(complex)[..., 0]  # no copy
        assert (values == signals.pressure).all()
        assert (file.attrs["baseband_frequency"], file.attrs["sample_rate"]) == (FREQUENCY, 40e3)
        assert (file.ping_start_time == signals.ping_times).all() and (file.sample_time == signals.sample_times).all()
    again = tubefoot.signals(tmp_path / "signals.nc")
    assert again.pressure.tobytes() == signals.pressure.tobytes() and again.waveform == signals.waveform
    first = (tmp_path / "signals.nc").read_bytes()
    again.write(tmp_path / "signals.nc")
    with netCDF4.Dataset(tmp_path / "signals.nc") as file:
        assert file["pressure"].shape == (3, 8, 400, 2)
    assert (tmp_path / "signals.nc").read_bytes() == first
    with pytest.raises(tubefoot.UsageError):
        signals.write(tmp_path / "nowhere" / "signals.nc" / "")


def test_a_strangers_file_with_the_other_sign(signals, tmp_path):
    signals.write(tmp_path / "a.nc")
    with xarray.open_dataset(tmp_path / "a.nc") as file:
        own = file.load()
    own.assign_attrs(time_factor="exp(+i omega t)").to_netcdf(tmp_path / "b.nc")
    assert (tubefoot.signals(tmp_path / "b.nc").pressure == signals.pressure.conj()).all()
    own.rename(pressure="sound").to_netcdf(tmp_path / "c.nc")
    with pytest.raises(tubefoot.InputError, match=r"c\.nc.*'pressure' is missing.*docs/output-files.md"):
        tubefoot.signals(tmp_path / "c.nc")


def test_beams_are_delays_and_sums(signals):
    compressed = signals.matched_filtered()
    assert compressed.is_matched_filtered and not signals.is_matched_filtered
    directions = TARGETS / np.linalg.norm(TARGETS, axis=1)[:, None]
    weights = tubefoot.window_weights("hann", 8)
    near = compressed.beams(directions, weights=weights, near_field=True, band=0.5)
    assert near.shape == (3, 2, 400) and near.dtype == np.complex128
    for k, target in enumerate(TARGETS):
        sample = round((2 * np.linalg.norm(target) / SPEED - 0.024) * 40e3)
        assert abs(np.abs(near[0, k]).argmax() - sample) <= 1
    # By phases, written out: sums over the spectrum of each receiver.
    far = compressed.beams(directions, [1], weights=weights, by_phase=True)
    length = 512
    f = FREQUENCY + np.fft.fftfreq(length, 1 / 40e3)
    spectra = np.fft.ifft(compressed.pressure[1], length) * length  # the sign of exp(-i omega t)
    for k, direction in enumerate(directions):
        later = -(RECEIVERS @ direction)[:, None] / SPEED
        own = np.fft.fft(np.sum(weights[:, None] * spectra * np.exp(-2j * np.pi * f * later), 0)) / length / weights.sum()
        assert far[0, k] == pytest.approx(own[:400], abs=1e-12)
    assert compressed.beams(directions, [1], weights=weights, error=1e-6) == pytest.approx(far, abs=1e-5 * np.abs(far).max())


def test_back_projection_gives_points_their_strength(signals):
    compressed = signals.matched_filtered()
    picture = compressed.back_projected(TARGETS[0], [0.1, 0, 0], [0, 0.1, 0], 3, 2, band=0.5)
    assert picture.shape == (2, 3)
    assert abs(picture[0, 0] - STRENGTHS[0]) < 2e-2  # the other point's side lobes


@pytest.mark.parametrize("change, text", [
    (dict(sample_rate=8e3), "more than half of the sampling rate"),
    (dict(samples=40), "longer than the record of 0.001 s per ping"),
    (dict(strengths=[1]), "one strength per target"),
    (dict(receivers=[[1, 2]]), r"receivers must have the shape \(N, 3\)"),
    (dict(ping_times=[3]), "ping 0 starts at 3 s, but the track has poses only from 0 s to 2 s"),
    (dict(sound_speed=-1), "sound speed is -1"),
])
def test_what_makes_no_signals(change, text):
    asked = dict(targets=TARGETS, strengths=STRENGTHS, receivers=RECEIVERS, waveform=tubefoot.Waveform(95e3, 105e3, 2e-3),
                 baseband_frequency=FREQUENCY, sample_rate=40e3, samples=400, track_times=[0, 2],
                 positions=[[0, 0, 0], [0, 1, 0]])
    with pytest.raises(ValueError, match=text):
        tubefoot.point_signals(**(asked | change))


def test_what_makes_no_beams(signals):
    with pytest.raises(ValueError, match="there is no ping 3: the signals have 3 pings"):
        signals.beams([[0, 0, -1]], [3])
    for wrong in [-1, 0.5]:
        with pytest.raises(ValueError, match="a ping's number must be a whole number of 0 or more, not"):
            signals.beams([[0, 0, -1]], [wrong])
        with pytest.raises(ValueError, match="columns must be a whole number"):
            signals.matched_filtered().back_projected([0, 0, -5], [1, 0, 0], [0, 1, 0], wrong, 1)
    with pytest.raises(ValueError, match="reference: expected finite numbers, but element 2 is nan"):
        signals.beams([[0, 0, -1]], reference=[0, 0, np.nan])
    with pytest.raises(ValueError, match="at most pi / 2"):
        signals.matched_filtered().back_projected([0, 0, -5], [1, 0, 0], [0, 1, 0], 1, 1, half_beam_rad=np.nan)
    with pytest.raises(ValueError, match="unknown window 'han'"):
        tubefoot.window_weights("han", 4)
    with pytest.raises(TypeError, match="did you mean 'weights'"):
        signals.beams([[0, 0, -1]], weigths=[1])


def test_a_run_hands_out_what_its_arrays_record(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text("""
[water]
sound_speed_m_s = 1500
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
centre_m = [0, 6, -6]
width_m = 2
length_m = 2
[trajectory]
kind = "line"
start_m = [0, 0, 0]
end_m = [0, 1, 0]
[[sensors]]
name = "elements"
kind = "array"
tilt_deg = 45
frequency_khz = 30
bandwidth_khz = 6
pulse_length_us = 500
range_min_m = 7
range_max_m = 11
horizontal_deg = 40
vertical_deg = 40
receivers = 3
pings = 2
ping_interval_s = 0.5
[[sensors]]
name = "camera"
kind = "imaging"
tilt_deg = 45
""")
    result = tubefoot.run(scene, output=tmp_path / "out")
    ours, files = result["elements"].signals, tubefoot.signals(tmp_path / "out" / "elements-signals.nc")
    assert ours.pressure.shape[:2] == (2, 3) and np.abs(ours.pressure).max() > 0
    assert ours.pressure.tobytes() == files.pressure.tobytes() and ours.waveform == files.waveform
    assert (ours.positions == files.positions).all() and (ours.receivers == files.receivers).all()
    assert result["elements"].signals is ours and not ours.pressure.flags.owndata
    assert result["elements"][1].signals is ours
    assert result["camera"].signals is None and tubefoot.open(tmp_path / "out")["elements"].signals is None
    pressure = ours.pressure
    del result, ours
    assert np.isfinite(pressure).all()
