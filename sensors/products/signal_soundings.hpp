// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "sensors/beamforming/signal_interpolator.hpp"
#include "sensors/detection/sounding.hpp"
#include "sensors/products/signal_products.hpp"

namespace tubefoot {

/// Detections of a fan across the track in one ping, by beam.
struct SignalSoundings {
  RangeSamples ranges;                                    ///< of the samples
  std::vector<std::complex<double>> beams;                ///< [beam][sample]
  std::vector<std::optional<Sounding>> amplitude, phase;  ///< by either method; empty without a detection
  std::vector<double> amplitude_sigma_m, phase_sigma_m;   ///< standard deviations of their ranges

  /// The detection with the smaller standard deviation.
  std::optional<Sounding> best(std::size_t beam) const;
};

/// Computes the beams of the fan, and detects the seabed in them. The amplitude method applies the gain r^2
/// as for other multibeams (BottomFinder). The phase method uses beams of the receivers' halves to port and
/// to starboard (split_beam_zero). It searches about the range of the amplitude, over the part of a level
/// seabed in the main lobe. `compressed`: one ping. Ping numbers in the result are 0.
SignalSoundings signal_soundings(const ElementSignals& compressed, const SignalMultibeam& multibeam,
                                 const SignalInterpolator& interpolator);

/// Half-power half-width of the main lobe of such an array and window, as a sine across the track.
double half_lobe_sine(const ElementSignals& signals, const std::vector<double>& weights);

}  // namespace tubefoot
