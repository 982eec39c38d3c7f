// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/relief/elevation_field.hpp"

// What relief finer than a mesh would change, as docs/textures.md derives it ("Refinement").
namespace tubefoot {

/// What meshes of all edge lengths leave out of a scene's relief.
class OmittedRelief {
 public:
  /// Fields by material, null where facets are flat. `finest_m`: the shortest edge that is asked about.
  OmittedRelief(std::span<const std::shared_ptr<const ElevationField>> relief, double finest_m);

  /// Of no less than an edge of a squared length, over all materials; it does not fall with the length.
  const ElevationField::LeftOut& at(double edge2_m2) const { return largest_[step(edge2_m2)]; }
  const ElevationField::LeftOut& at(double edge2_m2, std::uint16_t material) const {
    return by_material_[material][step(edge2_m2)];
  }
  double largest_height_m() const { return largest_height_m_; }

 private:
  /// Four steps an octave, 2^25 times the finest edge.
  static constexpr std::size_t steps = 101;
  std::size_t step(double edge2_m2) const;

  double finest2_m2_;
  double largest_height_m_ = 0;
  std::array<ElevationField::LeftOut, steps> largest_{};
  std::vector<std::array<ElevationField::LeftOut, steps>> by_material_;
};

/// A beam's range sample on the surface.
struct Resolution {
  double range_m = 1;       ///< slant range
  double sine_grazing = 1;  ///< of the grazing angle
  double sample_m = 0.01;   ///< length of a sample of slant range
  double beam_rad = 0.01;   ///< width of a beam, one way
};

/// Cotangent of a grazing angle; of less than about a degree, where next to nothing is scattered, that of it.
double grazing_cotangent(double sine);

/// RMS change of a range sample's energy, relative, by the relief that a mesh leaves out: an estimate.
double omitted_change(const ElevationField::LeftOut& left_out, double edge2_m2, const Resolution& cell);

}  // namespace tubefoot
