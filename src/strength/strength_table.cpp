// SPDX-License-Identifier: GPL-3.0-or-later
// Computes backscattering lengths of a mesh over directions and frequencies, in parallel over directions.
// It checks the mesh for open edges, coarse facets and a size below one wavelength, where Kirchhoff's
// approximation is invalid.
#include "strength/strength_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "engine/signal/certified_strength.hpp"
#include "engine/signal/placed_edges.hpp"
#include "engine/signal/target_strength.hpp"
#include "engine/visibility/far_view.hpp"
#include "files/input_error.hpp"
#include "geometry/steps/in_order.hpp"
#include "run/console/progress.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

/// An edge and a facet on it. Vertices at equal positions have the same number.
struct EdgeOfFacet {
  std::array<std::uint32_t, 2> ends;  ///< the smaller index first
  std::uint32_t facet, opposite;      ///< vertex opposite the edge
};

std::vector<EdgeOfFacet> edges_of(const ComponentMesh& mesh) {
  const std::vector<std::uint32_t> place = first_of_same_place(mesh.points_m);
  std::vector<EdgeOfFacet> edges;
  for (std::uint32_t facet = 0; facet < mesh.triangles.size(); ++facet)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<std::uint32_t, 3>& t = mesh.triangles[facet];
      const std::uint32_t a = place[t[k]], b = place[t[(k + 1) % 3]];
      if (a != b) edges.push_back({{std::min(a, b), std::max(a, b)}, facet, t[(k + 2) % 3]});
    }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const EdgeOfFacet& a, const EdgeOfFacet& b) { return a.ends < b.ends; });
  return edges;
}

/// Half of the diagonal of the bounding box of the mesh.
double radius_of(const ComponentMesh& mesh) {
  if (mesh.points_m.empty()) return 0;
  glm::dvec3 lo = mesh.points_m[0], hi = lo;
  for (const glm::dvec3& p : mesh.points_m) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  return glm::length(hi - lo) / 2;
}

/// Estimates the distance of two adjacent facets from a curved surface that they may approximate. A chord
/// of a circle that turns by an angle over a length deviates from it by angle times length over 8.
/// Triangles deviate by up to twice that. The shorter facet counts, because the longer one can be flat, as
/// between the side and the cap of a capsule. The distance is 0 at sharp edges and for coplanar facets.
struct Coarse {
  double off_m = 0, edge_m = 0;
};
Coarse coarseness(const ComponentMesh& mesh, const EdgeOfFacet& one, const EdgeOfFacet& other) {
  constexpr double sharp_rad = 0.61, flat_rad = 1e-6;  // 35 degrees
  const glm::dvec3 a = mesh.points_m[one.ends[0]], along = mesh.points_m[one.ends[1]] - a;
  const double length = glm::length(along);
  const auto height = [&](std::uint32_t corner) {
    const glm::dvec3 to = mesh.points_m[corner] - a;
    return to - glm::dot(to, along) / (length * length) * along;
  };
  const glm::dvec3 h = height(one.opposite), g = height(other.opposite);
  if (!(glm::length(h) > 0) || !(glm::length(g) > 0)) return {};
  const double angle = std::atan2(glm::length(glm::cross(h, g)), -glm::dot(h, g));
  if (angle > sharp_rad || angle < flat_rad) return {};
  return {angle * std::min(glm::length(h), glm::length(g)) / 4, length};
}

}  // namespace

ComponentMesh strength_mesh(const std::filesystem::path& file, std::optional<double> unit_m,
                            const std::optional<std::string>& up) {
  NamedMesh mesh = read_mesh_file(file, {up, unit_m});
  const double radius = radius_of(mesh);
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError(
        {file.string(), 0, 0},
        radius > 0 ? "the mesh is too large for floating-point numbers: check its unit"
                   : "all points of the mesh are at the same position, so it has no surface: check the file");
  return mesh;
}

