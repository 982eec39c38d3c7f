// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the answers of scattering water, of derivatives and of diffraction with closed forms, with their
// laws, and with differences of two runs.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <regex>

#include "geometry/numbers/scalars.hpp"
#include "sensors/recordings/echo_reader.hpp"
#include "suite/answers.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Solid angle of a beam between its corners, which are rounded to 2^-30.
double solid_angle_of(const AnsweredScene& scene, std::size_t beam) {
  const auto corner = [&](std::size_t border, const char* side) {
    const double a = scene.border_deg(border) * degree, e = scene.json["beams"][side].get<double>() * degree,
                 scale = std::ldexp(1.0, 30) - 1;
    const glm::dvec3 v{std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
    return glm::dvec3{std::round(v.x * scale), std::round(v.y * scale), std::round(v.z * scale)} / scale;
  };
  // Van Oosterom and Strackee 1983, doi 10.1109/TBME.1983.325207.
  const auto triangle = [](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    a = glm::normalize(a), b = glm::normalize(b), c = glm::normalize(c);
    return 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                          1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  };
  const glm::dvec3 p = corner(beam, "lower_deg"), q = corner(beam + 1, "lower_deg"),
                   r = corner(beam + 1, "upper_deg"), s = corner(beam, "upper_deg");
  return triangle(p, q, r) + triangle(p, r, s);
}

/// Integral of r^-2 10^(-2 a r / 10000) dr by Simpson's rule.
double spreading(double from_m, double to_m, double absorption_db_per_km) {
  constexpr int parts = 16;
  double sum = 0;
  for (int k = 0; k <= parts; ++k) {
    const double r = from_m + (to_m - from_m) * k / parts;
    sum += (k == 0 || k == parts ? 1
            : k % 2 == 1         ? 4
                                 : 2) *
           std::pow(10, -absorption_db_per_km * r / 5000) / (r * r);
  }
  return sum * (to_m - from_m) / (3 * parts);
}

TEST(SuiteBorderAnswers, WaterHoldsItsClosedForm) {
  const TestFolder folder;
  for (const std::string set : {"", "wet"}) {
    std::vector<std::string> options{"--scenes", "volume"};
    if (!set.empty()) options.insert(options.end(), {"--seed", set});
    const AnsweredScene scene(packed(folder, "suite" + set, options), "volume");
    const double s_v = scene.json["water"]["volume_scattering_per_m"],
                 a = scene.json["water"]["absorption_db_per_km"], to = scene.json["water_to_m"];
    double port_deg = 90, starboard_deg = -90;
    for (const auto& v : mesh_in(scene.folder / "plate.obj").vertices) {
      const double azimuth = std::atan2(v[0] - scene.sonar().x, v[1] - scene.sonar().y) / degree;
      port_deg = std::min(port_deg, azimuth), starboard_deg = std::max(starboard_deg, azimuth);
    }
    std::size_t water = 0, silent = 0;
    for (std::size_t beam = 0; beam < scene.energy.beams; ++beam) {
      const double left = scene.border_deg(beam), right = scene.border_deg(beam + 1);
      const bool is_open = right < port_deg || left > starboard_deg,
                 is_filled = left > port_deg && right < starboard_deg;
      const double angle = solid_angle_of(scene, beam);
      for (std::size_t k = 0; k < scene.energy.samples; ++k) {
        const double r0 = scene.first_m() + static_cast<double>(k) * scene.step_m(), r1 = r0 + scene.step_m(),
                     energy = scene.energy.at(0, beam, k), expected = s_v * angle * spreading(r0, r1, a);
        if (is_open || r1 < to) {
          ASSERT_NEAR(energy, expected, scene.bound.at(0, beam, k) + 1e-9 * expected) << beam << " " << k;
          ++water;
        } else if (is_filled && r0 > to + 0.75) {
          ASSERT_EQ(energy, 0) << beam << " " << k;
          ++silent;
        }
      }
    }
    EXPECT_GT(water, 800u) << set;
    EXPECT_GT(silent, 100u) << set;
  }
}

/// Energies of a run of the scene with an edited scene file.
std::vector<double> edited_run(const TestFolder& folder, const AnsweredScene& scene,
                               const std::string& pattern, const std::string& instead) {
  const std::string text = bytes_of(scene.folder / "scene.toml"),
                    edited = std::regex_replace(text, std::regex(pattern), instead);
  EXPECT_NE(text, edited);
  const fs::path place = folder / "edited";
  fs::remove_all(place);
  fs::copy(scene.folder, place);
  folder.write("edited/scene.toml", edited);
  const Outcome outcome = run_program({"run", (place / "scene.toml").string(), "-o", (place / "out").string(),
                                       "--quiet", "--pictures", "none"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return read_echo_file(place / "out/echoes.nc").sensors.at(0).energy;
}

TEST(SuiteBorderAnswers, DerivativesHoldTheirLaws) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "suite", {"--scenes", "gradient"});
  const AnsweredScene scene(suite, "gradient");
  const Array gradient = array_in(suite / "answers/gradient/gradient.npy"),
              bound = array_in(suite / "answers/gradient/gradient_bound.npy");
  std::vector<std::string> names;
  for (const Json& parameter : scene.json["gradient"]) names.push_back(parameter["name"]);
  ASSERT_EQ(gradient.pings, names.size());
  const std::size_t cells = gradient.beams * gradient.samples;
  const auto of = [&](const Array& all, const std::string& name) {
    const auto place = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    return std::span(all.values).subspan(place * cells, cells);
  };
  const double mu = scene.json["surfaces"][0]["mu"];
  EXPECT_EQ(scene.json["surfaces"][0]["name"], "bed");
  const auto by_mu = of(gradient, "material.bed.mu"), by_loss = of(gradient, "water.absorption");
  const std::vector<double> no_box = edited_run(folder, scene, "name = \"target\"\nlambert_db = [^\n]*",
                                                "name = \"target\"\nlambert_db = -120");
  double all = 0, off = 0;
  for (std::size_t k = 0; k < cells; ++k) {
    const double energy = scene.energy.values[k],
                 r0 = scene.first_m() + static_cast<double>(k % gradient.samples) * scene.step_m(),
                 r1 = r0 + scene.step_m(), scale = -std::numbers::ln10 / 5000 * energy;
    EXPECT_NEAR(by_mu[k] * mu, no_box[k],
                1e-9 * no_box[k] + 1e-10 * energy + mu * of(bound, "material.bed.mu")[k] + 1e-25);
    EXPECT_GE(by_loss[k], scale * r1 * (1 + 1e-9) - of(bound, "water.absorption")[k] - 1e-30);
    EXPECT_LE(by_loss[k], scale * r0 * (1 - 1e-9) + of(bound, "water.absorption")[k] + 1e-30);
  }
  // Central differences of two runs move edges and shadows, too.
  constexpr double step = 1.0 / 256;
  const std::vector<double> north = edited_run(folder, scene, "file = \"box.obj\"\n",
                                               "$&position_m = [0, 0.00390625, 0]\n"),
                            south = edited_run(folder, scene, "file = \"box.obj\"\n",
                                               "$&position_m = [0, -0.00390625, 0]\n");
  const auto by_north = of(gradient, "box.position.north");
  for (std::size_t k = 0; k < cells; ++k) {
    off += std::abs((north[k] - south[k]) / (2 * step) - by_north[k]);
    all += std::abs(by_north[k]);
  }
  EXPECT_LT(off, 0.03 * all);
  EXPECT_GT(all, 0);
}

/// Two-way weight behind a half-plane, by Simpson's rule.
double knife_edge_weight(double v) {
  const auto fresnel = [&](const auto& f) {
    constexpr int parts = 2000;
    double sum = 0;
    for (int k = 0; k <= parts; ++k)
      sum += (k == 0 || k == parts ? 1
              : k % 2 == 1         ? 4
                                   : 2) *
             f(std::numbers::pi / 2 * (v * k / parts) * (v * k / parts));
    return sum * v / (3 * parts);
  };
  const double c = 0.5 - fresnel([](double x) { return std::cos(x); }),
               s = 0.5 - fresnel([](double x) { return std::sin(x); });
  return std::pow((c * c + s * s) / 2, 2);
}

/// The point on the seabed z = 0 at a range from the sonar, in the plane of constant azimuth `azimuth_rad`.
glm::dvec3 seabed_at(const AnsweredScene& scene, double azimuth_rad, double range_m) {
  const Json& ping = scene.json["pings"][0];
  const auto vector = [&](const char* key) {
    return glm::dvec3{ping[key][0].get<double>(), ping[key][1].get<double>(), ping[key][2].get<double>()};
  };
  const glm::dvec3 ahead =
      std::sin(azimuth_rad) * vector("starboard") + std::cos(azimuth_rad) * vector("forward");
  double low = -30 * degree, high = 30 * degree;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    const double z =
        scene.sonar().z + range_m * (std::cos(middle) * ahead.z + std::sin(middle) * vector("up").z);
    (z < 0 ? low : high) = middle;
  }
  return scene.sonar() + range_m * (std::cos(low) * ahead + std::sin(low) * vector("up"));
}

