// SPDX-License-Identifier: GPL-3.0-or-later
// Tests material maps: areas and positions of materials against the map itself, for any facets of the
// terrain, and rejected maps.

#include "scene/surfaces/material_map.hpp"

#include <fmt/format.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "fixtures/processor_time.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "geometry/search/vertical_line.hpp"
#include "geometry/visibility/closure.hpp"
#include "scene/meshes/mesh_file.hpp"
#include "scene/scene.hpp"

// Compares areas and positions with the map itself, for any facets of the terrain.
namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// A seabed of 20 m x 30 m about the origin. The table of the map begins in line 11, its keys in 12.
std::string scene_with(const std::string& map) {
  return fmt::format(R"([[materials]]
name = "sand"
[[materials]]
name = "mud"
[[materials]]
name = "gravel"
[[terrain]]
material = "sand"
width_m = 20
length_m = 30
[terrain.material_map]
{}
[trajectory]
kind = "fixed"
position_m = [0, 0, 3]
[[sensors]]
name = "camera"
kind = "didson"
)",
                     map);
}

enum Material : std::uint16_t { sand, mud, gravel };

class MaterialMaps : public testing::Test {
 protected:
  Scene load(const std::string& map, const std::string& terrain = "kind = \"flat\"") const {
    return load_scene(
        read_scene(folder_, replaced(scene_with(map), "[[terrain]]\n", "[[terrain]]\n" + terrain + "\n")));
  }
  std::string error_of(const std::string& map) const {
    try {
      load(map);
    } catch (const InputError& error) {
      std::string message = error.what();
      const std::string prefix = folder_.path().string() + "/";
      for (std::size_t at; (at = message.find(prefix)) != std::string::npos;)
        message.erase(at, prefix.size());
      return message;
    }
    return {};
  }
  /// Local polygons: lists of corners as in WKT, with a name each.
  std::string polygons(const std::vector<std::pair<std::string, std::string>>& rings,
                       const std::string& more = "") const {
    std::string features;
    for (const auto& [name, coordinates] : rings)
      features += fmt::format(R"({}{{"type":"Feature","properties":{{"material":"{}"}},)"
                              R"("geometry":{{"type":"Polygon","coordinates":[{}]}}}})",
                              features.empty() ? "" : ",", name, coordinates);
    folder_.write("areas.geojson", R"({"type":"FeatureCollection","features":[)" + features + "]}");
    return "kind = \"polygons\"\nfile = \"areas.geojson\"\ncoordinates = \"local\"\n" + more;
  }
  /// An ASCII grid of 2 m cells over the whole seabed, 10 x 15 of them by default.
  std::string raster(const std::vector<int>& classes, const std::string& named, int columns = 10,
                     int rows = 15, double cell = 2, double x = -10, double y = -15) const {
    std::string text =
        fmt::format("ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value -9\n", columns,
                    rows, x, y, cell);
    for (std::size_t i = 0; i < classes.size(); ++i) text += fmt::format("{} ", classes[i]);
    folder_.write("classes.asc", text + "\n");
    return "kind = \"raster\"\nfile = \"classes.asc\"\nclasses = " + named + "\n";
  }

  TestFolder folder_;
};

/// Areas in plan view, by material.
std::vector<double> plan_areas(const Scene& scene) {
  std::vector<double> areas(scene.description.materials.size());
  for (std::size_t f = 0; f < scene.mesh.facets.size(); ++f) {
    const auto& [a, b, c] = scene.mesh.facets[f];
    const glm::dvec3 p = scene.grid.to_metres(scene.mesh.vertices[a]),
                     u = scene.grid.to_metres(scene.mesh.vertices[b]) - p,
                     v = scene.grid.to_metres(scene.mesh.vertices[c]) - p;
    areas[scene.mesh.material[f]] += (u.x * v.y - u.y * v.x) / 2;
  }
  return areas;
}

/// Material of the facet straight below or above a position. The vertical line must meet the mesh once.
std::uint16_t material_below(const Scene& scene, const SceneTree& tree, double x, double y) {
  const GridPoint p = scene.grid.snap({x, y, 0});
  std::vector<FacetId> near;
  facets_near_vertical(tree, p, near);
  std::vector<FacetId> met;
  for (const FacetId f : near)
    if (vertical_side(scene.mesh, f, p) != 0) met.push_back(f);
  EXPECT_EQ(met.size(), 1u) << "at " << x << ", " << y;
  return met.empty() ? std::uint16_t{0xffff} : scene.mesh.material[met.front()];
}

