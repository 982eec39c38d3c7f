// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "sensors/beamforming/back_projection.hpp"
#include "sensors/detection/bottom_detection.hpp"
#include "sensors/recordings/navigation.hpp"
#include "sensors/signals/aperture_window.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Beams in one plane, their axes evenly spread in angle; every sample is focused at its own distance.
struct SignalFan {
  enum class Plane { forward, across_track };
  Plane plane = Plane::forward;
  std::size_t beams = 96;
  double opening_rad = std::numbers::pi / 2;  ///< between the outermost axes, about ahead or straight down
  double depression_rad = 0;                  ///< of a forward fan
  ApertureWindow window{};                    ///< across the receivers, to starboard

  std::vector<double> angles_rad() const;      ///< of the axes, to starboard
  std::vector<glm::dvec3> directions() const;  ///< on the vehicle's axes
};

/// A beam abeam a ping, as a sidescan has them.
struct SignalSidescan {
  enum class Sides { port, starboard, both };
  Sides sides = Sides::starboard;
  double depression_rad = 0;  ///< of the beams' axes
  ApertureWindow window{};    ///< across the receivers, forward
};

/// Soundings of a fan across the track.
struct SignalMultibeam {
  SignalFan fan{SignalFan::Plane::across_track, 128, 2 * std::numbers::pi / 3};
  DetectionRule rule{};    ///< of amplitudes
  bool split_beam = true;  ///< by phase as well, of the receivers' two halves: the surer one counts
};

/// A synthetic aperture, beside what the same pings give without one.
struct SignalAperture {
  static constexpr std::size_t most_pixels = std::size_t{1} << 22;
  PixelPlane plane;
  ApertureWindow ping_window{};           ///< across all pings
  ApertureWindow receiver_window{};       ///< across the receivers, forward
  std::optional<double> half_beam_rad{};  ///< BackProjection::half_beam_rad
};

/// Phases between two receivers, or two groups of them.
struct SignalInterferogram {
  std::vector<std::size_t> upper,
      lower;                      ///< numbers of receivers; the phase is of upper times lower's conjugate
  glm::dvec3 direction{1, 0, 0};  ///< on the vehicle, of the groups' beams
  std::size_t looks_range = 4, looks_pings = 4;  ///< samples and pings that are averaged
};

/// Which files and pictures signals become. What is not set is not made.
struct SignalProducts {
  std::string name = "sonar";  ///< files are called <name>-...
  bool elements = true;        ///< picture of what the elements receive
  std::optional<SignalFan> fan{};
  std::optional<SignalSidescan> sidescan{};
  std::optional<SignalMultibeam> multibeam{};
  std::optional<SignalAperture> aperture{};
  std::optional<SignalInterferogram> interferogram{};
  bool jsf = false;           ///< the sidescan's beams as <name>.jsf
  bool sonar_netcdf = false;  ///< the fan's, else the multibeam's, as <name>-sonar.nc

  ApertureWindow range_window{};              ///< across a chirp's band
  double interpolation_error = 1e-4;          ///< SignalInterpolator
  std::size_t picture_ping = 0;               ///< of pictures of one ping
  std::vector<std::uint32_t> ping_numbers{};  ///< what pings are called; empty: from 0
};

/// What there is of signals, without them.
struct SignalCounts {
  std::size_t pings = 0, receivers = 0, samples = 0;
};

/// The fan whose complex beams go into SONAR-netCDF4: across the track, the fan's own, else the soundings'.
/// Null where there is none.
const SignalFan* fan_of_complex_beams(const SignalProducts& products);

/// Throws std::invalid_argument, saying what to do, for products that such signals do not make: no beams,
/// fans beyond a half circle, one receiver where halves are asked for, receivers that are not there, windows
/// across no extent, pixels or looks too many, a format without its beams.
void check(const SignalProducts& products, const ElementArray& array, const SignalCounts& counts);

/// Window across an array along an axis of the vehicle; empty for an even one. Throws std::invalid_argument
/// where the receivers do not extend along it, or where Chebyshev's meets uneven spacing.
std::vector<double> weights_along(const ElementArray& array, glm::dvec3 axis, const ApertureWindow& window);

/// For waveforms as they are sampled: takes the band that the waveform needs, at least half.
SignalInterpolator interpolator_for(const TransmitWaveform& waveform, const SignalSampling& sampling,
                                    double error);

}  // namespace tubefoot
