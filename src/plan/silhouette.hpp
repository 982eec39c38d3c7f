// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "plan/sheet.hpp"

namespace tubefoot {

/// Removes points whose distance from the simplified line is less than `tolerance`.
std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& points, double tolerance);

/// Union of many convex shapes as an outline. Each cell of a raster that a shape touches is covered, so
/// that even the thinnest beam is visible.
class Silhouette {
 public:
  /// Shapes are clipped to the box.
  explicit Silhouette(const Box& within);

  /// Adds the convex hull of some points.
  void add(std::span<const glm::dvec2> points);
  bool empty() const { return bounds_.empty(); }
  /// Returns the box of the covered cells.
  const Box& bounds() const { return bounds_; }
  /// Returns the data of an SVG path for the even-odd fill rule; empty if nothing is covered.
  std::string path() const;

 private:
  static constexpr double cell = 0.5;  // pixels
  std::vector<std::vector<glm::dvec2>> loops() const;

  Box within_, bounds_ = Box::none();
  std::size_t columns_, rows_;
  std::vector<std::uint8_t> covered_;
};

}  // namespace tubefoot
