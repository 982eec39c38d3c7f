// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the answers of the benchmark suite with closed forms, with integrals that the test computes, and
// with rays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <sstream>

#include "geometry/numbers/scalars.hpp"
#include "sensors/recordings/echo_reader.hpp"
#include "suite/answers.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

// README.md: E = mu H^2 w (r0^-4 - r1^-4) / 4; w between the rounded corner rays.
TEST(SuiteAnswers, FlatSeabedsHoldTheirClosedForm) {
  const TestFolder folder;
  for (const std::vector<std::string>& set : {std::vector<std::string>{}, {"--seed", "flat"}}) {
    std::vector<std::string> options{"--scenes", "grazing,large-flat"};
    options.insert(options.end(), set.begin(), set.end());
    const fs::path suite = packed(folder, set.empty() ? "debug" : "drawn", options);
    for (const std::string name : {"grazing", "large-flat"}) {
      const AnsweredScene scene(suite, name);
      const double mu = scene.json["surfaces"][0]["mu"], height = scene.sonar().z;
      const double across = std::cos(scene.json["beams"]["upper_deg"].get<double>() * degree),
                   scale = std::ldexp(1.0, 30) - 1;
      const auto edge = [&](std::size_t k) {
        const double azimuth = scene.border_deg(k) * degree;
        return std::atan2(std::round(std::sin(azimuth) * across * scale),
                          std::round(std::cos(azimuth) * across * scale));
      };
      EXPECT_NEAR(mu, 0.01, 1e-15);
      for (std::size_t beam = 0; beam < scene.energy.beams; ++beam)
        for (std::size_t k = 0; k < scene.energy.samples; ++k) {
          const double r0 = scene.first_m() + static_cast<double>(k) * scene.step_m(),
                       r1 = r0 + scene.step_m();
          const double truth = mu * height * height * (edge(beam + 1) - edge(beam)) *
                               (std::pow(r0, -4) - std::pow(r1, -4)) / 4;
          ASSERT_LE(std::abs(scene.energy.at(0, beam, k) - truth), scene.bound.at(0, beam, k) + 1e-13 * truth)
              << name << ", beam " << beam << ", sample " << k;
        }
    }
  }
}

TEST(SuiteAnswers, PlatesFallAsSolidAnglesAndAbsorptionDo) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "range-law,absorption"});
  for (const std::string name : {"range-law", "absorption"}) {
    const AnsweredScene scene(suite, name);
    const double a = scene.json["water"]["absorption_db_per_km"];
    EXPECT_EQ(a, name == std::string("absorption") ? 400 : 0);
    double all = 0;
    std::vector<double> filled;
    for (int plate = 0; plate < 5; ++plate) {
      const auto triangles = triangles_of(scene, "plate-" + std::to_string(plate) + ".obj");
      const double upper = std::tan(scene.json["beams"]["upper_deg"].get<double>() * degree);
      double range = 0, area = 0;
      // The integrand is zero outside of the fan. The sonar looks horizontally north.
      all += over(triangles, 200, [&](glm::dvec3 at, glm::dvec3 normal) {
        const glm::dvec3 way = at - scene.sonar();
        const double r = glm::length(way);
        range += r, area += 1;
        // The upper side of a beam is a plane through two of its corners, which lie on the cone.
        return std::abs(way.z) > upper * std::hypot(way.x, way.y)
                   ? 0
                   : scattered(0.1, scene.sonar(), scene.sonar(), at, normal) *
                         std::pow(10, -2 * a * r / 10000);
      });
      filled.push_back(range / area);
    }
    EXPECT_NEAR(scene.energy.sum() / all, 1, 2e-3) << name;
    // mu w h / d^2, in a beam before the middle of each plate.
    const double height = 2 * scene.json["beams"]["upper_deg"].get<double>() * degree;
    for (std::size_t plate = 0; plate < 5; ++plate) {
      const double azimuth = 7.2 * (static_cast<double>(plate) - 2);
      std::size_t beam = 0;
      while (scene.border_deg(beam + 1) < azimuth) ++beam;
      const double mean = filled[plate];
      EXPECT_NEAR(scene.energy.of_beam(beam) /
                      (0.1 * degree * height / (mean * mean) * std::pow(10, -2 * a * mean / 10000)),
                  1, 0.01)
          << name << ", plate " << plate;
    }
  }
}

