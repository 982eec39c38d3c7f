// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/relief/elevation_field.hpp"

// Estimates the error that a mesh causes by omitting finer relief. The formulas are derived in
// docs/notes/textures.md, section "Refinement".
namespace tubefoot {

/// Relief that meshes of all edge lengths omit from a scene.
class OmittedRelief {
 public:
  /// `relief` contains one field per material, null for flat facets. `finest_m` is the shortest edge for
  /// which values are required.
  OmittedRelief(std::span<const std::shared_ptr<const ElevationField>> relief, double finest_m);

  /// Returns the omitted relief, over all materials, for an edge of this squared length or the next larger
  /// step. It never decreases with the edge length.
  const ElevationField::LeftOut& at(double edge2_m2) const { return largest_[step(edge2_m2)]; }
  const ElevationField::LeftOut& at(double edge2_m2, std::uint16_t material) const {
    return by_material_[material][step(edge2_m2)];
  }
  double largest_height_m() const { return largest_height_m_; }

 private:
  /// Four steps per octave, up to 2^25 times the finest edge.
  static constexpr std::size_t steps = 101;
  std::size_t step(double edge2_m2) const;

  double finest2_m2_;
  double largest_height_m_ = 0;
  std::array<ElevationField::LeftOut, steps> largest_{};
  std::vector<std::array<ElevationField::LeftOut, steps>> by_material_;
};

/// Cell of one beam and one range sample on the surface.
struct Resolution {
  double range_m = 1;       ///< slant range
  double sine_grazing = 1;  ///< of the grazing angle
  double sample_m = 0.01;   ///< length of a sample in slant range
  double beam_rad = 0.01;   ///< one-way width of a beam
};

/// Returns the cotangent of a grazing angle. Below a grazing angle of about one degree, where almost nothing
/// is scattered, it is constant.
double grazing_cotangent(double sine);

/// Estimates the relative RMS change of a range sample's energy by the relief that a mesh omits.
double omitted_change(const ElevationField::LeftOut& left_out, double edge2_m2, const Resolution& cell);

}  // namespace tubefoot
