// SPDX-License-Identifier: GPL-3.0-or-later
// Tests sidescan mosaics: positions of targets, weights by area, gaps between lines, map coordinates, and
// sums of cells.

#include "sensors/detection/sidescan_mosaic.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <tuple>
#include <utility>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kAltitude = 6, kStep = 0.05;
constexpr int kSamples = 1000;
const SourcePlace mosaic_place{"scene.toml"};

Pose heading_at(double east, double north, double heading_deg) {
  return {{east, north, -20}, attitude_from_angles(heading_deg * degree, 0, 0)};
}

/// Adds pings in sequence, so that each has the previous and the next ping on its line.
class SidescanMosaic {
 public:
  explicit SidescanMosaic(double cell_m, std::size_t most_bytes = CellMeans::default_most_bytes)
      : cells_(cell_m, most_bytes) {}

  void add(const SidescanPing& ping) {
    sums_on_map(ping, nullptr, nullptr, cells_.cell_m());  // rejects it now
    if (last_) lay_out(&ping.pose);
    last_ = Kept{ping, {ping.port.begin(), ping.port.end()}, {ping.starboard.begin(), ping.starboard.end()}};
  }
  void end_line() {
    if (last_) lay_out(nullptr);
    last_.reset(), before_.reset();
  }
  const CellMeans& cells() {
    end_line();
    return cells_;
  }
  void write_tiff(const std::filesystem::path& file, const LocalFrame& frame, const char* unit) {
    write_cells(file, cells(), frame, "Backscatter", unit);
  }

 private:
  struct Kept {
    SidescanPing ping;
    std::vector<float> port, starboard;
  };
  void lay_out(const Pose* after) {
    const Kept kept = *std::exchange(last_, std::nullopt);
    SidescanPing ping = kept.ping;
    ping.port = kept.port;
    ping.starboard = kept.starboard;
    cells_.add(sums_on_map(ping, before_ ? &*before_ : nullptr, after, cells_.cell_m()));
    before_ = ping.pose;
  }

  CellMeans cells_;
  std::optional<Kept> last_;
  std::optional<Pose> before_;
};

/// Pings over a flat seabed with one bright target. Each ping receives the target at its slant range, on
/// its side, when it is abeam. The result is the position of the target.
class Survey {
 public:
  Survey(SidescanMosaic& mosaic, glm::dvec2 target) : mosaic_(mosaic), target_(target) {}

  void ping(double east, double north, double heading_deg, double half_beam_m = 0.26) {
    std::vector<float> port(kSamples, 1.f), starboard(kSamples, 1.f);
    const double h = heading_deg * degree;
    const glm::dvec2 to = target_ - glm::dvec2(east, north);
    const double ahead = to.x * std::sin(h) + to.y * std::cos(h),
                 abeam = to.x * std::cos(h) - to.y * std::sin(h);
    if (std::abs(ahead) < half_beam_m) {
      const auto k = static_cast<std::size_t>(std::hypot(abeam, kAltitude) / kStep);
      if (k < kSamples) (abeam < 0 ? port : starboard)[k] = 100;
    }
    mosaic_.add({heading_at(east, north, heading_deg), kAltitude, 0, kStep, port, starboard});
  }

 private:
  SidescanMosaic& mosaic_;
  glm::dvec2 target_;
};

/// Middle of the cells above the level of the seabed, weighted by the excess.
glm::dvec2 bright_place(const CellMeans& cells) {
  glm::dvec2 sum(0);
  double weight = 0;
  const auto& e = cells.extent();
  for (auto row = e.south; row < e.north; ++row)
    for (auto column = e.west; column < e.east; ++column) {
      const double over = cells.mean(column, row) - 1;
      if (!(over > 1e-6)) continue;
      sum += over * glm::dvec2(double(column) + 0.5, double(row) + 0.5) * cells.cell_m();
      weight += over;
    }
  EXPECT_GT(weight, 0) << "no target";
  return sum / weight;
}

void expect_at(const CellMeans& cells, glm::dvec2 target) {
  const glm::dvec2 found = bright_place(cells);
  // A range bin at 20 m is 5 cm long on the seabed, a cell is 10 cm, and pings are 50 cm apart.
  EXPECT_NEAR(found.x, target.x, 0.15);
  EXPECT_NEAR(found.y, target.y, 0.15);
}

TEST(SidescanMosaic, ATargetToPortAheadLiesNorthWestOfABowToTheNorth) {
  SidescanMosaic mosaic(0.1);
  Survey survey(mosaic, {-18.02, 12});
  for (int k = 0; k <= 40; ++k) survey.ping(0, 0.5 * k, 0);
  expect_at(mosaic.cells(), {-18.02, 12});
}

