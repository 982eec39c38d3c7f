// SPDX-License-Identifier: GPL-3.0-or-later
// Tests footprints of paths over mirrors. Energies are compared with the echoes of a run, order by order.
// Positions and ranges are compared with an image that the test constructs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "fixtures/footprint_rows.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

struct PathCase {
  const char *name, *water, *material, *sensor, *more;
  double tolerance;
};

/// A sidescan between a rough seabed with a box, and a surface that is a mirror. It receives no specular
/// return from the surface.
class FootprintsOverMirrors : public testing::TestWithParam<PathCase> {
 protected:
  static std::string scene(int order, std::string_view only, double height_m = 3) {
    const auto& of = GetParam();
    return fmt::format(
               "[water]\nabsorption_db_per_km = 300\n{}[sea_surface]\nheight_m = {}\nloss_db = 2\n"
               "rms_roughness_m = 0.0005\n[paths]\norder = {}\n{}",
               of.water, height_m, order, only) +
           lambert_material("sand", -27) + of.material +
           rough_terrain(12, 24, 2, "name = \"bed\"\nmaterial = \"sand\"\nrms_height_m = 0.05\n") +
           "[trajectory]\nkind = \"fixed\"\nposition_m = [0.1, 0.2, 1.4]\n" + of.more +
           "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\nalong_track_deg = 20\n"
           "depression_min_deg = -60\ndepression_max_deg = 60\nrange_min_m = 1\nrange_max_m = 7\nsamples = "
           "24\n" +
           of.sensor;
  }
};

INSTANTIATE_TEST_SUITE_P(
    Scenes, FootprintsOverMirrors,
    testing::Values(PathCase{"EvenWater", "", "", "", "", 1e-8},
                    PathCase{"Centroids", "", "", "", "[run]\nbinning = \"centroid\"\n", 1e-12},
                    PathCase{"ReceiverApart", "", "", "receiver_arm_m = [0.2, 0.1, -0.3]\n", "", 1e-8},
                    PathCase{"Patterns", "", "",
                             "transmit_pattern = \"gaussian\"\ntransmit_beam_width_deg = 20\n"
                             "receive_pattern = \"gaussian\"\nreceive_beam_width_deg = 12\n",
                             "", 1e-5},
                    PathCase{"Refraction",
                             "profile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = -2\n"
                             "profile_bottom_m = 30\nsurface_height_m = 3\n",
                             "", "", "", 1e-8},
                    PathCase{"RefractionReceiverApart",
                             "profile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = -2\n"
                             "profile_bottom_m = 30\nsurface_height_m = 3\n",
                             "", "receiver_arm_m = [0.2, 0.1, -0.3]\n", "", 1e-8},
                    PathCase{"ReliefOnline", "",
                             "[[materials.relief]]\nkind = \"ripples\"\ntile_m = 10.24\nresolution_m = 0.16\n"
                             "wavelength_m = 1.6\nrms_height_m = 0.03\n",
                             "", "[relief]\ncell_m = 0.5\n", 1e-8}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_P(FootprintsOverMirrors, SumToTheEchoesOfTheirOrder) {
  const TestFolder folder;
  const double tolerance = GetParam().tolerance;
  const Rows all = rows_of(footprints(folder, scene(3, ""), "side", "all.csv"));
  double sum = 0;
  for (int order = 1; order <= 3; ++order) {
    SCOPED_TRACE(order);
    const std::string of_order = scene(3, fmt::format("only_order = {}\n", order));
    const Echoes echoes = echoes_in(folder, of_order, {}, "side");
    const Rows rows = rows_of(footprints(folder, of_order, "side", "order.csv"));
    ASSERT_GT(echoes.total(), 0);
    EXPECT_NEAR(rows.sum("energy_j"), echoes.total(), tolerance * echoes.total());
    sum += rows.sum("energy_j");
    std::map<double, double> by_mirrors;
    for (const Row& row : rows.rows) {
      EXPECT_EQ(row.at("path_order"), order);
      EXPECT_EQ(row.at("tx_reflections") + row.at("rx_reflections") + 1, order);
      EXPECT_LE(row.at("slant_range_min_m"), row.at("slant_range_max_m"));
      by_mirrors[row.at("tx_reflections")] += row.at("energy_j");
    }
    EXPECT_EQ(by_mirrors.size(), order == 3 ? 1u : std::size_t(order)) << "over the surface, once each way";
    EXPECT_EQ(std::ranges::count_if(all.rows, [&](const Row& row) { return row.at("path_order") == order; }),
              std::ptrdiff_t(rows.rows.size()));
    const std::string_view name = GetParam().name;
    if (order == 2 && (name == "EvenWater" || name == "Refraction")) {
      EXPECT_NEAR(by_mirrors[0], by_mirrors[1], 1e-6 * by_mirrors[1]) << "the way there and back is the same";
    }
  }
  EXPECT_NEAR(all.sum("energy_j"), sum, 1e-12 * sum);
}

// The position and the half paths of a footprint are those of its image and the seabed.
TEST(FootprintsOverTheSurface, LieOnTheSeabedAtTheRangesOfTheImages) {
  const TestFolder folder;
  const std::string scene =
      "[sea_surface]\nheight_m = 3\nloss_db = 2\n[paths]\norder = 3\n" + lambert_material("sand", -27) +
      "[[terrain]]\nkind = \"flat\"\nname = \"bed\"\nmaterial = \"sand\"\nwidth_m = 30\nlength_m = "
      "30\ncell_m = "
      "2\n[trajectory]\nkind = \"fixed\"\nposition_m = [0.1, 0.2, 1]\n"
      "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\nalong_track_deg = 20\n"
      "depression_min_deg = -60\ndepression_max_deg = 60\nrange_min_m = 1\nrange_max_m = 9\nsamples = 24\n";
  const Rows rows = rows_of(footprints(folder, scene, "side", "side.csv"));
  std::set<std::pair<double, double>> ways;
  for (const Row& row : rows.rows) {
    const glm::dvec3 at(row.at("centroid_east_m"), row.at("centroid_north_m"), row.at("centroid_up_m")),
        apex(0.1, 0.2, 1), image(0.1, 0.2, 5);
    EXPECT_NEAR(at.z, 0, 1e-5);
    const double tx = glm::distance(at, row.at("tx_reflections") > 0 ? image : apex),
                 rx = glm::distance(at, row.at("rx_reflections") > 0 ? image : apex);
    EXPECT_LE(row.at("slant_range_min_m"), (tx + rx) / 2 + 1e-6);
    EXPECT_GE(row.at("slant_range_max_m"), (tx + rx) / 2 - 1e-6);
    EXPECT_NEAR(std::sin(row.at("grazing_deg") * std::numbers::pi / 180) * tx,
                row.at("tx_reflections") > 0 ? 5 : 1, 1e-5);
    double azimuth = std::atan2(at.x - apex.x, at.y - apex.y) * 180 / std::numbers::pi;
    if (azimuth < 0) azimuth += 360;
    EXPECT_NEAR(row.at("azimuth_deg"), azimuth, 1e-4);
    ways.insert({row.at("tx_reflections"), row.at("rx_reflections")});
  }
  EXPECT_EQ(ways, (std::set<std::pair<double, double>>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
}

}  // namespace
}  // namespace tubefoot
