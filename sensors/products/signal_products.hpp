// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Requests for products that are computed from signals: fans of beams, sidescan, soundings, synthetic
// apertures and interferograms, with their windows and checks.

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

/// Equiangular beams in one plane. Every sample is focused at its own distance.
struct SignalFan {
  enum class Plane { forward, across_track };
  Plane plane = Plane::forward;
  std::size_t beams = 96;
  double opening_rad = std::numbers::pi / 2;  ///< between the outermost axes, about forward or straight down
  double depression_rad = 0;                  ///< of a forward fan
  ApertureWindow window{};                    ///< across the receivers, to starboard

  std::vector<double> angles_rad() const;      ///< of the axes, to starboard
  std::vector<glm::dvec3> directions() const;  ///< on the vehicle's axes
};

/// A beam abeam of each ping, as in a sidescan sonar.
struct SignalSidescan {
  enum class Sides { port, starboard, both };
  Sides sides = Sides::starboard;
  double depression_rad = 0;  ///< of the beams' axes
  ApertureWindow window{};    ///< across the receivers, forward
};

/// Soundings of a fan across the track.
struct SignalMultibeam {
  SignalFan fan{SignalFan::Plane::across_track, 128, 2 * std::numbers::pi / 3};
  DetectionRule rule{};    ///< for amplitudes
  bool split_beam = true;  ///< adds detection by phase of the receivers' two halves; the result with the
                           ///< smaller deviation applies
};

/// A synthetic aperture, and the result of the same pings without one.
struct SignalAperture {
  static constexpr std::size_t most_pixels = std::size_t{1} << 22;
  PixelPlane plane;
  ApertureWindow ping_window{};           ///< across all pings
  ApertureWindow receiver_window{};       ///< across the receivers, forward
  std::optional<double> half_beam_rad{};  ///< BackProjection::half_beam_rad
};

/// Phases between two receivers, or two groups of receivers.
struct SignalInterferogram {
  std::vector<std::size_t> upper,
      lower;                      ///< numbers of receivers; the phase is that of upper times the conjugate
                                  ///< of lower
  glm::dvec3 direction{1, 0, 0};  ///< direction of the groups' beams on the vehicle
  std::size_t looks_range = 4, looks_pings = 4;  ///< numbers of averaged samples and pings
};

/// The requested files and pictures of signals. Products that are not set are not written.
struct SignalProducts {
  std::string name = "sonar";  ///< prefix of the file names, <name>-...
  bool elements = true;        ///< picture of the elements' signals
  std::optional<SignalFan> fan{};
  std::optional<SignalSidescan> sidescan{};
  std::optional<SignalMultibeam> multibeam{};
  std::optional<SignalAperture> aperture{};
  std::optional<SignalInterferogram> interferogram{};
  bool jsf = false;           ///< writes the sidescan's beams as <name>.jsf
  bool sonar_netcdf = false;  ///< writes the beams of the fan, or else of the multibeam, as <name>-sonar.nc

  ApertureWindow range_window{};              ///< across a chirp's band
  double interpolation_error = 1e-4;          ///< of the SignalInterpolator
  std::size_t picture_ping = 0;               ///< for pictures of one ping
  std::vector<std::uint32_t> ping_numbers{};  ///< numbers of the pings; empty: from 0
};

/// Numbers of pings, receivers and samples of signals.
struct SignalCounts {
  std::size_t pings = 0, receivers = 0, samples = 0;
};

/// The fan whose complex beams go into SONAR-netCDF4: the fan product if it is across the track, otherwise
/// the fan of the soundings. Null if there is none.
const SignalFan* fan_of_complex_beams(const SignalProducts& products);

/// Throws std::invalid_argument with advice for products that are impossible with such signals: no beams,
/// fans beyond a half circle, or halves of a single receiver. Others are missing receivers, windows across
/// no extent, too many pixels or looks, and a format without its beams.
void check(const SignalProducts& products, const ElementArray& array, const SignalCounts& counts);

/// Window across an array along an axis of the vehicle; empty for a uniform one. Throws
/// std::invalid_argument if the receivers have no extent along it, or for a Chebyshev window with nonuniform
/// spacing.
std::vector<double> weights_along(const ElementArray& array, glm::dvec3 axis, const ApertureWindow& window);

/// Interpolator for sampled waveforms. Its band is that of the waveform, and at least half of the sampling
/// band.
SignalInterpolator interpolator_for(const TransmitWaveform& waveform, const SignalSampling& sampling,
                                    double error);

}  // namespace tubefoot
