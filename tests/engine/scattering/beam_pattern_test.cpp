// SPDX-License-Identifier: GPL-3.0-or-later
// Compares beam patterns with the physics sheet (4.2). Integrals of beam patterns over footprints are
// compared with independent quadrature: triangles in space, adaptive, without slabs and arcs.
#include "engine/scattering/beam_pattern.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <numeric>

#include "engine/echo/echo.hpp"
#include "engine/echo/pair_on_facet.hpp"
#include "engine/scattering/radial_model.hpp"
#include "fixtures/geometry/plane_polygons.hpp"
#include "fixtures/world/histories.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using test::on_plane;
using test::Polygon2;
using Kind = Directivity::Kind;
using test::add_footprint;
using test::one_beam;
using test::total;

double db(double power) { return 10 * std::log10(power); }

Directivity line(double length_over_wavelength, double steered_rad = 0) {
  return {Kind::line, {1, 0, 0}, false, std::sin(steered_rad), length_over_wavelength};
}
Directivity piston(double ka) { return {Kind::piston, {0, 1, 0}, true, 0, ka}; }
Directivity gaussian(double width_rad) { return {Kind::gaussian, {1, 0, 0}, false, 0, width_rad}; }

// Between its nulls the amplitude of a sinc or of a piston has one sign, which alternates from lobe to lobe.
TEST(BeamPattern, AmplitudeChangesSignAtTheNulls) {
  const Directivity steered = line(4, std::asin(0.3));
  for (const double cosine : {-0.9, -0.65, -0.4, -0.1, 0.1, 0.3, 0.5, 0.6, 0.7, 0.9}) {
    const int nulls = int(std::abs(4 * (cosine - 0.3)));
    EXPECT_EQ(amplitude_sign(steered, cosine), nulls % 2 == 0 ? 1 : -1) << cosine;
  }
  for (const auto& [sine, sign] :
       {std::pair{0.0, 1}, {0.3, 1}, {0.5, -1}, {0.65, -1}, {0.8, 1}, {0.95, 1}})  // nulls at 0.383 and 0.702
    EXPECT_EQ(amplitude_sign(piston(10), std::sqrt(1 - sine * sine)), sign) << sine;
}

TEST(LineAmplitude, IsTheTransformOfTheWeights) {
  for (const double shading : {0.0, 0.3, 0.852, 1.0})
    for (const double u : {0.0, 0.4, 1.0, 1.7, -2.0, 5.3}) {
      const auto weighted = [&](double x) {
        return (1 + shading * std::cos(2 * pi * x)) * std::cos(2 * pi * u * x);
      };
      const double transform =
          boost::math::quadrature::gauss_kronrod<double, 31>::integrate(weighted, -0.5, 0.5);
      EXPECT_NEAR(line_amplitude(u, shading), transform, 1e-13) << shading << " " << u;
    }
}

TEST(LineAmplitude, HasTheWidthsAndSideLobesOfTheDocumentation) {
  const struct {
    double shading, width, side_lobe_db;
  } rows[] = {{0, 0.886, -13.3}, {0.5, 1.076, -25.7}, {0.852, 1.303, -42.7}, {1, 1.441, -31.5}};
  for (const auto& [shading, width, side_lobe_db] : rows) {
    EXPECT_NEAR(db(std::pow(line_amplitude(width / 2, shading), 2)), -3.01, 0.01) << shading;
    // The main lobe ends at the first null.
    double u = 0.9, highest = 0;
    while (std::abs(line_amplitude(u + 1e-3, shading)) < std::abs(line_amplitude(u, shading))) u += 1e-3;
    for (; u < 20; u += 1e-3) highest = std::max(highest, std::abs(line_amplitude(u, shading)));
    EXPECT_NEAR(db(highest * highest), side_lobe_db, 0.05) << shading;
  }
}

TEST(BeamPattern, AmplitudeOfAShadedArrayChangesSignAtItsNulls) {
  Directivity shaded = line(8, std::asin(0.3));
  shaded.shading = 0.75;  // nulls at u = 2, 3, ... and at 1 / sqrt(1 - shading) = 2: no change of sign at 2
  for (const auto& [u, sign] : {std::pair{0.5, 1}, {1.5, 1}, {2.5, 1}, {3.5, -1}, {-3.5, -1}})
    EXPECT_EQ(amplitude_sign(shaded, 0.3 + u / 8), sign) << u;
}

