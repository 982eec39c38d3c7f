// SPDX-License-Identifier: GPL-3.0-or-later
// Tests material maps in whole runs: the border of two materials cuts footprints in the same way as a facet
// edge.
#include <fmt/format.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <map>
#include <numbers>

#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// The south-east half of a seabed of two facets, with corners on the grid of the scene. No facet edge lies
/// along its border.
constexpr std::string_view half = R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":
{"material":"second"},"geometry":{"type":"Polygon","coordinates":[[[-64,-48],[64,-64],[64,48],[-64,-48]]]}}]})";

constexpr std::string_view half_map = R"(
[terrain.material_map]
kind = "polygons"
file = "half.geojson"
coordinates = "local"
)";

std::string scene(double first_db, double second_db, std::string_view map, double heading_deg = 54) {
  return still_water() + lambert_material("first", first_db) + lambert_material("second", second_db) +
         flat_terrain(128, 128, "material = \"first\"\n" + std::string(map)) +
         fixed_at(0, 0, 10, fmt::format("heading_deg = {}\n", heading_deg)) + downward_fan(7, 28, 64);
}

class MaterialMapRun : public testing::Test {
 protected:
  MaterialMapRun() { folder_.write("half.geojson", half); }
  Echoes echoes(double first_db, double second_db, std::string_view map = half_map) const {
    return echoes_in(folder_, scene(first_db, second_db, map));
  }
  TestFolder folder_;
};

TEST_F(MaterialMapRun, EqualMaterialsAreOneMaterial) {
  EXPECT_LT(largest_relative_difference(echoes(-27, -27), echoes(-27, -27, "")), 1e-12);
}

// The energy of each half is linear in its mu. A run plus the run with exchanged values equals the sum of
// two uniform seabeds.
TEST_F(MaterialMapRun, HalvesAddUpToTheWhole) {
  const Echoes one = echoes(-30, -20), other = echoes(-20, -30), faint = echoes(-30, -30, ""),
               loud = echoes(-20, -20, "");
  ASSERT_EQ(one.energy.size(), loud.energy.size());
  std::size_t both = 0;
  for (std::size_t k = 0; k < loud.energy.size(); ++k) {
    EXPECT_NEAR(one.energy[k] + other.energy[k], faint.energy[k] + loud.energy[k], 1e-12 * loud.energy[k]);
    both += one.energy[k] > 1.01 * faint.energy[k] && one.energy[k] < 0.99 * loud.energy[k];
  }
  EXPECT_GT(both, 10u) << "samples that hold both materials";
}

// Two rectangles meet below the sonar. Each beam has the closed form with the mu of its side (physics.md
// 7.5).
TEST_F(MaterialMapRun, EachSideIsItsClosedForm) {
  folder_.write("half.geojson", R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":
{"material":"second"},"geometry":{"type":"Polygon","coordinates":[[[0,-99],[99,-99],[99,99],[0,99],[0,-99]]]}}]})");
  const Echoes seen =
      echoes_in(folder_, replaced(replaced(scene(-30, -20, half_map, 0), "beams = 7", "beams = 2"),
                                  "horizontal_deg = 28", "horizontal_deg = 10"));
  for (const std::size_t beam : {0u, 1u})  // from west to east
    for (std::size_t k = 20; k < 60; ++k) {
      const double mu = beam == 0 ? 1e-3 : 1e-2, near_m = seen.first_m(k), far_m = seen.last_m(k);
      const double expected =
          mu * 100 * (5 * std::numbers::pi / 180) / 4 * (std::pow(near_m, -4) - std::pow(far_m, -4));
      EXPECT_NEAR(seen.energy[beam * 64 + k], expected, 1e-6 * expected) << beam << ' ' << k;
    }
}

TEST_F(MaterialMapRun, CheckAuditAndFootprintsKnowTheMaterials) {
  const std::string file = folder_.write("scene.toml", scene(-30, -20, half_map)).string();
  const Outcome check = run_program({"check", file});
  ASSERT_EQ(check.exit_code, 0) << check.err;
  // The triangle has 7168 m2 of 16384.
  EXPECT_THAT(check.out, testing::ContainsRegex("\nfirst +[0-9]+ +9216\n"));
  EXPECT_THAT(check.out, testing::ContainsRegex("\nsecond +[0-9]+ +7168\n"));
  EXPECT_THAT(check.out, HasSubstr("terrain: 2 facets are cut along the borders of its material map"));

  const Outcome audit = run_program({"audit", file, "--quiet"});
  EXPECT_EQ(audit.exit_code, 0) << audit.err << audit.out;
  EXPECT_THAT(audit.out, testing::ContainsRegex("failures +0\n"));

  const std::filesystem::path footprints = folder_ / "footprints.csv";
  const Outcome listed = run_program({"footprints", file, "--sensor", "beam", "-o", footprints.string()});
  ASSERT_EQ(listed.exit_code, 0) << listed.err;
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> data(
      GDALDataset::Open(footprints.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  ASSERT_NE(data, nullptr);
  std::map<std::string, int> count;
  for (const auto& feature : data->GetLayer(0)) {
    const std::string material = feature->GetFieldAsString("material");
    ++count[material];
    // The border runs from (-64, -48) to (64, 48): y = 0.75 x. The other border is y = -56 - x / 8.
    const double x = feature->GetFieldAsDouble("centroid_east_m"),
                 y = feature->GetFieldAsDouble("centroid_north_m");
    EXPECT_EQ(material, y < 0.75 * x && y > -56 - x / 8 ? "second" : "first") << x << ' ' << y;
  }
  EXPECT_GE(count["first"], 5);
  EXPECT_GE(count["second"], 3);
}

}  // namespace
}  // namespace tubefoot
