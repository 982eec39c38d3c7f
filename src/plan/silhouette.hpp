// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "plan/sheet.hpp"

namespace tubefoot {

/// Leaves out points that are less than `tolerance` from the line without them.
std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& points, double tolerance);

/// What many convex shapes cover together, as one outline: the union of their pixels, traced. Each cell that
/// a shape touches is covered, so that the thinnest beam is seen.
class Silhouette {
 public:
  /// What lies outside of the box is cut off.
  explicit Silhouette(const Box& within);

  /// The convex hull of some points.
  void add(std::span<const glm::dvec2> points);
  bool empty() const { return bounds_.empty(); }
  /// Of what was covered.
  const Box& bounds() const { return bounds_; }
  /// Data of an SVG path, to be filled by the even-odd rule; empty if nothing is covered.
  std::string path() const;

 private:
  static constexpr double cell = 0.5;  // pixels
  std::vector<std::vector<glm::dvec2>> loops() const;

  Box within_, bounds_ = Box::none();
  std::size_t columns_, rows_;
  std::vector<std::uint8_t> covered_;
};

}  // namespace tubefoot
