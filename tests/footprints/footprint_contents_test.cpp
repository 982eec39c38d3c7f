// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the columns of `tubefoot footprints`. Energies are compared with the echoes of a run. Occluders and
// areas are compared with projections onto a flat seabed. Selections of pings and beams, and rejected
// options, are tested, too.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <sstream>

#include "fixtures/footprint_rows.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A flat or rough seabed with a box under a sensor with the given keys. All ranges lie in the range gate.
std::string box_scene(const std::string& sensor_keys, const std::string& more = {}) {
  return "[water]\nabsorption_db_per_km = 300\n" + lambert_material("sand", -27) +
         lambert_material("steel", -5) +
         rough_terrain(30, 40, 1, "name = \"bed\"\nmaterial = \"sand\"\nrms_height_m = 0.05\n") +
         box_ahead(4) + more + R"(
[[sensors]]
name = "camera"
kind = "didson"
pings = 2
tilt_deg = 30
beams = 6
horizontal_deg = 12
window_start_m = 1
window_length_m = 20
samples = 64
)" + sensor_keys +
         "\n";
}

/// The same in stratified water.
std::string in_layers(const std::string& scene) {
  return replaced(scene, "absorption_db_per_km = 300",
                  "absorption_db_per_km = 300\nprofile = \"gradient\"\nsound_speed_m_s = 1500\n"
                  "gradient_per_s = 0.5\nprofile_bottom_m = 30\nsurface_height_m = 10");
}

struct EnergyCase {
  const char *name, *sensor, *more;
  double tolerance;
  bool by_beam;
};

class FootprintEnergies : public testing::TestWithParam<EnergyCase> {};

INSTANTIATE_TEST_SUITE_P(
    Sensors, FootprintEnergies,
    testing::Values(
        EnergyCase{"Ideal", "", "", 1e-12, true},
        EnergyCase{"Centroids", "", "[run]\nbinning = \"centroid\"\n", 1e-12, true},
        EnergyCase{"Spread", "", "[run]\nbinning = \"spread\"\n", 1e-12, true},
        EnergyCase{"PartOfTheWindow", "window_start_m = 4.3\nwindow_length_m = 0.7\n", "", 1e-12, true},
        EnergyCase{"Texture", "",
                   "[[materials.reflectivity]]\nkind = \"perlin\"\nwavelength_m = 0.4\ndepth = 0.9\n", 1e-5,
                   true},
        EnergyCase{"Refraction", "", "", 1e-12, true}, EnergyCase{"Shots", "cycles = 3\n", "", 1e-12, true},
        EnergyCase{"Patterns",
                   "transmit_pattern = \"gaussian\"\ntransmit_beam_width_deg = 14\n"
                   "receive_pattern = \"gaussian\"\nreceive_beam_width_deg = 2\n",
                   "", 1e-5, false},
        EnergyCase{"ReceiverApart", "receiver_arm_m = [0.05, 0, 0.1]\n", "", 1e-8, true},
        EnergyCase{"RefractionReceiverApart", "receiver_arm_m = [0.05, 0, 0.1]\n", "", 1e-8, true}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_P(FootprintEnergies, SumToTheEchoes) {
  const auto [name, sensor, more, tolerance, by_beam] = GetParam();
  std::string scene = box_scene(sensor, more);
  if (std::string(name).starts_with("Refraction")) scene = in_layers(scene);
  if (std::string(sensor).starts_with("window")) {  // in place of the values of the scene
    scene = replaced(scene, "window_start_m = 1\n", "");
    scene = replaced(scene, "window_length_m = 20\n", "");
  }
  const TestFolder folder;
  const Echoes echoes = echoes_in(folder, scene, {}, "camera");
  const Rows rows = rows_of(footprints(folder, scene, "camera", "camera.csv", {"--pings", ":"}));
  ASSERT_GT(echoes.total(), 0);
  EXPECT_NEAR(rows.sum("energy_j"), echoes.total(), tolerance * echoes.total());
  EXPECT_EQ(rows.values("path_order"), std::set<double>{1});
  std::map<std::pair<double, double>, double> own, all;
  for (const Row& row : rows.rows) {
    EXPECT_LE(row.at("own_beam_energy_j"), row.at("energy_j") * (1 + 1e-12));
    own[{row.at("ping"), row.at("beam")}] += row.at("own_beam_energy_j");
    all[{row.at("ping"), row.at("beam")}] += row.at("energy_j");
  }
  ASSERT_EQ(own.size(), 12u);
  for (const auto& [place, energy] : own) {
    const double received = echoes.beam_total(std::size_t(place.first), std::size_t(place.second));
    if (by_beam) {
      EXPECT_NEAR(energy, received, tolerance * echoes.total());
      EXPECT_EQ(energy, all[place]);
    } else {
      EXPECT_GT(energy, 0);
      EXPECT_LE(energy, received * (1 + 1e-5)) << "others add to what a beam receives of its own tubes";
    }
  }
}

TEST(FootprintChoice, OfBeamsLeavesTheOthersOutAndChangesNothing) {
  const TestFolder folder;
  const std::string scene = box_scene("");
  const Rows all = rows_of(footprints(folder, scene, "camera", "all.csv"));
  const Rows some = rows_of(footprints(folder, scene, "camera", "some.csv", {"--beams", "4:,1,0:1"}));
  EXPECT_EQ(some.values("beam"), (std::set<double>{0, 1, 4, 5}));
  std::vector<Row> expected;
  for (const Row& row : all.rows)
    if (row.at("beam") != 2 && row.at("beam") != 3) expected.push_back(row);
  EXPECT_EQ(some.rows, expected);
  EXPECT_EQ(rows_of(footprints(folder, scene, "camera", "one.csv", {"--beams", "3", "--pings", "1"}))
                .values("ping"),
            std::set<double>{1});
}

TEST(FootprintChoice, ThatCannotBeIsRefused) {
  const TestFolder folder;
  const std::string scene = folder.write("scene.toml", box_scene("")).string();
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"footprints", scene, "-o", (folder / "out.csv").string()};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml"}));
    return outcome.err;
  };
  for (const char* beams : {"1,", "a", "1:2:3", "-1"}) {
    SCOPED_TRACE(beams);
    EXPECT_THAT(refused({"--sensor", "camera", "--beams=" + std::string(beams)}),
                HasSubstr(fmt::format("--beams '{}': expected beams as N, A:B", beams)));
  }
  for (const char* beams : {"0:6", "4:2"})
    EXPECT_THAT(refused({"--sensor", "camera", "--beams", beams}), HasSubstr("the sensor has beams 0 to 5"));
  EXPECT_THAT(refused({"--sensor", "camera", "--pings", "2"}), HasSubstr("the sensor has pings 0 to 1"));
  EXPECT_THAT(refused({"--sensor", "camera", "--sensor", "other"}), HasSubstr("--sensor"));
  EXPECT_THAT(refused({"--sensor", "camera", "-o", (folder / "a.txt").string(), "--rationals",
                       (folder / "b.txt").string()}),
              HasSubstr("-o"));
}

