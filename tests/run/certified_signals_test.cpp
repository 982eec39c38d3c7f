// SPDX-License-Identifier: GPL-3.0-or-later
// Compares certified signals of smooth surfaces with integrals over the surfaces. The integrals use neither
// edge forms nor the visibility computation of the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <optional>

#include "files/input_error.hpp"
#include "fixtures/program.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/formats/signals_netcdf.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/recordings/echo_reader.hpp"
#include "sensors/signals/matched_filter.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

constexpr double sound_speed = 1500, floor_z = -3, plate_z = -2, tolerance = 1e-6;

/// A rectangle in a level plane.
struct Rectangle {
  double z, west, south, east, north;
  double reflection;

  /// Returns the part of a lower plane that the rectangle hides from a point source or from a receiver.
  Rectangle shadow(glm::dvec3 of, double on_z) const {
    const double far = (of.z - on_z) / (of.z - z);
    return {on_z,
            of.x + far * (west - of.x),
            of.y + far * (south - of.y),
            of.x + far * (east - of.x),
            of.y + far * (north - of.y),
            1};
  }
  Rectangle common(const Rectangle& o) const {
    return {z,
            std::max(west, o.west),
            std::max(south, o.south),
            std::min(east, o.east),
            std::min(north, o.north),
            reflection};
  }
};
const Rectangle bottom{floor_z, -0.5, -0.5, 0.75, 0.5, -0.5},
    plate{plate_z, -0.25, -0.125, 0.125, 0.25, 0.75};

std::string scene_of_plate(const std::string& sensor, const std::string& more = "") {
  return fmt::format(
      "[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 40\n"
      "[[materials]]\nname = \"foam\"\nsmooth = true\nreflection = -0.5\n"
      "[[materials]]\nname = \"steel\"\nsmooth = true\nreflection = 0.75\n"
      "[[terrain]]\nkind = \"flat\"\nmaterial = \"foam\"\ncentre_m = [0.125, 0, -3]\nwidth_m = "
      "1.25\nlength_m = 1\n"
      "[[objects]]\nname = \"plate\"\nshape = \"mesh\"\nfile = \"plate.obj\"\nmaterial = \"steel\"\n"
      "[trajectory]\nkind = \"fixed\"\nposition_m = [0, 0, 0]\n{}"
      "[[sensors]]\nname = \"sonar\"\nkind = \"array\"\ntilt_deg = 90\nfrequency_khz = 20\n"
      "range_min_m = 1.8\nrange_max_m = 3.7\nhorizontal_deg = 110\nvertical_deg = 110\n"
      "receivers_m = [[0, 0, 0], [0.25, 0.125, 0.0625]]\nsampling_frequency_khz = 30\n{}",
      more, sensor);
}

/// A pulse at a distance: the signal at one time as a function of path length, and its derivative.
struct Reception {
  const ElementSignals& signals;
  double time_s;

  std::pair<Complex, Complex> of(double path) const {
    const TransmitWaveform& w = signals.waveform;
    const double s = time_s - path / sound_speed, length = w.duration_s;
    if (s < 0 || s > length) return {};
    const double flank = w.taper * length / 2, height = 1 / std::sqrt(length * (1 - 0.625 * w.taper)),
                 from_end = std::min(s, length - s);
    double envelope = height, slope = 0;
    if (from_end < flank) {
      envelope = height * (1 - std::cos(pi * from_end / flank)) / 2;
      slope = height * pi / flank * std::sin(pi * from_end / flank) / 2 * (s < length / 2 ? 1 : -1);
    }
    const double fade = 0.04 * std::log(10) / 20, rate = (w.stop_hz - w.start_hz) / length;
    const Complex phase = std::polar(std::exp(-fade * path), 2 * pi * signals.sampling.baseband_hz * time_s -
                                                                 2 * pi * (w.start_hz + rate * s / 2) * s);
    const Complex value = envelope * phase;
    return {value, -(slope * phase - Complex(0, 2 * pi) * (w.start_hz + rate * s) * value) / sound_speed -
                       fade * value};
  }
  /// Returns whether the ends of the pulse and of its flanks lie outside of all path lengths of a
  /// rectangle.
  bool is_even(double shortest, double longest) const {
    const double length = signals.waveform.duration_s, flank = signals.waveform.taper * length / 2;
    for (const double border : {0.0, flank, length - flank, length}) {
      if (border == flank && signals.waveform.taper == 1) continue;
      const double path = (time_s - border) * sound_speed;
      if (path > shortest - 1e-6 && path < longest + 1e-6) return false;
    }
    return true;
  }
};

