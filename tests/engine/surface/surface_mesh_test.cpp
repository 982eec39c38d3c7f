// SPDX-License-Identifier: GPL-3.0-or-later
// Tests surface meshes with relief: online and offline refinement, watertightness, materials at their
// borders, displacement of a sphere, and the tolerance of refinement.

#include "engine/surface/surface_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>

#include "engine/echo/echo.hpp"
#include "engine/echo/finer_relief.hpp"
#include "engine/visibility/tube_engine.hpp"

namespace tubefoot {
namespace {

/// A product of sines, for which the error of a mesh is known.
class SineField : public ElevationField {
 public:
  SineField(double amplitude, double wavelength, double phase = 0)
      : a_(amplitude), k_(2 * M_PI / wavelength), phase_(phase) {}
  double height_m(glm::dvec3 p) const override {
    return a_ * std::sin(k_ * p.x + phase_) * std::cos(k_ * p.y + 0.7 * p.z);
  }
  double largest_m() const override { return a_; }
  double finest_m() const override { return 2 * M_PI / k_ / 8; }
  /// Chords of a sine wave: sagitta and slope error of one edge. The error is the full wave for edges as
  /// long as a wave.
  LeftOut left_out(double edge) const override {
    const double bend = std::min(1.0, k_ * edge * k_ * edge / 8), slope = a_ * k_ * std::min(1.0, k_ * edge);
    return {a_ * bend / 2, slope / 2, 2 * a_ * bend, 2 * slope};
  }

 private:
  double a_, k_, phase_;
};

using Fields = std::vector<std::shared_ptr<const ElevationField>>;

/// A seabed of n by n squares about the origin, of one material or with a function of materials.
FacetMesh seabed(const WorldGrid& grid, int n, double side_m, double slope = 0,
                 std::uint16_t (*material)(int i, int j) = nullptr) {
  std::vector<glm::dvec3> points;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = (double(i) / n - 0.5) * side_m, y = (double(j) / n - 0.5) * side_m;
      points.push_back({x, y, slope * y});
    }
  MeshBuilder builder(grid);
  for (std::uint16_t wanted = 0; wanted < 2; ++wanted) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        if ((material ? int{material(i, j)} : 0) != wanted) continue;
        const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1,
                   c = a + static_cast<std::uint32_t>(n) + 1, d = c + 1;
        triangles.push_back({a, b, d});
        triangles.push_back({a, d, c});
      }
    builder.add(points, triangles, wanted, 0);
  }
  MeshReport report;
  return builder.finish(report);
}

const WorldGrid grid(20, {0, 0, 0});

/// A camera above the origin that looks north and downwards.
TubeSet camera(double height_m, double tilt_deg, int beams, double width_deg = 12, double reach_m = 8) {
  TubeSet set;
  set.apex = grid.snap({0.013, -2.007, height_m});
  AngularGrid angles;
  const double w = width_deg * M_PI / 180, t = tilt_deg * M_PI / 180, v = 5 * M_PI / 180;
  for (int b = 0; b <= beams; ++b) angles.azimuth_edges_rad.push_back(w * (double(b) / beams - 0.5));
  angles.elevation_edges_rad = {-v, v};
  const glm::dvec3 forward{0, std::cos(t), -std::sin(t)}, right{1, 0, 0}, up{0, std::sin(t), std::cos(t)};
  angles.frame = glm::dmat3(forward, right, up);
  append_tubes(set, angles);
  set.reach = reach_m / grid.unit_m();
  return set;
}

constexpr RangeSamples samples{2, 0.05, 120};

struct Transmission {
  RefinedMesh surface_mesh;
  History history;
  Echo echo;
};

Transmission fired(const RefinedMesh& surface_mesh, const TubeSet& tubes) {
  Transmission transmission{surface_mesh, {}, {}};
  const SceneTree tree(transmission.surface_mesh.mesh, SceneTree::HeightFieldSearch::ignored);
  const TubeEngine engine(transmission.surface_mesh.mesh, tree, grid.unit_m(), {});
  transmission.history = engine.trace(tubes);
  std::vector<std::uint32_t> beams(tubes.tubes.size());
  std::iota(beams.begin(), beams.end(), 0u);
  const std::vector<double> mu(4, 0.01);
  transmission.echo = integrate_echo(transmission.history, {static_cast<int>(beams.size()), beams}, samples,
                                     {mu, transmission.surface_mesh.mesh.material, 0});
  return transmission;
}

double total(const Echo& echo) { return std::accumulate(echo.energy.begin(), echo.energy.end(), 0.0); }

SurfaceSettings cells(double cell_m, double tolerance = 0) {
  return {cell_m, Displacement::vertical, tolerance};
}