TEST(FootprintChoice, LeavesOutWhatFootprintsAreNot) {
  const TestFolder folder;
  const auto outcome_of = [&](const std::string& scene, const char* file) {
    return run_program({"footprints", folder.write("scene.toml", scene).string(), "--sensor", "camera", "-o",
                        (folder / file).string()});
  };
  const std::string mirrors = "[sea_surface]\nheight_m = 10\nloss_db = 1\n[paths]\norder = 2\n";
  const Outcome mirrored = outcome_of(box_scene("", mirrors), "camera.txt");
  EXPECT_EQ(mirrored.exit_code, 0) << mirrored.err;
  EXPECT_THAT(mirrored.err, HasSubstr("exact corners are written only for paths of order 1"));
  const Outcome twice = outcome_of(box_scene("", mirrors + "scatterings = 2\npatch_m = 2\n"), "camera.csv");
  EXPECT_EQ(twice.exit_code, 0) << twice.err;
  EXPECT_THAT(twice.err, HasSubstr("footprints contain single scattering only"));
}

// A seabed in z = 0 (facets 0, 1) under a plate in z = 1 (facets 2, 3), from 5 m. Similar triangles give
// the sections of tubes and facets on the plane of the seabed.
constexpr std::string_view two_plates = R"(v -20 -20 0
v 20 -20 0
v 20 20 0
v -20 20 0
v -0.7 -0.45 1
v 0.8 -0.55 1
v 0.65 0.6 1
v -0.75 0.5 1
f 1 2 3
f 1 3 4
f 5 6 7
f 5 7 8
)";
constexpr std::string_view plates_scene = R"([[materials]]
name = "sand"
[[objects]]
name = "plates"
shape = "mesh"
file = "plates.obj"
[trajectory]
kind = "fixed"
position_m = [0, 0, 5]
[[sensors]]
name = "down"
kind = "didson"
beams = 9
horizontal_deg = 40
vertical_deg = 30
tilt_deg = 90
window_start_m = 1
window_length_m = 10
)";
constexpr double apex_up_m = 5;