TEST(PairIntegrand, GainsBelowTheSmallestOneCountAsZero) {
  const std::vector<double> mu{0.1};
  const std::vector<std::uint16_t> material{0};
  const FacetPlane plane{{0, 0, 1}, 10};
  const PlaneFrame frame(plane);
  const Directivity beam = gaussian(0.2);
  const PathCutter::Receiver apex = over_plane(plane, frame, glm::dvec3(0));
  const glm::dvec2 place(2, 1);
  const double range = std::sqrt(105);
  const double gain = std::pow(beam.gain((2.0 * frame.u + frame.v - 10.0 * plane.normal) / range), 2);
  const auto energy = [&](double least) {
    double value = -1;
    PairIntegrand{{PathOnFacet(plane, frame, apex, apex, 0, {mu, material}),
                   {std::span(&beam, 1), &beam, least}}}(place, range, range, std::span(&value, 1));
    return value;
  };
  EXPECT_GT(energy(0.999 * gain), 0);
  EXPECT_EQ(energy(0.999 * gain), energy(0));
  EXPECT_EQ(energy(1.001 * gain), 0);
}

TEST(BeamPattern, LineArrayHasThePublishedWidthsAndSideLobe) {
  const double size = 100;
  const Directivity d = line(size);
  EXPECT_EQ(d.gain_at(0), 1);
  EXPECT_NEAR(db(d.gain_at(std::sin(0.88589 / 2 / size))), -3.0103, 2e-4);
  EXPECT_NEAR(db(std::pow(d.gain_at(std::sin(0.63783 / 2 / size)), 2)), -3.0103, 2e-4);
  EXPECT_NEAR(db(d.gain_at(1.4303 / size)), -13.261, 1e-3);
  EXPECT_NEAR(d.gain_at(1 / size), 0, 1e-30);
}

TEST(BeamPattern, SteeringMovesTheMainLobe) {
  const Directivity d = line(120, 10 * degree);
  EXPECT_EQ(d.gain_at(std::sin(10 * degree)), 1);
  EXPECT_LT(d.gain_at(0), 1e-3);
}

TEST(BeamPattern, PistonHasThePublishedWidthsAndSideLobe) {
  const double ka = 200;
  const Directivity d = piston(ka);
  const auto off_axis = [&](double angle) { return d.gain_at(std::cos(angle)); };
  EXPECT_EQ(off_axis(0), 1);
  const double lambda_over_diameter = pi / ka;
  EXPECT_NEAR(db(off_axis(1.02899 * lambda_over_diameter / 2)), -3.0103, 3e-4);
  EXPECT_NEAR(db(off_axis(std::asin(5.135 / ka))), -17.570, 1e-3);
  for (const double x : {0.0, 0.005, 0.00999, 0.0101, 0.1, 1.0, 3.8, 7.0}) {
    const double exact = x == 0 ? 1 : std::pow(2 * boost::math::cyl_bessel_j(1, x) / x, 2);
    EXPECT_NEAR(off_axis(std::asin(x / ka)), exact, 1e-11) << x;
  }
}

TEST(BeamPattern, GaussianIsHalfAtHalfItsWidth) {
  const Directivity d = gaussian(3 * degree);
  EXPECT_NEAR(d.gain_at(std::sin(1.5 * degree)), 0.5, 1e-14);
  EXPECT_NEAR(d.gain_at(std::sin(-1.5 * degree)), 0.5, 1e-14);
  EXPECT_NEAR(d.gain_at(std::sin(3 * degree)), 1.0 / 16, 1e-14);
}

