// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// What a scene of the benchmark suite leaves open. In the debug set every value is the one that the pack
/// publishes; in a validation set it is drawn by a word that somebody chooses, for each scene apart, so that
/// a scene is the same whichever others are asked for. Same word, same values, on every machine.
class Draw {
 public:
  Draw(std::optional<std::string> word, std::string_view scene);

  /// `published`, or one of first, first + step, ..., last, all as likely.
  double among(double published, double first, double last, double step);
  /// 0 to n - 1 in the order that is published, or in any.
  std::vector<std::size_t> order(std::vector<std::size_t> published);
  /// Evenly spread over 0 to 1, 1 excluded: scattered things are scattered in the debug set, too.
  double number();

 private:
  std::uint64_t next();
  std::optional<std::string> word_;
  std::string scene_;
  std::uint64_t drawn_ = 0;
};

}  // namespace tubefoot