using Polygon = std::vector<glm::dvec2>;

double signed_area(const Polygon& p) {
  double twice = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const glm::dvec2 a = p[k], b = p[(k + 1) % p.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

/// Convex polygons of either orientation.
Polygon intersection(Polygon a, Polygon b) {
  if (signed_area(b) < 0) std::reverse(b.begin(), b.end());
  for (std::size_t k = 0; k < b.size() && !a.empty(); ++k) {
    const glm::dvec2 from = b[k], along = b[(k + 1) % b.size()] - from;
    const auto height = [&](glm::dvec2 p) { return along.x * (p.y - from.y) - along.y * (p.x - from.x); };
    Polygon kept;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const glm::dvec2 p = a[i], q = a[(i + 1) % a.size()];
      const double hp = height(p), hq = height(q);
      if (hp >= 0) kept.push_back(p);
      if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) kept.push_back(p + hp / (hp - hq) * (q - p));
    }
    a = kept;
  }
  return a;
}

double common_area(const Polygon& a, const Polygon& b) { return std::abs(signed_area(intersection(a, b))); }

/// By number: the quadrangle of the tube on the plane z = 0, from the rays in a file of exact corners.
std::map<int, Polygon> tubes_on_the_seabed(const fs::path& exact) {
  std::map<int, Polygon> tubes;
  std::istringstream lines(bytes_of(exact));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    int number = 0, beam = 0;
    words >> kind;
    if (kind != "tube") continue;
    double skipped = 0;
    words >> number >> beam >> skipped >> skipped >> skipped;
    for (glm::dvec3 ray; words >> ray.x >> ray.y >> ray.z;)
      tubes[number].push_back(glm::dvec2(ray) * (apex_up_m / -ray.z));
  }
  return tubes;
}

TEST(FootprintsOfTwoPlates, HaveTheAreasAndTheOccludersOfTheirProjections) {
  const TestFolder folder;
  folder.write("plates.obj", two_plates);
  const fs::path exact = folder / "exact.txt";
  const Rows rows = rows_of(
      footprints(folder, std::string(plates_scene), "down", "down.gpkg", {"--rationals", exact.string()}));
  const std::map<int, Polygon> tubes = tubes_on_the_seabed(exact);
  const auto projected = [](std::vector<glm::dvec3> corners) {
    Polygon p;
    for (const glm::dvec3& c : corners) p.push_back(glm::dvec2(c) * (apex_up_m / (apex_up_m - c.z)));
    return p;
  };
  const glm::dvec3 a(-0.7, -0.45, 1), b(0.8, -0.55, 1), c(0.65, 0.6, 1), d(-0.75, 0.5, 1);
  const std::array<Polygon, 4> facets{projected({{-20, -20, 0}, {20, -20, 0}, {20, 20, 0}}),
                                      projected({{-20, -20, 0}, {20, 20, 0}, {-20, 20, 0}}),
                                      projected({a, b, c}), projected({a, c, d})};
  const double to_plate = (apex_up_m - 1) / apex_up_m;  // lengths on the plate over those on the seabed
  constexpr double nothing_m2 = 1e-9;                   // the grid moves corners by half a micrometre
  std::size_t expected_rows = 0, hidden = 0, free = 0;
  for (const auto& [number, tube] : tubes)
    for (const Polygon& facet : facets) {
      double seen = common_area(tube, facet);
      if (&facet < &facets[2])
        for (const Polygon& plate : {facets[2], facets[3]})
          seen -= common_area(intersection(tube, facet), plate);
      expected_rows += seen > nothing_m2;
    }
  EXPECT_EQ(rows.rows.size(), expected_rows);
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    const Row& row = rows.rows[k];
    SCOPED_TRACE(fmt::format("tube {} facet {}", row.at("tube"), row.at("facet")));
    const Polygon& tube = tubes.at(int(row.at("tube")));
    const auto facet = std::size_t(row.at("facet"));
    const Polygon held = intersection(tube, facets[facet]);
    double area = std::abs(signed_area(held));
    std::string occluders;
    if (facet < 2)
      for (const std::size_t plate : {2u, 3u}) {
        const double taken = common_area(held, facets[plate]);
        area -= taken;
        if (taken > nothing_m2) occluders += fmt::format("{}{}", occluders.empty() ? "" : " ", plate);
      }
    else
      area *= to_plate * to_plate;
    EXPECT_NEAR(row.at("area_m2"), area, 1e-5);
    EXPECT_EQ(rows.occluders[k], occluders);
    hidden += !occluders.empty();
    free += occluders.empty();
  }
  EXPECT_GT(hidden, 20u);
  EXPECT_GT(free, 20u);
}

