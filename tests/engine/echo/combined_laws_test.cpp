// SPDX-License-Identifier: GPL-3.0-or-later
// Tests scattering model, micro-texture, beam patterns and reflection loss of mirrors together, in each
// integrator. The comparison is brute-force quadrature with independent formulas.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <random>

#include "engine/certified/reference.hpp"
#include "engine/echo/echo.hpp"
#include "engine/paths/path_echo.hpp"
#include "engine/scattering/layered_reflectivity.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "fixtures/world/textures.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::add_footprint;
using test::Field;
using test::line;
using test::map_askew;
using test::on_plane;
using test::perlin;
using test::Polygon2;
using test::rectangle;

constexpr double seabed_height_m = 4;
const FacetPlane flat_bed = test::flat_seabed(seabed_height_m);

/// A scattering model and an independent formula: cross-section by angle of incidence.
struct Law {
  std::string name;
  double mu = 0;
  std::shared_ptr<const ScatteringModel> model;
  std::function<double(double incidence)> value;
};

Law lambert(double mu = 0.002) {
  return {"Lambert", mu, nullptr, [mu](double phi) { return mu * std::cos(phi) * std::cos(phi); }};
}
Law gsab(double width_deg = 6, double mu = 0.5) {
  const double b = width_deg * degree, f = 20 * degree;
  return {"GSAB", mu,  // mu must have no effect
          std::make_shared<const ScatteringModel>(ScatteringModel::gsab({0.4, b, 0.01, 1.7, 0.03, f})),
          [=](double phi) {
            return 0.4 * std::exp(-phi * phi / (2 * b * b)) + 0.01 * std::pow(std::cos(phi), 1.7) +
                   0.03 * std::exp(-phi * phi / (2 * f * f));
          }};
}
Law table(double mu = 0.5) {
  static const std::vector<double> grazing{10, 35, 52, 80, 90}, level{-32, -24, -20, -16, -9};
  return {"table", mu, std::make_shared<const ScatteringModel>(ScatteringModel::table(grazing, level)),
          [](double phi) {
            const double g = 90 - phi / degree;
            if (g < grazing[0])
              return std::pow(10, level[0] / 10) *
                     std::pow(std::sin(g * degree) / std::sin(grazing[0] * degree), 2);
            std::size_t k = 0;
            while (k + 2 < grazing.size() && g > grazing[k + 1]) ++k;
            const double x = (g - grazing[k]) / (grazing[k + 1] - grazing[k]);
            return std::pow(10, (level[k] + x * (level[k + 1] - level[k])) / 10);
          }};
}
std::vector<Law> models() { return {lambert(), gsab(), table()}; }

/// Textures that are smooth enough for quadrature rules without knowledge of texture cells.
std::vector<Field> smooth_textures() {
  return {nullptr, perlin(0.5, 2, 0.5, 5),
          std::make_shared<LayeredReflectivity>(std::vector{perlin(0.9, 1, 0.5, 5), perlin(0.7, 1, 0.5, 5)})};
}

/// No patterns; beams of one array, which the integrator computes from moments; beams without a common
/// axis; tables.
std::vector<std::optional<BeamPatterns>> pattern_sets(std::uint32_t tubes) {
  const glm::dvec3 x{1, 0, 0}, y{0, 1, 0};
  const TransmitPattern sent(std::vector<Directivity>{line(6, 0.1, y), line(6, -0.3, y)});
  const auto set = [&](TransmitPattern transmit, std::vector<Directivity> receive) {
    BeamPatterns patterns{{std::move(transmit)}, std::move(receive), {}, {}};
    patterns.fan_of_tube.assign(tubes, 0);
    patterns.beams_of_tube.assign(tubes, {0, std::uint32_t(patterns.receive.size())});
    return patterns;
  };
  return {std::nullopt, set(sent, {line(20, 0.1, x), line(20, 0.3, x), line(20, 0.5, x), line(20, 0.7, x)}),
          set(sent, {line(9, 0.4, x), {Directivity::Kind::gaussian, y, false, 0.2, 0.3, {}}})};
}

