// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdlib>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "engine/signal/signal_channel.hpp"

namespace tubefoot {

/// Covariances of the samples of two channels. They are 0 for samples whose indices differ by more than
/// `reach`.
struct SampleCovariances {
  int samples = 0, reach = 0;
  std::vector<std::complex<double>> value;  ///< [(2 reach + 1) k + (j - k + reach)]

  std::complex<double> at(int k, int j) const {
    return std::abs(j - k) > reach || j < 0 || j >= samples
               ? 0
               : value[std::size_t((2 * reach + 1) * k + j - k + reach)];
  }
};

/// Covariances with the range samples of a recording as gates, sharp on both sides. Let y_a be the echo in
/// sample k of channel a and y_b the echo in sample j of channel b. Then
///     E[y_a y_b*] = integral of sigma A_a A_b e^{ik(L_a - L_b)} dA
/// over the part of the polygons that lies in sample k of a and in sample j of b. A is the amplitude of
/// density.hpp and of the beam patterns, and L the length of transmit and receive leg. Sample k of a channel
/// contains the channel's half paths from first + k step on. For a = b the result is the energies of
/// integrate_echo().
///
/// `patches`: common visibility of both channels (visible_polygons(), common_patches()). `tolerance`: error
/// of the integral over a polygon, relative to its value without interference; 1e-6 at best for scattering
/// models with kinks. Throws std::invalid_argument for samples without extent and for a negative wavenumber.
SampleCovariances gated_covariances(const VisiblePolygons& patches, const SignalChannel& a,
                                    const SignalChannel& b, const RangeSamples& samples,
                                    double wavenumber_rad_m, const EchoModel& model,
                                    double tolerance = 1e-10);

}  // namespace tubefoot