TEST(SuiteAnswers, BeamsAreAsSceneJsonSaysAndPostsInThem) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "even-angles,even-tangents,listed-angles"});
  for (const std::string name : {"even-angles", "even-tangents", "listed-angles"}) {
    const AnsweredScene scene(suite, name);
    const std::vector<double> axes = scene.json["beams"]["axes_deg"],
                              borders = scene.json["beams"]["borders_deg"];
    ASSERT_EQ(axes.size(), 64u);
    ASSERT_EQ(borders.size(), 65u);
    double least = 1e9, most = 0;
    for (std::size_t k = 0; k + 1 < axes.size(); ++k) {
      EXPECT_NEAR(borders[k + 1], (axes[k] + axes[k + 1]) / 2, 1e-12);
      const double step = name == std::string("even-tangents")
                              ? std::tan(axes[k + 1] * degree) - std::tan(axes[k] * degree)
                              : axes[k + 1] - axes[k];
      least = std::min(least, step), most = std::max(most, step);
    }
    if (name == std::string("listed-angles"))
      EXPECT_GT(most / least, 1.9);
    else
      EXPECT_NEAR(most / least, 1, 1e-9) << name;
    // Compares the energy of each post in the beams with its share between their borders.
    std::vector<double> expected(axes.size());
    constexpr int parts = 300;
    for (int post = 0; post < 13; ++post)
      for (const auto& triangle : triangles_of(scene, "post-" + std::to_string(post) + ".obj")) {
        const double area = glm::length(glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0])) /
                            (2 * parts * parts);
        over({triangle}, parts, [&](glm::dvec3 at, glm::dvec3 normal) {
          const glm::dvec3 way = at - scene.sonar();
          const double azimuth = std::atan2(way.x, way.y) / degree;
          const auto beam =
              static_cast<std::size_t>(std::ranges::upper_bound(borders, azimuth) - borders.begin() - 1);
          if (beam < expected.size() && std::abs(std::atan2(way.z, std::hypot(way.x, way.y))) < 4 * degree)
            expected[beam] += area * scattered(0.1, scene.sonar(), scene.sonar(), at, normal);
          return 0.0;
        });
      }
    double found = 0, all = 0, moved = 0;
    for (std::size_t k = 0; k < axes.size(); ++k) found += scene.energy.of_beam(k), all += expected[k];
    for (std::size_t k = 0; k < axes.size(); ++k)
      moved += std::abs(scene.energy.of_beam(k) / found - expected[k] / all);
    EXPECT_LT(moved, 0.02)
        // the sum of each post has the same number of parts, for any area: all posts have the same angle
        << name;
  }
}

// README.md: images, and losses once and twice.
TEST(SuiteAnswers, SurfaceMultiplesAreThoseOfImages) {
  const TestFolder folder;
  for (const std::string seed : {"", "s"}) {
    std::vector<std::string> options{"--scenes", "surface-multiple"};
    if (!seed.empty()) options.insert(options.end(), {"--seed", seed});
    const AnsweredScene scene(packed(folder, "a" + seed, options), "surface-multiple");
    const auto plate = triangles_of(scene, "plate.obj");
    const glm::dvec3 sonar = scene.sonar(), image{sonar.x, sonar.y, -sonar.z};
    const double kept = std::pow(10, -scene.json["sea_surface"]["loss_db"].get<double>() / 10);
    const auto from = [&](glm::dvec3 a, glm::dvec3 b) {
      return over(plate, 40,
                  [&](glm::dvec3 at, glm::dvec3 normal) { return scattered(0.1, a, b, at, normal); });
    };
    const double direct = from(sonar, sonar),
                 later = 2 * kept * from(sonar, image) + kept * kept * from(image, image);
    const auto begins = static_cast<std::size_t>(
        (scene.json["later_from_m"].get<double>() - scene.first_m()) / scene.step_m());
    EXPECT_NEAR(scene.energy.sum(begins) / later, 1, 1e-4) << seed;
    EXPECT_NEAR(scene.energy.sum() / (direct + later), 1, 1e-4) << seed;
  }
}