struct Given {
  Law model;
  Field texture;
  const BeamPatterns* patterns = nullptr;
  double absorption_db_per_m = 0.2;
  glm::dvec3 apex_m{123.456, -78.9, 4.2};
  double tolerance = 1e-6;

  double beta() const { return 2 * absorption_db_per_m * std::log(10.0) / 10; }
  double gain(glm::dvec3 direction, std::size_t beam) const {
    return patterns == nullptr
               ? 1
               : patterns->transmit[0].gain(direction) * patterns->receive[beam].gain(direction);
  }
  /// Returns the energy per square metre of a level seabed at a position relative to the apex.
  double density(glm::dvec3 p, std::size_t beam, double distance = seabed_height_m) const {
    const double r = glm::length(p);
    return model.value(std::acos(std::min(distance / r, 1.0))) * (texture ? texture->factor(apex_m + p) : 1) *
           gain(p / r, beam) * std::exp(-beta() * r) / std::pow(r, 4);
  }
  std::string name() const {
    return model.name + (texture ? ", texture" : "") + (patterns ? ", patterns" : "");
  }
  std::size_t beams() const { return patterns ? patterns->receive.size() : 1; }
};

/// An `EchoModel` and the data that it refers to. All facets have one material.
struct Laws {
  explicit Laws(const Given& g, std::size_t facets = 4)
      : mu{g.model.mu}, material(facets, 0), fields{g.texture}, scattering{g.model.model} {
    model = {mu,          material, g.absorption_db_per_m, g.patterns,
             g.tolerance, fields,   Path{Leg{g.apex_m}},   scattering};
  }
  Laws(const Laws&) = delete;
  Laws& operator=(const Laws&) = delete;
  std::vector<double> mu;
  std::vector<std::uint16_t> material;
  std::vector<Field> fields;
  std::vector<std::shared_ptr<const ScatteringModel>> scattering;
  EchoModel model;
};

/// Gauss's rule of N nodes on each of n.x times n.y panels, for all beams at once.
template <int N>
std::vector<double> panels(glm::dvec2 lo, glm::dvec2 hi, glm::ivec2 n, std::size_t values,
                           const std::function<double(glm::dvec2, std::size_t)>& density) {
  using Rule = boost::math::quadrature::gauss<double, N>;
  std::vector<std::pair<double, double>> rule;
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
    for (const double side : {-1.0, 1.0})
      if (side < 0 || Rule::abscissa()[i] > 0)
        rule.emplace_back(side * Rule::abscissa()[i], Rule::weights()[i]);
  const glm::dvec2 half = (hi - lo) / (2.0 * glm::dvec2(n));
  std::vector<double> sums(values, 0);
  for (int i = 0; i < n.x; ++i)
    for (int j = 0; j < n.y; ++j)
      for (const auto& [u, wu] : rule)
        for (const auto& [v, wv] : rule) {
          const glm::dvec2 p = lo + half * glm::dvec2(2 * i + 1 + u, 2 * j + 1 + v);
          for (std::size_t k = 0; k < values; ++k) sums[k] += wu * wv * density(p, k) * half.x * half.y;
        }
  return sums;
}

glm::dvec3 surface_apex(glm::dvec2 p, double distance = seabed_height_m) {
  const FacetPlane plane = test::flat_seabed(distance);
  const PlaneFrame frame(plane);
  return -distance * plane.normal + p.x * frame.u + p.y * frame.v;
}

/// Makes one footprint of tube 0 per polygon, on facets 0, 1, ...
History history_of(const std::vector<std::pair<FacetPlane, Polygon2>>& parts) {
  History history;
  for (const auto& [plane, polygon] : parts)
    add_footprint(history, 0, FacetId(history.footprints.footprints.size()), plane, {polygon});
  measure(history.footprints);
  return history;
}

const std::vector<std::uint32_t> one_beam{0};

template <class Check>
void for_all(std::uint32_t tubes, const Check& check) {
  for (const auto& patterns : pattern_sets(tubes))
    for (const Law& model : models())
      for (const Field& texture : smooth_textures()) {
        const Given given{model, texture, patterns ? &*patterns : nullptr};
        SCOPED_TRACE(given.name());
        check(given);
      }
}

