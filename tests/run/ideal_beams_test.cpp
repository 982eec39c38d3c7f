// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the accuracy that README states for a flat Lambert seabed, for each kind of sensor. The comparisons
// are integrals over ideal beams without tubes, and certified references.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double height_m = 10;
/// README: in addition to the tolerance of the cones.
constexpr double readme = 3e-7;
const double ideal_mu = std::pow(10, -2.7);

/// A tolerance, and the sensor keys that set it.
const std::pair<double, const char*> tolerances[] = {{4.5e-5, ""}, {3e-7, "cone_tolerance = 3e-7\n"}};

std::string ideal_scene(const std::string& sensor) {
  return still_water() + lambert_material("bed", -27) + flat_terrain(256, 256) + fixed_at(0, 0, height_m) +
         "[[sensors]]\nname = \"s\"\n" + sensor;
}

/// Returns how far a direction (starboard, forward, up) lies inside an ideal beam; negative outside.
using Beam = std::function<double(glm::dvec3)>;

/// Energy of a range bin: the integral over rings of the seabed, times the part of each ring in the beam.
double expected(const Beam& beam, double from_m, double to_m, double first_turn, double last_turn) {
  const auto at = [&](double r, double turn) {
    const double rho = std::sqrt(r * r - height_m * height_m);
    return beam(glm::dvec3(rho * std::sin(turn), rho * std::cos(turn), -height_m) / r);
  };
  const auto ring = [&](double r) {  // radians that are in the beam
    constexpr int steps = 400;
    double sum = 0, before = first_turn, inside = at(r, first_turn);
    for (int k = 1; k <= steps; ++k) {
      const double turn = first_turn + (last_turn - first_turn) * k / steps, now = at(r, turn);
      if ((inside > 0) == (now > 0)) {
        sum += inside > 0 ? turn - before : 0;
      } else {
        double a = before, b = turn;
        for (int n = 0; n < 50; ++n) {
          const double middle = (a + b) / 2;
          ((at(r, middle) > 0) == (inside > 0) ? a : b) = middle;
        }
        sum += inside > 0 ? a - before : turn - a;
      }
      before = turn;
      inside = now;
    }
    return sum;
  };
  return ideal_mu * height_m * height_m *
         boost::math::quadrature::gauss_kronrod<double, 15>::integrate(
             [&](double r) { return std::pow(r, -5) * ring(r); }, from_m, to_m, 12, 1e-9);
}

/// Between two angles about an axis, and between two cones about it.
double within(double low, double value, double high) { return std::min(value - low, high - value); }

TEST(IdealBeams, ASidescansSamplesAreThoseOfItsCones) {
  const Beam starboard = [](glm::dvec3 d) {
    const double depression = std::atan2(-d.z, d.x), along = std::asin(d.y);
    return std::min(within(2 * degree, depression, 85 * degree),
                    within(-0.25 * degree, along, 0.25 * degree));
  };
  for (const auto& [tolerance, key] : tolerances) {
    const Echoes echoes = echoes_of(ideal_scene(
        std::string(key) + "kind = \"sidescan\"\nalong_track_deg = 0.5\nrange_max_m = 60\nsamples = 600\n"));
    for (const double range : {10.3, 14.05, 20.0, 27.3, 41.0, 59.0}) {
      const std::size_t k = echoes.sample_at(range);
      const double exact =
          expected(starboard, echoes.first_m(k), echoes.last_m(k), pi / 2 - 0.06, pi / 2 + 0.06);
      EXPECT_NEAR(echoes.at(0, 1, k) / exact, 1, tolerance + readme) << range;
      EXPECT_NEAR(echoes.at(0, 0, k) / exact, 1, tolerance + readme) << range;
    }
  }
}

TEST(IdealBeams, AMultibeamsSamplesAreThoseOfItsConesAndPlanes) {
  for (const auto& [tolerance, key] : tolerances) {
    const Echoes echoes =
        echoes_of(ideal_scene(std::string(key) +
                              "kind = \"multibeam\"\nbeams = 101\nswath_deg = 150\nbeam_across_deg = 1.5\n"
                              "along_track_deg = 1.5\nrange_min_m = 5\nrange_max_m = 60\nsamples = 550\n"));
    for (const std::size_t beam : {52u, 70u, 90u}) {
      const double across = (double(beam) - 50) * 1.5 * degree;
      const Beam ideal = [&](glm::dvec3 d) {
        return std::min(within(across - 0.75 * degree, std::atan2(d.x, -d.z), across + 0.75 * degree),
                        within(-0.75 * degree, std::asin(d.y), 0.75 * degree));
      };
      std::size_t loudest = 0;
      for (std::size_t k = 0; k < echoes.samples; ++k)
        if (echoes.at(0, beam, k) > echoes.at(0, beam, loudest)) loudest = k;
      const double exact =
          expected(ideal, echoes.first_m(loudest), echoes.last_m(loudest), pi / 2 - 0.5, pi / 2 + 0.5);
      EXPECT_NEAR(echoes.at(0, beam, loudest) / exact, 1, tolerance + readme) << beam;
    }
  }
}