/// Kirchhoff's integral over a rectangle, by Gauss rules: docs/notes/smooth-surfaces.md (1).
class SurfaceIntegral {
 public:
  SurfaceIntegral(const Rectangle& over, glm::dvec3 from, glm::dvec3 to) {
    constexpr std::array<double, 5> node{0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                         0.8650633666889845, 0.9739065285171717},
        weight{0.2955242247147529, 0.2692667193099963, 0.2190863625159820, 0.1494513491505806,
               0.0666713443086881};
    const auto rule = [&](double low, double high) {
      std::vector<std::pair<double, double>> all;
      const int parts = int(std::ceil((high - low) / 0.03));
      const double half = (high - low) / parts / 2;
      for (int k = 0; k < parts; ++k)
        for (std::size_t n = 0; n < 10; ++n)
          all.emplace_back(low + (2 * k + 1) * half + (n < 5 ? -1 : 1) * half * node[n % 5],
                           half * weight[n % 5]);
      return all;
    };
    if (!(over.west < over.east && over.south < over.north)) return;
    for (const auto& [x, wx] : rule(over.west, over.east))
      for (const auto& [y, wy] : rule(over.south, over.north)) {
        const glm::dvec3 there(x, y, over.z);
        const double r = glm::distance(from, there), s = glm::distance(there, to);
        const double up_tx = from.z - over.z, up_rx = to.z - over.z;
        points_.push_back(
            {r + s, up_tx / (r * r) + up_rx / (s * s), up_tx / r + up_rx / s, wx * wy / (4 * pi * r * s)});
        shortest_ = std::min(shortest_, r + s);
        longest_ = std::max(longest_, r + s);
      }
  }
  Complex at(const Reception& received, bool& even) const {
    if (points_.empty()) return 0;
    even = even && received.is_even(shortest_ - 0.03, longest_ + 0.03);
    Complex sum = 0;
    for (const Point& p : points_) {
      const auto [value, slope] = received.of(p.path);
      sum += p.weight * (value * p.first - slope * p.second);
    }
    return sum;
  }

 private:
  struct Point {
    double path, first, second, weight;
  };
  std::vector<Point> points_;
  double shortest_ = 1e9, longest_ = 0;
};

struct CertifiedSignals : testing::Test {
  TestFolder folder;
  std::unique_ptr<const Survey> survey;
  std::vector<Recording> recordings;

  CertifiedSignals() {
    folder.write("plate.obj",
                 "v -0.25 -0.125 -2\nv 0.125 -0.125 -2\nv 0.125 0.25 -2\nv -0.25 0.25 -2\nf 1 2 3 4\n");
  }
  ElementSignals signals_of(const std::string& text, std::optional<double> requested = tolerance) {
    const SceneDescription description = read_scene_file(folder.write("scene.toml", text));
    RunRequest request = request_of(description.run);
    request.reference_tolerance = requested;
    survey = open_survey(description, Facets::as_given);
    SimulationStats stats;
    recordings = simulate(*survey, request, stats);
    return element_signals_of(recordings.at(0));
  }
  static bool is_open(Complex bound) { return std::isinf(bound.real()) && std::isinf(bound.imag()); }

