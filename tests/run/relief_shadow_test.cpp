// SPDX-License-Identifier: GPL-3.0-or-later
// Compares shadows of relief at grazing angles with a march over the height field, which uses neither
// facets nor tubes. A pixel has no energy if and only if its seabed is hidden.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fixtures/world/echoes.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/scene.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

constexpr int beams = 12, samples = 200;
constexpr double shadow_fan_rad = 2.4 * std::numbers::pi / 180, eye_m = 1, first_m = 3, length_m = 8,
                 cell_m = 0.01;

constexpr std::string_view shadowing_relief = R"([[materials.relief]]
kind = "fbm"
hurst = 0.8
rms_height_m = 0.12
tile_m = 10.24
resolution_m = 0.32
)";
constexpr std::string_view micro = R"([[materials.reflectivity]]
kind = "perlin"
wavelength_m = 0.4
depth = 0.9
)";

/// A camera 1 m above the seabed that looks horizontally north. Beams are bounded by vertical planes. From
/// 3 to 11 m of slant range, rays would meet a flat seabed at 19 to 5 degrees.
std::string shadow_scene_of(std::string_view textures, std::string_view more = "") {
  return fmt::format(R"(
[water]
sound_speed_m_s = 1500
[[materials]]
name = "sand"
{}[[terrain]]
kind = "flat"
width_m = 0.8
length_m = 13
centre_m = [0, 5.5, 0]
[trajectory]
kind = "fixed"
position_m = [0, 0, {}]
[[sensors]]
name = "camera"
kind = "didson"
beams = {}
horizontal_deg = 2.4
vertical_deg = 160
samples = {}
window_start_m = {}
window_length_m = {}
{})",
                     textures, eye_m, beams, samples, first_m, length_m, more);
}

enum class Light { lit, dark, undecided };

/// Computes the visibility of the range bins of a beam by a march. It evaluates heights at nodes of
/// adjacent rays. Between nodes the heights are known to `slack_m`, the error of linear interpolation of
/// the field, here and in the facets. Seen from the eye, ground at height h and distance r appears at t =
/// (h - eye) / r. It is hidden if a nearer point appears higher.
class HeightMarch {
 public:
  static constexpr int strips = 16;  // of a beam, between 17 rays
  static constexpr double step_m = 0.005;

  HeightMarch(const ElevationField& field, int beam) : rays_(strips + 1), distance_m_(nodes()) {
    const double spacing_m = 12 * shadow_fan_rad / (beams * strips);  // at 12 m, the farthest
    slack_m_ = 2e-6 + field.left_out(cell_m).largest_height_m +
               field.left_out(std::hypot(step_m, spacing_m)).largest_height_m;
    for (std::size_t k = 0; k < nodes(); ++k) distance_m_[k] = 0.5 + static_cast<double>(k) * step_m;
    for (int i = 0; i <= strips; ++i) {
      const double azimuth = shadow_fan_rad * ((beam + static_cast<double>(i) / strips) / beams - 0.5);
      for (const double r : distance_m_)
        rays_[static_cast<std::size_t>(i)].push_back(
            field.height_m({r * std::sin(azimuth), r * std::cos(azimuth), 0}));
    }
  }

  std::vector<Light> samples_of_beam() const {
    std::vector<Light> light(samples, Light::dark);
    for (std::size_t i = 0; i + 1 < rays_.size(); ++i) not_hidden(i, light);
    // The outermost rays lie on the border of the beam: the adjacent beam may receive the points that they
    // see.
    for (std::size_t i = 1; i + 1 < rays_.size(); ++i) seen(i, light);
    return light;
  }

 private:
  static constexpr std::size_t nodes() { return static_cast<std::size_t>(11.5 / step_m); }
  double height(std::size_t ray, std::size_t k) const { return rays_[ray][k] - eye_m; }
  double slant_m(std::size_t ray, std::size_t k) const { return std::hypot(distance_m_[k], height(ray, k)); }
  static double sample_of(double slant) { return (slant - first_m) / length_m * samples; }

  /// Marks range bins as not dark where the surface between rays i and i + 1 may be visible. Two nodes at
  /// one distance that both appear higher hide everything between their rays. Nodes of the two rays at
  /// different distances would not.
  void not_hidden(std::size_t i, std::vector<Light>& light) const {
    double ridge = -1e9;
    for (std::size_t k = 0; k + 1 < distance_m_.size(); ++k) {
      ridge = std::max(ridge, (std::min(height(i, k), height(i + 1, k)) - slack_m_) / distance_m_[k]);
      double top = -1e9, nearest = 1e9, farthest = 0;
      for (const std::size_t ray : {i, i + 1})
        for (const std::size_t node : {k, k + 1}) {
          top = std::max(top, (height(ray, node) + slack_m_) / distance_m_[node]);
          nearest = std::min(nearest, slant_m(ray, node) - slack_m_);
          farthest = std::max(farthest, slant_m(ray, node) + slack_m_);
        }
      if (top < ridge) continue;
      const double last = std::min(std::floor(sample_of(farthest)), samples - 1.0);
      for (double s = std::max(std::floor(sample_of(nearest)), 0.0); s <= last; ++s)
        light[static_cast<std::size_t>(s)] = Light::undecided;
    }
  }

