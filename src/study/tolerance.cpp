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

[[noreturn]] void refuse(std::string_view text) {
  throw std::invalid_argument(fmt::format(
      "'{}' is no tolerance: write 0.1dB (RMS error of lit bins), or 1e-3 or 0.1% (relative L1 error)",
      text));
}

}  // namespace

Tolerance parse_tolerance(std::string_view text) {
  Tolerance tolerance;
  // from_chars reads "nan" and "inf", too: the ranges below refuse them.
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), tolerance.value);
  if (error != std::errc()) refuse(text);
  std::string unit;
  for (const char* c = end; c != text.data() + text.size(); ++c)
    if (*c != ' ' || !unit.empty()) unit += static_cast<char>(std::tolower(static_cast<unsigned char>(*c)));
  if (unit == "db") {
    tolerance.measure = ErrorMeasure::rms_db;
    if (!(tolerance.value >= least_db_tolerance && tolerance.value <= largest_db_tolerance))
      throw std::invalid_argument(fmt::format("'{}': a tolerance in dB is {:g}dB to {:g}dB", text,
                                              least_db_tolerance, largest_db_tolerance));
    return tolerance;
  }
  if (unit == "%")
    tolerance.value /= 100;
  else if (!unit.empty())
    refuse(text);
  if (!(tolerance.value >= least_l1_tolerance && tolerance.value <= largest_l1_tolerance))
    throw std::invalid_argument(
        fmt::format("'{}': a relative tolerance is {:g} to {:g}; less than that is for 'run --reference'",
                    text, least_l1_tolerance, largest_l1_tolerance));
  return tolerance;
}

std::string to_text(const Tolerance& tolerance) {
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
