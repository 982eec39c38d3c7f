// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "sensors/beamforming/signal_interpolator.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Places of a picture's pixels: first + column * column_step + row * row_step, in the scene's frame.
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
  /// A pixel is made of the pings that it lies no further from abeam of than this, as seen from the middle of
  /// the receivers: the cosine to the vehicle's forward axis is at most the sine of it. Unset: of all.
  std::optional<double> half_beam_rad{};
  bool spreading_undone = true;  ///< by out times home: a point has its strength f
  /// A real aperture: a pixel is made of one ping, of those the one that it lies nearest to abeam of (the
  /// first of equal ones). That is what a sidescan's lines make of this place.
  bool nearest_abeam_only = false;
};

/// I(x) = sum over pings p and receivers e of w_p w_e s_pe(tau) e^{-i omega_b tau} / sum of the weights,
/// [row][column], with the exact two-way delay tau of x: of stop-and-hop or of vehicles on the way, as the
/// signals are; of what is sent in the middle of the waveform. The signals should be matched filtered. Pixels
/// that no ping sees are 0. Work is pixels x pings x receivers; the same bits for any number of threads.
/// Throws std::invalid_argument for what makes no picture.
std::vector<std::complex<double>> back_projected(const ElementSignals& signals, const PixelPlane& plane,
                                                 const SignalInterpolator& interpolator,
                                                 const BackProjection& how = {});

}  // namespace tubefoot
