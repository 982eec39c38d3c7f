// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/certified_strength.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "engine/signal/certified_factor.hpp"
#include "engine/signal/target_strength.hpp"
#include "engine/signal/view_displacement.hpp"
#include "engine/visibility/far_view.hpp"
#include "geometry/integrals/certified_waves.hpp"
#include "geometry/numbers/ball_vector.hpp"

// Encloses backscattering lengths in ball arithmetic. Transforms of the view's triangles are summed, and the
// displacement of the vertices by the grid is bounded. Source: docs/notes/smooth-surfaces.md, "Target
// strength".

namespace tubefoot {
namespace {

/// Axes right, up and towards the viewer, equal to those of far_view() except for rounding. The rounding of
/// far_view()'s axes counts as a displacement of vertices, as that of the grid.
EnclosedAxes axes_of(double azimuth_deg, double elevation_deg, glm::dvec3 upwards) {
  const Ball degree = Ball::pi() / Ball(180.0);
  Ball sine_a, cosine_a, sine_e, cosine_e;
  sin_cos(Ball(azimuth_deg) * degree, sine_a, cosine_a);
  sin_cos(Ball(elevation_deg) * degree, sine_e, cosine_e);
  const BallVector towards{cosine_e * cosine_a, cosine_e * sine_a, sine_e};
  BallVector right = cross(balls(upwards), towards);
  const Ball length = root(dot(right, right));
  for (Ball& x : right) x = x / length;
  return {right, cross(towards, right), towards};
}

/// Corner of the view relative to the middle of the body, across the line of sight and towards the viewer,
/// in m.
struct Corner {
  Ball x, y, z;
};
Corner corner_of(glm::dvec3 from_apex, double radius_m) {
  const auto rounded = [](double value) {
    Ball ball(value);
    ball.add_error(Ball(std::ldexp(std::abs(value), -50)));  // 4 units in the last place (law E1)
    return ball;
  };
  const Ball x = rounded(from_apex.x), y = rounded(from_apex.y), z = rounded(from_apex.z),
             height(FarViewGrid::apex_height), scale = -(Ball(radius_m) * height / z);
  return {scale * x, scale * y, scale * (height + z)};
}

/// Triangle of the view: its area across the line of sight, and the coordinates of its corners towards the
/// viewer.
struct SeenTriangle {
  FacetId facet;
  Ball area;
  std::array<Ball, 3> towards;
};
std::vector<SeenTriangle> triangles_of(const FarView& view, const FarViewGrid& grid) {
  std::vector<SeenTriangle> seen;
  for (const FarView::Part& part : view.parts) {
    if (part.count < 3) continue;
    const Corner first = corner_of(grid.corners[part.first], grid.radius_m);
    Corner before = corner_of(grid.corners[part.first + 1], grid.radius_m);
    for (std::uint32_t k = part.first + 2; k < part.first + part.count; ++k) {
      Corner now = corner_of(grid.corners[k], grid.radius_m);
      seen.push_back(
          {part.facet,
           ((before.x - first.x) * (now.y - first.y) - (before.y - first.y) * (now.x - first.x)) / Ball(2.0),
           {first.z, before.z, now.z}});
      before = std::move(now);
    }
  }
  return seen;
}

}  // namespace

struct CertifiedStrength::State {
  std::span<const glm::dvec3> points_m;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  PlacedEdges edges;

