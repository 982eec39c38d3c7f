// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "scene/trajectory.hpp"

// The axes of other engines, the one table that all writers and readers of their scenes use. docs/exchange.md
namespace tubefoot {

/// Three axes, each said in ours: row k is the engine's axis k, as (east, north, up) of the world or as
/// (starboard, forward, up) of a body. A rotation: the determinant is 1.
struct Axes {
  std::string_view words;  ///< "x north, y east, z down"
  std::array<std::array<int, 3>, 3> rows;

  glm::dmat3 matrix() const;  ///< from ours to theirs
  /// No more than signs and places change: bit for bit.
  glm::dvec3 to_theirs(glm::dvec3 ours) const;
  glm::dvec3 to_ours(glm::dvec3 theirs) const;
};

/// The axes of one engine.
struct EngineAxes {
  std::string_view engine;  ///< as --to has it
  Axes world, body;
  Axes sonar;  ///< of a sonar's own frame; a fan lies about its "ahead"
};

enum class ExchangeFormat { sdf, stonefish, gltf, obj, holoocean };

const std::array<EngineAxes, 5>& engine_axes();
const EngineAxes& axes_of(ExchangeFormat format);
/// Of the word of --to. Throws UsageError.
ExchangeFormat exchange_format(std::string_view word);

/// A place and a rotation (columns: the turned frame's axes), in any axes.
struct Placement {
  glm::dvec3 position_m{0};
  glm::dmat3 turn{1};
};

/// First `inner`, then `outer`.
Placement operator*(const Placement& outer, const Placement& inner);
Placement inverse(const Placement& placement);
Placement placement_of(const Pose& pose);

/// Ours in an engine's axes, and back: the world's, and those of what is placed.
Placement to_theirs(const Placement& ours, const Axes& world, const Axes& of_what);
Placement to_ours(const Placement& theirs, const Axes& world, const Axes& of_what);

/// Roll, pitch, yaw about fixed x, y, z [rad]: the rotation is Rz(yaw) Ry(pitch) Rx(roll), as SDF, URDF and
/// Stonefish have it. Looking straight along z, roll and yaw are one turn: all of it is called yaw.
glm::dvec3 roll_pitch_yaw(const glm::dmat3& turn);
/// The inverse. Whole quarters of a turn are exact.
glm::dmat3 turn_of(glm::dvec3 roll_pitch_yaw_rad);
/// x, y, z, w, w not negative.
std::array<double, 4> quaternion_xyzw(const glm::dmat3& turn);
glm::dmat3 turn_of_quaternion(const std::array<double, 4>& xyzw);

/// Turns the frame of a fan that lies across the track, with its middle straight down, into its carrier's:
/// starboard stays, ahead is down, up is forward.
extern const glm::dmat3 looking_down;

}  // namespace tubefoot