  /// Marks range bins as insonified if they surely contain a node that no nearer point could hide.
  void seen(std::size_t i, std::vector<Light>& light) const {
    double ridge = -1e9;
    for (std::size_t k = 0; k < distance_m_.size(); ++k) {
      const double r = distance_m_[k], slant = slant_m(i, k);
      const double early = std::floor(sample_of(slant - slack_m_)),
                   late = std::floor(sample_of(slant + slack_m_));
      if ((height(i, k) - slack_m_) / r > ridge && early == late && early >= 0 && early < samples)
        light[static_cast<std::size_t>(early)] = Light::lit;
      ridge = std::max(ridge, (height(i, k) + slack_m_) / r);
    }
  }

  std::vector<std::vector<double>> rays_;  ///< heights of the nodes
  std::vector<double> distance_m_;         ///< horizontal distances of the nodes
  double slack_m_ = 0;
};

std::string seeded(int seed) { return fmt::format("{}seed = {}\n", shadowing_relief, seed); }

const std::string online = fmt::format("[relief]\ncell_m = {}\ntolerance = 0\n", cell_m),
                  offline = fmt::format("[relief]\ncell_m = {}\nmode = \"offline\"\n", cell_m);

double dark_fraction(const Echoes& echoes) {
  return static_cast<double>(std::count(echoes.energy.begin(), echoes.energy.end(), 0.0)) /
         static_cast<double>(echoes.energy.size());
}

TEST(ReliefShadow, DarkPixelsAreThoseOfAMarchOverTheHeights) {
  constexpr double pixels = beams * samples;
  const std::vector<int> seeds{1, 2, 3, 4};
  int hidden = 0;
  for (const int seed : seeds) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const Echoes echoes = echoes_of(shadow_scene_of(seeded(seed), online));
    ASSERT_EQ(echoes.energy.size(), beams * samples);
    const TestFolder folder;
    const Scene scene =
        load_scene(read_scene_file(folder.write("scene.toml", shadow_scene_of(seeded(seed), online))));
    int dark = 0, lit = 0;
    for (int beam = 0; beam < beams; ++beam) {
      const std::vector<Light> light = HeightMarch(*scene.relief.at(0), beam).samples_of_beam();
      for (std::size_t k = 0; k < samples; ++k) {
        const double energy = echoes.at(0, static_cast<std::size_t>(beam), k);
        if (light[k] != Light::undecided) {
          EXPECT_EQ(energy > 0, light[k] == Light::lit) << "beam " << beam << ", sample " << k;
        }
        dark += light[k] == Light::dark;
        lit += light[k] == Light::lit;
      }
    }
    // Fraction of the area, except for the range bins that the march leaves undecided. These are few enough
    // for a significant check.
    EXPECT_GE(dark_fraction(echoes), dark / pixels);
    EXPECT_LE(dark_fraction(echoes), 1 - lit / pixels);
    EXPECT_LT(pixels - lit - dark, 0.08 * pixels);
    hidden += dark;
  }
  EXPECT_GT(hidden, 0.1 * pixels * static_cast<double>(seeds.size()));
}

TEST(ReliefShadow, SameOnlineAndOffline) {
  const Echoes transmission = echoes_of(shadow_scene_of(seeded(1), online)),
               whole = echoes_of(shadow_scene_of(seeded(1), offline));
  EXPECT_GT(dark_fraction(transmission), 0.1);
  for (std::size_t k = 0; k < transmission.energy.size(); ++k)
    ASSERT_EQ(transmission.energy[k] == 0, whole.energy[k] == 0) << "pixel " << k;
  EXPECT_LT(largest_relative_difference(transmission, whole), 1e-11);
}

TEST(ReliefShadow, MicroTextureMakesNone) {
  const Echoes even = echoes_of(shadow_scene_of("")), textured = echoes_of(shadow_scene_of(micro));
  EXPECT_EQ(dark_fraction(even), 0);
  EXPECT_EQ(dark_fraction(textured), 0);
  EXPECT_GT(largest_relative_difference(even, textured), 0.3);
  // On relief, the shadows are those of the relief.
  const Echoes rough = echoes_of(shadow_scene_of(seeded(1), online)),
               both = echoes_of(shadow_scene_of(seeded(1) + std::string(micro), online));
  EXPECT_GT(dark_fraction(rough), 0.1);
  for (std::size_t k = 0; k < rough.energy.size(); ++k)
    ASSERT_EQ(both.energy[k] == 0, rough.energy[k] == 0) << "pixel " << k;
}

}  // namespace
}  // namespace tubefoot
