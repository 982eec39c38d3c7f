// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "scene/trajectory.hpp"

// Axes of other engines: the single table that all readers and writers of their scenes use. See
// docs/exchange-formats.md.
namespace tubefoot {

/// Three axes of an engine, expressed in those of tubefoot. Row k is axis k of the engine, as (east, north,
/// up) of the world or as (starboard, forward, up) of a body. They form a rotation: the determinant is 1.
struct Axes {
  std::string_view words;  ///< "x north, y east, z down"
  std::array<std::array<int, 3>, 3> rows;

  glm::dmat3 matrix() const;  ///< from tubefoot to the engine
  /// Exact conversion: only signs and positions of coordinates change.
  glm::dvec3 to_theirs(glm::dvec3 ours) const;
  glm::dvec3 to_ours(glm::dvec3 theirs) const;
};

/// Axes of one engine.
struct EngineAxes {
  std::string_view engine;  ///< name of the engine in --to
  Axes world, body;
  Axes sonar;  ///< axes of the frame of a sonar; a fan lies about the forward axis
};

enum class ExchangeFormat { sdf, stonefish, gltf, obj, holoocean };

const std::array<EngineAxes, 5>& engine_axes();
const EngineAxes& axes_of(ExchangeFormat format);
/// Returns the format for a word of --to. Throws UsageError.
ExchangeFormat exchange_format(std::string_view word);

/// A position and a rotation in any axes. The columns of the rotation are the axes of the rotated frame.
struct Placement {
  glm::dvec3 position_m{0};
  glm::dmat3 turn{1};
};

/// Applies `inner` first, then `outer`.
Placement operator*(const Placement& outer, const Placement& inner);
Placement inverse(const Placement& placement);
Placement placement_of(const Pose& pose);

/// Converts between the axes of tubefoot and those of an engine, given the axes of its world and of the
/// placed object.
Placement to_theirs(const Placement& ours, const Axes& world, const Axes& of_what);
Placement to_ours(const Placement& theirs, const Axes& world, const Axes& of_what);

/// Returns roll, pitch and yaw about fixed x, y and z in rad. The rotation is Rz(yaw) Ry(pitch) Rx(roll),
/// as in SDF, URDF and Stonefish. If x points along z, roll and yaw are the same rotation, and yaw has all
/// of it.
glm::dvec3 roll_pitch_yaw(const glm::dmat3& turn);
/// Inverse of roll_pitch_yaw(). Multiples of a quarter turn are exact.
glm::dmat3 turn_of(glm::dvec3 roll_pitch_yaw_rad);
/// Returns x, y, z, w with w not negative.
std::array<double, 4> quaternion_xyzw(const glm::dmat3& turn);
glm::dmat3 turn_of_quaternion(const std::array<double, 4>& xyzw);

/// Rotation from the frame of a fan across the track, whose centre looks straight down, to the frame of its
/// carrier. Starboard stays, forward becomes down, and up becomes forward.
extern const glm::dmat3 looking_down;

}  // namespace tubefoot
