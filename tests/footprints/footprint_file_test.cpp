// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the files of `tubefoot footprints`: OGR reads them, and polygons, areas and angles agree with each
// other and with the sector of the sensor.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <sstream>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Two pings of a camera whose whole sector meets the seabed, with a box in the sector.
const std::string scene =
    lambert_material("sand", -27) + lambert_material("steel", -27) +
    rough_terrain(40, 60, 0.5, "name = \"bed\"\nmaterial = \"sand\"\nrms_height_m = 0.05\n") + box_ahead(4) +
    R"([[sensors]]
name = "camera"
kind = "didson"
pings = 2
tilt_deg = 30
beams = 12
window_start_m = 1
window_length_m = 20
)";

struct FileRow {
  GIntBig ping, beam, tube, facet, pieces;
  std::string component, material, occluders;
  double area_m2, solid_angle_sr, grazing_deg, near_m, far_m;
  glm::dvec3 centroid_m;
  double polygon_area_m2;  ///< of the geometry itself
  double nearest_corner_m, farthest_corner_m;
};

/// Area vector of a ring in space, by Newell's formula about its first point.
glm::dvec3 area_of(const OGRSimpleCurve& ring) {
  const auto corner = [&](int k) { return glm::dvec3(ring.getX(k), ring.getY(k), ring.getZ(k)); };
  glm::dvec3 sum(0);
  for (int k = 1; k + 1 < ring.getNumPoints(); ++k)
    sum += glm::cross(corner(k) - corner(0), corner(k + 1) - corner(0)) * 0.5;
  return sum;
}

std::vector<FileRow> read_footprints(const fs::path& file, const glm::dvec3& apex) {
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> data(
      GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (!data) throw std::runtime_error("OGR cannot read " + file.string());
  OGRLayer* layer = data->GetLayer(0);
  std::map<GIntBig, std::unique_ptr<OGRMultiLineString>> uprights;
  if (OGRLayer* upright = data->GetLayerByName("upright"))
    for (const auto& feature : *upright)
      uprights[feature->GetFieldAsInteger64("footprint")].reset(
          feature->GetGeometryRef()->toMultiLineString()->clone());
  std::vector<FileRow> rows;
  for (const auto& feature : *layer) {
    const auto number = [&](const char* name) { return feature->GetFieldAsDouble(name); };
    FileRow row{feature->GetFieldAsInteger64("ping"),
                feature->GetFieldAsInteger64("beam"),
                feature->GetFieldAsInteger64("tube"),
                feature->GetFieldAsInteger64("facet"),
                feature->GetFieldAsInteger64("pieces"),
                feature->GetFieldAsString("component"),
                feature->GetFieldAsString("material"),
                feature->GetFieldAsString("occluders"),
                number("area_m2"),
                number("solid_angle_sr"),
                number("grazing_deg"),
                number("slant_range_min_m"),
                number("slant_range_max_m"),
                {number("centroid_east_m"), number("centroid_north_m"), number("centroid_up_m")},
                0,
                1e9,
                0};
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr) throw std::runtime_error("a footprint without geometry");
    EXPECT_TRUE(geometry->IsValid());
    glm::dvec3 area(0);
    const auto add = [&](const OGRSimpleCurve& ring) {
      EXPECT_TRUE(ring.get_IsClosed());
      area += area_of(ring);  // holes have the opposite orientation
      for (int k = 0; k < ring.getNumPoints(); ++k) {
        const double range = glm::distance(apex, glm::dvec3(ring.getX(k), ring.getY(k), ring.getZ(k)));
        row.nearest_corner_m = std::min(row.nearest_corner_m, range);
        row.farthest_corner_m = std::max(row.farthest_corner_m, range);
      }
    };
    const auto add_lines = [&](const OGRMultiLineString& lines) {
      for (const OGRLineString* line : lines) add(*line);
    };
    if (wkbFlatten(geometry->getGeometryType()) == wkbMultiLineString) {
      add_lines(*geometry->toMultiLineString());
    } else if (!geometry->IsEmpty()) {
      for (const OGRPolygon* polygon : *geometry->toMultiPolygon())
        for (const OGRLinearRing* ring : *polygon) add(*ring);
    } else {  // a GeoPackage stores them in a separate layer
      const auto lines = uprights.find(feature->GetFID());
      if (lines == uprights.end()) throw std::runtime_error("a footprint without shape");
      add_lines(*lines->second);
    }
    row.polygon_area_m2 = glm::length(area);
    rows.push_back(row);
  }
  return rows;
}

struct FootprintFiles : testing::TestWithParam<const char*> {
  TestFolder folder;
  fs::path scene_file = folder.write("scene.toml", scene);
  fs::path file = folder / ("camera" + std::string(GetParam()));

  Outcome write(const std::vector<std::string>& more = {}, const Surroundings& surroundings = {}) const {
    std::vector<std::string> words{"footprints", scene_file.string(), "--sensor", "camera",
                                   "-o",         file.string(),       "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, surroundings);
  }
};

INSTANTIATE_TEST_SUITE_P(Formats, FootprintFiles, testing::Values(".gpkg", ".geojson", ".csv"),
                         [](const auto& format) { return std::string(format.param + 1); });

TEST_P(FootprintFiles, AreReadBackWholeAndConsistent) {
  const Outcome outcome = write();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("wrote " + file.string()));
  EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", file.filename().string()}));

