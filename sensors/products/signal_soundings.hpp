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

/// What a fan across the track finds in one ping, by beam.
struct SignalSoundings {
  RangeSamples ranges;                                    ///< of the samples
  std::vector<std::complex<double>> beams;                ///< [beam][sample]
  std::vector<std::optional<Sounding>> amplitude, phase;  ///< by either method; none where it found nothing
  std::vector<double> amplitude_sigma_m, phase_sigma_m;   ///< standard deviations of their ranges

  /// The surer of the two.
  std::optional<Sounding> best(std::size_t beam) const;
};

/// Beams of the fan, and the seabed in them: amplitudes after the gain r^2 as of other multibeams
/// (BottomFinder), phases between beams of the receivers' two halves to port and to starboard
/// (split_beam_zero), about the range of the amplitude, as far as a level seabed is in the main lobe.
/// `compressed`: one ping. Numbers of pings are 0.
SignalSoundings signal_soundings(const ElementSignals& compressed, const SignalMultibeam& multibeam,
                                 const SignalInterpolator& interpolator);

/// Half the width of the main lobe of such an array and window at half power, in sines across the track.
double half_lobe_sine(const ElementSignals& signals, const std::vector<double>& weights);

}  // namespace tubefoot
