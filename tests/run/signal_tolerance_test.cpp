// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that signals of smooth surfaces keep `signal_tolerance` for pulses with flanks of any length, and
// without flanks. The comparisons are certified signals of the same scene and the image of a plane in
// closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "fixtures/program.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/array_files.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

/// Transmit pulse of an array, in the keys of the scene.
struct Waveform {
  double frequency_khz, bandwidth_khz, pulse_length_us, taper, sampling_khz;

  std::string keys(double tolerance) const {
    return fmt::format(
        "frequency_khz = {}\nbandwidth_khz = {}\npulse_length_us = {}\npulse_taper = {}\n"
        "sampling_frequency_khz = {}\nsignal_tolerance = {}\n",
        frequency_khz, bandwidth_khz, pulse_length_us, taper, sampling_khz, tolerance);
  }
};

struct SignalTolerance : testing::Test {
  TestFolder folder;

  ElementSignals signals_of(const std::string& text, std::optional<double> reference = {}) {
    const SceneDescription description = read_scene_file(folder.write("scene.toml", text));
    RunRequest request = request_of(description.run);
    request.reference_tolerance = reference;
    const auto survey = open_survey(description, Facets::as_given);
    SimulationStats stats;
    const std::vector<Recording> recordings = simulate(*survey, request, stats);
    return element_signals_of(recordings.at(0));
  }

  /// A plate over a tilted floor, and a sphere of facets.
  std::string scene(const Waveform& waveform, double tolerance, const std::string& surface = "") {
    folder.write("plate.obj",
                 "v -0.25 -0.125 -2\nv 0.125 -0.125 -2\nv 0.125 0.25 -2\nv -0.25 0.25 -2\nf 1 2 3 4\n"
                 "v -0.6 -0.5 -3\nv 0.75 -0.5 -3.1\nv 0.75 0.6 -3.2\nv -0.6 0.6 -3.1\nf 5 6 7 8\n");
    return fmt::format(
        "[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 40\n"
        "[[materials]]\nname = \"steel\"\nsmooth = true\nreflection = 0.75\n{}"
        "[[objects]]\nname = \"plate\"\nshape = \"mesh\"\nfile = \"plate.obj\"\nmaterial = \"steel\"\n"
        "[[objects]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.1\nchord_error_m = 0.04\n"
        "material = \"steel\"\nposition_m = [0.4, -0.2, -2.2]\n"
        "[trajectory]\nkind = \"fixed\"\nposition_m = [0, 0, 0]\n"
        "[[sensors]]\nname = \"sonar\"\nkind = \"array\"\ntilt_deg = 90\n"
        "range_min_m = 1.8\nrange_max_m = 3.9\nhorizontal_deg = 110\nvertical_deg = 110\n"
        "receivers_m = [[0, 0, 0], [0.25, 0.125, 0.0625]]\n{}",
        surface, waveform.keys(tolerance));
  }

  static double peak_of(const ElementSignals& signals) {
    double peak = 0;
    for (const Complex& value : signals.pressure) peak = std::max(peak, std::abs(value));
    return peak;
  }
  /// The largest difference that the bounds do not explain, relative to the peak.
  static double difference(const ElementSignals& plain, const ElementSignals& sure) {
    EXPECT_EQ(plain.pressure.size(), sure.pressure.size());
    double off = 0;
    std::size_t bounded = 0;
    for (std::size_t k = 0; k < sure.pressure.size(); ++k) {
      if (!std::isfinite(sure.bound[k].real())) continue;
      ++bounded;
      off = std::max(off, std::abs(plain.pressure[k] - sure.pressure[k]) - std::abs(sure.bound[k]));
    }
    EXPECT_EQ(bounded, sure.pressure.size());
    return off / peak_of(sure);
  }
};

