// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace tubefoot {

/// Converts levels or amplitudes to unsigned codes of a file, in uniform steps. The code is (value - bottom)
/// / step, rounded to the nearest integer, halves up, and limited to 0 and the largest code. Code 0 means
/// `bottom` and below, including no echo (minus infinity dB). The largest code means `top` and above.
class Quantiser {
 public:
  /// `bits`: 1 to 16. Throws std::invalid_argument unless bottom < top are finite.
  Quantiser(double bottom, double top, int bits);

  /// DIDSON: 8 bits over 90 dB. `bottom_db` is the level of code 0.
  static Quantiser didson(double bottom_db = 0) { return {bottom_db, bottom_db + 90, 8}; }
  /// ARIS: 8 bits over 80 dB.
  static Quantiser aris(double bottom_db = 0) { return {bottom_db, bottom_db + 80, 8}; }
  /// XTF, 16-bit unsigned samples of linear amplitude; code 65535 is `full_scale`.
  static Quantiser xtf_amplitude(double full_scale) { return {0, full_scale, 16}; }
  /// XTF, 16-bit unsigned samples of levels [dB].
  static Quantiser xtf_levels(double bottom_db, double top_db) { return {bottom_db, top_db, 16}; }

  /// Throws std::invalid_argument for NaN.
  std::uint16_t code(double value) const;
  /// The value that a code represents.
  double value(std::uint16_t code) const { return bottom_ + code * step_; }
  double step() const { return step_; }
  /// The largest |value(code(v)) - v| for v between bottom and top, except for rounding of doubles.
  double error_bound() const { return step_ / 2; }
  std::uint16_t largest_code() const { return largest_; }

 private:
  double bottom_, step_;
  std::uint16_t largest_;
};

}  // namespace tubefoot
