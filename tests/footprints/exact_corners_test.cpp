// SPDX-License-Identifier: GPL-3.0-or-later
// Tests exact corners of apparent facets and of bistatic footprints: the polygons of the table, in
// rationals, on the seabed.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <sstream>
#include <tuple>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

using Rational = boost::multiprecision::mpq_rational;

const std::string refracted =
    "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = 0.5\nprofile_bottom_m = 30\n"
    "surface_height_m = 10\n";

std::string scene_with_box(const std::string& water, const std::string& sensor) {
  return water + lambert_material("sand", -27) + lambert_material("steel", -5) +
         flat_terrain(30, 40, "material = \"sand\"\n") + box_ahead(4) + R"(
[[sensors]]
name = "camera"
kind = "didson"
tilt_deg = 30
beams = 3
horizontal_deg = 12
window_start_m = 1
window_length_m = 20
samples = 64
)" + sensor;
}

/// Facet, tube, receive tube.
using Key = std::tuple<int, int, int>;
struct Polygons {
  std::map<Key, double> area_m2;
  std::size_t pieces = 0, seen = 0, receiver_tubes = 0;
  std::map<int, double> farthest_up_m;  ///< or down, by facet
};

Polygons read(const std::filesystem::path& file) {
  Polygons all;
  std::istringstream lines(bytes_of(file));
  bool receiver = false;
  int tube = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "transmission") receiver = false;
    if (word == "receiver") receiver = true;
    if (word == "tube") {
      words >> tube;
      all.receiver_tubes += receiver;
    }
    all.seen += word == "seen";
    int facet = 0, rx = tube;
    std::size_t count = 0;
    if (word == "piece") {
      words >> facet >> count;
    } else if (word == "shared") {
      words >> facet >> tube >> rx >> count;
    } else {
      continue;
    }
    std::vector<glm::dvec3> corners;
    for (std::size_t k = 0; k < count; ++k) {
      glm::dvec3 p;
      for (int c = 0; c < 3; ++c) {
        std::string text;
        words >> text;
        p[c] = Rational(text).convert_to<double>();
      }
      corners.push_back(p);
    }
    if (!words) throw std::runtime_error("a line ends early: " + line.substr(0, 80));
    for (const glm::dvec3& p : corners)
      all.farthest_up_m[facet] = std::max(all.farthest_up_m[facet], std::abs(p.z));
    if (word == "shared" || !receiver) {
      glm::dvec3 sum(0);
      for (std::size_t k = 1; k + 1 < count; ++k)
        sum += glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
      all.area_m2[{facet, tube, word == "shared" ? rx : -1}] += glm::length(sum) / 2;
      ++all.pieces;
    }
  }
  return all;
}

struct ExactCorners : testing::TestWithParam<std::tuple<bool, bool, bool>> {};
INSTANTIATE_TEST_SUITE_P(Looks, ExactCorners,
                         testing::Combine(testing::Bool(), testing::Bool(), testing::Bool()),
                         [](const auto& one) {
                           return std::string(std::get<0>(one.param) ? "Bent" : "Straight") +
                                  (std::get<1>(one.param) ? "Apart" : "OnePlace") +
                                  (std::get<2>(one.param) ? "OfABeam" : "");
                         });

TEST_P(ExactCorners, AreThoseOfTheTable) {
  const auto [refracts, apart, of_a_beam] = GetParam();
  const TestFolder folder;
  const std::string text =
      scene_with_box(refracts ? refracted : "", apart ? "receiver_arm_m = [0.3, 0, 0.1]\n" : "");
  std::vector<std::string> words{"footprints",  folder.write("scene.toml", text).string(),
                                 "--sensor",    "camera",
                                 "-o",          (folder / "f.csv").string(),
                                 "--rationals", (folder / "f.txt").string(),
                                 "--quiet"};
  if (of_a_beam) words.insert(words.end(), {"--beams", "1"});
  const Outcome outcome = run_program(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Polygons exact = read(folder / "f.txt");
  EXPECT_EQ(exact.receiver_tubes > 0, apart);
  EXPECT_EQ(exact.seen > 0, refracts);
  std::size_t rows = 0, surface_apex = 0;
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open((folder / "f.csv").c_str(), GDAL_OF_VECTOR));
  ASSERT_TRUE(data);
  for (const auto& row : *data->GetLayer(0)) {
    const auto number = [&](const char* name) { return row->GetFieldAsInteger(name); };
    const int facet = number("facet"), tube = number("tube"), rx = number("receive_tube");
    const auto found = exact.area_m2.find({facet, tube, apart ? rx : -1});
    ASSERT_NE(found, exact.area_m2.end()) << facet << ' ' << tube << ' ' << rx;
    // The seabed is the plane 0, although rays arrive from apparent positions.
    if (std::string(row->GetFieldAsString("material")) == "sand") {
      EXPECT_LT(exact.farthest_up_m.at(facet), 1e-9);
      ++surface_apex;
    }
    const double area = row->GetFieldAsDouble("area_m2");
    EXPECT_NEAR(found->second, area, 1e-9 * area + 1e-12);
    if (!apart) {
      EXPECT_EQ(tube, rx);
    }
    if (of_a_beam) {
      EXPECT_EQ(number("beam"), 1);
    }
    ++rows;
  }
  EXPECT_GT(rows, of_a_beam ? 6u : 20u);
  EXPECT_GT(surface_apex, of_a_beam ? 1u : 5u);
  std::size_t keys = 0;
  for (const auto& [key, area] : exact.area_m2) keys += !apart || std::get<2>(key) >= 0;
  EXPECT_EQ(rows, keys);
}

// Doubles choose the same planes here. With a large tolerance, corners are still numbers.
TEST(ExactCornersOfDoubles, AreWhereTheChosenPlanesMeet) {
  const TestFolder folder;
  const auto corners = [&](const std::string& run, const char* name) {
    const std::string text = scene_with_box("", "receiver_arm_m = [0.3, 0, 0.1]\n") + run;
    const Outcome outcome = run_program({"footprints", folder.write("scene.toml", text).string(), "--sensor",
                                         "camera", "-o", (folder / name).string(), "--quiet"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read(folder / name);
  };
  const Polygons exact = corners("", "exact.txt");
  EXPECT_EQ(corners("[run]\narithmetic = \"double\"\n", "double.txt").area_m2, exact.area_m2);
  EXPECT_NE(corners("[run]\narithmetic = \"double\"\nzero_tolerance = 1e-3\n", "wrong.txt").area_m2,
            exact.area_m2);
}

}  // namespace
}  // namespace tubefoot
