// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/rays/ray_patch.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// The centre line of a beam along its longer side, and the beam's solid angle across it. A beam is one tube
/// or a grid of tubes (slices, rows) that share their corner rays.
class RayColumn {
 public:
  struct Ray {
    glm::dvec3 direction;
    double solid_angle_sr;
    std::uint32_t tube;
  };
  /// A position on the column.
  struct Cursor {
    std::size_t piece = 0;
    double v = 0;  // the last border, in the piece
  };

  /// `beam` has the tubes of one beam, `patches` those of all tubes. Throws std::invalid_argument if the
  /// tubes form no grid.
  RayColumn(const TubeSet& tubes, std::span<const RayPatch> patches, std::span<const std::uint32_t> beam);

  /// Returns a cursor at the lower border of ray `index` of `rays`.
  Cursor start(std::int64_t index, std::int64_t rays) const;
  /// Returns ray `index` of `rays` at equal angles and moves the cursor from the ray's lower to its upper
  /// border. The solid angle is that of the beam between the two borders, which are lines of constant u or v
  /// in each tube.
  Ray next(Cursor& cursor, std::span<const RayPatch> patches, std::int64_t index, std::int64_t rays) const;

  double solid_angle() const { return solid_angle_; }

 private:
  struct Piece {                       // the tubes side by side at one position of the column
    std::vector<std::uint32_t> tubes;  // from one side to the other
    std::uint32_t middle;              // the tube that contains the column
    glm::dvec3 begin, onward;          // orthonormal: the column is cos(a) begin + sin(a) onward
    double begin_length, end_length;   // lengths of the patch's points at both ends
    double sine, cosine;               // of the angle between the ends
    double angle_before;
  };
  double v_at(const Piece& piece, double angle) const;
  double solid_angle(const Piece& piece, std::span<const RayPatch> patches, double v0, double v1) const;

  std::vector<Piece> pieces_;
  double angle_ = 0, solid_angle_ = 0;
  bool along_u_ = false;
};

}  // namespace tubefoot