TEST(IdealBeams, TiltedFansSamplesAreThoseOfTheirConesAndPlanes) {
  const double tilt = 30 * degree;
  const std::string fan = "beams = 8\nhorizontal_deg = 24\nvertical_deg = 20\ntilt_deg = 30\nsamples = 300\n";
  for (const auto& [tolerance, key] : tolerances)
    for (const std::string kind : {"kind = \"didson\"\nwindow_start_m = 12\nwindow_length_m = 30\n",
                                   "kind = \"imaging\"\nrange_min_m = 12\nrange_max_m = 42\n"}) {
      const Echoes echoes = echoes_of(ideal_scene(key + kind + fan));
      for (const std::size_t beam : {4u, 7u}) {
        const double from = (double(beam) - 4) * 3 * degree;
        const Beam ideal = [&](glm::dvec3 d) {
          const double forward = d.y * std::cos(tilt) - d.z * std::sin(tilt),
                       up = d.y * std::sin(tilt) + d.z * std::cos(tilt);
          return std::min(within(from, std::atan2(d.x, forward), from + 3 * degree),
                          within(-10 * degree, std::asin(up), 10 * degree));
        };
        for (const double range : {16.0, 20.05, 27.0}) {
          const std::size_t k = echoes.sample_at(range);
          const double exact = expected(ideal, echoes.first_m(k), echoes.last_m(k), -0.5, 0.8);
          EXPECT_NEAR(echoes.at(0, beam, k) / exact, 1, tolerance + readme)
              << kind << ' ' << beam << ' ' << range;
        }
      }
    }
}

TEST(IdealBeams, EveryKindIsWithinTheFigureOfItsReference) {
  for (const std::string sensor :
       {"kind = \"didson\"\nbeams = 4\nhorizontal_deg = 12\ntilt_deg = 30\nwindow_start_m = "
        "12\nwindow_length_m = 20\nsamples = 40\n",
        "kind = \"sidescan\"\nrange_max_m = 40\nsamples = 40\ndepression_min_deg = 20\ndepression_max_deg = "
        "40\n",
        "kind = \"multibeam\"\nbeams = 3\nswath_deg = 60\nrange_min_m = 5\nrange_max_m = 25\nsamples = 400\n",
        "kind = \"imaging\"\nbeams = 4\nhorizontal_deg = 12\ntilt_deg = 30\nrange_min_m = 5\nrange_max_m = "
        "25\nsamples = 40\n",
        "kind = \"scanning\"\nscan_deg = 12\nstep_deg = 4\nbeam_horizontal_deg = 5\ntilt_deg = 30\n"
        "range_min_m = 5\nrange_max_m = 25\nsamples = 40\n",
        "kind = \"imaging\"\nbeam_angles_deg = [-9, -2, 1, 6]\ntilt_deg = 30\nrange_min_m = 5\n"
        "range_max_m = 25\nsamples = 40\n",
        "kind = \"echosounder\"\nrange_min_m = 5\nrange_max_m = 15\nsamples = 400\nbeam_deg = 6\n"}) {
    SCOPED_TRACE(sensor);
    const Echoes plain = echoes_of(ideal_scene(sensor));
    const Echoes certified = echoes_of(ideal_scene(sensor), {"--reference", "--tolerance", "1e-9"});
    std::size_t lit = 0;
    for (std::size_t beam = 0; beam < plain.beams; ++beam) {
      double loudest = 0;
      for (std::size_t k = 0; k < plain.samples; ++k) loudest = std::max(loudest, certified.at(0, beam, k));
      for (std::size_t k = 0; k < plain.samples; ++k) {
        const double truth = certified.at(0, beam, k);
        EXPECT_NEAR(plain.at(0, beam, k), truth, readme * truth + 1e-6 * readme * loudest)
            << beam << ' ' << k;
        lit += truth > 0;
      }
    }
    EXPECT_GT(lit, 5u);
  }
}

}  // namespace
}  // namespace tubefoot
