// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdlib>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "engine/signal/signal_channel.hpp"

namespace tubefoot {

/// Covariances of the samples of two channels. Samples farther from each other than `reach` have none.
struct SampleCovariances {
  int samples = 0, reach = 0;
  std::vector<std::complex<double>> value;  ///< [(2 reach + 1) k + (j - k + reach)]

  std::complex<double> at(int k, int j) const {
    return std::abs(j - k) > reach || j < 0 || j >= samples
               ? 0
               : value[std::size_t((2 * reach + 1) * k + j - k + reach)];
  }
};

/// With the range samples of a recording as gates, sharp on both sides: of the echoes y_a in sample k of
/// channel a and y_b in sample j of channel b,
///     E[y_a y_b*] = integral over the patches, what of them lies in sample k of a and in sample j of b, of
///                   sigma A_a A_b e^{ik(L_a - L_b)} dA,
/// A the amplitudes that density.hpp and patterns make, L the transmit and receive legs; sample k holds half
/// ways from first + k step on, of each channel its own. One channel with itself: the energies of
/// integrate().
///
/// `patches`: what both channels see (visible_polygons(), common_patches()). `tolerance`: of an integral over
/// a patch, relative to what it would be without interference; 1e-6 at best with laws that have corners.
/// Throws std::invalid_argument for samples that have no extent or a wavenumber that is negative.
SampleCovariances gated_covariances(const VisiblePolygons& patches, const SignalChannel& a,
                                    const SignalChannel& b, const RangeSamples& samples,
                                    double wavenumber_rad_m, const EchoModel& model,
                                    double tolerance = 1e-10);

}  // namespace tubefoot