// Pulses of one frequency and sweeps, few and many periods long, with flanks of all lengths.
TEST_F(SignalTolerance, IsKeptForFlanksOfAnyLength) {
  const Waveform waveforms[] = {{20, 0, 200, 0.1, 50}, {20, 0, 200, 0.5, 30},  {20, 0, 600, 0.02, 20},
                                {20, 8, 700, 0.1, 30}, {60, 30, 400, 0.1, 45}, {20, 0, 500, 1e-6, 20}};
  for (const Waveform& waveform : waveforms) {
    SCOPED_TRACE(waveform.keys(0));
    const ElementSignals sure = signals_of(scene(waveform, 1e-3), 1e-5);
    for (const double tolerance : {1e-3, 1e-6})
      EXPECT_LT(difference(signals_of(scene(waveform, tolerance)), sure), tolerance) << tolerance;
  }
}

// A rectangular pulse is discontinuous, and samples at the discontinuity have wide bounds.
TEST_F(SignalTolerance, IsKeptWithoutFlanks) {
  for (const Waveform& waveform : {Waveform{20, 0, 200, 0, 30}, Waveform{50, 10, 500, 0, 40}}) {
    SCOPED_TRACE(waveform.keys(0));
    const ElementSignals sure = signals_of(scene(waveform, 1e-3), 1e-5);
    for (const double tolerance : {1e-3, 1e-6})
      EXPECT_LT(difference(signals_of(scene(waveform, tolerance)), sure), tolerance) << tolerance;
  }
}

// The floor is so wide that its edge echoes come after its image: R / 2h g(t - 2h / c). For a rough floor
// and a long pulse, the factor e^{-q^2 s^2 / 2} remains.
TEST_F(SignalTolerance, HoldsForTheImageOfAPlane) {
  for (const double taper : {0.02, 0.1, 0.5, 1.0})
    for (const double roughness_m : {0.0, 0.004}) {
      const double frequency = 40e3, length = 800e-6, height = 2;
      const std::string text = fmt::format(
          "[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 40\n"
          "[[materials]]\nname = \"foam\"\nsmooth = true\nreflection = -0.5\nroughness_m = {}\n"
          "[[terrain]]\nkind = \"flat\"\nmaterial = \"foam\"\ncentre_m = [0, 0, -2]\nwidth_m = "
          "8\nlength_m = 8\n"
          "[trajectory]\nkind = \"fixed\"\nposition_m = [0, 0, 0]\n"
          "[[sensors]]\nname = \"sonar\"\nkind = \"array\"\ntilt_deg = 90\nrange_min_m = 1.9\n"
          "range_max_m = 2.6\nhorizontal_deg = 130\nvertical_deg = 130\nreceivers_m = [[0, 0, 0]]\n{}",
          roughness_m, Waveform{frequency / 1e3, 0, length * 1e6, taper, 40}.keys(1e-4));
      const ElementSignals signals = signals_of(text);
      const double k = 2 * pi * frequency / 1500, image = 2 * height,
                   left = std::exp(-2 * std::pow(k * roughness_m, 2));
      double off = 0, peak = 0;
      for (std::size_t n = 0; n < signals.samples(); ++n) {
        const double since = signals.sampling.time_s(n) - image / 1500;
        peak = std::max(peak, std::abs(signals.pressure[n]));
        // Near its ends the pulse of a rough floor is a mean over its heights.
        const double flank = taper * length / 2, spread = roughness_m > 0 ? 6 * 2 * roughness_m / 1500 : 0;
        if (spread > 0 && (since < flank + spread || since > length - flank - spread)) continue;
        const Complex truth = -0.5 / image * std::pow(10, -0.04 * image / 20) * left *
                              std::polar(1.0, k * image) *
                              baseband_at(signals.waveform, signals.sampling.baseband_hz, since);
        off = std::max(off, std::abs(signals.pressure[n] - truth));
      }
      EXPECT_GT(peak, 0);
      // A rough piece of the floor has one angle for the whole piece.
      EXPECT_LT(off, (roughness_m > 0 ? 0.02 : 1e-4) * peak) << taper << ' ' << roughness_m;
    }
}

}  // namespace
}  // namespace tubefoot
