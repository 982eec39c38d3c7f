// SPDX-License-Identifier: GPL-3.0-or-later
// Tests certified energies of scattering models. It compares them with single integrals in long doubles and
// with the ordinary run.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/certified/reference.hpp"
#include "engine/scattering/sediment.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Law = std::shared_ptr<const ScatteringModel>;
using Real = long double;

constexpr double scattering_height = 8;

Law shared(ScatteringModel model) { return std::make_shared<const ScatteringModel>(std::move(model)); }
Law three_terms() { return shared(ScatteringModel::gsab({0.4, 4 * degree, 0.01, 1.7, 0.03, 22 * degree})); }
Law coarse_sand() {
  return shared(
      ScatteringModel::table(sediment_grazing_deg, sediment_backscatter("coarse sand", 20).strength_db));
}

/// Two facets of a plane below the apex, on a grid of 2^-20 m about the apex.
struct Seabed {
  explicit Seabed(glm::dvec3 up = {0, 0, 1}) : grid(20, glm::dvec3(0)) {
    up = glm::normalize(up);
    const glm::dvec3 a = 256.0 * glm::normalize(glm::cross(up, glm::dvec3(0, 1, 0.1))), b = glm::cross(up, a),
                     centre =
                         -scattering_height * up + 0.1 * a + 0.03 * b;  // no edge contains the foot point
    MeshBuilder builder(grid);
    builder.add({centre - a - b, centre + a - b, centre + a + b, centre - a + b}, {{0, 1, 2}, {0, 2, 3}}, 0,
                0);
    MeshReport report;
    mesh = builder.finish(report);
    tree = std::make_unique<SceneTree>(mesh);
  }
  static TubeSet tube(const std::array<glm::dvec3, 4>& corners, double reach_m, const WorldGrid& grid) {
    TubeSet set;
    set.apex = grid.snap(glm::dvec3(0));
    set.reach = reach_m / grid.unit_m();
    Tube one;
    for (std::size_t k = 0; k < 4; ++k) {
      one[k] = std::uint32_t(k);
      set.rays.push_back(integer_ray(glm::normalize(corners[k])));
    }
    if (glm::dot(glm::cross(corners[0], corners[1]), corners[2]) < 0) std::swap(one[1], one[3]);
    set.tubes.push_back(one);
    return set;
  }
  struct Result {
    Echo ordinary;
    CertifiedEcho certified;
  };
  Result run(const TubeSet& set, const RangeSamples& samples, const Law& model, double tolerance,
             double absorption = 0, const BeamPatterns* patterns = nullptr) const {
    const std::vector<double> material_mu{0.001};
    const std::vector<Law> models{model};
    EchoModel echo_model{material_mu, mesh.material, absorption, patterns, 1e-11};
    echo_model.scattering = models;
    const std::vector<std::uint32_t> beam_of_tube{0};
    const VisibilityOptions options;
    const History history = TubeEngine(mesh, *tree, grid.unit_m(), options).trace(set);
    Result result{integrate_echo(history, {1, beam_of_tube}, samples, echo_model), {}};
    result.certified = certify_echo(mesh, *tree, history, options, beam_of_tube, samples, echo_model,
                                    result.ordinary, tolerance);
    return result;
  }

  WorldGrid grid;
  FacetMesh mesh;
  std::unique_ptr<SceneTree> tree;
};

/// A tube from straight below almost to the horizon, between two vertical planes.
const std::array<glm::dvec3, 4> scattering_wedge{
    glm::dvec3(0x1p-12, 0, -1), {0.5, 0, -0x1p-6}, {0.5, 0.125, -0x1p-6}, {0x1p-12, 0x1p-14, -1}};

/// Computes the published formulas in long doubles, without the evaluation code of `ScatteringModel`.
Real gsab_value(Real phi) {
  const auto lobe = [&](Real b) { return std::exp(-phi * phi / (2 * b * b)); };
  return 0.4L * lobe(4 * degree) + 0.01L * std::pow(std::cos(phi), 1.7L) + 0.03L * lobe(22 * degree);
}
Real table_value(Real phi) {
  const auto& angle = sediment_grazing_deg;
  const auto& level = sediment_backscatter("coarse sand", 20).strength_db;
  const Real grazing = 90 - phi / (std::numbers::pi_v<Real> / 180);
  if (grazing < angle[0])
    return std::pow(10.0L, level[0] / 10.0L) *
           std::pow(std::cos(phi) / std::sin(angle[0] * std::numbers::pi_v<Real> / 180), 2.0L);
  std::size_t k = 0;
  while (k + 2 < angle.size() && grazing > angle[k + 1]) ++k;
  return std::pow(
      10.0L,
      (level[k] + (grazing - angle[k]) / (angle[k + 1] - angle[k]) * (level[k + 1] - level[k])) / 10.0L);
}

double truth(Real (*value)(Real), bool table, double dphi, double from, double to, double absorption) {
  const Real beta = 2 * Real(absorption) * std::numbers::ln10_v<Real> / 10, h = scattering_height;
  std::vector<Real> ends{std::max<Real>(from, h), to};
  if (table)
    for (const double g : sediment_grazing_deg)
      if (const Real r = h / std::sin(g * std::numbers::pi_v<Real> / 180); r > ends[0] && r < to)
        ends.push_back(r);
  std::sort(ends.begin(), ends.end());
  Real sum = 0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k)
    sum += boost::math::quadrature::gauss_kronrod<Real, 31>::integrate(
        [&](Real x) {
          const Real r = std::hypot(h, x);
          return dphi * x * value(std::atan2(x, h)) * std::pow(r, Real(-4)) * std::exp(-beta * r);
        },
        std::sqrt((ends[k] - h) * (ends[k] + h)), std::sqrt((ends[k + 1] - h) * (ends[k + 1] + h)), 12,
        1e-17L);
  return double(sum);
}