  /// Sine of the angle between the facet and the line of sight; the interval from 0 to 1 for a degenerate
  /// facet.
  Ball sine(std::size_t facet, const BallVector& towards) const {
    const std::array<std::uint32_t, 3>& t = triangles[facet];
    const BallVector normal =
        cross(vector_between(points_m[t[0]], points_m[t[1]]), vector_between(points_m[t[0]], points_m[t[2]]));
    const Ball square = dot(normal, normal);
    if (!square.surely_positive()) return Ball::between(0, 1);
    const Ball along = dot(normal, towards) / root(square);
    return root(squared(along));
  }
};

CertifiedStrength::CertifiedStrength(std::span<const glm::dvec3> points_m,
                                     std::span<const std::array<std::uint32_t, 3>> triangles)
    : state_(new State{points_m, triangles, PlacedEdges(points_m, triangles)}) {}
CertifiedStrength::~CertifiedStrength() = default;

CertifiedStrength::Seen CertifiedStrength::towards(double azimuth_deg, double elevation_deg,
                                                   const SmoothSurface& surface, double sound_speed,
                                                   std::span<const double> frequencies_hz) const {
  if (!(sound_speed > 0) || !std::isfinite(sound_speed))
    throw std::invalid_argument("the sound speed must be positive and finite");
  const State& s = *state_;
  Seen result;
  FarViewGrid grid;
  const FarView view = far_view(s.points_m, s.triangles, sonar_direction(azimuth_deg, elevation_deg), &grid);
  result.silhouette_m2 = view.area_m2();
  result.lengths.resize(frequencies_hz.size());
  if (s.points_m.empty() || s.triangles.empty()) return result;

  const EnclosedAxes axes = axes_of(azimuth_deg, elevation_deg, grid.upwards);
  const ViewDisplacement displacement(grid, s.points_m, s.triangles, s.edges, axes);
  const std::vector<SeenTriangle> seen = triangles_of(view, grid);
  const bool same = !surface.fluid && surface.roughness_m == 0;
  std::vector<Ball> sines;
  if (!same)
    for (std::size_t facet = 0; facet < s.triangles.size(); ++facet) sines.push_back(s.sine(facet, axes[2]));
  const double largest =
      surface.fluid ? 1 : std::hypot(surface.reflection.real(), surface.reflection.imag()) * (1 + 1e-15);
  const Ball middle = dot(axes[2], balls(grid.middle_m));
  Ball area(0.0);
  for (const SeenTriangle& t : seen) area += t.area;

  std::vector<ComplexBall> factors(sines.size());
  for (std::size_t i = 0; i < frequencies_hz.size(); ++i) {
    const Ball k = Ball(2.0) * Ball::pi() * Ball(frequencies_hz[i]) / Ball(sound_speed),
               turn = Ball(-2.0) * k;
    for (std::size_t facet = 0; facet < factors.size(); ++facet)
      factors[facet] = certified_factor(surface, sines[facet], k);
    ComplexBall sum(0.0);
    for (const SeenTriangle& t : seen) {
      const ComplexBall mean =
          certified_mean_phasor({turn * t.towards[0], turn * t.towards[1], turn * t.towards[2]});
      const ComplexBall part = ComplexBall(t.area) * mean;
      sum += same ? part : part * factors[t.facet];
    }
    if (same) sum = sum * ComplexBall(Ball(surface.reflection.real()), Ball(surface.reflection.imag()));
    const Ball over = k / (Ball(2.0) * Ball::pi());
    const ComplexBall length = ComplexBall(Ball(0.0), -over) * certified_phasor(turn * middle) * sum;

    CertifiedLength& certified = result.lengths[i];
    certified.length_m = {length.real().middle(), length.imaginary().middle()};
    certified.grid_m = displacement.bound_m2(k.hi(), area.hi(), largest, factors) * over.hi() * (1 + 1e-15);
    certified.bound_m = (certified.grid_m + radius_about(length.real(), certified.length_m.real()) +
                         radius_about(length.imaginary(), certified.length_m.imag())) *
                        (1 + 1e-15);
    if (!std::isfinite(certified.bound_m)) certified.bound_m = std::numeric_limits<double>::infinity();
  }
  return result;
}

double target_strength_bound_db(const CertifiedLength& length) {
  const double size = std::hypot(length.length_m.real(), length.length_m.imag());
  if (!(length.bound_m < size)) return std::numeric_limits<double>::infinity();
  // The lower side of the interval is the wider one. The margin covers rounding of both strengths and of the
  // printed values.
  return -20 / std::log(10.0) * std::log1p(-length.bound_m / size) * (1 + 1e-12) + 1e-12;
}

}  // namespace tubefoot