Look look_of(const TubeSet& tubes) { return {&tubes, samples.first_m, samples.step_m}; }

/// Returns the polygons of each tube, independent of facet numbers.
std::vector<std::vector<double>> polygons(const Transmission& transmission) {
  std::vector<std::vector<double>> all;
  const FootprintSet& set = transmission.history.footprints;
  for (const Footprint& f : set.footprints)
    for (std::uint32_t p = 0; p < f.piece_count; ++p) {
      const Piece& piece = set.pieces[f.first_piece + p];
      std::vector<double> polygon{double(f.tube), f.plane_distance_m, f.area_m2};
      for (std::uint32_t c = 0; c < piece.count; ++c)
        for (int k = 0; k < 3; ++k) polygon.push_back(set.corners_m[piece.first + c][k]);
      all.push_back(polygon);
    }
  return all;
}

/// With equal refinement, both modes give the same visible polygons to the last bit.
TEST(SurfaceMesh, OnlineAndOfflineSeeTheSame) {
  const FacetMesh base = seabed(grid, 3, 16, 0.1);
  for (int seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE(seed);
    const Fields fields{std::make_shared<SineField>(0.04, 0.5, seed), nullptr};
    const SurfaceMesh surface_mesh(base, grid, fields, cells(0.06));
    const RefinedMesh everywhere = surface_mesh.everywhere({});
    const TubeSet tubes = camera(1.5 + 0.3 * seed, 20 + 10 * seed, 6);
    const std::array<Look, 1> looks{look_of(tubes)};
    const RefinedMesh seen = surface_mesh.seen_by(looks, {});
    EXPECT_LT(2 * seen.mesh.facets.size(), everywhere.mesh.facets.size());
    const Transmission offline = fired(everywhere, tubes), online = fired(seen, tubes);
    EXPECT_GT(online.history.footprints.footprints.size(), 500u);
    EXPECT_EQ(polygons(offline), polygons(online));
    EXPECT_EQ(offline.echo.energy, online.echo.energy);
  }
}

TEST(SurfaceMesh, RefiningWithoutDisplacementChangesNoEnergy) {
  // The cases are a sloping seabed whose bisections all lie on the grid, and a level seabed of irregular
  // size.
  for (const auto& [side, slope] : {std::pair{16.0, 0.25}, std::pair{14.37, 0.0}}) {
    const FacetMesh base = seabed(grid, 2, side, slope);
    const SurfaceMesh surface_mesh(base, grid, Fields{std::make_shared<SineField>(0.0, 0.5), nullptr},
                                   cells(0.12));
    const TubeSet tubes = camera(2, 25, 6);
    RefinedMesh plain;
    plain.mesh = base;
    const Transmission coarse = fired(plain, tubes), fine = fired(surface_mesh.everywhere({}), tubes);
    ASSERT_GT(total(coarse.echo), 0);
    EXPECT_GT(fine.history.footprints.footprints.size(), 8 * coarse.history.footprints.footprints.size());
    const double largest = *std::max_element(coarse.echo.energy.begin(), coarse.echo.energy.end());
    for (std::size_t k = 0; k < coarse.echo.energy.size(); ++k)
      EXPECT_NEAR(fine.echo.energy[k], coarse.echo.energy[k],
                  1e-12 * std::max(coarse.echo.energy[k], 1e-2 * largest));
  }
}

/// Tubes wholly inside a displaced seabed see no water: the proof is exact.
TEST(SurfaceMesh, IsWatertightWhateverItsLevels) {
  const FacetMesh base = seabed(grid, 3, 16);
  const Fields fields{std::make_shared<SineField>(0.08, 0.4), std::make_shared<SineField>(0.02, 0.9)};
  for (const double tolerance : {0.0, 0.02, 0.2, 1.0}) {
    const TubeSet tubes = camera(1.2, 45, 5, 12, 6);
    std::array<Look, 1> looks{look_of(tubes)};
    looks[0].first_m = tolerance;  // near ranges finer or not
    const RefinedMesh seen = SurfaceMesh(base, grid, fields, cells(0.04, tolerance)).seen_by(looks, {});
    const SceneTree tree(seen.mesh, SceneTree::HeightFieldSearch::ignored);
    const TubeEngine engine(seen.mesh, tree, grid.unit_m(), {});
    for (const TubeAudit& audit : engine.audit(tubes, 0)) EXPECT_TRUE(audit.closes);
    VisibilityOptions options;
    options.open_water = true;
    VisibilityScratch scratch;
    TubeVisibility view;
    for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube) {
      see(seen.mesh, tree, tubes, tube, options, scratch, view);
      EXPECT_FALSE(view.pieces.empty());
      EXPECT_TRUE(view.open.empty());
    }
  }
}