TEST(SidescanMosaic, ATargetToStarboardAsternLiesNorthWestOfABowToTheSouthEast) {
  SidescanMosaic mosaic(0.1);
  // Heading 135 degrees, starboard is south-west: 7 m astern of the end, 15 m to starboard.
  const double c = std::sqrt(0.5);
  const glm::dvec2 end(20 * c, -20 * c), target = end + glm::dvec2(-7 * c - 15 * c, 7 * c - 15 * c);
  Survey survey(mosaic, target);
  for (int k = 0; k <= 40; ++k) survey.ping(0.5 * k * c, -0.5 * k * c, 135);
  expect_at(mosaic.cells(), target);
}

TEST(SidescanMosaic, ATurnKeepsTheTargetInPlace) {
  SidescanMosaic mosaic(0.1);
  // Around (30, 0) at a radius of 30 m, clockwise from north. The centre stays to starboard, abeam. The
  // target thus lies outside the turn, on the radius of 60 degrees.
  const double at = 60 * degree;
  const glm::dvec2 target = glm::dvec2(30, 0) + 44.0 * glm::dvec2(-std::cos(at), std::sin(at));
  Survey survey(mosaic, target);
  for (int k = 0; k <= 90; ++k) {
    const double turned = k * degree;
    survey.ping(30 - 30 * std::cos(turned), 30 * std::sin(turned), k, 0.4);
  }
  expect_at(mosaic.cells(), target);
}

TEST(SidescanMosaic, KeepsValuesAndLeavesNoHoles) {
  SidescanMosaic mosaic(0.25);
  const std::vector<float> level(kSamples, 3.7f);
  for (int k = 0; k <= 20; ++k) mosaic.add({heading_at(0, 1.3 * k, 0), kAltitude, 0, kStep, level, level});
  const double far = std::sqrt(std::pow(kSamples * kStep, 2) - kAltitude * kAltitude);
  const CellMeans& cells = mosaic.cells();
  int filled = 0;
  for (std::int64_t row = 0; row < 26 * 4; ++row)
    for (std::int64_t column = -std::int64_t(far * 4); column < std::int64_t(far * 4); ++column, ++filled)
      ASSERT_FLOAT_EQ(float(cells.mean(column, row)), 3.7f) << column << ", " << row;
  EXPECT_GT(filled, 40000);
  EXPECT_TRUE(std::isnan(cells.mean(std::int64_t(far * 4) + 2, 10))) << "beyond the last sample";
  EXPECT_TRUE(std::isnan(cells.mean(0, -3))) << "before the line";
}

// The value of a cell that two pings share is their mean by area. Range bins before the altitude are water.
TEST(SidescanMosaic, WeighsByAreaAndLeavesOutTheWater) {
  SidescanMosaic mosaic(10);
  const auto line = [&](double north, float value) {
    std::vector<float> samples(400, value);                        // 0 to 20 m: seabed up to 19.08 m
    for (int k = 0; k < 120; ++k) samples[std::size_t(k)] = 1e6f;  // up to 6 m
    mosaic.add({heading_at(0, north, 0), kAltitude, 0, kStep, samples, samples});
  };
  line(0.001, 2);
  line(4, 8);  // 2 extends to 2.0005, 8 from there
  line(10, 8);
  EXPECT_NEAR(mosaic.cells().mean(0, 0), 0.2 * 2 + 0.8 * 8, 0.01);
  EXPECT_NEAR(mosaic.cells().mean(-1, 0), 0.2 * 2 + 0.8 * 8, 0.01);
}

TEST(SidescanMosaic, FillsNothingBetweenLines) {
  SidescanMosaic mosaic(1);
  const std::vector<float> level(kSamples, 1.f);
  mosaic.add({heading_at(0, 0.5, 0), kAltitude, 0, kStep, level, level});
  mosaic.end_line();
  mosaic.add({heading_at(0, 20.5, 0), kAltitude, 0, kStep, level, level});
  EXPECT_TRUE(std::isnan(mosaic.cells().mean(5, 10)));
  EXPECT_EQ(mosaic.cells().mean(5, 0), 1);
  EXPECT_EQ(mosaic.cells().mean(-5, 20), 1);
}

struct Raster {
  GDALDatasetUniquePtr data;
  std::array<double, 6> transform{};
  explicit Raster(const std::filesystem::path& file) {
    GDALAllRegister();
    data.reset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
    if (!data || data->GetGeoTransform(transform.data()) != CE_None) throw std::logic_error("no raster");
  }
  float at(double x, double y) {
    float value = 0;
    EXPECT_EQ(data->GetRasterBand(1)->RasterIO(GF_Read, int(std::floor((x - transform[0]) / transform[1])),
                                               int(std::floor((y - transform[3]) / transform[5])), 1, 1,
                                               &value, 1, 1, GDT_Float32, 0, 0),
              CE_None);
    return value;
  }
};

