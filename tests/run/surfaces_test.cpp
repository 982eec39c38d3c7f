// SPDX-License-Identifier: GPL-3.0-or-later
// Tests where a beam has no surface. The comparison is the outline of a flat seabed, independent of hidden
// parts.
#include "run/surfaces.hpp"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr double sonar_height_m = 2, half_width_m = 4, ahead_m = 9;

/// A camera 2 m above the middle of a seabed that ends 4 m to either side and 9 m ahead. The camera is
/// level, so that the walls of its beams are vertical.
std::string seabed_seen(const std::string& more = {}, const std::string& keys = {}) {
  return lambert_material("sand", -27) +
         flat_terrain(2 * half_width_m, 2 * ahead_m, "material = \"sand\"\n") + more +
         fixed_at(0, 0, sonar_height_m) +
         "[[sensors]]\nname = \"camera\"\nkind = \"didson\"\nbeams = 24\nhorizontal_deg = 120\nvertical_deg "
         "= 80\n"
         "samples = 400\nwindow_start_m = 1\nwindow_length_m = 14\n" +
         keys;
}

/// A wall across the seabed, higher than the camera.
const std::string wall =
    "[[objects]]\nname = \"wall\"\nmaterial = \"sand\"\nshape = \"box\"\nsize_m = [30, 0.2, 8]\nposition_m = "
    "[0, 3, 4]\n";

std::vector<int> surfaces_in(const std::string& text, bool without_echoes = true) {
  const TestFolder folder;
  const auto survey = open_survey(read_scene_file(folder.write("scene.toml", text)));
  EXPECT_TRUE(surfaces_are_known(*survey, 0));
  std::vector<double> energy(24 * 400, 0.0);
  if (!without_echoes) energy = echoes_in(folder, text).energy;
  return samples_with_surfaces(*survey, 0, 0, energy);
}

/// The farthest point of the seabed between two azimuths.
double farthest_m(double from, double to) {
  double farthest = 0;
  for (int k = 0; k <= 10000; ++k) {
    const double azimuth = from + (to - from) * k / 10000;
    farthest =
        std::max(farthest, std::min(ahead_m / std::cos(azimuth), half_width_m / std::abs(std::sin(azimuth))));
  }
  return std::hypot(farthest, sonar_height_m);
}

TEST(Surfaces, EndWhereTheSeabedEnds) {
  const std::vector<int> found = surfaces_in(seabed_seen());
  for (std::size_t beam = 0; beam < 24; ++beam) {
    const double from = (-60 + 5 * double(beam)) * degree;
    EXPECT_NEAR(found[beam], (farthest_m(from, from + 5 * degree) - 1) / 14 * 400, 1.01) << "beam " << beam;
  }
}

TEST(Surfaces, AreThereInShadowToo) {
  const std::vector<int> seen = surfaces_in(seabed_seen());
  const std::vector<int> hidden = surfaces_in(seabed_seen(wall), false);
  const TestFolder folder;
  const Echoes echoes = echoes_in(folder, seabed_seen(wall));
  for (std::size_t beam = 8; beam < 16; ++beam) {  // those whose seabed ends ahead, behind the wall
    EXPECT_EQ(echoes.at(0, beam, std::size_t(seen[beam]) - 5), 0) << "the wall hides it";
    EXPECT_EQ(hidden[beam], seen[beam]) << "beam " << beam;
  }
}

TEST(Surfaces, AreAsManyWhetherOneAsksTheEchoesOrNot) {
  EXPECT_EQ(surfaces_in(seabed_seen(), false), surfaces_in(seabed_seen()));
}

TEST(Surfaces, OfABeamThatLooksAwayAreNone) {
  const std::vector<int> up = surfaces_in(seabed_seen({}, "tilt_deg = -60\n"));
  EXPECT_THAT(up, testing::Each(0));
  const std::vector<int> all =
      surfaces_in(replaced(seabed_seen(), "window_length_m = 14", "window_length_m = 2"));
  EXPECT_THAT(all, testing::Each(testing::Gt(0)));
}

TEST(Surfaces, AreNotKnownWhereRaysBendOrTheReceiverIsApart) {
  const TestFolder folder;
  const auto known = [&](const std::string& text) {
    const auto survey = open_survey(read_scene_file(folder.write("scene.toml", text)));
    return surfaces_are_known(*survey, 0);
  };
  EXPECT_FALSE(known(seabed_seen({}, "receiver_arm_m = [0.4, 0, 0]\n")));
  EXPECT_FALSE(known(seabed_seen() +
                     "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\n"
                     "profile_bottom_m = 30\nsurface_height_m = 10\n"));
}

std::size_t pixels_like(const std::filesystem::path& file, Colour colour) {
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::runtime_error("no picture " + file.string());
  std::vector<float> values(std::size_t(3) * input->spec().width * input->spec().height);
  input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data());
  constexpr double half_a_step = 0.501 / 255;  // pictures have 8 bits
  const auto like = [](float value, double wanted) { return std::abs(value - wanted) < half_a_step; };
  std::size_t count = 0;
  for (std::size_t k = 0; k < values.size(); k += 3)
    count +=
        like(values[k], colour.red) && like(values[k + 1], colour.green) && like(values[k + 2], colour.blue);
  return count;
}

TEST(Surfaces, OfARunAreInItsPictures) {
  const TestFolder folder;
  const auto drawn = [&](const std::string& name, const std::string& text) {
    const std::filesystem::path scene = folder.write(name + ".toml", text);
    const Outcome ran = run_program({"run", scene.string(), "-o", (folder / name).string()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return folder / name / "camera-0000.png";
  };
  const auto small = drawn("small", seabed_seen()), hidden = drawn("hidden", seabed_seen(wall)),
             large = drawn("large", replaced(seabed_seen(), "width_m = 8\nlength_m = 18",
                                             "width_m = 80\nlength_m = 80"));
  EXPECT_GT(pixels_like(small, palette.beyond), 20'000u);
  EXPECT_EQ(pixels_like(large, palette.beyond), 0u);
  // A shadow is as dark as otherwise, and no part of it is taken for open water. In the outer beams the
  // wall itself extends beyond the seabed.
  const auto open_water = static_cast<double>(pixels_like(small, palette.beyond));
  EXPECT_NEAR(static_cast<double>(pixels_like(hidden, palette.beyond)), open_water, 0.05 * open_water);
  EXPECT_GT(pixels_like(hidden, palette.no_echo), pixels_like(small, palette.no_echo) + 20'000);
}

}  // namespace
}  // namespace tubefoot
