// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `tubefoot coverage`: tables and layers agree with each other and close in rationals, in the
// reference system of the scene. Scenes without coverage are rejected.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <array>
#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Rational = boost::multiprecision::mpq_rational;
using testing::HasSubstr;

/// Five pings of a sidescan past a box on a flat seabed. Adjacent beams overlap.
constexpr std::string_view covered_scene = R"(
title = "Box"
[[materials]]
name = "sand"
[[terrain]]
name = "bed"
kind = "fractal"
material = "sand"
width_m = 40
length_m = 20
cell_m = 1
rms_height_m = 0.05
[[objects]]
name = "box"
shape = "box"
position_m = [6, 0.3, 0.5]
heading_deg = 20
[trajectory]
kind = "line"
start_m = [0, -1, 5]
end_m = [0, 1, 5]
speed_m_s = 1
[[sensors]]
name = "sidescan"
kind = "sidescan"
pings = 5
ping_interval_s = 0.3
along_track_deg = 3
range_min_m = 1
range_max_m = 15
samples = 100
)";

Outcome cover(const fs::path& scene_file, const fs::path& output, const std::vector<std::string>& more = {},
              const Surroundings& surroundings = {}) {
  std::vector<std::string> words{"coverage", scene_file.string(), "-o", output.string(), "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words, surroundings);
}

std::unique_ptr<GDALDataset> opened(const fs::path& file) {
  GDALAllRegister();
  std::unique_ptr<GDALDataset> data(
      GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (!data) throw std::runtime_error("OGR cannot read " + file.string());
  return data;
}

struct FacetRow {
  double area_m2 = 0, seen_m2 = 0, shadow_m2 = 0;
  Rational seen, never, shadow;
};

TEST(CoverageRun, LayersAndTablesAgreeAndCloseInRationals) {
  const TestFolder folder;
  const fs::path file = folder / "c.gpkg";
  const Outcome outcome = cover(folder.write("scene.toml", covered_scene), file);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", "c.gpkg"}));
  const auto data = opened(file);

  std::map<GIntBig, FacetRow> facets;
  for (const auto& row : *data->GetLayerByName("facets")) {
    FacetRow& facet = facets[row->GetFieldAsInteger64("facet")];
    facet = {row->GetFieldAsDouble("area_m2"),
             row->GetFieldAsDouble("seen_m2"),
             row->GetFieldAsDouble("shadow_m2"),
             Rational(row->GetFieldAsString("seen_exact")),
             Rational(row->GetFieldAsString("never_exact")),
             Rational(row->GetFieldAsString("shadow_exact"))};
    EXPECT_EQ(facet.seen + facet.never, 1);
    EXPECT_LE(facet.shadow, facet.never);
    EXPECT_NEAR(facet.seen_m2, facet.area_m2 * facet.seen.convert_to<double>(), 1e-12);
  }
  ASSERT_GT(facets.size(), 100u);
  EXPECT_THAT(outcome.out, HasSubstr(fmt::format("closure        {0} of {0} facets", facets.size())));

  std::map<GIntBig, Rational> sums, seen;
  GIntBig most = 0;
  for (const auto& row : *data->GetLayerByName("depths")) {
    const GIntBig facet = row->GetFieldAsInteger64("facet"), pings = row->GetFieldAsInteger64("pings");
    sums[facet] += Rational(row->GetFieldAsString("share_exact"));
    if (pings > 0) seen[facet] += Rational(row->GetFieldAsString("share_exact"));
    most = std::max(most, pings);
  }
  EXPECT_GE(most, 2);
  EXPECT_LE(most, 5);
  EXPECT_EQ(sums.size(), facets.size());
  for (const auto& [id, facet] : facets) {
    EXPECT_EQ(sums[id], 1);
    EXPECT_EQ(seen[id], facet.seen);
  }

  // Polygons cover each facet completely, including plan areas by OGR.
  std::map<GIntBig, double> area, seen_area, shadow_area;
  for (const auto& feature : *data->GetLayerByName("coverage")) {
    const GIntBig facet = feature->GetFieldAsInteger64("facet");
    area[facet] += feature->GetFieldAsDouble("area_m2");
    if (feature->GetFieldAsInteger64("pings") > 0) seen_area[facet] += feature->GetFieldAsDouble("area_m2");
    if (std::string(feature->GetFieldAsString("component")) == "bed") {
      double plan = 0;
      EXPECT_TRUE(feature->GetGeometryRef()->IsValid());
      for (const OGRPolygon* polygon : *feature->GetGeometryRef()->toMultiPolygon())
        plan += polygon->get_Area();
      EXPECT_NEAR(plan, feature->GetFieldAsDouble("area_m2"), 0.2 * plan);
      EXPECT_LE(plan, feature->GetFieldAsDouble("area_m2") + 1e-9);
    }
  }
  double in_shadow = 0;
  for (const auto& feature : *data->GetLayerByName("shadows")) {
    shadow_area[feature->GetFieldAsInteger64("facet")] += feature->GetFieldAsDouble("area_m2");
    EXPECT_GE(feature->GetFieldAsInteger64("in_sector"), 1);
    EXPECT_STREQ(feature->GetFieldAsString("first_sensor"), "sidescan");
    if (std::string(feature->GetFieldAsString("component")) == "bed" &&
        std::string(feature->GetFieldAsString("occluder_component")) == "box")
      in_shadow += feature->GetFieldAsDouble("area_m2");
  }
  for (const auto& [id, facet] : facets) {
    EXPECT_NEAR(area[id], facet.area_m2, 1e-9);
    EXPECT_NEAR(seen_area[id], facet.seen_m2, 1e-9);
    EXPECT_NEAR(shadow_area[id], facet.shadow_m2, 1e-9);
  }
  EXPECT_GT(in_shadow, 0.3) << "the box throws a shadow on the bed";
}

TEST(CoverageRun, FolderHoldsTheSameAsTheFiles) {
  const TestFolder folder;
  const fs::path scene_file = folder.write("scene.toml", covered_scene);
  ASSERT_EQ(cover(scene_file, folder / "out", {"--threads", "1"}).exit_code, 0);
  ASSERT_EQ(cover(scene_file, folder / "c.gpkg", {"--threads", "3"}).exit_code, 0);
  ASSERT_EQ(cover(scene_file, folder / "c.csv", {"--picture", (folder / "c.png").string()}).exit_code, 0);
  EXPECT_TRUE(bytes_of(folder / "out/coverage.gpkg") == bytes_of(folder / "c.gpkg"));
  EXPECT_TRUE(bytes_of(folder / "out/facets.csv") == bytes_of(folder / "c.csv"));
  EXPECT_TRUE(bytes_of(folder / "out/coverage.png") == bytes_of(folder / "c.png"));
  std::istringstream rows(bytes_of(folder / "out/facets.csv"));
  std::string header, row;
  std::getline(rows, header);
  EXPECT_EQ(header,
            "facet,component,material,most_pings,area_m2,seen_m2,never_m2,shadow_m2,seen_share,never_share,"
            "shadow_share,mean_pings,seen_exact,never_exact,shadow_exact");
  std::size_t count = 0;
  while (std::getline(rows, row)) ++count;
  EXPECT_EQ(count,
            static_cast<std::size_t>(opened(folder / "c.gpkg")->GetLayerByName("facets")->GetFeatureCount()));
}

/// Returns the numbers of an ASCII array of a VTK file.
std::vector<double> vtk_array(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("Name=\"" + name + "\""), begin = text.find('>', at) + 1;
  EXPECT_NE(at, std::string::npos) << name;
  std::istringstream words(text.substr(begin, text.find('<', begin) - begin));
  std::vector<double> values;
  for (double value = 0; words >> value;) values.push_back(value);
  return values;
}

/// Returns a column of a CSV table by its name.
std::vector<double> csv_column(const std::string& text, const std::string& name) {
  std::istringstream rows(text);
  std::string row, word;
  std::getline(rows, row);
  std::istringstream header(row);
  std::size_t column = 0;
  while (std::getline(header, word, ',') && word != name) ++column;
  std::vector<double> values;
  while (std::getline(rows, row)) {
    std::istringstream words(row);
    for (std::size_t k = 0; k <= column; ++k) std::getline(words, word, ',');
    values.push_back(std::stod(word));
  }
  return values;
}

TEST(CoverageRun, MeshesHaveTheValuesOfTheTable) {
  const TestFolder folder;
  const fs::path scene_file = folder.write("scene.toml", covered_scene);
  ASSERT_EQ(cover(scene_file, folder / "out").exit_code, 0);
  for (const char* suffix : {"vtp", "glb"}) {
    ASSERT_EQ(cover(scene_file, folder / fmt::format("c.{}", suffix)).exit_code, 0);
    EXPECT_TRUE(bytes_of(folder / fmt::format("out/coverage.{}", suffix)) ==
                bytes_of(folder / fmt::format("c.{}", suffix)));
  }
  const std::string table = bytes_of(folder / "out/facets.csv"), vtp = bytes_of(folder / "c.vtp");
  for (const char* name : {"facet", "most_pings", "area_m2", "seen_share", "shadow_share", "mean_pings"})
    EXPECT_EQ(vtk_array(vtp, name), csv_column(table, name)) << name;
  // The triangles have the areas of the table.
  const std::vector<double> points = vtk_array(vtp, "Points"), area = csv_column(table, "area_m2");
  ASSERT_EQ(points.size(), 9 * area.size());
  for (std::size_t k = 0; k < area.size(); ++k) {
    std::array<double, 3> e{}, f{};
    for (std::size_t c = 0; c < 3; ++c) {
      e[c] = points[9 * k + 3 + c] - points[9 * k + c];
      f[c] = points[9 * k + 6 + c] - points[9 * k + c];
    }
    const double own =
        std::hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]) / 2;
    EXPECT_NEAR(own, area[k], 1e-12);
  }

  const std::string glb = bytes_of(folder / "c.glb");
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, glb.data() + at, sizeof value);
    return value;
  };
  ASSERT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word(8), glb.size());
  const std::size_t json_size = word(12), data = 20 + json_size + 8;
  const auto json = nlohmann::json::parse(glb.substr(20, json_size));
  EXPECT_EQ(json.at("buffers")[0].at("byteLength").get<std::size_t>(), glb.size() - data);
  const auto& attributes = json.at("meshes")[0].at("primitives")[0].at("attributes");
  const auto value_of = [&](const char* name, std::size_t number) {
    const auto& accessor = json.at("accessors")[attributes.at(name).get<std::size_t>()];
    const auto& view = json.at("bufferViews")[accessor.at("bufferView").get<std::size_t>()];
    float value = 0;
    std::memcpy(&value, glb.data() + data + view.at("byteOffset").get<std::size_t>() + number * sizeof value,
                sizeof value);
    return value;
  };
  const std::vector<double> mean = csv_column(table, "mean_pings"),
                            shadow = csv_column(table, "shadow_share");
  const std::vector<double> place = json.at("nodes")[0].at("translation").get<std::vector<double>>();
  for (std::size_t k = 0; k < 3 * mean.size(); ++k) {
    EXPECT_EQ(value_of("_MEAN_PINGS", k), static_cast<float>(mean[k / 3]));
    EXPECT_EQ(value_of("_SHADOW_SHARE", k), static_cast<float>(shadow[k / 3]));
    // East, up and south.
    EXPECT_NEAR(value_of("POSITION", 3 * k) + place[0], points[3 * k], 1e-5);
    EXPECT_NEAR(value_of("POSITION", 3 * k + 1) + place[1], points[3 * k + 2], 1e-5);
    EXPECT_NEAR(value_of("POSITION", 3 * k + 2) + place[2], -points[3 * k + 1], 1e-5);
  }
}

