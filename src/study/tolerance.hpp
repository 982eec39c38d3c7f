// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "study/work_precision.hpp"

namespace tubefoot {

/// Permitted error in one of the two measures.
struct Tolerance {
  ErrorMeasure measure = ErrorMeasure::l1;
  double value = 0;  ///< relative L1 error, or RMS error of insonified bins in dB
};

/// Range of tolerances of an ordinary run. Smaller tolerances need a reference run, which bounds its own
/// error (docs/notes/certified-energies.md).
inline constexpr double least_l1_tolerance = 1e-6, largest_l1_tolerance = 1;
inline constexpr double least_db_tolerance = 1e-5, largest_db_tolerance = 30;

/// Parses "0.1dB" (RMS over insonified bins), "1e-3" or "0.1%" (relative L1). A space before the unit and
/// any case of "dB" are permitted. Throws std::invalid_argument with the expected format, also outside of
/// the range above.
Tolerance parse_tolerance(std::string_view text);

/// Formats a tolerance for parse_tolerance().
std::string to_text(const Tolerance& tolerance);

/// Returns the relative error of a single energy that corresponds to the tolerance. A tolerance in dB is
/// taken as a reduction, which gives the smaller relative error.
double relative_error(const Tolerance& tolerance);

/// Formats an error: "0.0421 dB" or "0.12 %".
std::string error_text(ErrorMeasure measure, double error);

}  // namespace tubefoot
