// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "study/work_precision.hpp"

namespace tubefoot {

/// How much error somebody allows, in one of the two measures.
struct Tolerance {
  ErrorMeasure measure = ErrorMeasure::l1;
  double value = 0;  ///< relative L1 error, or RMS error of lit bins in dB
};

/// What an ordinary run can be asked for. Below, only a reference run knows its own error
/// (docs/reference.md).
inline constexpr double least_l1_tolerance = 1e-6, largest_l1_tolerance = 1;
inline constexpr double least_db_tolerance = 1e-5, largest_db_tolerance = 30;

/// "0.1dB" (RMS over lit bins), "1e-3" or "0.1%" (relative L1); a space before the unit and any case of "dB"
/// will do. Throws std::invalid_argument saying what was expected, also out of the range above.
Tolerance parse_tolerance(std::string_view text);

/// As parse_tolerance() reads it.
std::string to_text(const Tolerance& tolerance);

/// As a relative error of a single energy: of so many dB less, which is the smaller way.
double relative_error(const Tolerance& tolerance);

/// An error in words: "0.0421 dB" or "0.12 %".
std::string error_text(ErrorMeasure measure, double error);

}  // namespace tubefoot
