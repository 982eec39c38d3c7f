// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "sensors/signals/transmit_waveform.hpp"

namespace tubefoot {

/// Values of a sampled signal between its samples: a sinc under Kaiser's window, cut off at half the sampling
/// rate. The number of taps follows from what is asked for by Kaiser's formula (1974).
class SignalInterpolator {
 public:
  /// Of signals within `band` of half the sampling rate, 0 < band < 1, with an error of at most `error` of
  /// their largest modulus for one frequency, 1e-9 <= error < 0.5. Throws std::invalid_argument for others,
  /// and for more than 512 taps.
  explicit SignalInterpolator(double band = 0.8, double error = 1e-5);

  /// Throws std::invalid_argument, saying what to do, for a sweep beyond its band: the error would be
  /// another.
  void check_holds(const TransmitWaveform& waveform, const SignalSampling& sampling) const;

  std::size_t taps() const { return taps_; }
  double band() const { return band_; }
  double error() const { return error_; }

  /// At `position`, counted in samples from the first; what lies before and behind the signal is 0.
  std::complex<double> at(std::span<const std::complex<double>> signal, double position) const;
  /// Adds factor times the signal `shift` samples later, out[k] += factor signal(k + shift).
  void add_shifted(std::span<const std::complex<double>> signal, double shift, std::complex<double> factor,
                   std::span<std::complex<double>> out) const;

 private:
  /// Of the samples floor(position) - taps / 2 + 1 and on, where `fraction` is what floor() took away.
  void weights(double fraction, double* into) const;

  double band_, error_;
  std::size_t taps_ = 0;
  std::vector<double> table_;  ///< [phase][tap]; phases -1 to phases + 1
};

}  // namespace tubefoot
