// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/volume_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/certified/certified_driver.hpp"
#include "engine/certified/certified_integral.hpp"
#include "engine/echo/volume_regions.hpp"
#include "engine/scattering/radial_model.hpp"
#include "geometry/numbers/ball_vector.hpp"

// Encloses the two integrals of volume_echo.cpp per beam and sample: solid angles, and those of F(R) - F_k.

namespace tubefoot {
namespace {

/// Polygons in balls, relative to the apex.
struct BallSpace {
  using Number = Ball;
  using Vector = BallVector;
  using Polygon = CertifiedPolygon;

  static std::vector<Vector> corners(const Polygon& polygon) { return corners_of(polygon); }
  static Polygon on_same_plane(const Polygon& polygon, std::span<const Vector> corners) {
    return part_of(polygon, corners);
  }
  static Polygon on_plane(const glm::dvec3& normal, const Ball& distance, std::span<const Vector> corners) {
    return certified_polygon(normal, distance, corners);
  }
  static int sign(const Ball& x) { return tubefoot::sign(x); }
  static glm::dvec3 middle(const Vector& v) { return {v[0].middle(), v[1].middle(), v[2].middle()}; }
  static double middle_of(const Ball& x) { return x.middle(); }
  static Ball product(const glm::dvec3& a, const Vector& b) { return dot(balls(a), b); }
  static Vector between(const Vector& a, const Vector& b, const Ball& share) {
    Vector point;
    for (std::size_t k = 0; k < 3; ++k) point[k] = a[k] + share * (b[k] - a[k]);
    return point;
  }
  static Vector scaled(const Vector& v, const Ball& factor) {
    return {factor * v[0], factor * v[1], factor * v[2]};
  }
};

/// Both integrals of one tube, by bin.
struct VolumeBins {
  Bins<Ball> solid_angle;  ///< bins of rows with one more sample
  Bins<Ball> partial;
};

TubeContent<BallSpace> content_of(const NameContext& context, const TubeVisibility& seen, const Tube& tube,
                                  const TubeSet& tubes, double unit_m) {
  TubeContent<BallSpace> content;
  for (std::size_t k = 0; k < content.rays.size(); ++k) {
    const GridPoint& ray = tubes.rays[tube[k]];
    content.rays[k] = {Ball(double(ray.x)), Ball(double(ray.y)), Ball(double(ray.z))};
  }
  for (const NamedPiece& piece : seen.pieces)
    content.surfaces.push_back(certified_polygon(context, seen.corners, piece, unit_m));
  for (const NamedPiece& piece : seen.open)
    content.open.push_back(directions_of(context, seen.corners, piece));
  return content;
}

/// Bound of the ranges of all vertices.
double farthest_m(const FacetMesh& mesh, const History& history) {
  double farthest = 0;
  for (const GridPoint& v : mesh.vertices) {
    const double x = double(v.x) - history.tubes.apex.x, y = double(v.y) - history.tubes.apex.y,
                 z = double(v.z) - history.tubes.apex.z;
    farthest = std::max(farthest, x * x + y * y + z * z);
  }
  return 1.01 * std::sqrt(farthest) * history.grid_unit_m;
}

/// Approximate number of cones that share the bins of each beam.
std::vector<double> cones_of_beams(const History& history, const CertifiedRequest& request,
                                   std::span<const std::uint32_t> beam_of_tube, std::size_t borders,
                                   std::size_t beams) {
  std::vector<double> cones(beams, 1);
  const auto add = [&](std::uint32_t tube, double count) {
    const auto [first, end] = request.beams_of(tube, beam_of_tube);
    for (std::uint32_t beam = first; beam < end; ++beam) cones[beam] += count;
  };
  for (const Footprint& f : history.footprints.footprints) add(f.tube, f.piece_count);
  for (std::uint32_t tube = 0; tube < history.tubes.tubes.size(); ++tube) add(tube, 2.0 + double(borders));
  return cones;
}

}  // namespace

CertifiedEcho certify_volume(const FacetMesh& mesh, const SceneTree& tree, const History& history,
                             const VisibilityOptions& options, std::span<const std::uint32_t> beam_of_tube,
                             const RangeSamples& samples, const EchoModel& model,
                             const VolumeScattering& volume, const Echo& ordinary, double tolerance) {
  require_exact(options);
  VisibilityOptions with_open = options;
  with_open.open_water = true;
  CertifiedRequest request(model, samples);
  const std::size_t row = request.row(), beams = ordinary.energy.size() / row;
  std::vector<double> extended = request.borders;
  extended.push_back(std::max(extended.back() * farthest_over_last, farthest_m(mesh, history)));
  std::vector<Ball> spreading;
  for (std::size_t k = 0; k < row; ++k)
    spreading.push_back(volume_primitive(Ball(request.borders[k + 1]), request.beta_per_m) -
                        volume_primitive(Ball(request.borders[k]), request.beta_per_m));
  const std::vector<double> cones =
      cones_of_beams(history, request, beam_of_tube, volume.borders_m.size(), beams);
  /// By beam and sample: permitted error of the solid angle in the sample, which counts in all nearer
  /// samples.
  std::vector<double> solid_angle_target;
  const auto set_targets = [&] {
    solid_angle_target.assign(beams * (row + 1), std::numeric_limits<double>::max());
    for (std::size_t beam = 0; beam < beams; ++beam)
      for (std::size_t k = 0; k < row; ++k)
        solid_angle_target[beam * (row + 1) + k + 1] = std::min(
            solid_angle_target[beam * (row + 1) + k], request.target[beam * row + k] / spreading[k].middle());
  };
  const auto allowed = [&](const std::vector<double>& target, std::size_t samples_of_row, double size) {
    return CertifiedIntegrator::Allowance{
        request.tolerance / 3, [&, samples_of_row, size](std::uint32_t beam, std::uint32_t sample) {
          return std::max(target[beam * samples_of_row + sample] / 3 / (4 * cones[beam]) / size,
                          least_allowed);
        }};
  };
  const auto enclose_tube = [&](std::uint32_t tube, const NameContext& context, const TubeVisibility& seen,
                                VolumeBins& bins) {
    CertifiedIntegrator solid_angle(extended, request.beta_per_m),
        partial(request.borders, request.beta_per_m);
    solid_angle.take_density(CertifiedIntegrator::Density::solid_angle);
    partial.take_density(CertifiedIntegrator::Density::volume);
    VolumeRegions<BallSpace> regions(volume, model.path.tx.apex_m.z, request.borders.back());
    const std::uint32_t own_beam = beam_of_tube.empty() ? 0 : beam_of_tube[tube];
    const auto integrate = [&](CertifiedIntegrator& integrator, const CertifiedPolygon& cone,
                               const Ball& factor, const std::vector<double>& target,
                               std::size_t samples_of_row, Bins<Ball>& sums) {
      const auto allowance =
          allowed(target, samples_of_row, std::max(std::abs(factor.middle()), least_allowed));
      const Sink<Ball> sink = [&](const Part<Ball>& part) {
        sums[part.beam * samples_of_row + part.sample] += factor * part.value;
      };
      if (model.patterns != nullptr)
        integrator.add(cone, *model.patterns, tube, allowance, sink);
      else
        integrator.add(cone, own_beam, allowance, sink);
    };
    regions.divide(content_of(context, seen, history.tubes.tubes[tube], history.tubes, history.grid_unit_m),
                   [&](const CertifiedPolygon& cone, double s_v_per_m) {
                     stop_if_wanted();
                     const Ball factor = Ball(s_v_per_m) * cone.distance;
                     integrate(solid_angle, cone, factor, solid_angle_target, row + 1, bins.solid_angle);
                     integrate(partial, cone, factor, request.target, row, bins.partial);
                   });
  };
  return refined_until_tolerance(request, ordinary, tolerance, reference_targets, [&] {
    set_targets();
    const auto by_tube = enclose_tubes<VolumeBins>(mesh, tree, history.tubes, with_open, enclose_tube);
    std::vector<Ball> solid_angle(beams * (row + 1)), total(ordinary.energy.size());
    for (const VolumeBins& bins : by_tube) {
      for (const auto& [bin, part] : bins.solid_angle) solid_angle[bin] += part;
      for (const auto& [bin, part] : bins.partial) total[bin] += part;
    }
    for (std::size_t beam = 0; beam < beams; ++beam) {
      Ball beyond;
      for (std::size_t k = row; k-- > 0;) {
        beyond += solid_angle[beam * (row + 1) + k + 1];
        total[beam * row + k] += beyond * spreading[k];
      }
    }
    return enclosed_echo(ordinary, total);
  });
}

}  // namespace tubefoot