TEST(SidescanMosaic, TheRasterLiesOnTheMap) {
  const TestFolder folder;
  SidescanMosaic mosaic(0.5);
  Survey survey(mosaic, {-18.1, 12.1});
  for (int k = 0; k <= 80; ++k) survey.ping(0, 0.25 * k, 0, 0.6);

  mosaic.write_tiff(folder / "utm.tif",
                    LocalFrame::projected("EPSG:32602", 621860, 7245027, -50, mosaic_place), "dB");
  Raster utm(folder / "utm.tif");
  EXPECT_STREQ(utm.data->GetSpatialRef()->GetAuthorityCode(nullptr), "32602");
  EXPECT_GT(utm.at(621860 - 18.1, 7245027 + 12.1), 10);
  EXPECT_EQ(utm.at(621860 + 18.1, 7245027 + 12.1), 1) << "port is not starboard";
  EXPECT_EQ(utm.data->GetRasterBand(1)->GetNoDataValue(), no_data);
  EXPECT_EQ(utm.data->GetRasterBand(1)->GetRasterDataType(), GDT_Float32);
  EXPECT_STREQ(utm.data->GetRasterBand(1)->GetDescription(), "Backscatter");

  mosaic.write_tiff(folder / "local.tif", LocalFrame(), "dB");
  Raster local(folder / "local.tif");
  EXPECT_EQ(local.data->GetSpatialRef(), nullptr);
  EXPECT_GT(local.at(-18.1, 12.1), 10);

  // The tangent frame finds the target again from the coordinates that GDAL alone reads in the raster of
  // this frame.
  const LocalFrame tangent = LocalFrame::at_lat_lon(48.3, -4.5, 0);
  mosaic.write_tiff(folder / "tangent.tif", tangent, "dB");
  Raster geo(folder / "tangent.tif");
  EXPECT_GT(geo.at(-18.1, 12.1), 10);
  OGRSpatialReference crs(*geo.data->GetSpatialRef()), wgs84;
  EXPECT_STREQ(crs.GetName(), "Tangent plane at 48.3, -4.5 (WGS 84)") << "as programs list it";
  wgs84.importFromEPSG(4326);
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> step(OGRCreateCoordinateTransformation(&crs, &wgs84));
  double x = -18.1, y = 12.1;
  ASSERT_TRUE(step->Transform(1, &x, &y));
  const glm::dvec3 there = tangent.from_lat_lon(y, x, 0, mosaic_place);
  EXPECT_NEAR(there.x, -18.1, 1e-5);
  EXPECT_NEAR(there.y, 12.1, 1e-5);
}

// Sums of partial sums equal sums of single values except for rounding, and exactly for values with exact
// sums.
TEST(CellMeans, SumsOfManyValuesAreTheValues) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> step(-0.9, 0.9);
  std::uniform_int_distribution<int> value(-50, 50), weight(1, 8);
  CellMeans one_by_one(0.7), summed(0.7);
  double east = 0, north = 0;
  std::size_t values = 0, sums = 0;
  for (int part = 0; part < 200; ++part) {
    CellSums some(0.7);
    for (int k = 0; k < 100; ++k, ++values) {
      east += 0.3 * step(random), north += 0.3 * step(random);
      const double v = value(random), w = weight(random);
      one_by_one.add(east, north, v, w);
      some.add(east, north, v, w);
    }
    sums += some.sums().size();
    summed.add(some);
  }
  EXPECT_LT(2 * sums, values) << "neighbours come together";
  const CellMeans::Extent &a = one_by_one.extent(), &b = summed.extent();
  ASSERT_EQ(std::tie(a.west, a.south, a.east, a.north), std::tie(b.west, b.south, b.east, b.north));
  for (auto row = a.south; row < a.north; ++row)
    for (auto column = a.west; column < a.east; ++column) {
      const double mean = one_by_one.mean(column, row);
      if (std::isnan(mean))
        ASSERT_TRUE(std::isnan(summed.mean(column, row)));
      else
        ASSERT_EQ(summed.mean(column, row), mean) << column << ", " << row;
    }
  EXPECT_THROW(summed.add(CellSums(0.6)), std::invalid_argument) << "of other cells";
  EXPECT_THROW(CellSums(-1), std::invalid_argument);
  EXPECT_THROW(CellSums(1).add(NAN, 0, 1, 1), std::invalid_argument);
}

// Rows longer than a few cells, repeatedly: the sums of a ping grow with its cells, not with its range
// bins.
TEST(CellSums, AreNotManyMoreThanTheirCells) {
  CellSums sums(1);
  CellMeans one_by_one(1), summed(1);
  for (int row = 0; row < 2000; ++row)
    for (int column = 0; column < 100; ++column) {
      sums.add(column + 0.5, row % 7 + 0.5, row, 2);
      one_by_one.add(column + 0.5, row % 7 + 0.5, row, 2);
    }
  EXPECT_LE(sums.sums().size(), 4096u);
  summed.add(sums);
  for (int row = 0; row < 7; ++row)
    for (int column = 0; column < 100; ++column)
      EXPECT_EQ(summed.mean(column, row), one_by_one.mean(column, row));
}