/// A half-edge mesh accepts each facet with three corners. From within the seabed no tube finds water
/// between facets.
void expect_closed(const Scene& scene) {
  // A border that almost follows an edge leaves slivers, whose corners may coincide on the grid.
  const auto slivers = std::ranges::count_if(
      scene.mesh.facets, [](const auto& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  EXPECT_EQ(facets_outside_halfedge(scene.mesh, 0, static_cast<FacetId>(scene.mesh.facets.size())),
            static_cast<std::size_t>(slivers));
  const SceneTree tree(scene.mesh);
  TubeSet tubes;
  tubes.apex = scene.grid.snap({0.3, -0.7, 2});
  tubes.reach = 1e12;
  for (int j = 0; j <= 6; ++j)  // straight down, less than 5 m to each side
    for (int i = 0; i <= 6; ++i) tubes.rays.push_back({(i - 3) * 220001, (j - 3) * 210011, -(1 << 18)});
  for (std::uint32_t j = 0; j < 6; ++j)
    for (std::uint32_t i = 0; i < 6; ++i)
      tubes.tubes.push_back({j * 7 + i, (j + 1) * 7 + i, (j + 1) * 7 + i + 1, j * 7 + i + 1});
  VisibilityScratch scratch;
  TubeVisibility seen;
  VisibilityOptions options;
  options.open_water = true;
  for (std::uint32_t t = 0; t < tubes.tubes.size(); ++t) {
    see(scene.mesh, tree, tubes, t, options, scratch, seen);
    EXPECT_TRUE(seen.open.empty());
    EXPECT_FALSE(seen.pieces.empty());
    EXPECT_TRUE(audit(scene.mesh, tubes, t, seen, t).closes);
  }
}

const std::string hills = "kind = \"fractal\"\ncell_m = 1.7\nrms_height_m = 0.3";
constexpr double unit_area = 1e-4;  // 30 m borders moved by half a micrometre, many times over

TEST_F(MaterialMaps, PolygonsGiveTheirAreas) {
  // A square with a hole, a triangle over its corner, and a polygon that lies half beyond the seabed.
  const std::string map =
      polygons({{"mud", "[[-8,-8],[2,-8],[2,2],[-8,2],[-8,-8]],[[-6,-6],[-5,-6],[-5,-3],[-6,-3],[-6,-6]]"},
                {"gravel", "[[0,0],[4.5,0],[0,6.5],[0,0]]"},
                {"gravel", "[[6,-9],[14,-9],[14,-1],[6,-1],[6,-9]]"}});
  // The part x <= 2, y <= 2 of the triangle lies over the square: 2 x 2, all of it below the slope.
  const double triangle = 4.5 * 6.5 / 2, square = 100 - 3;
  for (const std::string& terrain : {std::string("kind = \"flat\""), hills}) {
    const Scene scene = load(map, terrain);
    const std::vector<double> areas = plan_areas(scene);
    EXPECT_NEAR(areas[mud], square - 4, unit_area);
    EXPECT_NEAR(areas[gravel], triangle + 4 * 8, unit_area);
    EXPECT_NEAR(areas[sand], 600 - (square - 4) - triangle - 32, unit_area);
    EXPECT_GT(scene.report.components[0].cut_facets, 0u);
    EXPECT_GT(scene.report.components[0].facets, scene.report.components[0].facets_in_file);
    expect_closed(scene);
  }
  const std::vector<double> first = plan_areas(load(map + "overlaps = \"first\"\n", hills));
  EXPECT_NEAR(first[mud], square, unit_area);
  EXPECT_NEAR(first[gravel], triangle - 4 + 32, unit_area);
}

TEST_F(MaterialMaps, RandomPolygonsLieWhereTheyAreDrawn) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> anywhere(-13, 13), radius(1, 6);
  struct Disc {
    double x, y, r;
    int corners;
  };
  std::vector<Disc> discs(12);
  std::vector<std::pair<std::string, std::string>> rings;
  for (std::size_t k = 0; k < discs.size(); ++k) {
    Disc& d = discs[k] = {anywhere(random), anywhere(random), radius(random), 3 + static_cast<int>(k)};
    std::string ring;
    for (int c = 0; c <= d.corners; ++c) {
      const double turn = 2 * std::numbers::pi * (c % d.corners) / d.corners;
      ring += fmt::format("{}[{:.12f},{:.12f}]", c > 0 ? "," : "", d.x + d.r * std::cos(turn),
                          d.y + d.r * std::sin(turn));
    }
    rings.emplace_back(k % 3 == 0 ? "sand" : k % 3 == 1 ? "mud" : "gravel", "[" + ring + "]");
  }
  const Scene scene = load(polygons(rings), hills);
  expect_closed(scene);
  const SceneTree tree(scene.mesh);
  std::uniform_real_distribution<double> x(-9.99, 9.99), y(-14.99, 14.99);
  std::size_t tried = 0;
  for (int k = 0; k < 4000; ++k) {
    const double px = x(random), py = y(random);
    std::uint16_t expected = sand;
    bool clear = true;
    for (std::size_t d = 0; d < discs.size(); ++d) {
      // A regular polygon in polar coordinates about its middle.
      const double away = std::hypot(px - discs[d].x, py - discs[d].y),
                   part = 2 * std::numbers::pi / discs[d].corners;
      double turn =
          std::fmod(std::atan2(py - discs[d].y, px - discs[d].x) + 4 * std::numbers::pi, part) - part / 2;
      const double edge = discs[d].r * std::cos(part / 2) / std::cos(turn);
      if (away < edge) expected = static_cast<std::uint16_t>(d % 3);
      clear = clear && std::abs(away - edge) > 1e-5;
    }
    if (!clear) continue;
    ++tried;
    EXPECT_EQ(material_below(scene, tree, px, py), expected) << px << ", " << py;
  }
  EXPECT_GT(tried, 3900u);
}

TEST_F(MaterialMaps, RasterCellsLieWhereTheyAre) {
  std::mt19937_64 random(5);
  std::vector<int> classes(150);
  for (int& c : classes) c = std::array{-9, 1, 2, 7}[random() % 4];
  const std::string map = raster(classes, "{ 1 = \"mud\", 2 = \"gravel\", 7 = \"sand\" }");
  const auto expected = [&](double x, double y) -> std::uint16_t {
    const int c =
        classes[static_cast<std::size_t>((15 - y) / 2) * 10 + static_cast<std::size_t>((x + 10) / 2)];
    return c == 1 ? mud : c == 2 ? gravel : sand;
  };
  for (const std::string& terrain : {std::string("kind = \"flat\""), hills}) {
    const Scene scene = load(map, terrain);
    expect_closed(scene);
    const SceneTree tree(scene.mesh);
    std::uniform_real_distribution<double> x(-9.99, 9.99), y(-14.99, 14.99);
    for (int k = 0; k < 2000; ++k) {
      const double px = x(random), py = y(random);
      if (std::abs(std::remainder(px, 2)) < 1e-5 || std::abs(std::remainder(py + 1, 2)) < 1e-5) continue;
      EXPECT_EQ(material_below(scene, tree, px, py), expected(px, py)) << px << ", " << py;
    }
    const std::vector<double> areas = plan_areas(scene);
    EXPECT_NEAR(areas[mud], 4.0 * static_cast<double>(std::ranges::count(classes, 1)), unit_area);
    EXPECT_NEAR(areas[gravel], 4.0 * static_cast<double>(std::ranges::count(classes, 2)), unit_area);
  }
}

// Long straight borders are one piece, so that they give few facets. Borders beyond the seabed cut nothing.
TEST_F(MaterialMaps, StraightBordersOfCellsAreMerged) {
  std::vector<int> halves(150, 1);
  for (std::size_t i = 0; i < halves.size(); ++i)
    if (i % 10 >= 4) halves[i] = 7;
  const std::string map = raster(halves, "{ 1 = \"mud\", 7 = \"sand\" }");
  const Scene scene = load(map);
  // x = -2 through two facets: a triangle and a quadrilateral each
  EXPECT_EQ(scene.mesh.facets.size(), 6u);
  EXPECT_NEAR(plan_areas(scene)[mud], 8 * 30, 1e-9);
  // The scene file places the same map: the western half of the seabed lies under the eastern columns of
  // the raster.
  EXPECT_NEAR(plan_areas(load(map + "origin_m = [-18, -200]\ncell_m = 25\n"))[mud], 600, 1e-9);
  EXPECT_NEAR(plan_areas(load(map + "origin_m = [-110, -200]\ncell_m = 25\n"))[mud], 0, 1e-9);
}

TEST_F(MaterialMaps, MapsLargerSmallerAndElsewhere) {
  EXPECT_EQ(
      plan_areas(load(polygons({{"mud", "[[-900,-900],[900,-900],[900,900],[-900,900],[-900,-900]]"}})))[mud],
      600);
  const Scene elsewhere = load(polygons({{"mud", "[[40,0],[50,0],[50,9],[40,0]]"}}));
  EXPECT_EQ(plan_areas(elsewhere)[sand], 600);
  EXPECT_EQ(elsewhere.mesh.facets.size(), 2u);
  // A polygon along the outline of the seabed, and the same polygon twice.
  const std::string same = "[[-10,-15],[10,-15],[10,15],[-10,15],[-10,-15]]";
  const Scene outline = load(polygons({{"mud", same}, {"gravel", same}}));
  EXPECT_EQ(plan_areas(outline)[gravel], 600);
  EXPECT_EQ(outline.mesh.facets.size(), 2u);
}

const std::string patches =
    "kind = \"patches\"\npatch_size_m = 1.1\nshares = { mud = 2, gravel = 1, sand = 1 }\n";

TEST_F(MaterialMaps, PatchesKeepTheirSharesAndTheirSeed) {
  const Scene scene = load(patches, hills);
  expect_closed(scene);
  const std::vector<double> areas = plan_areas(scene);
  EXPECT_NEAR(std::accumulate(areas.begin(), areas.end(), 0.0), 600, unit_area);
  // 496 patches: a share of one half has an error of about 0.025, and patches differ in size.
  EXPECT_NEAR(areas[mud] / 600, 0.5, 0.1);
  EXPECT_NEAR(areas[gravel] / 600, 0.25, 0.1);
  EXPECT_NEAR(areas[sand] / 600, 0.25, 0.1);

  EXPECT_EQ(load(patches, hills).mesh.material, scene.mesh.material);
  EXPECT_NE(plan_areas(load(patches + "seed = 2\n", hills)), areas);
  // Patches depend on position alone. A larger terrain with other facets has the same patches, and so has
  // one of two facets.
  const Scene larger = load_scene(read_scene(
      folder_, replaced(replaced(scene_with(patches), "width_m = 20", "kind = \"flat\"\nwidth_m = 33"),
                        "length_m = 30", "length_m = 31")));
  const SceneTree tree(scene.mesh), larger_tree(larger.mesh);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> x(-9.99, 9.99), y(-14.99, 14.99);
  int differ = 0;
  for (int k = 0; k < 2000; ++k) {
    const double px = x(random), py = y(random);
    differ += material_below(scene, tree, px, py) != material_below(larger, larger_tree, px, py);
  }
  EXPECT_LE(differ, 1);  // within a micrometre of a border
}

TEST_F(MaterialMaps, CarriesPolygonsIntoTheFrame) {
  // A square of 8 m in UTM on a frame tangent to the Earth near by, and in degrees on a frame in UTM.
  GDALAllRegister();
  const LocalFrame utm = LocalFrame::projected("EPSG:32630", 432000, 5372000, 0, {});
  for (const bool tangent : {true, false}) {
    const std::string name = tangent ? "a.gpkg" : "b.gpkg";
    std::vector<glm::dvec3> corners{{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
    glm::dvec3 origin(0);
    utm.to_lon_lat({&origin, 1}, {});
    if (tangent) {
      LocalFrame::at_lat_lon(origin.y, origin.x, 0).to_lon_lat(corners, {});
    } else {
      for (glm::dvec3& p : corners) p += glm::dvec3(432000, 5372000, 0);
    }
    {
      const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName("GPKG")->Create(
          (folder_.path() / name).c_str(), 0, 0, 0, GDT_Unknown, nullptr));
      OGRSpatialReference crs;
      crs.SetFromUserInput(tangent ? "EPSG:4326" : "EPSG:32630");
      crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      OGRLayer* layer = out->CreateLayer("areas", &crs, wkbPolygon, nullptr);
      OGRFieldDefn field("bottom", OFTInteger);
      ASSERT_EQ(layer->CreateField(&field), OGRERR_NONE);
      OGRFeature feature(layer->GetLayerDefn());
      feature.SetField("bottom", 3);
      OGRLinearRing ring;
      for (std::size_t k = 0; k <= 4; ++k) ring.addPoint(corners[k % 4].x, corners[k % 4].y);
      OGRPolygon polygon;
      polygon.addRing(&ring);
      feature.SetGeometry(&polygon);
      ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
    }
    const std::string map = fmt::format(
        "kind = \"polygons\"\nfile = \"{}\"\nattribute = \"bottom\"\nclasses = {{ 3 = \"mud\" }}\n", name);
    EXPECT_THAT(error_of(map), HasSubstr("frame is not georeferenced"));
    const std::string frame =
        tangent ? fmt::format("origin_lat_lon_deg = [{:.12f}, {:.12f}]\n", origin.y, origin.x)
                : "crs = \"EPSG:32630\"\norigin_crs = [432000, 5372000]\n";
    const Scene scene = load_scene(read_scene(
        folder_, "[georeference]\n" + frame +
                     replaced(scene_with(map), "[[terrain]]\n", "[[terrain]]\nkind = \"flat\"\n")));
    EXPECT_NEAR(plan_areas(scene)[mud], 64, tangent ? 1e-4 : 1e-6);
    const SceneTree tree(scene.mesh);
    EXPECT_EQ(material_below(scene, tree, 3.9999, -3.9999), mud);
    EXPECT_EQ(material_below(scene, tree, 4.0001, 0), sand);
    EXPECT_EQ(material_below(scene, tree, 0, 4.0001), sand);
  }
}

// Cells of UTM in a frame tangent to the Earth are neither square nor straight, but have their correct
// positions.
TEST_F(MaterialMaps, CarriesRastersIntoTheFrame) {
  GDALAllRegister();
  const LocalFrame utm = LocalFrame::projected("EPSG:32630", 300000, 5372000, 0, {});
  {
    const GDALDatasetUniquePtr out(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        (folder_.path() / "classes.tif").c_str(), 4, 4, 1, GDT_Byte, nullptr));
    std::array<double, 6> corner{300000 - 8, 4, 0, 5372000 + 8, 0, -4};
    out->SetGeoTransform(corner.data());
    OGRSpatialReference crs;
    crs.SetFromUserInput("EPSG:32630");
    out->SetSpatialRef(&crs);
    std::array<unsigned char, 16> classes{1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0};
    ASSERT_EQ(
        out->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 4, 4, classes.data(), 4, 4, GDT_Byte, 0, 0, nullptr),
        CE_None);
  }
  glm::dvec3 origin(0), corner(3.999, -3.999, 0), beyond(4.001, -2, 0);
  for (glm::dvec3* p : {&origin, &corner, &beyond}) utm.to_lon_lat({p, 1}, {});
  const LocalFrame tangent = LocalFrame::at_lat_lon(origin.y, origin.x, 0);
  corner = tangent.from_lat_lon(corner.y, corner.x, 0, {});
  beyond = tangent.from_lat_lon(beyond.y, beyond.x, 0, {});
  EXPECT_GT(std::abs(corner.x - 3.999), 0.05) << "grid north is not north here";
  const std::string map =
      "kind = \"raster\"\nfile = \"classes.tif\"\nclasses = { 0 = \"sand\", 1 = \"mud\", 2 = \"gravel\" }\n";
  const Scene scene = load_scene(read_scene(
      folder_, fmt::format("[georeference]\norigin_lat_lon_deg = [{:.12f}, {:.12f}]\n", origin.y, origin.x) +
                   replaced(scene_with(map), "[[terrain]]\n", "[[terrain]]\nkind = \"flat\"\n")));
  EXPECT_NEAR(plan_areas(scene)[mud], 64, 0.1);  // the scale of the projection is within 0.05 % of one
  EXPECT_NEAR(plan_areas(scene)[gravel], 16, 0.03);
  const SceneTree tree(scene.mesh);
  EXPECT_EQ(material_below(scene, tree, corner.x, corner.y), gravel);
  EXPECT_EQ(material_below(scene, tree, beyond.x, beyond.y), sand);
  expect_closed(scene);
  EXPECT_THAT(error_of(map), HasSubstr("frame is not georeferenced"));
}