TEST(CombinedLaws, OrdinaryEchoAgreesWithBruteForce) {
  // The polygons lie about the foot point, next to it, and far from it.
  const std::vector<std::pair<glm::dvec2, glm::dvec2>> places{
      {{-0.7, -0.5}, {0.4, 0.5}}, {{0.3, 0.2}, {1.2, 1}}, {{6, 1}, {7, 1.9}}};
  for (const auto& [lo, hi] : places) {
    const History history = history_of({{flat_bed, rectangle(lo, hi)}});
    for_all(1, [&, lo = lo, hi = hi](const Given& given) {
      const auto expected = panels<4>(lo, hi, {45, 45}, given.beams(), [&](glm::dvec2 p, std::size_t b) {
        return given.density(surface_apex(p), b);
      });
      Given ideal = given;
      ideal.patterns = nullptr;
      const double peak = given.patterns == nullptr
                              ? expected[0]
                              : panels<4>(lo, hi, {20, 20}, 1, [&](glm::dvec2 p, std::size_t) {
                                  return 2 * ideal.density(surface_apex(p), 0);
                                })[0];
      for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
        Given own = given;
        own.tolerance = tolerance;
        const Laws l(own);
        const Echo echo = integrate_echo(history, {int(given.beams()), one_beam}, {0.1, 0.31, 80}, l.model);
        for (std::size_t b = 0; b < given.beams(); ++b) {
          const auto row = echo.energy.begin() + std::ptrdiff_t(b) * echo.samples;
          EXPECT_NEAR(std::accumulate(row, row + echo.samples, 0.0) / peak, expected[b] / peak,
                      tolerance + 5e-7)
              << "beam " << b << ", tolerance " << tolerance << ", from " << lo.x;
        }
      }
    });
  }
}

TEST(CombinedLaws, RangeSamplesAreRings) {
  const History history = history_of({{flat_bed, rectangle({-4, -4}, {4, 4})}});
  const RangeSamples samples{4.07, 0.11, 4};  // between the ranges of the kinks of the table
  for_all(1, [&](const Given& given) {
    const Laws l(given);
    const Echo echo = integrate_echo(history, {int(given.beams()), one_beam}, samples, l.model);
    for (int k = 0; k < samples.count; ++k) {
      const auto rho = [&](int i) {
        return std::sqrt(std::pow(samples.first_m + i * samples.step_m, 2) -
                         seabed_height_m * seabed_height_m);
      };
      const auto ring = [&](const Given& g, glm::ivec2 n) {
        return panels<4>({rho(k), 0}, {rho(k + 1), 2 * pi}, n, g.beams(), [&](glm::dvec2 p, std::size_t b) {
          return p.x * g.density(surface_apex({p.x * std::cos(p.y), p.x * std::sin(p.y)}), b);
        });
      };
      const auto expected = ring(given, {3, 180});
      Given ideal = given;
      ideal.patterns = nullptr;
      const double peak = given.patterns == nullptr ? expected[0] : 2 * ring(ideal, {1, 60})[0];
      for (std::size_t b = 0; b < given.beams(); ++b)
        EXPECT_NEAR(echo.at(int(b), k) / peak, expected[b] / peak, 2e-6) << "beam " << b << ", sample " << k;
    }
  });
}