TEST(FootprintsOfTwoPlates, LieInTheDirectionsTheyLieIn) {
  const TestFolder folder;
  folder.write("plates.obj", two_plates);
  for (const Row& row : rows_of(footprints(folder, std::string(plates_scene), "down", "down.csv")).rows) {
    const double east = row.at("centroid_east_m"), north = row.at("centroid_north_m"),
                 depth = apex_up_m - row.at("centroid_up_m");
    EXPECT_GE(row.at("azimuth_deg"), 0);
    EXPECT_LT(row.at("azimuth_deg"), 360);
    const double azimuth = row.at("azimuth_deg") * std::numbers::pi / 180, across = std::hypot(east, north);
    EXPECT_NEAR(across * std::sin(azimuth), east, 1e-9);
    EXPECT_NEAR(across * std::cos(azimuth), north, 1e-9);
    EXPECT_NEAR(row.at("grazing_deg") * std::numbers::pi / 180, std::atan2(depth, across), 1e-9);
  }
}

TEST(FootprintFileBytes, DependOnNeitherThreadsNorTime) {
  const TestFolder folder;
  const std::string scene = box_scene("");
  for (const char* ending : {".gpkg", ".geojson", ".csv", ".vtp", ".obj", ".ply", ".nc", ".txt"}) {
    SCOPED_TRACE(ending);
    const auto bytes = [&](const char* threads) {
      return bytes_of(footprints(folder, scene, "camera", std::string("camera") + ending,
                                 {"--pings", ":", "--threads", threads}));
    };
    const std::string one = bytes("1");
    EXPECT_GT(one.size(), 1000u);
    EXPECT_TRUE(one == bytes("3"));  // a failure message with all bytes would be too long
  }
}

TEST(FootprintFileBytes, OfNothingSeenAreAFileAllTheSame) {
  const TestFolder folder;
  const std::string scene = replaced(box_scene(""), "tilt_deg = 30", "tilt_deg = -60");
  for (const char* ending : {".gpkg", ".geojson", ".csv", ".vtp", ".obj", ".ply", ".nc", ".txt"}) {
    SCOPED_TRACE(ending);
    EXPECT_GT(bytes_of(footprints(folder, scene, "camera", std::string("camera") + ending)).size(), 50u);
  }
  EXPECT_TRUE(rows_of(folder / "camera.gpkg").rows.empty());
  EXPECT_TRUE(rows_of(folder / "camera.geojson").rows.empty());
}

TEST(FootprintFileBytes, OfALateFailureAreTakenAway) {
  const TestFolder folder;
  const auto scene = folder.write("scene.toml", box_scene(""));
  for (const char* ending : {".vtp", ".obj", ".ply", ".nc", ".txt"}) {
    SCOPED_TRACE(ending);
    Surroundings full_disk;
    full_disk.largest_file_bytes = 9000;
    const Outcome outcome = run_program({"footprints", scene.string(), "--sensor", "camera", "--pings", ":",
                                         "-o", (folder / ("camera" + std::string(ending))).string()},
                                        full_disk);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("camera"));
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml"}));
  }
}

TEST(FootprintFileBytes, OfAnInterruptedCommandAreTakenAway) {
  const TestFolder folder;
  const auto scene = folder.write(
      "scene.toml", replaced(replaced(box_scene(""), "pings = 2", "pings = 400\nping_interval_s = 0.002"),
                             "cell_m = 1", "cell_m = 0.2"));
  for (const char* ending : {".gpkg", ".vtp", ".nc"}) {
    SCOPED_TRACE(ending);
    Surroundings impatient;
    impatient.interrupt_when = [&] {
      for (const std::string& name : names_below(folder.path()))
        if (name.starts_with(".camera") && name.ends_with(ending)) return true;
      return false;
    };
    const Outcome outcome = run_program({"footprints", scene.string(), "--sensor", "camera", "--pings", ":",
                                         "-o", (folder / ("camera" + std::string(ending))).string()},
                                        impatient);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("interrupted"));
    EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml"}));
  }
}