TEST_F(MaterialMaps, MistakesAreNamed) {
  EXPECT_THAT(
      error_of("kind = \"patches\"\npatch_size_m = 2\nshares = { mudd = 1 }"),
      StartsWith("scene.toml:15:12: no entry of [[materials]] is named \"mudd\": did you mean \"mud\"?"));
  EXPECT_THAT(
      error_of("kind = \"patches\"\npatch_size_m = 1e-4\nshares = { mud = 1 }"),
      AllOf(StartsWith("scene.toml:12:1: patches of 0.0001 m"), HasSubstr("increase 'patch_size_m'")));
  const std::vector<int> classes{1, 2, 3, 12};
  EXPECT_THAT(
      error_of(raster(classes, "{ 1 = \"mud\", 3 = \"graval\" }", 2, 2)),
      StartsWith(
          "scene.toml:15:28: no entry of [[materials]] is named \"graval\": did you mean \"gravel\"?"));
  EXPECT_THAT(
      error_of(raster(classes, "{ 1 = \"mud\", 3 = \"gravel\" }", 2, 2)),
      AllOf(StartsWith("scene.toml:12:1: classes.asc: "), HasSubstr("classes without a material: 2, 12;")));
  EXPECT_THAT(error_of(raster(classes, "{ 1.5 = \"mud\" }", 2, 2)), StartsWith("scene.toml:15:"));
  EXPECT_THAT(error_of(raster(classes, "{ x = \"mud\" }", 2, 2)),
              AllOf(StartsWith("scene.toml:15:17: "), HasSubstr("whole numbers")));
  EXPECT_THAT(error_of(raster(classes, "{ 1 = \"mud\", 01 = \"sand\" }", 2, 2)),
              HasSubstr("already has a material"));
  EXPECT_THAT(error_of(raster(classes, "{ 1 = \"mud\" }\ncell_m = 2", 2, 2)), HasSubstr("add 'origin_m'"));

  const std::string ring = "[[0,0],[1,0],[0,1],[0,0]]";
  EXPECT_THAT(error_of(polygons({{"mudd", ring}})),
              StartsWith("scene.toml:12:1: areas.geojson: feature 0: there is no material named \"mudd\": "
                         "did you mean \"mud\"?"));
  EXPECT_THAT(error_of(polygons({{"mud", ring}}, "attribute = \"materials\"\n")),
              HasSubstr("no attribute \"materials\": did you mean \"material\"?"));
  EXPECT_THAT(error_of(polygons({{"mud", ring}}, "layer = \"area\"\n")),
              HasSubstr("has no layer \"area\": expected \"areas\""));
  EXPECT_THAT(error_of(polygons({{"a", ring}, {"b", ring}}, "classes = { a = \"mud\" }\n")),
              HasSubstr("without a material: \"b\""));
  EXPECT_THAT(error_of(polygons({{"mud", "[[0,0],[1e300,0],[0,1],[0,0]]"}})),
              HasSubstr("is too far from this scene"));
  const std::string map = polygons({{"mud", ring}});
  folder_.write("areas.geojson", R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":)"
                                 R"({"material":"mud"},"geometry":{"type":"Point","coordinates":[1,2]}}]})");
  EXPECT_THAT(error_of(map), HasSubstr("feature 0: is a POINT, expected a polygon"));
  for (const char* bytes : {"", "{", "PK\3\4", "{\"type\":\"FeatureCollection\",\"features\":[{\"type\""}) {
    folder_.write("areas.geojson", bytes);
    EXPECT_THAT(error_of(map), StartsWith("scene.toml:12:1: areas.geojson: ")) << bytes;
    folder_.write("classes.asc", bytes);
    EXPECT_THAT(error_of("kind = \"raster\"\nfile = \"classes.asc\"\nclasses = { 1 = \"mud\" }"),
                StartsWith("scene.toml:12:1: classes.asc: "))
        << bytes;
  }
}