TEST(CombinedLaws, ToleranceIsKeptByTheProductOfAllFactors) {
  const unsigned seed = 20262;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-3, 3), size(0.1, 1.5), distance(0.7, 5);
  double worst = 0;
  for (int i = 0; i < 15; ++i) {
    const FacetPlane plane = test::random_plane(random, distance(random));
    const glm::dvec2 lo(place(random), place(random)), hi = lo + glm::dvec2(size(random), size(random));
    const History history = history_of({{plane, rectangle(lo, hi)}});
    for (const auto& patterns : pattern_sets(1))
      for (const Law& model : {gsab(2), gsab(12), table()})
        for (const Field& texture : {perlin(0.4, 1, 0.5, 5), map_askew()}) {
          const auto energies = [&](double tolerance) {
            const Laws l(
                {model, texture, patterns ? &*patterns : nullptr, 0.2, {123.456, -78.9, 4.2}, tolerance});
            return integrate_echo(history, {patterns ? int(patterns->receive.size()) : 1, one_beam},
                                  {0.1, 100, 1}, l.model)
                .energy;
          };
          const Laws ideal({model, nullptr});
          const double peak =
              2 * integrate_echo(history, {1, one_beam}, {0.1, 100, 1}, ideal.model).energy[0];
          const auto exact = energies(1e-12);
          for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
            const auto own = energies(tolerance);
            for (std::size_t b = 0; b < own.size(); ++b) {
              worst = std::max(worst, std::abs(own[b] - exact[b]) / peak / tolerance);
            }
          }
        }
  }
  EXPECT_LT(worst, 1);
}

TEST(CombinedLaws, FacetsOfAllKindsBesideEachOtherAddUp) {
  // The footprints alternate between Lambert's law and another model, uniform and textured, on planes at
  // equal and at different distances.
  const std::vector<Law> all{lambert(), gsab(), table(), gsab(15)};
  const std::vector<Field> fields{nullptr, perlin(0.5, 2, 0.5, 5), map_askew()};
  std::vector<std::pair<FacetPlane, Polygon2>> parts;
  std::vector<double> mu;
  std::vector<std::uint16_t> material;
  std::vector<Field> reflectivity;
  std::vector<std::shared_ptr<const ScatteringModel>> scattering;
  for (int i = 0; i < 24; ++i) {
    const double x = 0.9 * (i % 6) - 0.4, y = 0.7 * (i / 6) - 0.3;
    parts.push_back(
        {test::flat_seabed(i % 5 == 3 ? 3.5 : seabed_height_m), rectangle({x, y}, {x + 0.8, y + 0.6})});
    const Law& model = all[std::size_t(i * 7) % all.size()];
    mu.push_back(model.mu);
    material.push_back(std::uint16_t(i));
    reflectivity.push_back(fields[std::size_t(i * 5) % 3]);
    scattering.push_back(model.model);
  }
  const RangeSamples samples{3.4, 0.05, 90};
  for (const auto& patterns : pattern_sets(1)) {
    EchoModel model{mu, material, 0.2, patterns ? &*patterns : nullptr};
    model.reflectivity = reflectivity;
    model.scattering = scattering;
    model.path.tx.apex_m = {123.456, -78.9, 4.2};
    const int beams = patterns ? int(patterns->receive.size()) : 1;
    const Echo together = integrate_echo(history_of(parts), {beams, one_beam}, samples, model);
    std::vector<double> sum(together.energy.size(), 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      EchoModel own = model;
      const std::vector<std::uint16_t> own_material{material[i]};
      own.material = own_material;
      const Echo one = integrate_echo(history_of({parts[i]}), {beams, one_beam}, samples, own);
      EXPECT_GT(std::accumulate(one.energy.begin(), one.energy.end(), 0.0), 0);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += one.energy[k];
    }
    const double most = *std::max_element(sum.begin(), sum.end());
    for (std::size_t k = 0; k < sum.size(); ++k)
      EXPECT_NEAR(together.energy[k], sum[k], 1e-9 * most) << k << " of " << beams << " beams";
  }
}

