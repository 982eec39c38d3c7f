// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "sensors/beamforming/signal_interpolator.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Positions of an image's pixels: first + column * column_step + row * row_step, in the scene's frame.
struct PixelPlane {
  glm::dvec3 first_m{0}, column_step_m{0}, row_step_m{0};
  std::size_t columns = 0, rows = 0;

  glm::dvec3 at(std::size_t column, std::size_t row) const {
    return first_m + column_step_m * static_cast<double>(column) + row_step_m * static_cast<double>(row);
  }
};

struct BackProjection {
  std::vector<double> ping_weights{};      ///< across the synthetic aperture; empty: all 1
  std::vector<double> receiver_weights{};  ///< empty: all 1
  /// Half-width of the beam about abeam. A pixel uses the pings that see it within this angle. The cosine
  /// between its direction and the vehicle's forward axis is then at most the sine of the angle. The
  /// direction counts from the middle of the receivers. Unset: all pings.
  std::optional<double> half_beam_rad{};
  bool spreading_undone = true;  ///< multiplies by both ranges, so that a point has its strength f
  /// A real aperture: a pixel uses only the ping that sees it nearest to abeam (the first of equal ones).
  /// The result is the image of sidescan lines at these positions.
  bool nearest_abeam_only = false;
};

/// I(x) = sum over pings p and receivers e of w_p w_e s_pe(tau) e^{-i omega_b tau} / sum of the weights,
/// [row][column], with the exact two-way delay tau of x. The delay has the motion model of the signals
/// (stop-and-hop or moving vehicles) and applies to the middle of the waveform. The signals should be
/// matched filtered. Pixels that no ping sees are 0. The cost is pixels x pings x receivers. The result is
/// bitwise the same for any number of threads. Throws std::invalid_argument for invalid arguments.
std::vector<std::complex<double>> back_projected(const ElementSignals& signals, const PixelPlane& plane,
                                                 const SignalInterpolator& interpolator,
                                                 const BackProjection& how = {});

}  // namespace tubefoot