// Each of these maps is small. An earlier version of the program took minutes for it.
TEST_F(MaterialMaps, PolygonsThatOverlapManyTimesAreRefusedInTime) {
  std::mt19937 random(20261127);
  std::uniform_real_distribution<double> x(-10, 10), y(-15, 15);
  std::vector<std::pair<std::string, std::string>> rings;
  for (int k = 0; k < 400; ++k) {
    std::string ring = "[";  // a star of random corners about a random point
    const double east = x(random), north = y(random);
    std::string first;
    for (int i = 0; i <= 40; ++i) {
      const double angle = 2 * std::numbers::pi * i / 40, radius = i % 2 == 0 ? 9 : 3;
      const std::string corner =
          fmt::format("[{},{}]", east + radius * std::cos(angle), north + radius * std::sin(angle));
      if (i == 0) first = corner;
      ring += (i == 0 ? "" : ",") + (i == 40 ? first : corner);
    }
    rings.emplace_back(k % 2 == 0 ? "mud" : "gravel", ring + "]");
  }
  const std::string map = polygons(rings);
  std::string error;
  EXPECT_LT(processor_seconds([&] { error = error_of(map); }), hostile_input_s);
  EXPECT_THAT(error, AllOf(StartsWith("scene.toml:12:1: "), HasSubstr("cross each other more than"),
                           HasSubstr("dissolve")));
}