std::pair<double, double> spread_db(const StrengthTable& table) {
  double weakest = std::numeric_limits<double>::infinity(), strongest = -weakest;
  for (const std::complex<double>& length : table.length_m) {
    weakest = std::min(weakest, target_strength_db(length));
    strongest = std::max(strongest, target_strength_db(length));
  }
  return {weakest, strongest};
}

BoundsHeld bounds_held(const StrengthTable& table) {
  const StrengthRequest& request = table.request;
  const std::size_t frequencies = request.frequencies_hz.size(), azimuths = request.azimuths_deg.size();
  std::vector<double> strongest(frequencies, 0);
  for (std::size_t k = 0; k < table.length_m.size(); ++k)
    strongest[k % frequencies] = std::max(strongest[k % frequencies], std::abs(table.length_m[k]));
  BoundsHeld held;
  for (std::size_t k = 0; k < table.bound_m.size(); ++k) {
    const double bound = table.bound_m[k];
    const double requested =
        request.tolerance.value_or(0) *
        std::max(std::abs(table.length_m[k]), strength_floor * strongest[k % frequencies]);
    held.most_m = std::max(held.most_m, bound);
    if (bound > 0) held.most_grid = std::max(held.most_grid, table.grid_bound_m[k] / bound);
    if (bound <= requested && requested > 0) {
      held.worst_ratio = std::max(held.worst_ratio, bound / requested);
      continue;
    }
    if (bound == 0) continue;  // the length is 0 and exact
    ++held.over;
    const double ratio = requested > 0 ? bound / requested : std::numeric_limits<double>::infinity();
    if (ratio <= held.worst_ratio) continue;
    held.worst_ratio = ratio;
    held.worst_elevation = k / frequencies / azimuths;
    held.worst_azimuth = k / frequencies % azimuths;
    held.worst_frequency = k % frequencies;
  }
  return held;
}

std::string in_words(const BoundsHeld& held, const StrengthTable& table) {
  const StrengthRequest& request = table.request;
  const double tolerance = request.tolerance.value_or(0);
  std::string words =
      held.over == 0
          ? fmt::format(
                "reference: certified; each bound is at most {:g} times the length; lengths below {:g} times "
                "the strongest length at the same frequency count as this minimum\n",
                tolerance, strength_floor)
          : fmt::format(
                "reference: {} of {} lengths have bounds wider than {:g}; the widest is {:.3g} times the "
                "requested bound, at elevation {:g}, azimuth {:g}, {:g} Hz\n",
                held.over, table.bound_m.size(), tolerance, held.worst_ratio,
                request.elevations_deg[held.worst_elevation], request.azimuths_deg[held.worst_azimuth],
                request.frequencies_hz[held.worst_frequency]);
  return words + fmt::format(
                     "bounds         up to {:.3g} m, of which up to {:.3g} % are due to rounding to the grid "
                     "of the view\n",
                     held.most_m, 100 * held.most_grid);
}

std::optional<std::string> too_small_for(const ComponentMesh& mesh, double lowest_frequency_hz,
                                         double sound_speed) {
  const double across = 2 * radius_of(mesh) * lowest_frequency_hz / sound_speed;
  if (across >= 1) return std::nullopt;
  return fmt::format(
      "the mesh is {:.2g} wavelengths across at {:g} Hz, but the Kirchhoff approximation needs about one "
      "wavelength or more (docs/signals.md)",
      across, lowest_frequency_hz);
}