TEST(BeamPattern, TableGoesThroughItsRowsWithoutOvershoot) {
  const std::vector<double> angle{-0.3, -0.1, 0, 0.2, 0.21, 0.5}, level{-30, -10, 0, -3, -25, -25};
  const PatternTable table(angle, level);
  for (std::size_t k = 0; k < angle.size(); ++k) EXPECT_NEAR(table.level_db(angle[k]), level[k], 1e-12);
  EXPECT_EQ(table.level_db(-2), -30);
  EXPECT_EQ(table.level_db(2), -25);
  for (std::size_t k = 0; k + 1 < angle.size(); ++k)
    for (double x = 0; x <= 1; x += 1.0 / 64) {
      const double value = table.level_db(angle[k] + x * (angle[k + 1] - angle[k]));
      EXPECT_GE(value, std::min(level[k], level[k + 1]) - 1e-9);
      EXPECT_LE(value, std::max(level[k], level[k + 1]) + 1e-9);
    }
  // The levels are continuous across the rows, and so is their slope.
  for (const double a : angle)
    EXPECT_NEAR((table.level_db(a + 1e-7) - table.level_db(a)),
                (table.level_db(a) - table.level_db(a - 1e-7)), 2e-7);
}

TEST(BeamPattern, TableRefusesWhatIsNoTable) {
  EXPECT_THROW(PatternTable({0}, {0}), std::invalid_argument);
  EXPECT_THROW(PatternTable({0, 0}, {0, 1}), std::invalid_argument);
  EXPECT_THROW(PatternTable({0, 1}, {0}), std::invalid_argument);
  EXPECT_THROW(PatternTable({0, 1}, {0, std::nan("")}), std::invalid_argument);
}

// --- integrals over footprints

const double mu = std::pow(10, -2.7);

Echo echo_of(const History& history, const RangeSamples& samples, double absorption_db_per_m,
             const BeamPatterns* patterns, double tolerance = 1e-11) {
  const std::vector<double> material_mu{mu};
  const std::vector<std::uint16_t> one_facet{0};
  const std::vector<std::uint32_t> beam_of_tube(patterns ? patterns->fan_of_tube.size() : 1, 0);
  return integrate_echo(history, {patterns ? int(patterns->receive.size()) : 1, beam_of_tube}, samples,
                        EchoModel{material_mu, one_facet, absorption_db_per_m, patterns, tolerance});
}

/// Returns the energy of a polygon at ranges first to last, triangle by triangle in space.
double quadrature(const FacetPlane& plane, const Polygon2& p, double absorption_db_per_m,
                  const std::function<double(glm::dvec3)>& gain, double first, double last) {
  using boost::math::quadrature::gauss_kronrod;
  const double beta = 2 * absorption_db_per_m * std::log(10.0) / 10;
  const auto corners = on_plane(plane, p);
  double sum = 0;
  for (std::size_t t = 2; t < p.size(); ++t) {
    const glm::dvec3 a = corners[0], b = corners[t - 1] - a, c = corners[t] - corners[t - 1];
    const double jacobian = glm::length(glm::cross(b, c));
    const auto density = [&](double x, double y) {
      const glm::dvec3 q = a + x * (b + y * c);
      const double r = glm::length(q), sine = std::abs(glm::dot(plane.normal, q)) / r;
      if (r < first || r >= last) return 0.0;
      return mu * sine * sine * std::pow(r, -4) * std::exp(-beta * r) * gain(q / r);
    };
    const auto row = [&](double x) {
      return x * gauss_kronrod<double, 31>::integrate([&](double y) { return density(x, y); }, 0.0, 1.0, 6,
                                                      1e-11);
    };
    sum += jacobian * gauss_kronrod<double, 31>::integrate(row, 0.0, 1.0, 6, 1e-11);
  }
  return sum;
}

TEST(PatternIntegral, AUniformPatternIsTheBoundaryIntegral) {
  const unsigned seed = 314159;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-12, 12), distance(0.2, 8), size(0.1, 4);
  const BeamPatterns uniform = one_beam({}, {});
  for (int i = 0; i < 300; ++i) {
    History history;
    const double a = size(random);
    add_footprint(
        history, 0, 0, test::random_plane(random, distance(random)),
        {test::random_convex(random, {i % 3 ? place(random) : 0, i % 3 ? place(random) : 0.1}, a, a / 3)});
    const RangeSamples samples{0, 0.13, 300};
    const Echo exact = echo_of(history, samples, 0.2, nullptr),
               echo = echo_of(history, samples, 0.2, &uniform);
    for (int k = 0; k < samples.count; ++k)
      ASSERT_NEAR(echo.at(0, k), exact.at(0, k), 1e-8 * total(exact)) << i << " sample " << k;
  }
}