TEST_F(MaterialMaps, ACombOfFiveThousandPointsIsCutInTime) {
  std::string ring = "[[-9,-14]";
  constexpr int teeth = 1250;
  for (int k = 0; k < teeth; ++k) {
    const double left = -9 + 18.0 * k / teeth, right = left + 9.0 / teeth;
    ring += fmt::format(",[{0},-13],[{0},13],[{1},13],[{1},-13]", left, right);
  }
  const std::string map = polygons({{"mud", ring + ",[9,-14],[-9,-14]]"}});
  EXPECT_LT(processor_seconds([&] { EXPECT_NEAR(plan_areas(load(map))[mud], 18 * 1 + 9 * 26, 0.1); }),
            hostile_input_s);
}

TEST_F(MaterialMaps, ThousandsOfAttributesAreRefusedInTime) {
  const auto feature = [](const std::string& properties) {
    return R"({"type":"Feature","properties":{"material":"mud")" + properties +
           R"(},"geometry":{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,0]]]}})";
  };
  const auto told = [&](const std::string& features) {
    const std::string map = polygons({{"mud", "[[0,0],[4,0],[4,4],[0,0]]"}});
    folder_.write("areas.geojson", "{\"type\":\"FeatureCollection\",\n\"features\":[" + features + "]}");
    std::string error;
    EXPECT_LT(processor_seconds([&] { error = error_of(map); }), hostile_input_s);
    return error;
  };
  std::string many, some;
  for (int k = 0; k < 50'000; ++k) many += fmt::format(",\"a{}\":{}", k, k);
  for (int k = 0; k < 900; ++k) some += fmt::format(",\"a{}\":{}", k, k);
  EXPECT_EQ(told(feature(some) + "," + feature(some)), "");
  EXPECT_THAT(told(feature(many)),
              AllOf(HasSubstr("areas.geojson:2: has more than 1000 attributes"), HasSubstr("-select")));
  EXPECT_THAT(told("/* \" */" + feature(many)), HasSubstr("more than 1000 attributes"));
  // Fewer attributes, but each feature has them in another order.
  std::mt19937 random(1);
  std::vector<int> order(300);
  std::iota(order.begin(), order.end(), 0);
  std::string features;
  for (int k = 0; k < 300; ++k) {
    std::shuffle(order.begin(), order.end(), random);
    std::string properties;
    for (const int i : order) properties += fmt::format(",\"a{}\":{}", i, i);
    features += (k > 0 ? "," : "") + feature(properties);
  }
  EXPECT_THAT(told(features), HasSubstr("lists its attributes in too many different orders"));
}

TEST_F(MaterialMaps, ManyClasses) {
  std::string materials = "[[materials]]\nname = \"sand\"\n", named;
  std::vector<int> classes(150);
  for (int k = 0; k < 150; ++k) {
    materials += fmt::format("[[materials]]\nname = \"m{}\"\n", k);
    named += fmt::format("{}{} = \"m{}\"", k > 0 ? ", " : "", k, k);
    classes[static_cast<std::size_t>(k)] = k;
  }
  std::string text = scene_with(raster(classes, "{ " + named + " }"));
  text = materials + text.substr(text.find("[[terrain]]"));
  const Scene scene =
      load_scene(read_scene(folder_, replaced(text, "[[terrain]]\n", "[[terrain]]\nkind = \"flat\"\n")));
  const std::vector<double> areas = plan_areas(scene);
  EXPECT_NEAR(areas[0], 0, 1e-9);
  for (std::size_t m = 1; m < areas.size(); ++m) EXPECT_NEAR(areas[m], 4, 1e-6);
  expect_closed(scene);
}

}  // namespace
}  // namespace tubefoot
