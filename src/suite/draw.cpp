// SPDX-License-Identifier: GPL-3.0-or-later
#include "suite/draw.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "files/file_hash.hpp"

namespace tubefoot {

Draw::Draw(std::optional<std::string> word, std::string_view scene) : word_(std::move(word)), scene_(scene) {}

std::uint64_t Draw::next() {
  Sha256 hash;
  // A word may have any characters, so that its length marks its end.
  const std::string word = word_.value_or("");
  hash.update(
      fmt::format("{} {} {} {} {}", word_ ? "validation" : "debug", word.size(), word, scene_, drawn_++));
  return std::stoull(hash.hex_digest().substr(0, 16), nullptr, 16);
}

double Draw::among(double published, double first, double last, double step) {
  if (!word_) return published;
  const auto values = static_cast<std::uint64_t>(std::llround((last - first) / step)) + 1;
  return first + static_cast<double>(next() % values) * step;
}

std::vector<std::size_t> Draw::order(std::vector<std::size_t> published) {
  if (word_)
    for (std::size_t k = published.size(); k > 1; --k) std::swap(published[k - 1], published[next() % k]);
  return published;
}

double Draw::number() { return static_cast<double>(next() >> 11) * 0x1p-53; }

}  // namespace tubefoot