TEST(PatternIntegral, AgreesWithQuadratureInSpace) {
  const unsigned seed = 577215;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-9, 9), distance(0.5, 8), turn(-1, 1);
  const std::vector<Directivity> patterns{
      {}, line(3, 0.2), line(12), piston(5), gaussian(0.4), {Kind::gaussian, {0, 1, 0}, true, 0, 0.7}};
  for (int i = 0; i < 24; ++i) {
    Directivity transmit = patterns[i % patterns.size()], receive = patterns[(i / 2 + 1) % patterns.size()];
    transmit.axis = glm::normalize(glm::dvec3(turn(random), turn(random), turn(random)));
    receive.axis = glm::normalize(glm::dvec3(turn(random), turn(random), turn(random)));
    const FacetPlane plane = test::random_plane(random, distance(random));
    // Every fourth polygon contains the foot point, so that whole circles lie in it.
    const glm::dvec2 centre = i % 4 ? glm::dvec2(place(random), place(random)) : glm::dvec2(0.2, -0.1);
    const Polygon2 p = test::random_convex(random, centre, 2.5, 1.5);
    History history;
    add_footprint(history, 0, 0, plane, {p});
    const BeamPatterns beam = one_beam(transmit, receive);
    const Echo echo = echo_of(history, {0, 0.09, 400}, 0.2, &beam);
    const double expected = quadrature(
        plane, p, 0.2, [&](glm::dvec3 d) { return transmit.gain(d) * receive.gain(d); }, 0, 36);
    const double peak = quadrature(
        plane, p, 0.2, [](glm::dvec3) { return 1.0; }, 0, 36);
    EXPECT_NEAR(total(echo), expected, 1e-10 * peak) << i;
  }
}

TEST(PatternIntegral, FlatSeabedUnderALineArrayIsASingleIntegral) {
  // The sonar is at height H over the seabed with an array along x. The integrand is sinc^2(size x / r)
  // over the whole ring, integrated over azimuth.
  const double height = 10, size = 40, r1 = 13, r2 = 13.2;
  Polygon2 seabed;
  for (int i = 0; i < 5; ++i)
    seabed.push_back(100.0 * glm::dvec2(std::cos(1.2566 * i), std::sin(1.2566 * i)));
  History history;
  add_footprint(history, 0, 0, test::flat_seabed(height), {seabed});
  const BeamPatterns beam = one_beam(line(size), line(size, 0.1));
  const double energy = echo_of(history, {r1, r2 - r1, 1}, 0, &beam).at(0, 0);
  using boost::math::quadrature::gauss_kronrod;
  const auto sinc2 = [](double u) { return u == 0 ? 1 : std::pow(std::sin(pi * u) / (pi * u), 2); };
  const auto ring = [&](double r) {
    const double rho = std::sqrt(r * r - height * height);
    return mu * height * height * std::pow(r, -5) *
           gauss_kronrod<double, 61>::integrate(
               [&](double phi) {
                 const double w = rho / r * std::cos(phi);
                 return sinc2(size * w) * sinc2(size * (w - std::sin(0.1)));
               },
               0.0, 2 * pi, 10, 1e-13);
  };
  const double expected = gauss_kronrod<double, 61>::integrate(ring, r1, r2, 10, 1e-13);
  EXPECT_NEAR(energy / expected, 1, 1e-9);
}

TEST(PatternIntegral, FlatSeabedUnderAPistonIsASingleIntegral) {
  const double height = 10, ka = 30;
  Polygon2 seabed;
  for (int i = 0; i < 5; ++i)
    seabed.push_back(100.0 * glm::dvec2(std::cos(1.2566 * i), std::sin(1.2566 * i)));
  History history;
  add_footprint(history, 0, 0, test::flat_seabed(height), {seabed});
  Directivity down = piston(ka);
  down.axis = {0, 0, -1};
  const BeamPatterns beam = one_beam(down, down);
  const Echo echo = echo_of(history, {9.9, 0.3, 10}, 0.1, &beam);
  const double beta = 0.2 * std::log(10.0) / 10;
  for (int k = 0; k < 10; ++k) {
    const double first = std::max(height, 9.9 + k * 0.3), last = 9.9 + (k + 1) * 0.3;
    const double expected = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
        [&](double r) {
          const double x = ka * std::sqrt(1 - height * height / (r * r));
          const double b = x == 0 ? 1 : std::pow(2 * boost::math::cyl_bessel_j(1, x) / x, 2);
          return 2 * pi * mu * height * height * std::pow(r, -5) * std::exp(-beta * r) * b * b;
        },
        first, last, 10, 1e-13);
    EXPECT_NEAR(echo.at(0, k), expected, 1e-10 * total(echo)) << k;
  }
}