TEST(CombinedLaws, FastBinningAndRaysTakeAllOfThemAtOnePlace) {
  const glm::dvec2 lo{1, 0.4}, hi{1.3, 0.8};
  const History tubes = history_of({{flat_bed, rectangle(lo, hi)}});
  const glm::dvec3 centroid = tubes.footprints.footprints[0].centroid_m;
  for_all(1, [&](const Given& given) {
    const Laws l(given);
    const auto total = [&](const History& history, Binning binning, std::size_t beam) {
      const RangeSamples samples{0.1, 0.2, 60};
      const Echo echo = integrate_echo(history, {int(given.beams()), one_beam}, samples, l.model, binning);
      const auto row = echo.energy.begin() + std::ptrdiff_t(beam) * echo.samples;
      return std::accumulate(row, row + echo.samples, 0.0);
    };
    for (std::size_t b = 0; b < given.beams(); ++b) {
      const double expected = given.density(centroid, b) * (hi.x - lo.x) * (hi.y - lo.y);
      for (const Binning binning : {Binning::spread, Binning::centroid})
        EXPECT_NEAR(total(tubes, binning, b), expected, 1e-12 * expected) << b;
    }
    // Rays through a square lattice: the directions of the rays are floats.
    constexpr int n = 60;
    History rays;
    const glm::dvec2 cell = (hi - lo) / double(n);
    std::vector<double> sum(given.beams(), 0);
    double size = 0;
    for (int i = 0; i < n * n; ++i) {
      const glm::dvec3 p = surface_apex(lo + cell * glm::dvec2(i % n + 0.5, i / n + 0.5));
      const double r = glm::length(p), sine = seabed_height_m / r;
      rays.hits.push_back({0, 0, r, sine, cell.x * cell.y * sine / (r * r), glm::vec3(p / r)});
      for (std::size_t b = 0; b < given.beams(); ++b) sum[b] += given.density(p, b) * cell.x * cell.y;
      size += given.model.value(std::acos(sine)) * std::pow(r, -4) * cell.x * cell.y;
    }
    for (std::size_t b = 0; b < given.beams(); ++b) {
      EXPECT_NEAR(total(rays, Binning::exact, b), sum[b], 1e-5 * size) << b;
      EXPECT_NEAR(total(rays, Binning::exact, b), total(tubes, Binning::exact, b), 3e-4 * size) << b;
    }
  });
}

// --- transmitter and separate receiver, and loss of mirrors

/// Combines the angles of both legs as sqrt(sigma sigma), as docs/environment.md defines.
double apart_density(const Given& g, const Path* path, glm::dvec3 t, double ht, glm::dvec3 r, double hr,
                     std::size_t beam, const glm::dmat3& mirrored = glm::dmat3(1)) {
  const double rt = glm::length(t), rr = glm::length(r);
  double value = std::sqrt(g.model.value(std::acos(ht / rt)) * g.model.value(std::acos(hr / rr))) *
                 std::exp(-g.beta() / 2 * (rt + rr)) / (rt * rt * rr * rr);
  if (g.texture) value *= g.texture->factor(g.apex_m + t);
  if (g.patterns)
    value *= g.patterns->transmit[0].gain(mirrored * t / rt) * g.patterns->receive[beam].gain(r / rr);
  if (path) value *= path->tx.loss.at(t / rt) * path->back().loss.at(r / rr);
  return value;
}

TEST(CombinedLaws, BistaticEchoAndLossAgreeWithBruteForce) {
  const glm::dvec2 lo{0.4, 0.1}, hi{1.3, 0.8};
  const glm::dvec3 receiver{0.7, -1.1, 0.8};
  const BistaticHistory history = test::piece_on(flat_bed, rectangle(lo, hi), receiver);
  Path over_mirrors;
  over_mirrors.tx.loss = {0.7, {{0, 0, 1}}, 3};
  over_mirrors.rx = Leg{};
  over_mirrors.rx->loss = {1, {{0, 0, 1}, glm::normalize(glm::dvec3(1, 0, 1))}, 0.6};
  for_all(1, [&](const Given& given) {
    Laws l(given);
    for (const Path* mirrors : {static_cast<const Path*>(nullptr), static_cast<const Path*>(&over_mirrors)}) {
      const Leg at_place = l.model.path.tx;
      if (mirrors != nullptr) {
        l.model.path = *mirrors;
        l.model.path.tx.apex_m = at_place.apex_m;
      }
      const auto expected = panels<4>(lo, hi, {25, 25}, given.beams(), [&](glm::dvec2 p, std::size_t b) {
        const glm::dvec3 t = surface_apex(p);
        return apart_density(given, mirrors, t, seabed_height_m, t - receiver, seabed_height_m + receiver.z,
                             b);
      });
      const double most = *std::max_element(expected.begin(), expected.end());
      const double tolerance = given.model.name == "table" ? 1e-5 : 1e-6;
      for (const RangeSamples samples : {RangeSamples{0, 100, 1}, RangeSamples{0, 0.09, 1000}}) {
        const Echo echo =
            integrate_echo(history, {int(given.beams()), one_beam}, samples, l.model, {Binning::exact, 1e-8});
        for (std::size_t b = 0; b < given.beams(); ++b) {
          const auto row = echo.energy.begin() + std::ptrdiff_t(b) * echo.samples;
          EXPECT_NEAR(std::accumulate(row, row + echo.samples, 0.0) / most, expected[b] / most, tolerance)
              << b << ' ' << samples.count;
        }
      }
    }
  });
}