// Behind the middle of the wall, the upper edge alone determines the weights at the end of the shadow.
TEST(SuiteBorderAnswers, ShadowBordersHoldTheWeightOfAHalfPlane) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "suite", {"--scenes", "shadow-border"});
  const AnsweredScene scene(suite, "shadow-border");
  const Array sharp = array_in(suite / "answers/shadow-border/sharp.npy");
  EXPECT_NEAR(knife_edge_weight(0), 1.0 / 16, 1e-9);
  EXPECT_EQ(scene.json["beams"]["shadow"], "fresnel");
  const double wavelength = scene.json["water"]["sound_speed_m_s"].get<double>() /
                            (1000 * scene.json["beams"]["frequency_khz"].get<double>());
  const std::vector<double> open =
      edited_run(folder, scene, "\\[\\[objects\\]\\]\nname = \"wall\"\n([^\n]+\n)*\n", "");
  // The upper edge at the back of the wall casts the border of the shadow.
  std::vector<glm::dvec3> top;
  for (const auto& v : mesh_in(scene.folder / "wall.obj").vertices)
    if (v[2] > 0.9) top.emplace_back(v[0], v[1], v[2]);
  ASSERT_EQ(top.size(), 4u);
  const glm::dvec3 sonar = scene.sonar();
  std::ranges::sort(top, {}, [&](const glm::dvec3& v) { return -glm::length(v - sonar); });
  glm::dvec3 a = top[0], b = top[0];
  // Its other end is at the distance of the length of the wall.
  for (const glm::dvec3& v : top)
    if (std::abs(glm::length(v - a) - 1.5) < std::abs(glm::length(b - a) - 1.5)) b = v;
  glm::dvec3 normal = glm::normalize(glm::cross(a - sonar, b - a));
  if (normal.z < 0) normal = -normal;
  const glm::dvec3 across = glm::cross(normal, glm::normalize(b - a));
  const auto share = [&](glm::dvec3 ray) {  // along the edge, from 0 to 1
    const double d1 = glm::dot(a - sonar, across) / glm::dot(ray, across);
    return glm::dot(sonar + d1 * ray - a, b - a) / glm::dot(b - a, b - a);
  };
  std::size_t compared = 0, diffracted = 0;
  for (std::size_t beam = 0; beam < scene.energy.beams; ++beam)
    for (std::size_t k = 0; k < scene.energy.samples; ++k) {
      constexpr int parts = 8;
      double weight = 0;
      bool is_near_border = true;
      for (int i = 0; i < parts && is_near_border; ++i) {
        const double r = scene.first_m() + (static_cast<double>(k) + (i + 0.5) / parts) * scene.step_m();
        const glm::dvec3 place =
            seabed_at(scene, scene.json["beams"]["axes_deg"][beam].get<double>() * degree, r);
        const glm::dvec3 ray = (place - sonar) / r;
        const double d1 = glm::dot(a - sonar, across) / glm::dot(ray, across), d2 = r - d1;
        const double v = -glm::dot(place - sonar, normal) * std::sqrt(2 * d1 / (wavelength * d2 * r));
        is_near_border = d2 > 1 && std::abs(share(ray) - 0.5) < 0.15 && v > -0.9 && v < 1.5;
        if (is_near_border) weight += knife_edge_weight(v) / parts;
      }
      const std::size_t bin = beam * scene.energy.samples + k;
      if (!is_near_border || !(open[bin] > 0)) continue;
      EXPECT_NEAR(scene.energy.values[bin] / open[bin], weight, 0.01 + 0.1 * weight) << beam << " " << k;
      ++compared;
      diffracted += sharp.values[bin] == 0 && scene.energy.values[bin] > 0;
    }
  EXPECT_GT(compared, 20u);
  EXPECT_GT(diffracted, 5u);
}

}  // namespace
}  // namespace tubefoot