TEST(CertifiedScattering, FanIsASingleIntegralWithinTheBound) {
  const Seabed seabed;
  const TubeSet set = Seabed::tube(scattering_wedge, 40, seabed.grid);
  const double dphi = std::atan2(double(set.rays[2].y), double(set.rays[2].x));
  const RangeSamples samples{9, 0.5, 40};
  const struct {
    Law model;
    Real (*value)(Real);
    bool table;
  } cases[] = {{three_terms(), gsab_value, false}, {coarse_sand(), table_value, true}};
  for (const auto& c : cases)
    for (const double absorption : {0.0, 0.3})
      for (const double tolerance : {1e-5, 1e-10}) {
        const auto result = seabed.run(set, samples, c.model, tolerance, absorption);
        EXPECT_EQ(result.certified.bins_over, 0u) << tolerance;
        for (int k = 0; k < samples.count; ++k) {
          const double from = 9 + 0.5 * k,
                       expected = truth(c.value, c.table, dphi, from, from + 0.5, absorption);
          const double energy = result.certified.echo.at(0, k),
                       bound = result.certified.bound[std::size_t(k)];
          EXPECT_LE(std::abs(energy - expected), bound + 1e-13 * expected)
              << "table " << c.table << ", sample " << k << ", tolerance " << tolerance;
          EXPECT_LE(bound, tolerance * energy);
          // The ordinary run agrees, too.
          EXPECT_NEAR(result.ordinary.at(0, k), energy, bound + 1e-11 * energy);
        }
      }
}

TEST(CertifiedScattering, BoundDoesNotHoldForAnotherLaw) {
  const Seabed seabed;
  const TubeSet set = Seabed::tube(scattering_wedge, 40, seabed.grid);
  const RangeSamples samples{9, 1, 20};
  const auto right = seabed.run(set, samples, three_terms(), 1e-9);
  const auto wrong =
      seabed.run(set, samples,
                 shared(ScatteringModel::gsab({0.4, 4 * degree, 0.01, 1.7 + 1e-6, 0.03, 22 * degree})), 1e-9);
  int apart = 0;
  for (int k = 0; k < samples.count; ++k)
    apart += std::abs(right.certified.echo.at(0, k) - wrong.certified.echo.at(0, k)) >
             right.certified.bound[std::size_t(k)] + wrong.certified.bound[std::size_t(k)];
  EXPECT_EQ(apart, samples.count);
}

TEST(CertifiedScattering, LambertAsGsabIsEnclosedAsLambertIs) {
  const Seabed seabed({0.2, -0.1, 1});
  const TubeSet set = Seabed::tube(
      {glm::dvec3(-0.3, -0.2, -1), {0.6, -0.3, -1}, {0.5, 0.4, -1}, {-0.2, 0.3, -1}}, 40, seabed.grid);
  const RangeSamples samples{7.5, 0.5, 12};
  const auto lambert = seabed.run(set, samples, nullptr, 1e-10, 0.1),
             gsab = seabed.run(set, samples,
                               shared(ScatteringModel::gsab({.oblique = 0.001, .oblique_exponent = 2})),
                               1e-10, 0.1);
  double sum = 0;
  for (int k = 0; k < samples.count; ++k) {
    const std::size_t i = std::size_t(k);
    sum += gsab.certified.echo.at(0, k);
    EXPECT_LE(std::abs(gsab.certified.echo.at(0, k) - lambert.certified.echo.at(0, k)),
              gsab.certified.bound[i] + lambert.certified.bound[i]);
  }
  EXPECT_GT(sum, 0);
  EXPECT_EQ(gsab.certified.bins_over, 0u);
}

TEST(CertifiedScattering, OrdinaryRunIsWithinTheBoundAboutTheFootAndWithPatterns) {
  const Seabed seabed({0.05, -0.1, 1});
  const TubeSet set = Seabed::tube(
      {glm::dvec3(-0.3, -0.2, -1), {0.6, -0.3, -1}, {0.5, 0.4, -1}, {-0.2, 0.3, -1}}, 40, seabed.grid);
  // A range bin that contains the foot point gets a wider bound than requested under patterns, also with
  // Lambert's law.
  const TubeSet aside = Seabed::tube(
      {glm::dvec3(0.3, -0.2, -1), {0.6, -0.3, -1}, {0.5, 0.4, -1}, {0.4, 0.3, -1}}, 40, seabed.grid);
  const RangeSamples samples{7.75, 0.5, 8};
  Directivity line;
  line.kind = Directivity::Kind::line;
  line.size = 6;
  const BeamPatterns patterns{{line}, {line}, {0}, {{0, 1}}};
  for (const Law& model : {three_terms(), coarse_sand()})
    for (const BeamPatterns* p : {(const BeamPatterns*)nullptr, &patterns}) {
      const double tolerance = p ? 1e-6 : 1e-8;
      const auto result = seabed.run(p ? aside : set, samples, model, tolerance, 0.1, p);
      EXPECT_EQ(result.certified.bins_over, 0u);
      double sum = 0;
      for (int k = 0; k < samples.count; ++k) {
        const double energy = result.certified.echo.at(0, k), bound = result.certified.bound[std::size_t(k)];
        EXPECT_NEAR(result.ordinary.at(0, k), energy, bound + 1e-9 * energy) << k;
        sum += energy;
      }
      EXPECT_GT(sum, 0);
    }
}

}  // namespace
}  // namespace tubefoot
