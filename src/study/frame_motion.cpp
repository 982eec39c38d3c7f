// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/frame_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tubefoot {
namespace {

constexpr double least_overlap = 0.25;
constexpr double none = -std::numeric_limits<double>::infinity();

std::size_t seen(const PixelMap& map) {
  return static_cast<std::size_t>(
      std::count_if(map.values.begin(), map.values.end(), [](double v) { return !std::isnan(v); }));
}

/// Sums over the pixels that two pictures have in common.
struct Shared {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(double x, double y) {
    if (std::isnan(x) || std::isnan(y)) return;
    n += 1;
    a += x;
    b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  double correlation() const {
    const double spread = (aa - a * a / n) * (bb - b * b / n);
    return spread > 0 ? (ab - a * b / n) / std::sqrt(spread) : 0;
  }
};

/// Correlations of all integer shifts of at most `most` pixels in each direction.
class Correlations {
 public:
  Correlations(const PixelMap& first, const PixelMap& second, int most) : most_(most) {
    const double least = least_overlap * static_cast<double>(seen(first));
    for (int r = -most; r <= most; ++r)
      for (int c = -most; c <= most; ++c) {
        const Shared shared = overlap(first, second, c, r);
        values_.push_back(shared.n >= least ? shared.correlation() : none);
      }
  }
  double at(int c, int r) const {
    if (std::abs(c) > most_ || std::abs(r) > most_) return none;
    const auto side = static_cast<std::size_t>(2 * most_ + 1);
    return values_[static_cast<std::size_t>(r + most_) * side + static_cast<std::size_t>(c + most_)];
  }

 private:
  static Shared overlap(const PixelMap& first, const PixelMap& second, int c, int r) {
    Shared shared;
    const auto columns = static_cast<int>(first.columns), rows = static_cast<int>(first.rows);
    for (int y = std::max(0, -r); y < std::min(rows, rows - r); ++y)
      for (int x = std::max(0, -c); x < std::min(columns, columns - c); ++x)
        shared.add(first.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y)),
                   second.at(static_cast<std::size_t>(x + c), static_cast<std::size_t>(y + r)));
    return shared;
  }

  int most_;
  std::vector<double> values_;
};

/// Returns the offset of the vertex of a parabola through three neighbours from the middle one, which is
/// the largest.
double vertex(double before, double middle, double after) {
  const double bend = before - 2 * middle + after;
  return std::isfinite(before) && std::isfinite(after) && bend < 0 ? (before - after) / (2 * bend) : 0;
}

}  // namespace

FrameShift find_shift(const PixelMap& first, const PixelMap& second, int most_shift) {
  if (first.columns != second.columns || first.rows != second.rows ||
      first.values.size() != first.columns * first.rows || second.values.size() != first.values.size())
    throw std::invalid_argument("both frames must have the same size");
  if (most_shift < 1 || static_cast<std::size_t>(most_shift) >= std::min(first.columns, first.rows))
    throw std::invalid_argument(
        "the largest shift must be at least one pixel and less than the size of the frame");
  if (seen(first) == 0 || seen(second) == 0) throw std::invalid_argument("a frame has no visible pixels");

  const Correlations all(first, second, most_shift);
  int c = 0, r = 0;
  for (int y = -most_shift; y <= most_shift; ++y)
    for (int x = -most_shift; x <= most_shift; ++x)
      if (all.at(x, y) > all.at(c, r)) c = x, r = y;
  FrameShift shift;
  shift.columns = c + vertex(all.at(c - 1, r), all.at(c, r), all.at(c + 1, r));
  shift.rows = r + vertex(all.at(c, r - 1), all.at(c, r), all.at(c, r + 1));
  shift.correlation = all.at(c, r);
  return shift;
}

}  // namespace tubefoot