std::vector<std::string> warnings_of(const ComponentMesh& mesh, double highest_frequency_hz,
                                     double sound_speed) {
  const std::vector<EdgeOfFacet> edges = edges_of(mesh);
  std::size_t all = 0, open = 0, crowded = 0;
  Coarse worst;
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t end = k + 1;
    while (end < edges.size() && edges[end].ends == edges[k].ends) ++end;
    ++all;
    if (end - k == 1) ++open;
    if (end - k > 2) ++crowded;
    if (end - k == 2)
      if (const Coarse coarse = coarseness(mesh, edges[k], edges[k + 1]); coarse.off_m > worst.off_m)
        worst = coarse;
    k = end;
  }
  std::vector<std::string> warnings;
  if (open > 0)
    warnings.push_back(fmt::format(
        "the mesh is open: {} of its {} edges belong to only one facet. Both sides of a facet reflect, "
        "including inner sides that can be seen through the opening: close the mesh if the body is closed",
        open, all));
  if (crowded > 0)
    warnings.push_back(
        fmt::format("{} of the {} edges of the mesh belong to more than two facets; only one of several "
                    "coincident facets reflects",
                    crowded, all));
  constexpr double good = 1.0 / 50;  // corresponds to a two-way phase of a quarter of a radian
  const double wavelength = sound_speed / highest_frequency_hz;
  if (worst.off_m > good * wavelength)
    warnings.push_back(fmt::format(
        "flat facets deviate from a curved surface by up to {:.3g} mm, which is {:.2g} of the wavelength at "
        "{:g} Hz ({:.3g} mm). The result is the target strength of the mesh of flat facets. For a deviation "
        "of 1/50 of a wavelength, multiply edge lengths by {:.2g} ({:.3g} mm instead of {:.3g} mm)",
        1e3 * worst.off_m, worst.off_m / wavelength, highest_frequency_hz, 1e3 * wavelength,
        std::sqrt(good * wavelength / worst.off_m),
        1e3 * worst.edge_m * std::sqrt(good * wavelength / worst.off_m), 1e3 * worst.edge_m));
  const double phase = 4 * std::numbers::pi / wavelength * radius_of(mesh) * FarView::vertex_error;
  constexpr double worth_telling_rad = 0.01;
  if (phase > worth_telling_rad)
    warnings.push_back(
        fmt::format("the mesh is {:.3g} wavelengths across at {:g} Hz; rounding its vertices to a grid for "
                    "each direction causes phase errors of up to {:.2g} rad",
                    2 * radius_of(mesh) / wavelength, highest_frequency_hz, phase));
  return warnings;
}

StrengthTable strength_of(const ComponentMesh& mesh, const std::string& name, const StrengthRequest& request,
                          bool quiet) {
  StrengthTable table{request, name, {}, {}};
  std::vector<double> wave_numbers;
  for (const double hertz : request.frequencies_hz)
    wave_numbers.push_back(2 * std::numbers::pi * hertz / request.sound_speed);
  struct Seen {
    std::vector<std::complex<double>> length_m;
    double silhouette_m2;
    std::vector<CertifiedLength> certified{};
  };
  std::optional<CertifiedStrength> reference;
  if (request.tolerance) reference.emplace(mesh.points_m, mesh.triangles);
  Progress progress("directions", table.directions(), quiet);
  const std::size_t azimuths = request.azimuths_deg.size();
  in_order(
      0, table.directions(), mesh.triangles.size() * 400 + wave_numbers.size() * 16,
      [&](std::size_t direction) {
        const double azimuth = request.azimuths_deg[direction % azimuths],
                     elevation = request.elevations_deg[direction / azimuths];
        if (reference) {
          CertifiedStrength::Seen seen = reference->towards(azimuth, elevation, request.surface,
                                                            request.sound_speed, request.frequencies_hz);
          return Seen{{}, seen.silhouette_m2, std::move(seen.lengths)};
        }
        const glm::dvec3 towards = sonar_direction(azimuth, elevation);
        const FarView view = far_view(mesh.points_m, mesh.triangles, towards);
        return Seen{backscattering_lengths(view, mesh.points_m, mesh.triangles, towards, request.surface,
                                           wave_numbers),
                    view.area_m2()};
      },
      [&](std::size_t, const Seen& seen) {
        table.length_m.insert(table.length_m.end(), seen.length_m.begin(), seen.length_m.end());
        for (const CertifiedLength& certified : seen.certified) {
          table.length_m.push_back(certified.length_m);
          table.bound_m.push_back(certified.bound_m);
          table.grid_bound_m.push_back(certified.grid_m);
        }
        table.silhouette_m2.push_back(seen.silhouette_m2);
        progress.step();
      });
  return table;
}

}  // namespace tubefoot