/// Returns the height of a PNG picture in pixels.
int height_of(const fs::path& file) {
  const std::string png = bytes_of(file);
  int height = 0;
  for (std::size_t k = 20; k < 24; ++k) height = height << 8 | static_cast<unsigned char>(png.at(k));
  return height;
}

TEST(CoverageRun, PictureOfAWallHasASideView) {
  const TestFolder folder;
  const fs::path wall = fs::path(TUBEFOOT_SOURCE_DIR) / "scenes/coverage/scene.toml";
  ASSERT_EQ(cover(wall, folder / "wall", {"--pings", "50"}).exit_code, 0);
  const std::string text = bytes_of(wall);
  ASSERT_NE(text.find("size_m = [20, 0.5, 4]"), std::string::npos);
  // A low step has the same plan, and too little visible area for a side view.
  const fs::path step =
      folder.write("step.toml", replaced(replaced(text, "size_m = [20, 0.5, 4]", "size_m = [20, 0.5, 0.1]"),
                                         "position_m = [0, 15, 2]", "position_m = [0, 15, 0.05]"));
  ASSERT_EQ(cover(step, folder / "step", {"--pings", "50"}).exit_code, 0);
  EXPECT_GT(height_of(folder / "wall/coverage.png"), height_of(folder / "step/coverage.png") + 150);
}