TEST(CellMeans, CellsWestAndSouthOfTheOriginAreReportedApart) {
  CellMeans cells(0.5);
  for (int row = -300; row < 300; ++row) cells.add(-0.25 - 64, 0.5 * row + 0.1, row);
  for (int row = -300; row < 300; ++row) EXPECT_EQ(cells.mean(-129, row), row);
  EXPECT_TRUE(std::isnan(cells.mean(-128, 0)));
  EXPECT_TRUE(std::isnan(cells.mean(-130, 0)));
}

// A ping covers half of the distances to both adjacent pings, on its own side. Its cells depend on poses
// alone.
TEST(SidescanMosaic, APingFillsHalfTheWayToItsNeighbours) {
  const std::vector<float> level(kSamples, 2.f);
  const Pose before = heading_at(0, -3, 0), after = heading_at(0, 5, 0);
  const SidescanPing ping{heading_at(0, 0, 0), kAltitude, 0, kStep, level, level};
  const auto area_of = [](const CellSums& sums) {
    double area = 0;
    for (const CellSum& sum : sums.sums()) area += sum.weight;
    return area;
  };
  const double swath = 2 * std::sqrt(std::pow(kSamples * kStep, 2) - kAltitude * kAltitude);
  EXPECT_NEAR(area_of(sums_on_map(ping, &before, &after, 0.5)), 4 * swath, 1e-6 * swath);
  EXPECT_NEAR(area_of(sums_on_map(ping, &before, nullptr, 0.5)), 1.5 * swath, 1e-6 * swath);
  EXPECT_NEAR(area_of(sums_on_map(ping, nullptr, &after, 0.5)), 2.5 * swath, 1e-6 * swath);
  EXPECT_LT(area_of(sums_on_map(ping, nullptr, nullptr, 0.5)), 1e-6 * swath);
  const CellSums both = sums_on_map(ping, &before, &after, 0.5);
  for (const CellSum& sum : both.sums()) {
    EXPECT_EQ(sum.value, 2 * sum.weight);
    EXPECT_GE(sum.row, -3);
    EXPECT_LT(sum.row, 5);
  }
}

TEST(CellMeans, AgreesWithMeansTakenByHand) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-400, 400), value(-5, 5);
  CellMeans cells(0.7);
  std::map<std::pair<std::int64_t, std::int64_t>, std::pair<double, int>> expected;
  for (int k = 0; k < 20000; ++k) {
    const double east = place(random), north = place(random), v = value(random);
    cells.add(east, north, v);
    auto& [sum, count] =
        expected[{std::int64_t(std::floor(east / 0.7)), std::int64_t(std::floor(north / 0.7))}];
    sum += v;
    ++count;
  }
  for (const auto& [cell, mean] : expected)
    ASSERT_NEAR(cells.mean(cell.first, cell.second), mean.first / mean.second, 1e-12);
}

TEST(SidescanMosaic, RefusesWhatMakesNoSense) {
  SidescanMosaic mosaic(0.1, 1 << 20);
  const std::vector<float> level(kSamples, 1.f);
  const auto refuses = [&](SidescanPing ping, const char* message) {
    EXPECT_THAT([&] { mosaic.add(ping); }, ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
  };
  refuses({heading_at(0, 0, 0), -1, 0, kStep, level, level}, "altitude is -1 m");
  refuses({heading_at(0, 0, 0), 1, 0, 0, level, level}, "a step of 0 m");
  refuses({heading_at(NAN, 0, 0), 1, 0, kStep, level, level}, "position");
  refuses({{{0, 0, 0}, attitude_from_angles(0, 90 * degree, 0)}, 1, 0, kStep, level, level}, "no heading");
  EXPECT_THROW(SidescanMosaic(0), std::invalid_argument);
  EXPECT_THROW(sums_on_map({heading_at(0, 0, 0), 1, 0, kStep, level, level}, nullptr, nullptr, 0),
               std::invalid_argument);
  EXPECT_THAT(
      [&] {
        for (int k = 0; k < 1000; ++k) mosaic.add({heading_at(0, k, 0), kAltitude, 0, kStep, level, level});
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("more than 1 MiB: use larger cells")));
  const TestFolder folder;
  EXPECT_THAT([&] { SidescanMosaic(1).write_tiff(folder / "none.tif", LocalFrame(), "dB"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("nothing to write")));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const samples::FullDisk full(100);
  samples::failure_naming(folder / "full.tif",
                          [&] { mosaic.write_tiff(folder / "full.tif", LocalFrame(), "dB"); });
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace tubefoot
