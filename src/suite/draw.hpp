// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// The variable parameters of a scene of the benchmark suite. The debug set uses the published values. A
/// validation set draws the values from a seed word.
/// Each scene draws independently of the selection of scenes. The same word gives the same values on every
/// machine.
class Draw {
 public:
  Draw(std::optional<std::string> word, std::string_view scene);

  /// Returns `published`, or one of first, first + step, ..., last with equal probability.
  double among(double published, double first, double last, double step);
  /// Returns a permutation of 0 to n - 1: the published one, or a random one.
  std::vector<std::size_t> order(std::vector<std::size_t> published);
  /// Returns a number of the uniform distribution on [0, 1). It is pseudo-random in the debug set, too.
  double number();

 private:
  std::uint64_t next();
  std::optional<std::string> word_;
  std::string scene_;
  std::uint64_t drawn_ = 0;
};

}  // namespace tubefoot