TEST(SurfaceMesh, BordersOfMaterialsFit) {
  const auto checkered = [](int i, int j) { return static_cast<std::uint16_t>((i + j) % 2); };
  const FacetMesh base = seabed(grid, 4, 8, 0.05, checkered);
  for (const Fields& fields :
       {Fields{std::make_shared<SineField>(0.1, 0.7), std::make_shared<SineField>(0.06, 0.4, 1)},
        Fields{std::make_shared<SineField>(0.1, 0.7), nullptr}}) {
    const RefinedMesh refined = SurfaceMesh(base, grid, fields, cells(0.2)).everywhere({});
    std::map<std::pair<VertexId, VertexId>, int> facets;
    for (const auto& f : refined.mesh.facets)
      for (int k = 0; k < 3; ++k) ++facets[std::minmax(f[k], f[(k + 1) % 3])];
    for (const auto& [edge, count] : facets) {
      const glm::dvec3 a = grid.to_metres(refined.mesh.vertices[edge.first]),
                       b = grid.to_metres(refined.mesh.vertices[edge.second]);
      const bool outer = (std::abs(a.x) == 4 && a.x == b.x) || (std::abs(a.y) == 4 && a.y == b.y);
      EXPECT_EQ(count, outer ? 1 : 2);
    }
    // On the border both materials have the mean of their heights. A material without relief counts as
    // zero.
    std::size_t met = 0;
    for (const GridPoint p : refined.mesh.vertices) {
      const glm::dvec3 m = grid.to_metres(p);
      if (m.x != 2 || std::fmod(std::abs(m.y), 2) == 0) continue;
      ++met;
      const glm::dvec3 flat{m.x, m.y, 0.05 * m.y};
      double sum = 0;
      for (const auto& f : fields) sum += f ? f->height_m(flat) : 0;
      EXPECT_NEAR(m.z, flat.z + sum / 2, 2 * grid.unit_m());
    }
    EXPECT_GT(met, 20u);
  }
}

TEST(SurfaceMesh, NormalDisplacementOfASphereStaysClosed) {
  // An octahedron on a sphere, refined into a sphere by the test: four bisections.
  std::vector<glm::dvec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<std::uint32_t, 3>> facets{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                   {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < 3; ++level) {
    std::vector<std::array<std::uint32_t, 3>> next;
    for (const auto& [a, b, c] : facets) {
      const auto mid = [&](std::uint32_t p, std::uint32_t q) {
        points.push_back(glm::normalize(points[p] + points[q]));
        return static_cast<std::uint32_t>(points.size() - 1);
      };
      const std::uint32_t x = mid(a, b), y = mid(b, c), z = mid(c, a);
      next.insert(next.end(), {{a, x, z}, {x, b, y}, {z, y, c}, {x, y, z}});
    }
    facets = next;
  }
  MeshBuilder builder(grid);
  builder.add(points, facets, 0, 0);
  MeshReport report;
  const FacetMesh base = builder.finish(report);
  const Fields fields{std::make_shared<SineField>(0.05, 0.5)};
  const RefinedMesh refined = SurfaceMesh(base, grid, fields, {0.05, Displacement::normal, 0}).everywhere({});
  OpenMesh::TriMesh_ArrayKernelT<> mesh;
  std::vector<OpenMesh::VertexHandle> handle;
  double outermost = 0, innermost = 2;
  for (const GridPoint p : refined.mesh.vertices) {
    handle.push_back(mesh.add_vertex({}));
    const double r = glm::length(grid.to_metres(p));
    outermost = std::max(outermost, r);
    innermost = std::min(innermost, r);
  }
  for (const auto& [a, b, c] : refined.mesh.facets)
    ASSERT_TRUE(mesh.add_face(handle[a], handle[b], handle[c]).is_valid());
  for (const auto edge : mesh.edges()) EXPECT_FALSE(mesh.is_boundary(edge));
  EXPECT_EQ(mesh.n_vertices() + mesh.n_faces(), mesh.n_edges() + 2);
  EXPECT_GT(outermost, 1.03);
  EXPECT_LT(innermost, 0.98);
  EXPECT_LT(outermost, 1.051);
}

TEST(SurfaceMesh, DoesNotDependOnThreads) {
  const FacetMesh base = seabed(grid, 2, 16);
  const SurfaceMesh surface_mesh(base, grid, Fields{std::make_shared<SineField>(0.05, 0.5), nullptr},
                                 cells(0.05, 0.02));
  const TubeSet tubes = camera(1.7, 30, 8);
  const std::array<Look, 1> looks{look_of(tubes)};
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return surface_mesh.seen_by(looks, {});
  };
  const RefinedMesh one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.mesh.vertices, four.mesh.vertices);
  EXPECT_EQ(one.mesh.facets, four.mesh.facets);
  EXPECT_EQ(one.parent, four.parent);
}

