// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that convex pieces become valid simple features. GEOS, which GDAL calls, decides whether they are
// valid.
#include "footprints/plan_shape.hpp"

#include <fmt/format.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <set>

#include "fixtures/program.hpp"
#include "geometry/footprints/piece_union.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Pieces and their corners in sequence.
struct Pieces {
  std::vector<glm::dvec3> corners;
  std::vector<Piece> pieces;
  void add(const std::vector<glm::dvec3>& polygon) {
    pieces.push_back(
        {static_cast<std::uint32_t>(corners.size()), static_cast<std::uint32_t>(polygon.size())});
    corners.insert(corners.end(), polygon.begin(), polygon.end());
  }
  void add_box(double west, double south, double east, double north) {
    add({{west, south, 0}, {east, south, 0}, {east, north, 0}, {west, north, 0}});
  }
  std::vector<RingedPolygon> made() const { return united(corners, pieces).value(); }
  PlanShape shape() const { return plan_shape(corners, corners, pieces); }
};

TEST(PieceUnion, OfNeighboursHasNoEdgeBetweenThem) {
  Pieces two;
  two.add_box(0, 0, 1, 1);
  two.add_box(1, 0, 2, 1);
  ASSERT_EQ(two.made().size(), 1u);
  EXPECT_EQ(two.made()[0].size(), 1u);
  EXPECT_EQ(two.made()[0][0].size(), 6u);
  EXPECT_DOUBLE_EQ(two.shape().multi_polygon()->get_Area(), 2);
}

TEST(PieceUnion, KnowsACornerOnAnotherPiecesEdge) {
  Pieces three;
  three.add_box(0, 0, 1, 3);
  three.add_box(1, 0, 2, 1);
  three.add_box(1, 1, 2, 2);
  ASSERT_EQ(three.made().size(), 1u);
  const auto shape = three.shape().multi_polygon();
  EXPECT_TRUE(shape->IsValid());
  EXPECT_DOUBLE_EQ(shape->get_Area(), 5);
}

TEST(PieceUnion, ARingOfPiecesHasAHole) {
  Pieces ring;
  ring.add_box(0, 0, 3, 1);
  ring.add_box(2, 1, 3, 3);
  ring.add_box(0, 2, 2, 3);
  ring.add_box(0, 1, 1, 2);
  ASSERT_EQ(ring.made().size(), 1u);
  ASSERT_EQ(ring.made()[0].size(), 2u);
  EXPECT_DOUBLE_EQ(ring.shape().multi_polygon()->get_Area(), 8);
  EXPECT_TRUE(ring.shape().multi_polygon()->IsValid());
}

// A hole that touches the border in a corner is a hole: the ring must not visit this corner twice.
TEST(PieceUnion, AHoleMayTouchTheBorder) {
  Pieces pieces;
  pieces.add({{0, 0, 0}, {4, 0, 0}, {2, 2, 0}});  // about a hole (0, 0) (2, 2) (1, 3) (0, 2)
  pieces.add({{2, 2, 0}, {4, 0, 0}, {4, 4, 0}});
  pieces.add({{2, 2, 0}, {4, 4, 0}, {1, 3, 0}});
  pieces.add({{1, 3, 0}, {4, 4, 0}, {-1, 4, 0}});
  pieces.add({{0, 2, 0}, {1, 3, 0}, {-1, 4, 0}});
  pieces.add({{0, 0, 0}, {0, 2, 0}, {-1, 4, 0}});
  const auto made = pieces.made();
  ASSERT_EQ(made.size(), 1u);
  ASSERT_EQ(made[0].size(), 2u);
  EXPECT_EQ(made[0][1].size(), 4u);
  EXPECT_TRUE(pieces.shape().multi_polygon()->IsValid());
}

TEST(PieceUnion, WhatTouchesInACornerIsTwoPolygons) {
  Pieces two;
  two.add_box(0, 0, 1, 1);
  two.add_box(1, 1, 2, 2);
  EXPECT_EQ(two.made().size(), 2u);
  EXPECT_TRUE(two.shape().multi_polygon()->IsValid());
}

TEST(PlanShape, OfAWallIsTheLinesRoundIt) {
  Pieces wall;
  wall.add({{0, 0, 0}, {3, 4, 0}, {3, 4, 1}, {0, 0, 1}});
  wall.add({{0, 0, 1}, {3, 4, 1}, {3, 4, 2}});
  const PlanShape shape = wall.shape();
  EXPECT_TRUE(shape.is_upright());
  ASSERT_EQ(shape.outlines.size(), 1u);
  EXPECT_EQ(shape.outlines[0].front(), shape.outlines[0].back());
  EXPECT_TRUE(shape.multi_polygon()->IsEmpty());
  EXPECT_TRUE(shape.multi_line()->IsValid());
}