TEST(CoverageRun, PingsAndSensorAreThoseRequested) {
  const TestFolder folder;
  const fs::path scene_file = folder.write("scene.toml", covered_scene);
  const auto most = [&](const std::vector<std::string>& more) {
    EXPECT_EQ(cover(scene_file, folder / "c.gpkg", more).exit_code, 0);
    GIntBig pings = 0;
    const auto data = opened(folder / "c.gpkg");
    for (const auto& row : *data->GetLayerByName("facets"))
      pings = std::max(pings, row->GetFieldAsInteger64("most_pings"));
    return pings;
  };
  EXPECT_EQ(most({"--pings", "2"}), 1);
  EXPECT_GT(most({"--sensor", "sidescan"}), 1);
  EXPECT_EQ(cover(scene_file, folder / "d.gpkg", {"--pings", "5"}).exit_code, 2);
  EXPECT_EQ(cover(scene_file, folder / "d.gpkg", {"--sensor", "sidescam"}).exit_code, 2);
  EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", "c.gpkg"}));
}

TEST(CoverageRun, IsInTheReferenceSystemOfTheScene) {
  const TestFolder folder;
  const auto extent_of = [&](const std::string& text) {
    EXPECT_EQ(cover(folder.write("scene.toml", text), folder / "c.gpkg", {"--pings", "0"}).exit_code, 0);
    const auto data = opened(folder / "c.gpkg");
    OGREnvelope extent;
    EXPECT_EQ(data->GetLayerByName("coverage")->GetExtent(&extent), OGRERR_NONE);
    const char* code = data->GetLayerByName("coverage")->GetSpatialRef()->GetAuthorityCode(nullptr);
    return std::pair(extent, std::string(code ? code : ""));
  };
  const auto [local, no_code] = extent_of(std::string(covered_scene));
  const std::string projected = replaced(covered_scene, "title = \"Box\"\n",
                                         "title = \"Box\"\n[georeference]\ncrs = \"EPSG:32602\"\n"
                                         "origin_crs = [621930.0, 7245100.0]\n");
  const auto [utm, code] = extent_of(projected);
  EXPECT_EQ(code, "32602");
  EXPECT_NEAR(utm.MinX - local.MinX, 621930, 1e-6);
  EXPECT_NEAR(utm.MaxY - local.MaxY, 7245100, 1e-6);
}