  /// Compares the signals with the surfaces minus the parts that higher surfaces hide. These are hidden
  /// from the transmitter, and from another position: that of the receiver of the sensor, or of each
  /// element.
  static void expect_held(const ElementSignals& signals, const std::vector<Rectangle>& surfaces,
                          const std::function<std::optional<glm::dvec3>(std::size_t)>& received_from) {
    ASSERT_EQ(signals.bound.size(), signals.pressure.size());
    for (std::size_t e = 0; e < signals.receivers(); ++e) {
      const glm::dvec3 from(0), to = signals.array.receivers_m[e];
      std::vector<std::pair<double, SurfaceIntegral>> parts;
      for (const Rectangle& surface : surfaces) {
        std::vector<Rectangle> dark;
        for (const Rectangle& above : surfaces) {
          if (above.z <= surface.z) continue;
          dark.push_back(above.shadow(from, surface.z));
          if (const auto place = received_from(e)) dark.push_back(above.shadow(*place, surface.z));
        }
        for (std::size_t some = 0; some < std::size_t(1) << dark.size(); ++some) {  // of a union
          Rectangle part = surface;
          double sign = 1;
          for (std::size_t i = 0; i < dark.size(); ++i)
            if (some >> i & 1) {
              part = part.common(dark[i]);
              sign = -sign;
            }
          parts.emplace_back(sign * surface.reflection, SurfaceIntegral(part, from, to));
        }
      }
      double peak = 0;
      for (std::size_t k = 0; k < signals.samples(); ++k)
        peak = std::max(peak, std::abs(signals.channel(0, e)[k]));
      ASSERT_GT(peak, 0.1);
      std::size_t even_ones = 0;
      for (std::size_t k = 0; k < signals.samples(); ++k) {
        const Reception received{signals, signals.sampling.time_s(k)};
        bool even = true;
        Complex truth = 0;
        for (const auto& [factor, part] : parts) truth += factor * part.at(received, even);
        const Complex value = signals.channel(0, e)[k], bound = signals.bound[e * signals.samples() + k];
        // The quadrature intervals contain no border of the pulse, or contain one with a kink.
        const double rules = (even ? 1e-12 : 2e-6) * peak;
        ASSERT_LE(std::abs(value.real() - truth.real()), bound.real() + rules) << e << ' ' << k;
        ASSERT_LE(std::abs(value.imag() - truth.imag()), bound.imag() + rules) << e << ' ' << k;
        ASSERT_LE(std::max(bound.real(), bound.imag()), tolerance * std::max(std::abs(value), 1e-3 * peak))
            << e << ' ' << k;
        if (even && std::abs(truth) > 1e-3 * peak) ++even_ones;
      }
      EXPECT_GE(even_ones, 3u);
    }
  }
};

std::optional<glm::dvec3> from_nowhere(std::size_t) { return {}; }

// Law Q12: a plate before a floor, both smooth, a Hann pulse of one frequency with an offset mixing
// frequency, and absorption.
TEST_F(CertifiedSignals, HoldIntegralsOverWhatIsSeen) {
  expect_held(signals_of(scene_of_plate(
                  "bandwidth_khz = 0\npulse_length_us = 600\npulse_taper = 1\nbaseband_khz = 21\n")),
              {bottom, plate}, from_nowhere);
}

// Law Q12 for a chirp with short flanks and shadows of both ends.
TEST_F(CertifiedSignals, OfAChirpThatEachElementSeesForItself) {
  const ElementSignals signals = signals_of(
      scene_of_plate("bandwidth_khz = 8\npulse_length_us = 700\npulse_taper = 0.3\nown_sights = true\n"));
  expect_held(signals, {bottom, plate}, [&](std::size_t e) { return signals.array.receivers_m[e]; });
}