  const std::vector<FileRow> rows = read_footprints(file, {0, 0, 2.5});
  ASSERT_GT(rows.size(), 100u);
  EXPECT_THAT(outcome.out, HasSubstr(fmt::format("({} footprints)", rows.size())));
  double solid_angle = 0;
  std::set<std::string> components;
  std::set<GIntBig> beams;
  std::size_t cut = 0;
  for (const FileRow& row : rows) {
    SCOPED_TRACE(fmt::format("tube {} facet {}", row.tube, row.facet));
    EXPECT_EQ(row.ping, 0);
    beams.insert(row.beam);
    components.insert(row.component);
    EXPECT_EQ(row.material, row.component == "box" ? "steel" : "sand");
    EXPECT_GT(row.area_m2, 0);
    EXPECT_NEAR(row.polygon_area_m2, row.area_m2, 1e-9 + 1e-6 * row.area_m2);
    EXPECT_GT(row.grazing_deg, 0);
    EXPECT_LE(row.grazing_deg, 90);
    EXPECT_LE(row.near_m, row.nearest_corner_m + 1e-9);  // may lie inside
    EXPECT_NEAR(row.far_m, row.farthest_corner_m, 1e-9);
    const double range = glm::distance(row.centroid_m, glm::dvec3(0, 0, 2.5));
    EXPECT_GE(range, row.near_m - 1e-9);
    EXPECT_LE(range, row.far_m + 1e-9);
    // The solid angle of a facet is its foreshortened area over range squared: between the extremes of its
    // ranges.
    EXPECT_LE(row.solid_angle_sr, row.area_m2 / (row.near_m * row.near_m));
    EXPECT_GT(row.solid_angle_sr, 0);
    cut += row.occluders.empty() ? 0 : 1;
    solid_angle += row.solid_angle_sr;
  }
  EXPECT_EQ(components, (std::set<std::string>{"bed", "box"}));
  EXPECT_EQ(beams.size(), 12u);
  EXPECT_EQ(*beams.rbegin(), 11);
  EXPECT_GT(cut, 0u) << "the box hides something";
  // The seabed fills the sector of 29 x 14 degrees in azimuth and elevation. The tubes replace its walls of
  // constant elevation by planes, at most 1e-4 outwards.
  const double sector = 29 * std::numbers::pi / 180 * 2 * std::sin(7 * std::numbers::pi / 180);
  EXPECT_GE(solid_angle, sector * (1 - 1e-8));
  EXPECT_LE(solid_angle, sector * (1 + 1e-4));
}

TEST_P(FootprintFiles, HoldThePingsRequested) {
  const auto pings_with = [&](const std::vector<std::string>& more) {
    const Outcome outcome = write(more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    std::set<GIntBig> pings;
    for (const FileRow& row : read_footprints(file, {0, 0, 0})) pings.insert(row.ping);
    return pings;
  };
  EXPECT_EQ(pings_with({"--pings", "0:1"}), (std::set<GIntBig>{0, 1}));
  EXPECT_EQ(pings_with({"--pings", "1"}), (std::set<GIntBig>{1}));
}

TEST_P(FootprintFiles, EarlierFileOutlivesAFailedRun) {
  const std::string earlier = "an earlier file, of whatever kind";
  folder.write(file.filename().string(), earlier);
  const auto expect_untouched = [&] {
    EXPECT_TRUE(bytes_of(file) == earlier);  // a failure message with all bytes would be too long
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", file.filename().string()}));
  };
  EXPECT_EQ(write({"--pings", "2"}).exit_code, 2);
  expect_untouched();
  for (const std::size_t bytes : {0u, 20000u, 120000u}) {
    SCOPED_TRACE(bytes);
    Surroundings full_disk;
    full_disk.largest_file_bytes = bytes;
    const Outcome outcome = write({"--pings", "0:1"}, full_disk);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(file.filename().string()));
    expect_untouched();
  }
  EXPECT_EQ(write().exit_code, 0);
  EXPECT_NE(bytes_of(file), earlier);
}

TEST(Footprints, OfAGeoPackageAreMetresOfALocalFrameNotDegrees) {
  const TestFolder folder;
  const fs::path file = folder / "camera.gpkg";
  ASSERT_EQ(run_program({"footprints", folder.write("scene.toml", scene).string(), "--sensor", "camera", "-o",
                         file.string(), "--quiet"})
                .exit_code,
            0);
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> data(
      GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  ASSERT_TRUE(data);
  const OGRSpatialReference* frame = data->GetLayer(0)->GetSpatialRef();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->IsLocal());
  EXPECT_FALSE(frame->IsGeographic());
}

TEST(Footprints, OfAnUnknownKindAreRefused) {
  const TestFolder folder;
  const auto scene_file = folder.write("scene.toml", scene);
  for (const char* name : {"camera.shp", "camera", "camera.gpkg.zip", "camera.GPK"}) {
    SCOPED_TRACE(name);
    const Outcome outcome = run_program(
        {"footprints", scene_file.string(), "--sensor", "camera", "-o", (folder / name).string()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(name));
    EXPECT_THAT(outcome.err, HasSubstr(".gpkg, .geojson, .csv, .vtp, .obj, .ply, .nc or .txt"));
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml"}));
  }
}

TEST(Footprints, IntoAFolderOrAMissingFolderAreRefused) {
  const TestFolder folder;
  const auto scene_file = folder.write("scene.toml", scene);
  const auto exit_code = [&](const fs::path& output) {
    return run_program({"footprints", scene_file.string(), "--sensor", "camera", "-o", output.string()})
        .exit_code;
  };
  fs::create_directory(folder / "folder.csv");
  EXPECT_EQ(exit_code(folder / "folder.csv"), 2);
  EXPECT_NE(exit_code(folder / "missing/camera.csv"), 0);
  EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", "folder.csv"}));
}

}  // namespace
}  // namespace tubefoot
