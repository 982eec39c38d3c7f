// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/number_list.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "files/usage_error.hpp"

namespace tubefoot {

std::vector<std::string> split_at(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<double> numbers_of(const std::string& text, const NumberList& list) {
  constexpr std::size_t most_values = 1000000;
  const auto fail = [&](const std::string& why) {
    throw UsageError(fmt::format("{} '{}': {}; expected {}", list.option, text, why, list.expected));
  };
  const auto value = [&](const std::string& word) {
    const std::optional<double> result = list.read(word);
    if (!result) fail(fmt::format("'{}' is not a number", word));
    return *result;
  };
  std::vector<double> values;
  const std::vector<std::string> range = split_at(text, ':');
  if (range.size() == 1) {
    for (const std::string& word : split_at(text, ',')) values.push_back(value(word));
  } else {
    if (range.size() > 3 || (range.size() == 2 && !list.step)) fail("the step is missing");
    const double first = value(range[0]), last = value(range[1]);
    const double by = range.size() == 3 ? value(range[2]) : *list.step;
    if (!(by > 0)) fail("the step is not above 0");
    if (last < first) fail("the last value is less than the first");
    const double count = std::floor((last - first) / by * (1 + 1e-12) + 1e-9) + 1;
    if (!(count <= static_cast<double>(most_values)))
      fail(fmt::format("the range has more than {} values", most_values));
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
      values.push_back(first + static_cast<double>(k) * by);
  }
  for (std::size_t k = 1; k < values.size(); ++k)
    if (!(values[k] > values[k - 1])) fail("the values do not increase");
  return values;
}

}  // namespace tubefoot