// Law Q12: another plate partly hides a plate over the floor, for a separate receiver.
TEST_F(CertifiedSignals, OfPlatesThatHideEachOtherFromASeparateReceiver) {
  const Rectangle lower{-2.5, -0.125, 0, 0.375, 0.375, 0.75};
  folder.write(
      "plate.obj",
      "v -0.25 -0.125 -2\nv 0.125 -0.125 -2\nv 0.125 0.25 -2\nv -0.25 0.25 -2\n"
      "v -0.125 0 -2.5\nv 0.375 0 -2.5\nv 0.375 0.375 -2.5\nv -0.125 0.375 -2.5\nf 1 2 3 4\nf 5 6 7 8\n");
  const glm::dvec3 place(0.5, 0.25, 0.125);
  expect_held(signals_of(scene_of_plate(
                  "bandwidth_khz = 4\npulse_length_us = 500\npulse_taper = 1\nreceiver_arm_m = [0.5, "
                  "0.25, 0.125]\n")),
              {bottom, plate, lower}, [&](std::size_t) { return place; });
}

// The signals of the ordinary run are unchanged, and lie about as close as their stated error.
TEST_F(CertifiedSignals, AreThoseOfAnOrdinaryRun) {
  const std::string text = scene_of_plate(
      "bandwidth_khz = 8\npulse_length_us = 700\npulse_taper = 0.8\nsignal_tolerance = 1e-5\n");
  const ElementSignals sure = signals_of(text), plain = signals_of(text, std::nullopt);
  EXPECT_TRUE(plain.bound.empty());
  ASSERT_EQ(sure.pressure.size(), plain.pressure.size());
  double peak = 0, off = 0;
  for (std::size_t k = 0; k < sure.pressure.size(); ++k) {
    peak = std::max(peak, std::abs(sure.pressure[k]));
    off = std::max(off, std::abs(sure.pressure[k] - plain.pressure[k]));
  }
  EXPECT_LT(off, 1e-3 * peak);
}

// A rough floor: samples that may contain its speckle have no bound. Earlier samples are the same as
// without the floor.
TEST_F(CertifiedSignals, AreOpenWhereRoughSurfacesAreReceived) {
  const std::string sensor = "bandwidth_khz = 0\npulse_length_us = 600\npulse_taper = 1\n";
  std::string rough = scene_of_plate(sensor);
  const std::string smooth_floor = "name = \"foam\"\nsmooth = true\nreflection = -0.5\n";
  rough.replace(rough.find(smooth_floor), smooth_floor.size(), "name = \"foam\"\nlambert_db = -20\n");
  const ElementSignals both = signals_of(scene_of_plate(sensor)), some = signals_of(rough);
  std::size_t open = 0, sure = 0;
  for (std::size_t e = 0; e < some.receivers(); ++e) {
    const double to_floor_m = 6 + some.array.receivers_m[e].z;
    for (std::size_t k = 0; k < some.samples(); ++k) {
      const Complex bound = some.bound[e * some.samples() + k];
      if (some.sampling.time_s(k) > to_floor_m / sound_speed &&
          some.sampling.time_s(k) < to_floor_m / sound_speed + 600e-6) {
        EXPECT_TRUE(is_open(bound)) << k;
      }
      if (is_open(bound)) {
        ++open;
        continue;
      }
      // The echo of the floor comes after one more metre per leg, and only its samples are excluded.
      EXPECT_LE(std::abs(some.channel(0, e)[k] - both.channel(0, e)[k]), 2 * std::abs(bound) + 1e-9);
      if (std::abs(some.channel(0, e)[k]) > 0.01) ++sure;
    }
  }
  EXPECT_GT(open, 20u);
  EXPECT_GT(sure, 20u);
}