TEST(FootprintMeshes, AreReadBackByTheSceneLoaders) {
  const TestFolder folder;
  const std::string scene = box_scene("");
  const double area = rows_of(footprints(folder, scene, "camera", "camera.csv")).sum("area_m2");
  for (const char* name : {"camera.obj", "camera.ply"}) {
    SCOPED_TRACE(name);
    const ComponentMesh mesh = read_mesh_file(footprints(folder, scene, "camera", name));
    double read = 0;
    for (const auto& f : mesh.triangles)
      read += glm::length(glm::cross(mesh.points_m[f[1]] - mesh.points_m[f[0]],
                                     mesh.points_m[f[2]] - mesh.points_m[f[0]])) /
              2;
    EXPECT_NEAR(read, area, 1e-9 * area);
    for (const auto& f : mesh.triangles) {  // visible from the sensor, or edge-on to rounding
      const glm::dvec3 p = mesh.points_m[f[0]],
                       n = glm::cross(mesh.points_m[f[1]] - p, mesh.points_m[f[2]] - p);
      EXPECT_GT(glm::dot(n, glm::dvec3(0, 0, 2.5) - p), -1e-12);
    }
  }
}

TEST(GeoreferencedFootprints, LieWhereTheSceneDoes) {
  const TestFolder folder;
  const double east = 431000, north = 5400000;
  const std::string place =
      "[georeference]\ncrs = \"EPSG:32632\"\norigin_crs = [431000, 5400000]\norigin_height_m = -20\n";
  const std::string scene = place + box_scene("");
  const Rows rows = rows_of(footprints(folder, scene, "camera", "camera.csv"));
  GDALAllRegister();
  const auto open = [&](const char* name) {
    return std::unique_ptr<GDALDataset>(GDALDataset::Open(footprints(folder, scene, "camera", name).c_str(),
                                                          GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr,
                                                          nullptr));
  };
  const auto map = open("camera.gpkg"), globe = open("camera.geojson");
  ASSERT_TRUE(map && globe);
  OGRSpatialReference utm, lat_lon;
  ASSERT_EQ(utm.importFromEPSG(32632), OGRERR_NONE);
  ASSERT_EQ(lat_lon.importFromEPSG(4326), OGRERR_NONE);
  for (OGRSpatialReference* crs : {&utm, &lat_lon}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  EXPECT_TRUE(map->GetLayer(0)->GetSpatialRef()->IsSame(&utm));
  EXPECT_THAT(map->GetLayer(0)->GetMetadataItem("DESCRIPTION"), HasSubstr("CRS of the scene"));
  const std::unique_ptr<OGRCoordinateTransformation> to_utm(
      OGRCreateCoordinateTransformation(&lat_lon, &utm));
  std::map<GIntBig, OGREnvelope3D> uprights;  // of features without plan area
  for (const auto& feature : *map->GetLayerByName("upright"))
    feature->GetGeometryRef()->getEnvelope(&uprights[feature->GetFieldAsInteger64("footprint")]);
  EXPECT_FALSE(uprights.empty());
  std::size_t row = 0;
  for (const auto& feature : *map->GetLayer(0)) {
    OGREnvelope3D box, degrees;
    feature->GetGeometryRef()->getEnvelope(&box);
    if (feature->GetGeometryRef()->IsEmpty()) box = uprights.at(feature->GetFID());
    const Row& r = rows.rows.at(row++);
    EXPECT_GE(east + r.at("centroid_east_m"), box.MinX - 1e-6);
    EXPECT_LE(east + r.at("centroid_east_m"), box.MaxX + 1e-6);
    EXPECT_GE(north + r.at("centroid_north_m"), box.MinY - 1e-6);
    EXPECT_LE(north + r.at("centroid_north_m"), box.MaxY + 1e-6);
    EXPECT_GE(r.at("centroid_up_m") - 20, box.MinZ - 1e-6);
    EXPECT_LE(r.at("centroid_up_m") - 20, box.MaxZ + 1e-6);
    const std::unique_ptr<OGRFeature> other(globe->GetLayer(0)->GetNextFeature());
    ASSERT_TRUE(other);
    ASSERT_EQ(other->GetGeometryRef()->transform(to_utm.get()), OGRERR_NONE);
    other->GetGeometryRef()->getEnvelope(&degrees);
    EXPECT_NEAR(degrees.MinX, box.MinX, 1e-4);
    EXPECT_NEAR(degrees.MaxY, box.MaxY, 1e-4);
    EXPECT_NEAR(degrees.MinZ, box.MinZ, 1e-9);
  }
  EXPECT_EQ(row, rows.rows.size());
}

}  // namespace
}  // namespace tubefoot