/// Returns (closed, all) of the line "closure  CLOSED of ALL facets" that the command prints.
std::pair<int, int> closure_of(const std::string& output) {
  int closed = -1, all = -1;
  const std::size_t start = output.find("closure");
  if (start != std::string::npos)
    std::sscanf(output.c_str() + start, "closure %d of %d facets", &closed, &all);
  return {closed, all};
}

// Doubles choose the same planes here. With a large tolerance their choice is still a partition.
TEST(CoverageRun, OfWhatDoublesSeeIsAsExact) {
  const TestFolder folder;
  const fs::path file = folder.write("scene.toml", covered_scene);
  ASSERT_EQ(cover(file, folder / "exact.csv").exit_code, 0);
  ASSERT_EQ(cover(file, folder / "double.csv", {"--arithmetic", "double"}).exit_code, 0);
  EXPECT_TRUE(bytes_of(folder / "exact.csv") == bytes_of(folder / "double.csv"));
  const Outcome wrong =
      cover(folder.write("wrong.toml", std::string(covered_scene) +
                                           "[run]\narithmetic = \"double\"\nzero_tolerance = 1e-3\n"),
            folder / "wrong.csv");
  ASSERT_EQ(wrong.exit_code, 0) << wrong.err;
  EXPECT_FALSE(bytes_of(folder / "exact.csv") == bytes_of(folder / "wrong.csv"));
  const auto [closed, all] = closure_of(wrong.out);
  EXPECT_GT(all, 100);
  EXPECT_EQ(closed, all);
}

TEST(CoverageRun, WhatHasNoCoverageIsRefused) {
  const TestFolder folder;
  folder.write("scene.toml", covered_scene);
  for (const char* name : {"c.shp", "c.gpkg.zip", "c.GPKG"}) {
    const Outcome outcome = cover(folder / "scene.toml", folder / name);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(".gpkg, .csv, .vtp or .glb"));
  }
}

TEST(CoverageRun, EarlierFileOutlivesAFailedRun) {
  const TestFolder folder;
  const fs::path scene_file = folder.write("scene.toml", covered_scene);
  for (const char* name : {"c.gpkg", "c.csv"}) {
    folder.write(name, "an earlier file");
    Surroundings full_disk;
    full_disk.largest_file_bytes = 3000;
    const Outcome outcome = cover(scene_file, folder / name, {}, full_disk);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_EQ(bytes_of(folder / name), "an earlier file");
    fs::remove(folder / name);
  }
  EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml"}));
}

TEST(CoverageRun, ASectorThatMeetsNothingGivesEmptyTables) {
  const TestFolder folder;
  const Outcome outcome = cover(
      folder.write("scene.toml", replaced(replaced(covered_scene, "range_max_m = 15", "range_max_m = 2"),
                                          "position_m = [6, 0.3, 0.5]", "position_m = [16, 0.3, 0.5]")),
      folder / "out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("closure        0 of 0 facets"));
  EXPECT_TRUE(fs::exists(folder / "out/coverage.gpkg"));
}

/// Boxes embedded in the sand, cylinders and curved primitives of facets give contacts of all kinds.
TEST(CoverageRun, WellheadCloses) {
  const TestFolder folder;
  const Outcome outcome = cover(fs::path(TUBEFOOT_SOURCE_DIR) / "scenes/wellhead/scene.toml",
                                folder / "c.csv", {"--sensor", "camera"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto [closed, of] = closure_of(outcome.out);
  EXPECT_GT(of, 10000);
  EXPECT_EQ(closed, of);
}

}  // namespace
}  // namespace tubefoot