// The second receiver lies in the plane of a wall. Neither the receiver nor doubles can decide its side.
// The samples of the wall have no bound, and the others keep theirs.
TEST_F(CertifiedSignals, AWallThatAReceiverLiesInTakesNothingElseAway) {
  const std::string sensor = "bandwidth_khz = 0\npulse_length_us = 600\npulse_taper = 1\n";
  folder.write("wall.obj", "v 0.25 -0.4 -2.9\nv 0.25 0.4 -2.9\nv 0.25 0 -2.4\nf 1 2 3\n");
  const ElementSignals without = signals_of(scene_of_plate(sensor)),
                       with =
                           signals_of(scene_of_plate(sensor,
                                                     "[[objects]]\nname = \"wall\"\nshape = \"mesh\"\nfile = "
                                                     "\"wall.obj\"\nmaterial = \"steel\"\n"));
  double loudest = 0, loudest_open = 0;
  std::size_t open = 0, sure = 0;
  for (std::size_t k = 0; k < with.samples(); ++k) {
    loudest = std::max(loudest, std::abs(without.channel(0, 1)[k]));
    if (!is_open(with.bound[with.samples() + k])) {
      ++sure;
      continue;
    }
    ++open;
    loudest_open = std::max(loudest_open, std::abs(with.channel(0, 1)[k]));
  }
  EXPECT_GT(open, 10u);
  EXPECT_GT(sure, 10u);
  EXPECT_GT(loudest_open, 0.2 * loudest);
}

// Without any echo there is no strongest sample, and no quadrature converges to zero.
TEST_F(CertifiedSignals, OfSurfacesThatReflectNothingAreSilent) {
  std::string text = scene_of_plate("bandwidth_khz = 0\npulse_length_us = 600\npulse_taper = 1\n");
  for (const std::string reflection : {"-0.5\n", "0.75\n"})
    text.replace(text.find("reflection = " + reflection), 13 + reflection.size(), "reflection = 0\n");
  const ElementSignals silent = signals_of(text);
  for (const Complex& pressure : silent.pressure) EXPECT_EQ(pressure, 0.0);
  for (const Complex& bound : silent.bound) EXPECT_EQ(bound, 0.0);
}

TEST_F(CertifiedSignals, AreOpenWhereNothingIsProven) {
  const std::string sensor = "bandwidth_khz = 0\npulse_length_us = 600\npulse_taper = 1\n";
  const auto expect_open = [&](const std::string& text) {
    const ElementSignals signals = signals_of(text);
    for (std::size_t k = 0; k < signals.pressure.size(); ++k)
      EXPECT_TRUE(is_open(signals.bound[k]) || signals.pressure[k] == 0.0) << k;
    EXPECT_GT(std::ranges::count_if(signals.bound, is_open), 20);
  };
  expect_open(scene_of_plate(sensor + "transmit_pattern = \"gaussian\"\ntransmit_beam_width_deg = 60\n"));
  std::string fluid = scene_of_plate(sensor);
  for (const std::string name : {"-0.5\n", "0.75\n"})
    fluid.replace(fluid.find("reflection = " + name), 13 + name.size(),
                  "reflection = " + name + "roughness_m = 0.001\n");
  expect_open(fluid);
  expect_open(scene_of_plate(sensor, "[sea_surface]\nheight_m = 2\n[paths]\norder = 2\n"));
}

// The file contains the bounds and returns them. It has no bounds for filtered samples.
TEST_F(CertifiedSignals, BoundsAreInTheFile) {
  const ElementSignals sure =
      signals_of(scene_of_plate("bandwidth_khz = 0\npulse_length_us = 600\npulse_taper = 1\n"));
  write_signals(folder.path() / "signals.nc", sure);
  const ElementSignals read = read_signals(folder.path() / "signals.nc");
  EXPECT_EQ(read.pressure, sure.pressure);
  EXPECT_EQ(read.bound, sure.bound);
  EXPECT_TRUE(matched_filtered(sure).bound.empty());
  try {  // as `compare` reads
    read_echo_file(folder.path() / "signals.nc");
    FAIL() << "a file of signals was taken for one of echoes";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("name the echoes.nc of the same run"), std::string::npos);
  }
}

}  // namespace
}  // namespace tubefoot
