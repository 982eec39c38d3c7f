// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "engine/signal/smooth_surface.hpp"

// Backscattering lengths that are proven. docs/smooth-surfaces.md
namespace tubefoot {

/// A number and how far the true one may be from it.
struct CertifiedLength {
  std::complex<double> length_m;
  double bound_m = 0;  ///< of the modulus of the difference
  double grid_m = 0;   ///< what of it is because the view's vertices lie on a grid
};

/// What backscattering_lengths() computes, in balls, with everything between the mesh's numbers and the
/// result in the bound: the line of sight from its angles, the vertices that the view puts on a grid, the
/// corners' rounding, divided differences, reflection and roughness, sums. The mesh's coordinates, angles,
/// frequencies and the surface's numbers are taken as the doubles that they are.
class CertifiedStrength {
 public:
  struct Seen {
    std::vector<CertifiedLength> lengths;  ///< by frequency
    double silhouette_m2 = 0;
  };

  /// The mesh must outlive this.
  CertifiedStrength(std::span<const glm::dvec3> points_m,
                    std::span<const std::array<std::uint32_t, 3>> triangles);
  ~CertifiedStrength();

  /// From where sonar_direction() has the sonar. Throws std::invalid_argument as far_view() does, and for a
  /// sound speed that is not positive. Any number of threads may call it.
  /// Law Q10 (certain): the length of exact arithmetic lies within the bound.
  Seen towards(double azimuth_deg, double elevation_deg, const SmoothSurface& surface, double sound_speed,
               std::span<const double> frequencies_hz) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Half-width [dB] of the target strengths of all lengths within the bound: infinite where 0 is one of them.
double target_strength_bound_db(const CertifiedLength& length);

}  // namespace tubefoot