/// A tolerance leaves facets coarse. It changes the energies by no more than its value, and makes fewer
/// facets. The measure is the RMS over the range bins that are insonified throughout.
TEST(SurfaceMesh, ToleranceIsKept) {
  const FacetMesh base = seabed(grid, 1, 16);
  for (int seed = 0; seed < 3; ++seed) {
    const Fields fields{std::make_shared<SineField>(0.01, 0.4, seed), nullptr};
    const TubeSet tubes = camera(2, 35, 6);
    const std::array<Look, 1> looks{look_of(tubes)};
    const RefinedMesh fine = SurfaceMesh(base, grid, fields, cells(0.015)).seen_by(looks, {});
    const Transmission truth = fired(fine, tubes);
    std::size_t last = fine.mesh.facets.size();
    for (const double tolerance : {0.03, 0.3}) {
      const RefinedMesh some = SurfaceMesh(base, grid, fields, cells(0.015, tolerance)).seen_by(looks, {});
      EXPECT_LT(some.mesh.facets.size(), last);
      last = some.mesh.facets.size();
      const Transmission transmission = fired(some, tubes);
      const double largest = *std::max_element(truth.echo.energy.begin(), truth.echo.energy.end());
      double sum2 = 0;
      int lit = 0;
      for (std::size_t k = 0; k < truth.echo.energy.size(); ++k) {
        if (truth.echo.energy[k] < 0.2 * largest) continue;
        sum2 += std::pow(transmission.echo.energy[k] / truth.echo.energy[k] - 1, 2);
        ++lit;
      }
      ASSERT_GT(lit, 50);
      EXPECT_LT(std::sqrt(sum2 / lit), tolerance) << "seed " << seed;
    }
  }
}

TEST(SurfaceMesh, FinerReliefChangesNoMoreThanStated) {
  const FacetMesh base = seabed(grid, 1, 16);
  for (int seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE(seed);
    const Fields fields{std::make_shared<SineField>(0.01, 0.4, seed), nullptr};
    const TubeSet tubes = camera(2, 35, 6);
    const std::array<Look, 1> looks{look_of(tubes)};
    const SurfaceMesh coarse(base, grid, fields, cells(0.05)), fine(base, grid, fields, cells(0.02));
    const Transmission a = fired(coarse.seen_by(looks, {}), tubes), b = fired(fine.seen_by(looks, {}), tubes);
    const double stated =
        finer_relief(a.history, a.surface_mesh.mesh, coarse.omitted(), samples.step_m).largest;
    double changed = 0;
    for (std::size_t k = 0; k < a.echo.energy.size(); ++k)
      changed += std::abs(a.echo.energy[k] - b.echo.energy[k]);
    EXPECT_LT(changed / total(b.echo), stated);
    EXPECT_LT(stated, 2);
  }
}

TEST(SurfaceMesh, FindsTheSeabedInLineWithAPlace) {
  const FacetMesh base = seabed(grid, 1, 64);
  const SineField field(0.3, 1.1);
  const SurfaceMesh surface_mesh(base, grid, Fields{std::make_shared<SineField>(field), nullptr},
                                 cells(0.02));
  for (const glm::dvec3 at : {glm::dvec3{3.3, -7.1, 2}, {0, 0, 1}, {-20.01, 11.4, 0.2}}) {
    const RefinedMesh line = surface_mesh.in_line_with(at);
    EXPECT_LT(line.mesh.facets.size(), 20000u);
    double nearest = 1e9, height = 0;
    for (const GridPoint p : line.mesh.vertices) {
      const glm::dvec3 m = grid.to_metres(p);
      if (std::hypot(m.x - at.x, m.y - at.y) >= nearest) continue;
      nearest = std::hypot(m.x - at.x, m.y - at.y);
      height = m.z - field.height_m({m.x, m.y, 0});
    }
    EXPECT_LT(nearest, 0.015);
    EXPECT_NEAR(height, 0, 2 * grid.unit_m());
  }
}

TEST(SurfaceMesh, RefusesTooMuch) {
  const FacetMesh base = seabed(grid, 1, 100);
  const SurfaceMesh surface_mesh(base, grid, Fields{std::make_shared<SineField>(0.01, 0.4), nullptr},
                                 cells(0.01));
  EXPECT_EQ(surface_mesh.uniform_count(), std::size_t{1} << 29);
  EXPECT_THROW(surface_mesh.everywhere({10000}), RefinementTooLarge);
}

}  // namespace
}  // namespace tubefoot