/// Squares of a board with some removed, each cut into up to three pieces, rotated in space and displaced.
TEST(PlanShape, OfRandomBoardsIsValidWholeAndOfTheirCorners) {
  ASSERT_TRUE(OGRGeometryFactory::haveGEOS());
  constexpr unsigned seed = 20261124;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  for (int run = 0; run < 300; ++run) {
    SCOPED_TRACE(run);
    const double tilt = any(random) * 1.4, turn = any(random) * 6, share = 0.3 + 0.6 * any(random);
    const glm::dvec3 u(std::cos(turn), std::sin(turn), 0),
        v(-std::sin(turn) * std::cos(tilt), std::cos(turn) * std::cos(tilt), std::sin(tilt));
    const auto placed = [&](double x, double y) { return glm::dvec3(100, -3000, -50) + u * x + v * y; };
    Pieces board;
    double area = 0;
    for (int row = 0; row < 8; ++row)
      for (int column = 0; column < 8; ++column) {
        if (any(random) > share) continue;
        area += std::cos(tilt);
        const double x = column, y = row, at = any(random), low = any(random);
        if (any(random) < 0.3) {
          board.add({placed(x, y), placed(x + 1, y), placed(x + 1, y + 1), placed(x, y + 1)});
        } else if (any(random) < 0.5) {  // two pieces: a corner on edges of two adjacent squares
          board.add({placed(x, y), placed(x + low, y), placed(x + at, y + 1), placed(x, y + 1)});
          board.add({placed(x + low, y), placed(x + 1, y), placed(x + 1, y + 1), placed(x + at, y + 1)});
        } else {  // three pieces around an inner point
          const glm::dvec3 middle = placed(x + 0.2 + 0.6 * at, y + 0.2 + 0.6 * low);
          board.add({placed(x, y), placed(x + 1, y), middle});
          board.add({placed(x + 1, y), placed(x + 1, y + 1), middle});
          board.add({placed(x + 1, y + 1), placed(x, y + 1), middle});
          board.add({placed(x, y + 1), placed(x, y), middle});
        }
      }
    if (board.pieces.empty()) continue;
    const PlanShape shape = board.shape();
    const auto polygons = shape.multi_polygon();
    ASSERT_TRUE(polygons->IsValid());
    EXPECT_NEAR(polygons->get_Area(), area, 1e-9);
    std::set<std::pair<double, double>> corners;
    for (const glm::dvec3& corner : board.corners) corners.emplace(corner.x, corner.y);
    for (const auto& rings : shape.polygons)
      for (const PlanShape::Line& ring : rings)
        for (const glm::dvec3& p : ring) ASSERT_TRUE(corners.contains({p.x, p.y}));
  }
}

std::size_t features_of(const fs::path& file, std::size_t& invalid) {
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> data(
      GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (!data) throw std::runtime_error("OGR cannot read " + file.string());
  std::size_t features = 0;
  for (OGRLayer* layer : data->GetLayers())
    for (const auto& feature : *layer) {
      const OGRGeometry* shape = feature->GetGeometryRef();
      if (shape == nullptr) continue;
      ++features;
      if (!shape->IsValid()) ++invalid;
    }
  return features;
}

TEST(PlanShape, EveryFeatureOfTheShippedScenesIsAValidSimpleFeature) {
  ASSERT_TRUE(OGRGeometryFactory::haveGEOS());
  const TestFolder folder;
  const fs::path scenes = fs::path(TUBEFOOT_SOURCE_DIR) / "scenes";
  const auto expect_valid = [&](std::vector<std::string> words, const char* name, std::size_t least) {
    SCOPED_TRACE(name);
    const fs::path file = folder / name;
    words.insert(words.end(), {"-o", file.string(), "--quiet"});
    const Outcome outcome = run_program(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::size_t invalid = 0;
    EXPECT_GE(features_of(file, invalid), least);
    EXPECT_EQ(invalid, 0u);
  };
  const std::string well = (scenes / "wellhead/scene.toml").string(),
                    wrecks = (scenes / "survey/wrecks.toml").string();
  for (const char* name : {"well.gpkg", "well.geojson", "well.csv"})
    expect_valid({"footprints", well, "--sensor", "camera", "--pings", "0"}, name, 10000);
  expect_valid({"coverage", well, "--sensor", "camera"}, "coverage.gpkg", 20000);
  expect_valid({"footprints", wrecks, "--sensor", "multibeam", "--pings", "90:94"}, "wrecks.gpkg", 5000);
}

// Northings of 5 400 000 m have a resolution of a nanometre. Thin shapes that rounding folds over are
// repaired.
TEST(PlanShape, ValidInAProjectedSystemToo) {
  const TestFolder folder;
  const fs::path scene =
      folder.write("utm.toml", bytes_of(fs::path(TUBEFOOT_SOURCE_DIR) / "scenes/crosstalk/scene.toml") +
                                   "[georeference]\ncrs = \"EPSG:32632\"\norigin_crs = [431000, 5400000]\n");
  const fs::path file = folder / "ball.gpkg";
  const Outcome outcome =
      run_program({"footprints", scene.string(), "--sensor", "ideal", "-o", file.string(), "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::size_t invalid = 0;
  EXPECT_GT(features_of(file, invalid), 300u);
  EXPECT_EQ(invalid, 0u);
}

}  // namespace
}  // namespace tubefoot
