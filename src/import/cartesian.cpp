// SPDX-License-Identifier: GPL-3.0-or-later
// Resamples a fan in a Cartesian picture to beams and range samples. Each bin is the mean of the pixels at
// many points of the bin, so that a pixel counts in proportion to its overlap.
#include "import/cartesian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "files/usage_error.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Sines and cosines of the centres of equal parts of a beam, for at least a given number of parts.
class DirectionTable {
 public:
  DirectionTable(double left_rad, double right_rad) : left_(left_rad), wide_(right_rad - left_rad) {}
  double wide() const { return wide_; }
  /// Returns a table whose size is a power of two.
  const std::vector<std::pair<double, double>>& of(int least) const {
    std::size_t power = 0;
    while (1 << power < least) ++power;
    if (power >= tables_.size()) tables_.resize(power + 1);
    auto& table = tables_[power];
    for (int k = 0; table.size() < std::size_t{1} << power; ++k) {
      const double azimuth = left_ + (k + 0.5) * wide_ / (1 << power);
      table.emplace_back(std::sin(azimuth), std::cos(azimuth));
    }
    return table;
  }

 private:
  double left_, wide_;
  mutable std::vector<std::vector<std::pair<double, double>>> tables_;
};

FanPlace of_words(const std::string& words) {
  FanPlace place;
  const char *at = words.data(), *end = at + words.size();
  bool good = true;
  for (double* value : {&place.apex_column, &place.apex_row, &place.metres_a_pixel}) {
    const auto [rest, error] = std::from_chars(at, end, *value);
    good = good && error == std::errc{} && std::isfinite(*value);
    at = rest;
    if (good && value != &place.metres_a_pixel) good = at != end && *at++ == ':';
    if (!good) break;
  }
  if (!good || at != end || !(place.metres_a_pixel > 0))
    throw UsageError(
        fmt::format("--cartesian '{}': expected fan or COLUMN:ROW:METRES, with the apex in pixels from the "
                    "upper left corner and the metres per pixel",
                    words));
  return place;
}

}  // namespace

FanPlace fan_place(const std::string& words, std::size_t rows, std::size_t columns, const BinAxes& axes) {
  if (words != "fan") return of_words(words);
  const double near = axes.samples.edges.front(), far = axes.samples.edges.back(),
               left = axes.beams.edges.front(), right = axes.beams.edges.back();
  if (!(left >= -90) || !(right <= 90) || !(left < 0) || !(right > 0))
    throw UsageError(
        "--cartesian fan needs a fan around the forward direction, with at most 90 degrees on each side: "
        "give COLUMN:ROW:METRES");
  const double widest = far * (std::sin(right * degree) - std::sin(left * degree));
  FanPlace place;
  place.metres_a_pixel = widest / static_cast<double>(columns);
  place.apex_column = -far * std::sin(left * degree) / place.metres_a_pixel;
  // The picture ends at the apex, or at the lowest point of the nearest arc.
  const double lowest = near * std::cos(std::max(-left, right) * degree), height = static_cast<double>(rows);
  for (const double bottom : {0.0, lowest}) {
    place.apex_row = far / place.metres_a_pixel;
    if (std::abs((far - bottom) / place.metres_a_pixel - height) <= std::max(1.5, 0.01 * height))
      return place;
  }
  throw UsageError(
      fmt::format("--cartesian fan: the reference's fan ({:.4g} to {:.4g} degrees, to {:.4g} m) would be {} "
                  "x {:.0f} pixels, but the picture has {} x {}: give COLUMN:ROW:METRES",
                  left, right, far, columns, far / place.metres_a_pixel, columns, rows));
}

ForeignFrame turned_up(const ForeignFrame& frame, const std::string& forward) {
  if (forward.empty() || forward == "up") return frame;
  const bool sideways = forward == "left" || forward == "right";
  if (!sideways && forward != "down")
    throw UsageError(fmt::format("--forward '{}': expected up, down, left or right", forward));
  ForeignFrame turned = frame;
  if (sideways) std::swap(turned.rows, turned.columns);
  for (std::size_t row = 0; row < turned.rows; ++row)
    for (std::size_t column = 0; column < turned.columns; ++column) {
      // Rotation by 180 degrees.
      std::size_t from_row = frame.rows - 1 - row, from_column = frame.columns - 1 - column;
      if (forward == "left") from_row = frame.rows - 1 - column, from_column = row;
      if (forward == "right") from_row = column, from_column = frame.columns - 1 - row;
      turned.values[row * turned.columns + column] = frame.values[from_row * frame.columns + from_column];
    }
  return turned;
}

PolarPicture resampled_fan(const std::vector<double>& energies, std::size_t rows, std::size_t columns,
                           const FanPlace& place, const BinAxes& axes, std::size_t* outside) {
  constexpr double points_a_pixel = 4;
  constexpr int most_points = 256;
  const std::size_t beams = axes.beams.count(), samples = axes.samples.count();
  PolarPicture picture{beams, samples, std::vector<double>(beams * samples, 0), {}};
  const auto points_over = [&](double length_m) {
    return std::clamp(static_cast<int>(std::ceil(points_a_pixel * length_m / place.metres_a_pixel)), 2,
                      most_points);
  };
  for (std::size_t b = 0; b < beams; ++b) {
    stop_if_wanted();
    const DirectionTable directions(axes.beams.edges[b] * degree, axes.beams.edges[b + 1] * degree);
    for (std::size_t s = 0; s < samples; ++s) {
      const double near = axes.samples.edges[s], long_m = axes.samples.edges[s + 1] - near;
      const int along = points_over(long_m), least = points_over(directions.wide() * (near + long_m));
      const auto& across = directions.of(least);
      double sum = 0, weight = 0, whole = 0;
      for (int i = 0; i < along; ++i) {
        const double range = near + (i + 0.5) * long_m / along, pixels = range / place.metres_a_pixel;
        for (const auto& [sine, cosine] : across) {
          const double column = place.apex_column + pixels * sine, row = place.apex_row - pixels * cosine;
          whole += range;
          if (!(column >= 0 && column < static_cast<double>(columns) && row >= 0 &&
                row < static_cast<double>(rows)))
            continue;
          sum += range * energies[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
          weight += range;
        }
      }
      if (weight > 0) picture.energy[b * samples + s] = sum / weight;
      if (outside && weight < whole / 2) ++*outside;
    }
  }
  return picture;
}

}  // namespace tubefoot