/// Facets, an apex and pyramids of rays through the corners of rectangles, on a grid of 2^-20 m.
struct Bench {
  static constexpr double unit = 0x1p-20;
  FacetMesh mesh;
  TubeSet tubes;

  static GridPoint at(glm::dvec3 p) {
    return {std::int32_t(std::lround(p.x / unit)), std::int32_t(std::lround(p.y / unit)),
            std::int32_t(std::lround(p.z / unit))};
  }
  void add_seabed(glm::dvec2 lo, glm::dvec2 hi) {
    const VertexId v[] = {test::add_vertex(mesh, at({lo, -seabed_height_m})),
                          test::add_vertex(mesh, at({hi.x, lo.y, -seabed_height_m})),
                          test::add_vertex(mesh, at({hi, -seabed_height_m})),
                          test::add_vertex(mesh, at({lo.x, hi.y, -seabed_height_m}))};
    test::add_facet(mesh, v[0], v[1], v[2]);
    test::add_facet(mesh, v[0], v[2], v[3]);
  }
  /// Adds a tube of rays to the corners of a horizontal rectangle.
  void add_tube(glm::dvec2 lo, glm::dvec2 hi, double z) {
    const auto first = std::uint32_t(tubes.rays.size());
    for (const glm::dvec2 c : {lo, glm::dvec2(hi.x, lo.y), hi, glm::dvec2(lo.x, hi.y)})
      tubes.rays.push_back(integer_ray(glm::normalize(glm::dvec3(c, z))));
    Tube tube{first, first + 1, first + 2, first + 3};
    if (z < 0) std::swap(tube[1], tube[3]);
    tubes.tubes.push_back(tube);
    tubes.reach = 100 / unit;
  }
};

TEST(CombinedLaws, CertifiedBoundHoldsTheBruteForceValue) {
  // Cells of the noise on a level seabed are squares of 1/4 m, so that the panels between the cell borders
  // are smooth.
  const glm::dvec2 lo{0.25, 0.5}, hi{1, 1};
  const Field texture = perlin(0.5, 2, 0.5, 5);
  Bench bench;
  bench.add_seabed({-20, -20}, {20, 20});
  bench.add_tube(lo, hi, -seabed_height_m);
  const SceneTree tree(bench.mesh);
  const VisibilityOptions options;
  const History history = TubeEngine(bench.mesh, tree, Bench::unit, options).trace(bench.tubes);
  const RangeSamples samples{3, 2, 1};
  const BeamPatterns patterns{
      {TransmitPattern(std::vector<Directivity>{line(6, 0.1, {0, 1, 0}), line(6, -0.3, {0, 1, 0})})},
      {line(9, 0.4, {1, 0, 0})},
      {0},
      {{0, 1}}};
  for (const BeamPatterns* p : {static_cast<const BeamPatterns*>(nullptr), &patterns})
    for (const Law& model : {gsab(), table()}) {
      Given given{model, texture, p};
      given.apex_m = {32.25, -17.5, 4.125};
      SCOPED_TRACE(given.name());
      const Laws l(given);
      const Echo ordinary = integrate_echo(history, {1, one_beam}, samples, l.model);
      const double tolerance = 1e-7;
      const CertifiedEcho certified =
          certify_echo(bench.mesh, tree, history, options, one_beam, samples, l.model, ordinary, tolerance);
      // The pieces of a table meet on a circle, which the panels do not resolve.
      const int n = model.name == "table" ? 120 : 12;
      const double truth = panels<10>(lo, hi, {n, n}, 1, [&](glm::dvec2 q, std::size_t) {
        return given.density({q, -seabed_height_m}, 0);
      })[0];
      const double oracle = model.name == "table" ? 2e-7 : 2e-8;  // corners are rounded to rays
      EXPECT_EQ(certified.bins_over, 0u);
      EXPECT_LE(certified.bound[0], tolerance * certified.echo.energy[0]);
      EXPECT_LE(std::abs(certified.echo.energy[0] - truth), certified.bound[0] + oracle * truth);
      EXPECT_NEAR(ordinary.energy[0], certified.echo.energy[0], 2e-6 * certified.echo.energy[0]);
    }
}

