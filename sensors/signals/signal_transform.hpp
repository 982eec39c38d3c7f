// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/relief/fourier.hpp"

namespace tubefoot {

/// Discrete spectra of complex signals, with the sign of e^{-i omega t}: S_m = sum over n of s_n e^{+2 pi i
/// m n / N}. Thread-safe.
class SignalTransform {
 public:
  /// The length is the least power of two that is at least `length`.
  explicit SignalTransform(std::size_t length);

  std::size_t length() const { return length_; }
  /// Spectrum of a signal of at most length() samples, padded with zeros.
  std::vector<std::complex<double>> spectrum(std::span<const std::complex<double>> signal) const;
  /// The inverse, normalised.
  std::vector<std::complex<double>> signal(std::span<const std::complex<double>> spectrum) const;
  /// Frequency of a bin [Hz], within half the sampling rate of 0.
  double frequency_hz(std::size_t bin, double rate_hz) const;

 private:
  std::size_t length_;
  InverseTransforms transforms_;
};

}  // namespace tubefoot