TEST(PatternIntegral, EveryBeamOfAFanReceivesEveryTube) {
  const FacetPlane seabed = test::flat_seabed(5);
  const Polygon2 left{{4, 6}, {5, 6}, {5, 7}, {4, 7}}, right{{-5, 6}, {-4, 6}, {-4, 7}, {-5, 7}};
  History history;
  add_footprint(history, 0, 0, seabed, {left});
  add_footprint(history, 1, 0, seabed, {right});
  const Directivity a = line(4, 0.4), b = line(4, -0.4), transmit = gaussian(2);
  const BeamPatterns fan{{transmit}, {a, b}, {0, 0}, {{0, 2}, {0, 2}}};
  const BeamPatterns own{{transmit}, {a, b}, {0, 0}, {{0, 1}, {1, 2}}};
  const RangeSamples samples{5, 0.1, 60};
  const Echo all = echo_of(history, samples, 0, &fan), apart = echo_of(history, samples, 0, &own);
  const auto direct = [&](const Polygon2& p, const Directivity& d) {
    return quadrature(
        seabed, p, 0, [&](glm::dvec3 u) { return transmit.gain(u) * d.gain(u); }, 0, 100);
  };
  const auto beam_total = [&](const Echo& echo, int beam) {
    double sum = 0;
    for (int k = 0; k < samples.count; ++k) sum += echo.at(beam, k);
    return sum;
  };
  EXPECT_NEAR(beam_total(all, 0) / (direct(left, a) + direct(right, a)), 1, 1e-9);
  EXPECT_NEAR(beam_total(all, 1) / (direct(left, b) + direct(right, b)), 1, 1e-9);
  EXPECT_NEAR(beam_total(apart, 0) / direct(left, a), 1, 1e-9);
  EXPECT_NEAR(beam_total(apart, 1) / direct(right, b), 1, 1e-9);
}

TEST(PatternIntegral, RayHitsAreWeighedInTheirOwnDirection) {
  History history;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.2, 0.9, -0.3));
  history.hits = {{0, 0, 21, 0.5, 1e-4, glm::vec3(direction)}};
  const BeamPatterns beam = one_beam(gaussian(0.5), line(2));
  const double plain = echo_of(history, {20, 2, 1}, 0, nullptr).at(0, 0);
  EXPECT_NEAR(echo_of(history, {20, 2, 1}, 0, &beam).at(0, 0) / plain,
              gaussian(0.5).gain(direction) * line(2).gain(direction), 1e-6);
}

/// Footprints of about one beam width ahead of the sonar, with one tube each.
History rough_seabed(unsigned seed, std::uint32_t footprints) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> across(-2.5, 2.5), ahead(4, 9), size(0.02, 0.4);
  History history;
  for (std::uint32_t tube = 0; tube < footprints; ++tube) {
    const double a = size(random);
    add_footprint(history, tube, 0, test::random_plane(random, 3),
                  {test::random_convex(random, {across(random), ahead(random)}, a, a / 2)});
    Footprint& f = history.footprints.footprints.back();
    f.centroid_m = history.footprints.corners_m.back();
    f.area_m2 = a * a;
    f.grazing_angle_rad = 0.5;
    f.slant_range_min_m = glm::length(f.centroid_m);
    f.slant_range_max_m = f.slant_range_min_m + a;
    history.hits.push_back({0, tube, float(3 + a), 0.5, 1e-4, glm::vec3(glm::normalize(f.centroid_m))});
  }
  return history;
}