TEST(CombinedLaws, MirroredEchoAgreesWithBruteForce) {
  // A part of the seabed, seen directly from above and by the path over the water surface.
  const double surface = 1.5, rms = 0.02;
  const glm::dvec2 lo{0.5, 0.25}, hi{1, 0.625};
  Bench bench;
  bench.add_seabed(lo, hi);
  const glm::dvec2 margin{0.1, 0.1};
  bench.add_tube(lo - margin, hi + margin, -seabed_height_m);
  bench.add_tube(lo - margin, hi + margin, seabed_height_m + 2 * surface);
  const SceneTree tree(bench.mesh);
  const std::vector<std::uint32_t> beam(2, 0);
  PathSettings settings;
  settings.order = 2;
  settings.cutoff_db = 300;
  const std::vector<double> reflection{0};
  settings.mirrors.reflection = reflection;
  const double roughness = 40 * 40 * 4 * rms * rms;
  settings.mirrors.surface = SeaSurface{std::int32_t(std::lround(surface / Bench::unit)), 0.8, roughness};
  // For the path over the water surface, the transmitter has its mirror image at 2 * surface. Sound from
  // there travels downwards.
  const glm::dvec3 image{0, 0, 2 * surface};
  const double far = seabed_height_m + 2 * surface;
  const glm::dmat3 flipped{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  const auto patterns = pattern_sets(2);
  for (const auto& set : patterns)
    for (const Law& model : models())
      for (const Field& texture : {Field(), perlin(0.5, 2, 0.5, 5)}) {
        const Given given{model, texture, set ? &*set : nullptr};
        SCOPED_TRACE(given.name());
        const Laws l(given);
        const RangeSamples samples{0, 0.25, 60};
        const PathEcho paths = path_echo(bench.mesh, tree, Bench::unit, VisibilityOptions(), bench.tubes,
                                         bench.tubes, {int(given.beams()), beam}, samples, l.model, settings);
        const auto expected = panels<4>(lo, hi, {25, 25}, given.beams(), [&](glm::dvec2 q, std::size_t b) {
          const glm::dvec3 p{q, -seabed_height_m}, from_image = p - image;
          const double rt = glm::length(from_image), rr = glm::length(p);
          const double lost = 0.8 * std::exp(-roughness * std::pow(far / rt, 2));
          double value = std::sqrt(given.model.value(std::acos(far / rt)) *
                                   given.model.value(std::acos(seabed_height_m / rr))) *
                         std::exp(-given.beta() / 2 * (rt + rr)) / (rt * rt * rr * rr) * lost;
          if (given.texture) value *= given.texture->factor(given.apex_m + p);
          if (!given.patterns) return 2 * value;
          const glm::dvec3 up = flipped * from_image / rt, down = p / rr;
          const auto& sent = given.patterns->transmit[0];
          const auto& received = given.patterns->receive[b];
          return value * (sent.gain(up) * received.gain(down) + sent.gain(down) * received.gain(up));
        });
        const double most = *std::max_element(expected.begin(), expected.end());
        for (std::size_t b = 0; b < given.beams(); ++b) {
          const auto row = paths.by_order[2].energy.begin() + std::ptrdiff_t(b) * samples.count;
          EXPECT_NEAR(std::accumulate(row, row + samples.count, 0.0) / most, expected[b] / most,
                      model.name == "table" ? 1e-5 : 2e-6)
              << b;
        }
      }
}

}  // namespace
}  // namespace tubefoot
