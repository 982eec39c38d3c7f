// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "sensors/signals/transmit_waveform.hpp"

namespace tubefoot {

/// Interpolates a sampled signal with a sinc kernel under a Kaiser window, cut off at half the sampling
/// rate. Kaiser's formula (1974) gives the number of taps.
class SignalInterpolator {
 public:
  /// For signals within `band` of half the sampling rate, 0 < band < 1. `error` bounds the error relative to
  /// the largest modulus for one frequency, 1e-9 <= error < 0.5. Throws std::invalid_argument for other
  /// values, and if more than 512 taps are necessary.
  explicit SignalInterpolator(double band = 0.8, double error = 1e-5);

  /// Throws std::invalid_argument with advice if the waveform sweeps beyond the band, because the error
  /// bound would not hold.
  void check_holds(const TransmitWaveform& waveform, const SignalSampling& sampling) const;

  std::size_t taps() const { return taps_; }
  double band() const { return band_; }
  double error() const { return error_; }

  /// Value at `position`, in samples from the first. The signal is 0 before its first and after its last
  /// sample.
  std::complex<double> at(std::span<const std::complex<double>> signal, double position) const;
  /// Adds factor times the signal `shift` samples later: out[k] += factor signal(k + shift).
  void add_shifted(std::span<const std::complex<double>> signal, double shift, std::complex<double> factor,
                   std::span<std::complex<double>> out) const;

 private:
  /// Weights of the samples from floor(position) - taps / 2 + 1 on. `fraction` is position -
  /// floor(position).
  void weights(double fraction, double* into) const;

  double band_, error_;
  std::size_t taps_ = 0;
  std::vector<double> table_;  ///< [phase][tap]; phases -1 to phases + 1
};

}  // namespace tubefoot