BeamPatterns fan_of(const TransmitPattern& transmit, const std::vector<Directivity>& receive,
                    std::uint32_t tubes) {
  return {{transmit},
          receive,
          std::vector<std::uint32_t>(tubes, 0),
          std::vector<std::pair<std::uint32_t, std::uint32_t>>(tubes, {0, std::uint32_t(receive.size())})};
}

Echo echo_of(const History& history, const BeamPatterns* patterns, double tolerance,
             Binning binning = Binning::exact) {
  const std::vector<double> material_mu{mu};
  const std::vector<std::uint16_t> one_facet{0};
  const std::vector<std::uint32_t> beam_of_tube(history.footprints.footprints.size(), 0);
  return integrate_echo(history, {patterns ? int(patterns->receive.size()) : 1, beam_of_tube}, {3, 0.05, 200},
                        EchoModel{material_mu, one_facet, 0.3, patterns, tolerance}, binning);
}

TEST(PatternIntegral, BeamsSentAtOnceAddUp) {
  const std::uint32_t tubes = 40;
  const History history = rough_seabed(27182, tubes);
  const Directivity across = line(30, 0.1);
  Directivity upright = gaussian(0.3);
  upright.axis = {0, 0, 1};
  // The cases are transmit beams along the array of the receivers, transmit beams along other axes, and a
  // mix with an omnidirectional beam.
  for (const auto& sent : {std::vector{line(25, -0.2), across, line(30, 0.3)},
                           std::vector{upright, piston(4)}, std::vector{across, upright, Directivity()}})
    for (const auto& received : {std::vector{line(30)}, std::vector{line(30), line(30, 0.2), line(30, -0.2)}})
      for (const Binning binning : {Binning::exact, Binning::spread, Binning::centroid}) {
        const BeamPatterns together = fan_of(TransmitPattern(sent), received, tubes);
        const Echo echo = echo_of(history, &together, 1e-11, binning);
        std::vector<double> sum(echo.energy.size());
        for (const Directivity& beam : sent) {
          const BeamPatterns alone = fan_of(beam, received, tubes);
          const Echo part = echo_of(history, &alone, 1e-11, binning);
          for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += part.energy[k];
        }
        const double peak = *std::max_element(sum.begin(), sum.end());
        ASSERT_GT(peak, 0);
        for (std::size_t k = 0; k < sum.size(); ++k) ASSERT_NEAR(echo.energy[k], sum[k], 1e-9 * peak) << k;
      }
}

TEST(PatternIntegral, ManyBeamsOfAnArrayHearWhatEachWouldAlone) {
  const std::uint32_t tubes = 60;
  const History history = rough_seabed(16180, tubes);
  for (Directivity received : {line(60), gaussian(0.02), gaussian(0.3)}) {
    std::vector<Directivity> beams;
    for (int k = -3; k <= 3; ++k) {
      received.centre = 0.07 * k;
      beams.push_back(received);
    }
    beams[2] = Directivity();
    for (const TransmitPattern& sent : {TransmitPattern(beams), TransmitPattern(piston(6))}) {
      const BeamPatterns all = fan_of(sent, beams, tubes);
      const Echo echo = echo_of(history, &all, 1e-11), plain = echo_of(history, nullptr, 1e-11);
      for (int b = 0; b < int(beams.size()); ++b) {
        const BeamPatterns one = fan_of(sent, {beams[std::size_t(b)]}, tubes);
        const Echo alone = echo_of(history, &one, 1e-11);
        for (int k = 0; k < echo.samples; ++k)
          ASSERT_NEAR(echo.at(b, k), alone.at(0, k), 1e-9 * plain.at(0, k)) << b << " sample " << k;
      }
    }
  }
}

TEST(PatternIntegral, ErrorsStayBelowTheToleranceAndAreNotFree) {
  const std::uint32_t tubes = 300;
  const History history = rough_seabed(141421, tubes);
  for (const Directivity& shape : {line(120), gaussian(0.006), piston(40)}) {
    std::vector<Directivity> beams(5, shape);
    for (std::size_t k = 0; k < beams.size(); ++k) beams[k].centre = 0.1 * double(k) - 0.2;
    const BeamPatterns patterns = fan_of(TransmitPattern(beams), beams, tubes);
    const Echo fine = echo_of(history, &patterns, 1e-12), plain = echo_of(history, nullptr, 1e-6);
    for (const double tolerance : {1e-3, 1e-4, 1e-6, 1e-8}) {
      const Echo echo = echo_of(history, &patterns, tolerance);
      for (int b = 0; b < echo.beams; ++b)
        for (int k = 0; k < echo.samples; ++k)
          ASSERT_NEAR(echo.at(b, k), fine.at(b, k), (tolerance + 1e-10) * plain.at(0, k))
              << tolerance << " beam " << b << " sample " << k;
      EXPECT_NE(echo.energy, fine.energy);
    }
  }
}

