// SPDX-License-Identifier: GPL-3.0-or-later
// Axes of other engines and conversions of placements: signed permutations of axes, roll, pitch and yaw,
// and quaternions. docs/exchange-formats.md describes them.
#include "exchange/frames.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

constexpr Axes east_north_up{"x east, y north, z up", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
constexpr Axes north_east_down{"x north, y east, z down", {{{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}}};
constexpr Axes east_up_south{"x east, y up, z south", {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}}};
constexpr Axes starboard_forward_up{"x starboard, y forward, z up", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
constexpr Axes forward_port_up{"x forward, y port, z up", {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}};
constexpr Axes forward_starboard_down{"x forward, y starboard, z down", {{{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}}};
constexpr Axes starboard_down_ahead{"x starboard, y down, z ahead", {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}};
constexpr Axes starboard_up_behind{"x starboard, y up, z behind", {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}}};

/// Returns sine and cosine. They are exact at multiples of a quarter turn that a text of 15 digits or more
/// represents.
std::array<double, 2> sine_cosine(double angle) {
  const double quarters = angle / (std::numbers::pi / 2), whole = std::round(quarters);
  if (std::abs(quarters - whole) > 1e-15 * std::max(1.0, std::abs(whole)))
    return {std::sin(angle), std::cos(angle)};
  const int quarter = static_cast<int>(whole - 4 * std::floor(whole / 4));
  constexpr std::array<std::array<double, 2>, 4> exact{{{0, 1}, {1, 0}, {0, -1}, {-1, 0}}};
  return exact[static_cast<std::size_t>(quarter)];
}

}  // namespace

const glm::dmat3 looking_down{glm::dvec3(1, 0, 0), glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0)};

glm::dmat3 Axes::matrix() const {
  glm::dmat3 matrix(0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      matrix[column][row] = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  return matrix;
}

glm::dvec3 Axes::to_theirs(glm::dvec3 ours) const {
  glm::dvec3 theirs(0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (const int sign = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)]; sign != 0)
        theirs[row] = sign * ours[column] + 0.0;  // avoids -0
  return theirs;
}

glm::dvec3 Axes::to_ours(glm::dvec3 theirs) const {
  glm::dvec3 ours(0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (const int sign = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)]; sign != 0)
        ours[column] = sign * theirs[row] + 0.0;
  return ours;
}

const std::array<EngineAxes, 5>& engine_axes() {
  // Sources of the axes. Gazebo: documentation of SDFormat and of its sensors.
  // Stonefish: docs/scenario.rst, docs/environment.rst; its vision sensors look along z with -y up.
  // glTF 2.0, section 3.4: y up; its cameras look along -z. OBJ has no axes: those of tubefoot.
  // HoloOcean: "Units and Coordinates": x forward, y left, z up, right-handed.
  static const std::array<EngineAxes, 5> table{
      EngineAxes{"sdf", east_north_up, forward_port_up, forward_port_up},
      EngineAxes{"stonefish", north_east_down, forward_starboard_down, starboard_down_ahead},
      EngineAxes{"gltf", east_up_south, starboard_up_behind, starboard_up_behind},
      EngineAxes{"obj", east_north_up, starboard_forward_up, starboard_forward_up},
      EngineAxes{"holoocean", east_north_up, forward_port_up, forward_port_up}};
  return table;
}

const EngineAxes& axes_of(ExchangeFormat format) { return engine_axes()[static_cast<std::size_t>(format)]; }

ExchangeFormat exchange_format(std::string_view word) {
  for (std::size_t k = 0; k < engine_axes().size(); ++k)
    if (engine_axes()[k].engine == word) return static_cast<ExchangeFormat>(k);
  throw UsageError(
      fmt::format("--to '{}' is unknown: choose sdf, stonefish, gltf, obj or holoocean", std::string(word)));
}

Placement operator*(const Placement& outer, const Placement& inner) {
  return {outer.position_m + outer.turn * inner.position_m, outer.turn * inner.turn};
}

Placement inverse(const Placement& placement) {
  const glm::dmat3 back = glm::transpose(placement.turn);
  return {back * -placement.position_m, back};
}

Placement placement_of(const Pose& pose) { return {pose.position_m, glm::mat3_cast(pose.attitude)}; }

Placement to_theirs(const Placement& ours, const Axes& world, const Axes& of_what) {
  return {world.to_theirs(ours.position_m), world.matrix() * ours.turn * glm::transpose(of_what.matrix())};
}

Placement to_ours(const Placement& theirs, const Axes& world, const Axes& of_what) {
  return {world.to_ours(theirs.position_m), glm::transpose(world.matrix()) * theirs.turn * of_what.matrix()};
}

glm::dvec3 roll_pitch_yaw(const glm::dmat3& turn) {
  // Column c, row r: turn[c][r].
  const double level = std::hypot(turn[0][0], turn[0][1]), pitch = std::atan2(-turn[0][2], level);
  if (level < 1e-12) return {0, pitch, std::atan2(-turn[1][0], turn[1][1])};
  return {std::atan2(turn[1][2], turn[2][2]), pitch, std::atan2(turn[0][1], turn[0][0])};
}

glm::dmat3 turn_of(glm::dvec3 angles) {
  const auto [sr, cr] = sine_cosine(angles.x);
  const auto [sp, cp] = sine_cosine(angles.y);
  const auto [sy, cy] = sine_cosine(angles.z);
  return {glm::dvec3(cy * cp, sy * cp, -sp),
          glm::dvec3(cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr),
          glm::dvec3(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)};
}

std::array<double, 4> quaternion_xyzw(const glm::dmat3& turn) {
  glm::dquat q = glm::normalize(glm::quat_cast(turn));
  if (q.w < 0) q = -q;
  return {q.x + 0.0, q.y + 0.0, q.z + 0.0, q.w};
}

glm::dmat3 turn_of_quaternion(const std::array<double, 4>& xyzw) {
  return glm::mat3_cast(glm::normalize(glm::dquat(xyzw[3], xyzw[0], xyzw[1], xyzw[2])));
}

}  // namespace tubefoot
