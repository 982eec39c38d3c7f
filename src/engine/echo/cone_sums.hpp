// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/echo/pattern_integral.hpp"
#include "engine/echo/volume_regions.hpp"
#include "engine/scattering/radial_model.hpp"
#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {

/// Sums the volume reverberation of cones per beam and sample. In sample k, a cone up to a polygon at the
/// ranges R returns
///
///     s_v (Omega_k (F_k+1 - F_k) + integral of (F(R) - F_k) dOmega over the polygon's part in sample k).
///
/// F is a primitive of r^-2 e^(-2 beta r). Omega_k is the solid angle of the polygon's part beyond sample k,
/// weighted by the patterns. Hence two integrals over the parts of polygons in each sample suffice: the
/// solid angle, and that of F(R) - F_k.
class ConeSums {
 public:
  /// `patterns`: null for ideal beams; must outlive this object, as `beams`. Throws std::invalid_argument for
  /// samples that begin at range 0, where the integral is infinite.
  ConeSums(const ReceiveBeams& beams, const RangeSamples& samples, double absorption_db_per_m,
           const BeamPatterns* patterns, double pattern_tolerance);
  ConeSums(const ConeSums&) = delete;
  ConeSums& operator=(const ConeSums&) = delete;

  void add(const DoubleSpace::Polygon& cone, double s_v_per_m, std::uint32_t tube);
  /// Adds the directions of a beam that no cone covers, for ideal beams and cones with one coefficient. The
  /// solid angle of all tubes of the beam minus that of the cones is unobstructed. Differences below 1e-11 of
  /// the solid angle count as rounding.
  void add_rest(double solid_angle_sr, double s_v_per_m, std::uint32_t beam);
  /// Returns the energies [beam][sample] of all cones and forgets the cones.
  std::vector<double> energies();

 private:
  void add_ideal(double factor, double s_v_per_m, std::uint32_t beam);

  const ReceiveBeams& beams_;
  std::vector<double> borders_, extended_;
  std::size_t count_;
  double beta_;
  std::vector<double> spreading_;           ///< F_k+1 - F_k
  std::vector<double> solid_angle_;         ///< [beam][sample], times s_v; one more sample beyond the last
  std::vector<double> partial_;             ///< [beam][sample]: integral of s_v (F(R) - F_k)
  std::vector<double> nearer_solid_angle_;  ///< by beam, times s_v
  PlanarPolygon polygon_;
  std::shared_ptr<const VolumeRadials> radials_;
  /// Integrals of solid angles on one side of the samples, made when needed.
  struct Outside {
    explicit Outside(double from_m, double to_m);
    RadialIntegral radial;
    RangeCutter cutter;
  };
  std::optional<RangeCutter> cutter_;
  std::unique_ptr<Outside> nearer_, beyond_;
  std::optional<PatternIntegrator> solid_angle_patterns_, partial_patterns_;
};

}  // namespace tubefoot