TEST(PatternIntegral, TablesAreAsGoodAsTheirCornersAllow) {
  std::vector<double> angle, level;
  for (int k = -60; k <= 60; ++k) {
    angle.push_back(0.002 * k);
    level.push_back(std::max(-30.0, -3 * std::pow(0.2 * k, 2)));
  }
  Directivity table{
      Kind::table, {1, 0, 0}, false, 0, 0, 0, std::make_shared<const PatternTable>(angle, level)};
  const std::uint32_t tubes = 100;
  const History history = rough_seabed(17320, tubes);
  std::vector<Directivity> beams(4, table);
  for (std::size_t k = 0; k < beams.size(); ++k) beams[k].centre = 0.1 * double(k) - 0.15;
  double off = 0;
  for (std::uint32_t tube = 0; tube < tubes; ++tube) {
    // One footprint at a time, by brute force: a fine grid on its fan of triangles.
    History one;
    const Footprint& f = history.footprints.footprints[tube];
    const Piece piece = history.footprints.pieces[f.first_piece];
    const std::span<const glm::dvec3> corners =
        std::span(history.footprints.corners_m).subspan(piece.first, piece.count);
    const double beta = 0.6 * std::log(10.0) / 10;
    double direct = 0, all = 0;
    const int n = 200;
    for (std::size_t t = 2; t < corners.size(); ++t) {
      const glm::dvec3 b = corners[t - 1] - corners[0], c = corners[t] - corners[0];
      const double area = glm::length(glm::cross(b, c)) / 2 / (n * n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j)
          for (const double third : {1.0 / 3, 2.0 / 3}) {
            if (third > 0.5 && j == n - i - 1) continue;
            const glm::dvec3 p = corners[0] + ((i + third) * b + (j + third) * c) / double(n);
            const double r = glm::length(p), sine = f.plane_distance_m / r;
            if (r < 3 || r >= 13) continue;
            const double energy = mu * sine * sine * std::pow(r, -4) * std::exp(-beta * r) * area;
            direct += energy * beams[1].gain(p / r);
            all += energy;
          }
    }
    one.footprints.footprints = {f};
    one.footprints.footprints[0].tube = 0;
    one.footprints.pieces = history.footprints.pieces;
    one.footprints.corners_m = history.footprints.corners_m;
    const BeamPatterns alone = fan_of(TransmitPattern(), beams, 1);
    const Echo own = echo_of(one, &alone, 1e-6);
    double sum = 0;
    for (int k = 0; k < own.samples; ++k) sum += own.at(1, k);
    if (all > 0) off = std::max(off, std::abs(sum - direct) / all);
  }
  EXPECT_LT(off, 2e-4);
}

TEST(PatternIntegral, PatternsOfOtherBeamsAreRefused) {
  History history;
  const BeamPatterns good = one_beam({}, {});
  BeamPatterns bad = good;
  bad.beams_of_tube = {{0, 2}};
  EXPECT_NO_THROW(echo_of(history, {1, 1, 1}, 0, &good));
  EXPECT_THROW(echo_of(history, {1, 1, 1}, 0, &bad), std::invalid_argument);
  bad = good;
  bad.transmit[0].beams.clear();
  EXPECT_THROW(echo_of(history, {1, 1, 1}, 0, &bad), std::invalid_argument);
  for (const double tolerance : {0.0, 1e-13, 0.1, std::nan("")})
    EXPECT_THROW(echo_of(history, {1, 1, 1}, 0, &good, tolerance), std::invalid_argument) << tolerance;
  bad = good;
  bad.fan_of_tube = {1};
  EXPECT_THROW(echo_of(history, {1, 1, 1}, 0, &bad), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
