// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tolerance.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {
namespace {

/// Largest tolerance without a unit. Larger numbers are probably meant in dB or in percent.
constexpr double largest_bare_tolerance = 0.1;

[[noreturn]] void refuse(std::string_view text) {
  throw std::invalid_argument(
      fmt::format("'{}' is not a tolerance: expected 0.1dB (RMS error of bins with an echo), or 1e-3 or 0.1% "
                  "(relative L1 error)",
                  text));
}

}  // namespace

Tolerance parse_tolerance(std::string_view text) {
  Tolerance tolerance;
  // from_chars also reads "nan" and "inf"; the ranges below reject them.
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), tolerance.value);
  if (error != std::errc()) refuse(text);
  std::string unit;
  for (const char* c = end; c != text.data() + text.size(); ++c)
    if (*c != ' ' || !unit.empty()) unit += static_cast<char>(std::tolower(static_cast<unsigned char>(*c)));
  if (unit == "db") {
    tolerance.measure = ErrorMeasure::rms_db;
    if (!(tolerance.value >= least_db_tolerance && tolerance.value <= largest_db_tolerance))
      throw std::invalid_argument(fmt::format("'{}': a tolerance in dB must be {:g}dB to {:g}dB", text,
                                              least_db_tolerance, largest_db_tolerance));
    return tolerance;
  }
  if (unit == "%")
    tolerance.value /= 100;
  else if (!unit.empty())
    refuse(text);
  else if (tolerance.value > largest_bare_tolerance && tolerance.value <= 100)
    throw std::invalid_argument(
        fmt::format("'{3}' without a unit is a relative error of {1:g} %: write {0:g}dB (RMS error of bins "
                    "with an echo) or {0:g}%{2}",
                    tolerance.value, 100 * tolerance.value,
                    tolerance.value <= largest_l1_tolerance
                        ? fmt::format(", or {:g}% for this relative error", 100 * tolerance.value)
                        : std::string(),
                    text));
  if (!(tolerance.value >= least_l1_tolerance && tolerance.value <= largest_l1_tolerance))
    throw std::invalid_argument(fmt::format(
        "'{}': a relative tolerance must be {:g} to {:g}: use 'run --reference' for smaller errors", text,
        least_l1_tolerance, largest_l1_tolerance));
  return tolerance;
}

std::string to_text(const Tolerance& tolerance) {
  if (tolerance.measure == ErrorMeasure::l1 && tolerance.value > largest_bare_tolerance)
    return fmt::format("{:g}%", 100 * tolerance.value);
  return fmt::format("{:g}{}", tolerance.value, tolerance.measure == ErrorMeasure::rms_db ? "dB" : "");
}

double relative_error(const Tolerance& tolerance) {
  return tolerance.measure == ErrorMeasure::rms_db ? -std::expm1(-tolerance.value * std::numbers::ln10 / 10)
                                                   : tolerance.value;
}

std::string error_text(ErrorMeasure measure, double error) {
  return measure == ErrorMeasure::rms_db ? fmt::format("{:.3g} dB", error)
                                         : fmt::format("{:.3g} %", 100 * error);
}

}  // namespace tubefoot
