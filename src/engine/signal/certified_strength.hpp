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

// Computes backscattering lengths with proven bounds. Source: docs/notes/smooth-surfaces.md.
namespace tubefoot {

/// Backscattering length with a bound of its error.
struct CertifiedLength {
  std::complex<double> length_m;
  double bound_m = 0;  ///< bound of the modulus of the difference
  double grid_m = 0;   ///< part of the bound that comes from the grid of the view's vertices
};

/// Backscattering lengths as backscattering_lengths(), in ball arithmetic. The bound includes all errors
/// between the mesh and the result. Their sources are the direction from its angles, the grid of the view's
/// vertices, rounded corners, divided differences, reflection, roughness and sums. Coordinates, angles,
/// frequencies and the values of the surface count as exact doubles.
class CertifiedStrength {
 public:
  struct Seen {
    std::vector<CertifiedLength> lengths;  ///< per frequency
    double silhouette_m2 = 0;
  };

  /// The mesh must outlive this object.
  CertifiedStrength(std::span<const glm::dvec3> points_m,
                    std::span<const std::array<std::uint32_t, 3>> triangles);
  ~CertifiedStrength();

  /// Lengths as seen from the direction of sonar_direction(). Throws std::invalid_argument for a sound speed
  /// that is not positive, and the exceptions of far_view(). Thread-safe.
  /// Law Q10 (certain): the exact length lies within the bound.
  Seen towards(double azimuth_deg, double elevation_deg, const SmoothSurface& surface, double sound_speed,
               std::span<const double> frequencies_hz) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Half-width in dB of the target strengths of all lengths within the bound. Infinite if 0 is one of these
/// lengths.
double target_strength_bound_db(const CertifiedLength& length);

}  // namespace tubefoot
