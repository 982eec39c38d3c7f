// SPDX-License-Identifier: GPL-3.0-or-later
// References of two ends through refracting water: against closed forms of one gradient integrated apart, the
// reference of one apex, straight references, exchange, and every enclosure of a facet against single rays.
#include "engine/certified/paired_reference.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "fixtures/world/gradient_bed.hpp"
#include "fixtures/world/textures.hpp"

namespace tubefoot {
namespace {

using test::bed_fan;
using test::bed_gradient;
using test::GradientBed;
using test::Triangle;

constexpr double degree = GradientBed::degree;

/// Two ends over a flat bed, and what stands on it.
struct Paired {
  const GradientBed& site;
  const WaterColumn& water;
  TubeSet sent, heard;
  double absorption = 0;
  const BeamPatterns* patterns = nullptr;

  EigenrayOptions options{.deepest_turn_m = GradientBed::apex_depth_m + GradientBed::below_m};
  Straightening end(const TubeSet& tubes) const {
    return Straightening(water, site.grid.to_metres(tubes.apex), GradientBed::apex_depth_m, options, 1500);
  }
  RefractedReference certified(const StraighteningSettings& settings, const RangeSamples& samples,
                               double tolerance) const {
    std::vector<FacetId> all(site.base.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    const Straightening out = end(sent), home = end(heard);
    const Outlook from_out(sent, site.grid.unit_m(), out), from_home(heard, site.grid.unit_m(), home);
    const AlikeGrounds alike = straighten_alike(site.base, all, site.grid, std::array{&out, &home},
                                                absorption, settings, {}, std::array{&from_out, &from_home});
    const ApparentPair pair{alike.bed.mesh, alike.seen[0], alike.seen[1], alike.origin[0], alike.origin[1]};
    EchoLaw law = site.law(pair.mesh, absorption);
    law.patterns = patterns;
    const std::vector<std::uint32_t> beams(heard.tubes.size(), 0);
    const Echo ordinary = integrate_echo(
        trace_bistatic(pair, site.grid, {}, sent, heard, out, home, absorption), {1, beams}, samples, law);
    const RayEnclosure out_rays(out, options), home_rays(home, options);
    const SceneTree out_tree(alike.seen[0].refined.mesh, SceneTree::Sheets::ignored),
        home_tree(alike.seen[1].refined.mesh, SceneTree::Sheets::ignored);
    const PairedBed bed{alike.bed.mesh,
                        alike.bed.parent,
                        site.base,
                        site.grid,
                        {alike.seen[0], out_tree, alike.origin[0], out, out_rays},
                        {alike.seen[1], home_tree, alike.origin[1], home, home_rays}};
    return certify_refracted_echo(bed, {sent, heard}, {}, {1, beams}, samples, law, ordinary, tolerance);
  }
  CertifiedEcho straight(const RangeSamples& samples, double tolerance) const {
    EchoLaw law = site.law(site.base, absorption);
    law.patterns = patterns;
    const std::vector<std::uint32_t> beams(heard.tubes.size(), 0);
    const SceneTree tree(site.base);
    const BistaticHistory history = trace_bistatic(site.base, tree, site.grid.unit_m(), {}, sent, heard);
    const Echo ordinary = integrate_echo(history, {1, beams}, samples, law);
    return certify_echo(site.base, history, {1, beams}, samples, law, ordinary, tolerance);
  }
};

TubeSet at(TubeSet tubes, const WorldGrid& grid, glm::dvec3 apex_m) {
  tubes.apex = grid.snap(apex_m);
  return tubes;
}

/// Of one gradient: the ray from an apex to a place, in closed form (physics.md).
struct Ray {
  double time_s, sine, area_m2, arc_m;  ///< on the bed; per steradian at the apex
  Ray(double g, glm::dvec3 apex, glm::dvec3 place) {
    const double cs = 1500 - g * apex.z, cr = 1500 - g * place.z, h = apex.z - place.z,
                 x = std::hypot(place.x - apex.x, place.y - apex.y), chord = std::hypot(x, h),
                 tilt = std::atan(g * x / (cs + cr));
    time_s = std::acosh(1 + g * g * chord * chord / (2 * cs * cr)) / std::abs(g);
    sine = std::sin(std::asin(h / chord) - tilt);
    area_m2 = std::pow(cr * std::sinh(g * time_s) / g, 2);
    arc_m = chord * tilt / std::sin(tilt);
  }
};

/// What a rectangle of the bed returns to each sample, cell by cell of a fine grid about its borders.
std::vector<double> rectangle(double g, glm::dvec3 out, glm::dvec3 home, glm::dvec2 from, glm::dvec2 to,
                              const RangeSamples& samples, double absorption) {
  std::vector<double> energy(std::size_t(samples.count), 0);
  const double beta = absorption * std::numbers::ln10 / 10, cr = 1500 + g * GradientBed::below_m,
               speeds = (1500 - g * home.z) / cr;
  const auto place = [](double x, double y) { return glm::dvec3(x, y, -GradientBed::below_m); };
  const auto half = [&](double x, double y) {
    return 750 * (Ray(g, out, place(x, y)).time_s + Ray(g, home, place(x, y)).time_s);
  };
  const auto density = [&](double x, double y) {
    const Ray a(g, out, place(x, y)), b(g, home, place(x, y));
    return GradientBed::mu * a.sine * b.sine / (a.area_m2 * b.area_m2 * speeds * speeds) *
           std::exp(-beta * (a.arc_m + b.arc_m));
  };
  using Rule = boost::math::quadrature::gauss<double, 15>;
  constexpr int rows = 400;
  // Along x half paths grow from here on: borders by bisection, rows of y by Gauss.
  const std::array<double, 3> node{-std::sqrt(0.6), 0, std::sqrt(0.6)}, weight{5. / 18, 8. / 18, 5. / 18};
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < 3; ++k) {
      const double dy = (to.y - from.y) / rows, y = from.y + dy * (row + (1 + node[std::size_t(k)]) / 2);
      double x = from.x;
      for (int s = 0; s <= samples.count && x < to.x; ++s) {
        const double border = samples.first_m + s * samples.step_m;
        if (half(x, y) >= border) continue;
        double low = x, high = to.x;
        if (half(high, y) > border)
          for (int i = 0; i < 60; ++i) {
            const double middle = (low + high) / 2;
            (half(middle, y) < border ? low : high) = middle;
          }
        else
          low = high;
        if (s > 0)
          energy[std::size_t(s - 1)] +=
              weight[std::size_t(k)] * dy *
              Rule::integrate([&](double at_x) { return density(at_x, y); }, x, low);
        x = low;
      }
    }
  return energy;
}

/// Of which only a rectangle scatters: a bed with mu there alone would need a material; so a small one lies
/// in the water by itself.
GradientBed plate(glm::dvec2 from, glm::dvec2 to) {
  const double z = -GradientBed::below_m;
  GradientBed bed({}, 256, 512);
  MeshBuilder builder(bed.grid);
  builder.add(std::vector<glm::dvec3>{{from, z}, {to.x, from.y, z}, {to, z}, {from.x, to.y, z}},
              std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}, 0, 0);
  MeshReport report;
  bed.base = builder.finish(report);
  return bed;
}

const glm::dvec3 transmitter(0), receiver(-4, 3, 2);
const glm::dvec2 from(12, -3), to(24, 4);

TEST(PairedReference, HoldsTheClosedFormOfOneGradient) {
  const GradientBed bed = plate(from, to);
  const RangeSamples samples{22, 0.8, 16};
  for (const double g : {-0.6, 0.3}) {
    const double absorption = g < 0 ? 0.1 : 0;
    const std::vector<double> truth = rectangle(g, transmitter, receiver, from, to, samples, absorption);
    const WaterColumn water = bed_gradient(g, absorption);
    const Paired pair{bed, water, at(bed_fan(70), bed.grid, transmitter), at(bed_fan(70), bed.grid, receiver),
                      absorption};
    double before = 1, closest = 0;
    for (const double gap : {2e-2, 2e-3}) {
      SCOPED_TRACE(fmt::format("g {} gap {}", g, gap));
      const RefractedReference found = pair.certified({.gap_m = gap}, samples, 1e-2);
      EXPECT_EQ(found.unbounded, 0u);
      double bounds = 0, energies = 0;
      for (std::size_t k = 0; k < truth.size(); ++k) {
        const double energy = found.certified.echo.energy[k], bound = found.certified.bound[k];
        EXPECT_LE(std::abs(energy - truth[k]), bound + 1e-6 * truth[k]) << k;
        if (truth[k] > 0) {
          EXPECT_GT(std::abs(energy + 2 * bound - truth[k]), bound - 1e-6 * truth[k]) << k;
        }
        if (bound > 0) closest = std::max(closest, std::abs(energy - truth[k]) / bound);
        bounds += bound;
        energies += energy;
      }
      std::printf("g %g gap %g: bounds %g of energies, closest %g\n", g, gap, bounds / energies, closest);
      EXPECT_GT(energies, 0);
      EXPECT_LT(bounds / energies, before / 2);
      before = bounds / energies;
    }
    EXPECT_LT(before, 0.05);
    EXPECT_GT(closest, 0.02);
  }
}

}  // namespace
}  // namespace tubefoot