TEST(SuiteAnswers, TwoScatteringsAreThoseOfTwoPlatesAndTheirToleranceHolds) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "two-scatterings"});
  const AnsweredScene scene(suite, "two-scatterings");
  const auto port = triangles_of(scene, "port.obj"), starboard = triangles_of(scene, "starboard.obj");
  const glm::dvec3 sonar = scene.sonar();
  const double mu = std::pow(10, -0.6);
  const double later = 2 * over(port, 6, [&](glm::dvec3 p, glm::dvec3 n) {
                         return over(starboard, 6, [&](glm::dvec3 q, glm::dvec3 m) {
                           const double tx = glm::length(p - sonar), rx = glm::length(q - sonar),
                                        s = glm::length(q - p);
                           return mu * mu *
                                  std::abs(glm::dot(p - sonar, n) / tx * glm::dot(q - p, n) / s *
                                           glm::dot(q - p, m) / s * glm::dot(q - sonar, m) / rx) /
                                  (tx * tx * s * s * rx * rx);
                         });
                       });
  const auto begins =
      static_cast<std::size_t>((scene.json["later_from_m"].get<double>() - scene.first_m()) / scene.step_m());
  EXPECT_NEAR(scene.energy.sum(begins) / later, 1, 0.01);
  // Patches of half the length change the energies by less than the reported error.
  std::string finer = bytes_of(scene.folder / "scene.toml");
  finer.replace(finer.find("patch_m = 0.09375"), 17, "patch_m = 0.03125");
  fs::create_directory(folder / "finer");
  folder.write("finer/scene.toml", finer);
  for (const std::string obj : {"port.obj", "starboard.obj"})
    folder.write("finer/" + obj, bytes_of(scene.folder / obj));
  const Outcome outcome = run_program({"run", (folder / "finer/scene.toml").string(), "-o",
                                       (folder / "out").string(), "--quiet", "--pictures", "none"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const SensorEchoes now = read_echo_file(folder / "out/echoes.nc").sensors.at(0);
  double off = 0, off_later = 0;
  for (std::size_t b = 0; b < now.beams; ++b)
    for (std::size_t k = 0; k < now.samples; ++k) {
      const double difference = std::abs(now.at(0, b, k) - scene.energy.at(0, b, k));
      off += difference;
      if (k >= begins) off_later += difference;
    }
  const double told = json_in(suite / "answers/two-scatterings/answer.json")["tolerance_l1"];
  EXPECT_LT(off, told * scene.energy.sum());
  EXPECT_LT(off_later, 0.1 * later);
}

// sinc^2 of the README, at the middle of the target.
TEST(SuiteAnswers, SideLobesAreThoseOfALine) {
  const TestFolder folder;
  const AnsweredScene scene(packed(folder, "a", {"--scenes", "side-lobes"}), "side-lobes");
  const double wavelengths = scene.json["beams"]["receive"]["aperture_m"].get<double>() *
                             scene.json["beams"]["receive"]["frequency_khz"].get<double>() * 1000 / 1500;
  const auto target = triangles_of(scene, "target.obj");
  std::vector<double> expected(scene.energy.beams);
  for (std::size_t beam = 0; beam < expected.size(); ++beam) {
    const double axis = std::sin(scene.json["beams"]["axes_deg"][beam].get<double>() * degree);
    expected[beam] = over(target, 12, [&](glm::dvec3 at, glm::dvec3 normal) {
      const glm::dvec3 way = glm::normalize(at - scene.sonar());
      if (glm::dot(way, normal) > 0) return 0.0;  // the far side of a box is hidden
      const double x = std::numbers::pi * wavelengths * (way.x - axis);
      return scattered(0.1, scene.sonar(), scene.sonar(), at, normal) *
             (x == 0 ? 1 : std::pow(std::sin(x) / x, 2));
    });
  }
  double all = 0, beside = 0, found = 0, off = 0;
  std::size_t peak = 0;
  for (std::size_t b = 0; b < expected.size(); ++b) {
    if (scene.energy.of_beam(b) > scene.energy.of_beam(peak)) peak = b;
    off += std::abs(expected[b] - scene.energy.of_beam(b));
    all += expected[b], found += scene.energy.of_beam(b);
  }
  for (std::size_t b = 0; b < expected.size(); ++b)
    if (std::abs(static_cast<double>(b) - static_cast<double>(peak)) >
        scene.json["main_lobe_beams"].get<double>())
      beside += scene.energy.of_beam(b);
  EXPECT_LT(off, 0.01 * all);
  EXPECT_GT(beside, 0.03 * found);
}

TEST(SuiteAnswers, AgreeWithRays) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "occlusion-order,near-plane"});
  for (const std::string name : {"occlusion-order", "near-plane"}) {
    const AnsweredScene scene(suite, name);
    const Outcome outcome =
        run_program({"run", (scene.folder / "scene.toml").string(), "-o", (folder / name).string(),
                     "--engine", "ray", "--rays-per-beam", "100000", "--quiet", "--pictures", "none"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const SensorEchoes rays = read_echo_file(folder / name / "echoes.nc").sensors.at(0);
    double off = 0;
    std::size_t lit_in_shadow = 0;
    for (std::size_t k = 0; k < rays.energy.size(); ++k) {
      off += std::abs(rays.energy[k] - scene.energy.values[k]);
      lit_in_shadow += scene.energy.values[k] + scene.bound.values[k] == 0 && rays.energy[k] > 0;
    }
    EXPECT_LT(off, 0.02 * scene.energy.sum()) << name;
    EXPECT_EQ(lit_in_shadow, 0u) << name;
  }
}

}  // namespace
}  // namespace tubefoot
