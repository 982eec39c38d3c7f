// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the table and the depth grid of soundings: units, signs, coordinate systems, reproducibility, full
// disks, and the shaded picture.

#include <OpenImageIO/imagebuf.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <sstream>

#include "fixtures/world/recordings.hpp"
#include "sensors/detection/sounding_grid.hpp"
#include "sensors/formats/soundings_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/depth_picture.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const SourcePlace soundings_place{"scene.toml"};

Sounding sounding(std::uint32_t ping, std::uint32_t beam) {
  Sounding s;
  s.ping = ping;
  s.beam = beam;
  s.time_s = 0.25 * ping;
  s.position_m = {1.5 * beam, -0.5 * ping, -30.25};
  s.two_way_travel_time_s = 0.046875;
  s.slant_range_m = 35.125;
  s.beam_angle_deg = -62.5;
  s.amplitude = 0.375;
  s.quality = 0.75;
  s.method = DetectionMethod::energy_centroid;
  return s;
}

void write(const std::filesystem::path& file, const LocalFrame& frame, std::uint32_t pings,
           std::uint32_t beams) {
  SoundingsFile out(file, frame);
  for (std::uint32_t ping = 0; ping < pings; ++ping) {
    std::vector<Sounding> swath;
    for (std::uint32_t beam = 0; beam < beams; ++beam) swath.push_back(sounding(ping, beam));
    out.add(swath);
  }
  out.finish();
}

TEST(SoundingsFile, CsvStatesUnitsAndSigns) {
  const TestFolder folder;
  write(folder / "a.csv", LocalFrame(), 1, 1);
  EXPECT_EQ(bytes_of(folder / "a.csv"),
            "ping,beam,time_s,east_m,north_m,up_m,two_way_travel_time_s,slant_range_m,"
            "beam_angle_deg_starboard_positive,amplitude,quality_0_to_1,method,status\n"
            "0,0,0,0.0000,-0.0000,-30.2500,0.046875,35.1250,-62.5,0.375,0.75,energy_centroid,good\n");
  write(folder / "b.csv", LocalFrame::projected("EPSG:32602", 500000, 0, 5, soundings_place), 1, 1);
  std::istringstream lines(bytes_of(folder / "b.csv"));
  std::string head, row;
  std::getline(lines, head);
  std::getline(lines, row);
  EXPECT_THAT(head, HasSubstr("up_m,longitude_deg_east,latitude_deg_north,height_m_up_positive,two_way"));
  EXPECT_THAT(row, testing::StartsWith("0,0,0,0.0000,-0.0000,-30.2500,-171.0000000000,"));
  EXPECT_THAT(row, HasSubstr(",-25.2500,0.046875,"));
}

TEST(SoundingsFile, CsvHasEveryBeamOfALongLine) {
  const TestFolder folder;
  write(folder / "a.csv", LocalFrame(), 300, 101);
  std::istringstream lines(bytes_of(folder / "a.csv"));
  std::string line;
  std::getline(lines, line);
  for (int ping = 0; ping < 300; ++ping)
    for (int beam = 0; beam < 101; ++beam) {
      ASSERT_TRUE(std::getline(lines, line));
      ASSERT_THAT(line, testing::StartsWith(std::to_string(ping) + "," + std::to_string(beam) + ","));
    }
  EXPECT_FALSE(std::getline(lines, line));
}

struct Points {
  GDALDatasetUniquePtr data;
  OGRLayer* layer = nullptr;
  explicit Points(const std::filesystem::path& file) {
    GDALAllRegister();
    data.reset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
    if (!data || !(layer = data->GetLayerByName("soundings"))) throw std::logic_error("no soundings");
  }
};

TEST(SoundingsFile, GeoPackageHasPointsInTheScenesCrs) {
  const TestFolder folder;
  const LocalFrame utm = LocalFrame::projected("EPSG:32602", 621860, 7245027, 5, soundings_place);
  write(folder / "utm.gpkg", utm, 100, 101);
  Points points(folder / "utm.gpkg");
  EXPECT_STREQ(points.layer->GetSpatialRef()->GetAuthorityCode(nullptr), "32602");
  EXPECT_EQ(points.layer->GetFeatureCount(), 100 * 101);
  int index = 0;
  for (const auto& feature : *points.layer) {
    const Sounding s = sounding(std::uint32_t(index / 101), std::uint32_t(index % 101));
    const OGRPoint* point = feature->GetGeometryRef()->toPoint();
    ASSERT_EQ(point->getX(), 621860 + s.position_m.x);
    ASSERT_EQ(point->getY(), 7245027 + s.position_m.y);
    ASSERT_EQ(point->getZ(), -25.25);
    ASSERT_EQ((*feature)["ping"].GetInteger64(), s.ping);
    ASSERT_EQ((*feature)["beam"].GetInteger64(), s.beam);
    ++index;
  }
  const OGRFeatureUniquePtr one(points.layer->GetFeature(205));  // counted from 1
  EXPECT_EQ((*one)["time_s"].GetDouble(), 0.5);
  EXPECT_EQ((*one)["up_m"].GetDouble(), -30.25);
  EXPECT_EQ((*one)["two_way_travel_time_s"].GetDouble(), 0.046875);
  EXPECT_EQ((*one)["slant_range_m"].GetDouble(), 35.125);
  EXPECT_EQ((*one)["beam_angle_deg"].GetDouble(), -62.5);
  EXPECT_EQ((*one)["amplitude"].GetDouble(), 0.375);
  EXPECT_EQ((*one)["quality"].GetDouble(), 0.75);
  EXPECT_STREQ((*one)["method"].GetString(), "energy_centroid");
}

TEST(SoundingsFile, GeoPackageOfATangentFrameHasLongitudeAndLatitude) {
  const TestFolder folder;
  const LocalFrame tangent = LocalFrame::at_lat_lon(48.3, -4.5, 0);
  write(folder / "t.gpkg", tangent, 3, 50);
  Points points(folder / "t.gpkg");
  EXPECT_STREQ(points.layer->GetSpatialRef()->GetAuthorityCode(nullptr), "4326");
  const OGRFeatureUniquePtr one(points.layer->GetFeature(141));  // ping 2, beam 40
  const OGRPoint* point = one->GetGeometryRef()->toPoint();
  const glm::dvec3 back = tangent.from_lat_lon(point->getY(), point->getX(), point->getZ(), soundings_place);
  EXPECT_NEAR(back.x, 60, 1e-7);
  EXPECT_NEAR(back.y, -1, 1e-7);
  EXPECT_NEAR(back.z, -30.25, 1e-7);
  write(folder / "l.gpkg", LocalFrame(), 3, 50);
  Points local(folder / "l.gpkg");
  const OGRFeatureUniquePtr other(local.layer->GetFeature(141));
  EXPECT_EQ(other->GetGeometryRef()->toPoint()->getX(), 60);
}

TEST(SoundingsFile, EqualRunsGiveEqualFiles) {
  const TestFolder folder;
  std::filesystem::create_directory(folder / "again");
  for (const char* name : {"a.csv", "a.gpkg"}) {
    write(folder / name, LocalFrame(), 5, 20);
    write(folder / "again" / name, LocalFrame(), 5, 20);
    EXPECT_TRUE(bytes_of(folder / name) == bytes_of(folder / "again" / name)) << name;
  }
}

TEST(SoundingsFile, IsTakenAwayUnlessItIsFinished) {
  for (const char* name : {"a.csv", "a.gpkg"}) {
    const TestFolder folder;
    {
      SoundingsFile out(folder / name, LocalFrame());
      out.add(std::vector<Sounding>(10));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << name;
  }
  const TestFolder folder;
  EXPECT_THAT([&] { SoundingsFile(folder / "a.xyz", LocalFrame()); },
              ThrowsMessage<std::invalid_argument>(HasSubstr(".csv or .gpkg")));
}

TEST(SoundingsFile, SaysThatTheDiskIsFull) {
  for (const char* name : {"a.csv", "a.gpkg"}) {
    const TestFolder folder;
    {
      const samples::FullDisk full(400000);
      samples::failure_naming(folder / name, [&] { write(folder / name, LocalFrame(), 2000, 101); });
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << name;
  }
}

TEST(SoundingGrid, HoldsMeanDepthsPositiveDown) {
  const TestFolder folder;
  SoundingGrid grid(LocalFrame::projected("EPSG:32602", 621860, 7245027, 5, soundings_place), 2);
  const auto add = [&](double east, double north, double up) {
    Sounding s;
    s.position_m = {east, north, up};
    grid.add(s);
  };
  add(0.5, 0.5, -30);
  add(1.5, 1.5, -32);
  add(-3.5, 5, -40);
  add(NAN, 5, -40);
  grid.write_tiff(folder / "depth.tif");
  GDALAllRegister();
  const GDALDatasetUniquePtr data(GDALDataset::Open((folder / "depth.tif").c_str()));
  ASSERT_NE(data, nullptr);
  ASSERT_EQ(data->GetRasterXSize(), 3);
  ASSERT_EQ(data->GetRasterYSize(), 3);
  std::array<float, 9> depth{};
  ASSERT_EQ(data->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, 3, 3, depth.data(), 3, 3, GDT_Float32, 0, 0),
            CE_None);
  EXPECT_THAT(depth, ElementsAre(35, no_data, no_data, no_data, no_data, no_data, no_data, no_data, 26));
  std::array<double, 6> transform{};
  data->GetGeoTransform(transform.data());
  EXPECT_THAT(transform, ElementsAre(621856, 2, 0, 7245033, 0, -2));
  EXPECT_STREQ(data->GetRasterBand(1)->GetDescription(), "Depth");
  EXPECT_STREQ(data->GetRasterBand(1)->GetUnitType(), "m");
  EXPECT_EQ(data->GetRasterBand(1)->GetNoDataValue(), no_data);
}

SoundingGrid hill() {
  SoundingGrid grid(LocalFrame(), 0.5);
  for (int i = -100; i < 100; ++i)
    for (int j = -60; j < 60; ++j) {
      if (i > 60 && j > 30) continue;
      Sounding s;
      s.position_m = {0.5 * i + 0.25, 0.5 * j + 0.25, 0};
      s.position_m.z =
          -30 + 6 * std::exp(-(s.position_m.x * s.position_m.x + s.position_m.y * s.position_m.y) / 60) +
          0.4 * std::sin(s.position_m.x);
      grid.add(s);
    }
  return grid;
}

/// A sonar 20 m above a level seabed, which measures it in a direction (degrees from vertical, to starboard).
struct LevelBeam {
  Sounding sounding;
  LevelBeam(double angle_deg, double height_m = 0) {
    const double depth_m = 20 - height_m;
    sounding.position_m = {depth_m * std::tan(radians(angle_deg)), 0, -depth_m};
  }
  MeasuredFrom measured(double along_m = 0) const { return {sounding, {0, along_m, 0}}; }
};

TEST(SoundingGrid, LinesFillTheFootprintsOfALevelSeabed) {
  for (double angle_deg = -75; angle_deg < 75; angle_deg += 1.5) {
    const LevelBeam beam(angle_deg), next(angle_deg + 1.5);
    EXPECT_TRUE(fills_between(beam.measured(), next.measured(), 0.1)) << angle_deg;
    EXPECT_TRUE(fills_between(beam.measured(), beam.measured(0.3), 0.1)) << angle_deg;
  }
}

TEST(SoundingGrid, LinesDoNotCrossAShadow) {
  // The top of a box of 4 m, and the seabed behind its shadow.
  const LevelBeam top(45, 4), behind(46.5);
  EXPECT_FALSE(fills_between(top.measured(), behind.measured(), 0.1));
  EXPECT_FALSE(fills_between(behind.measured(), top.measured(), 0.1));
  EXPECT_TRUE(fills_between(top.measured(), behind.measured(), 3)) << "adjacent cells";
  // The same beam passes the end of the box between two pings.
  EXPECT_FALSE(fills_between(LevelBeam(45, 4).measured(), LevelBeam(45).measured(0.3), 0.1));
}

float brightness(const OIIO::ImageBuf& image, int x, int y) {
  return image.getchannel(x, y, 0, 0) + image.getchannel(x, y, 0, 1) + image.getchannel(x, y, 0, 2);
}

// Pings on the borders of cells, except for rounding.
TEST(SoundingGrid, RoundNumbersStayOnTheirSideOfABorder) {
  SoundingGrid grid(LocalFrame(), 1);
  for (int k = -50; k < 50; ++k)
    for (const double off : {-1e-9, 0.0, 1e-9}) {
      Sounding sounding;
      sounding.position_m = {0.1 + off, k + off, -20};
      grid.add(sounding);
    }
  EXPECT_EQ(grid.depths().extent().rows(), 100);
  for (int row = -50; row < 50; ++row) EXPECT_EQ(grid.depths().mean(0, row), 20) << row;
}

TEST(SoundingGrid, LinesFillOnlyCellsThatHaveNoSounding) {
  SoundingGrid grid(LocalFrame(), 1);
  Sounding a, b, between;
  a.position_m = {0.5, 0.5, -10};
  b.position_m = {0.5, 4.5, -14};
  between.position_m = {0.5, 2.5, -30};
  for (const Sounding& sounding : {a, b, between}) grid.add(sounding);
  grid.add_between(a, b);
  EXPECT_NEAR(grid.depths().mean(0, 1), 11, 0.3);
  EXPECT_NEAR(grid.depths().mean(0, 2), 30, 1e-6);
  EXPECT_NEAR(grid.depths().mean(0, 3), 13, 0.3);
  b.flags.set(DetectionFlag::cut_by_window);  // no depth: it adds nothing to a grid
  b.position_m.x = 2.5;
  grid.add(b);
  grid.add_between(a, b);
  EXPECT_EQ(grid.depths().extent().columns(), 1);
}

TEST(SoundingGrid, IsDrawnLitFromTheNorthWest) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "hill.png";
  draw_depths(hill().depths(), "a hill", label_font()).write_png(file, "");
  const OIIO::ImageBuf image(file.string());
  // 200 x 120 cells at 4.5 pixels from (120, 108).
  const auto at = [&](double east, double north) {
    return brightness(image, 120 + int((east + 50) * 9), 108 + int((30 - north) * 9));
  };
  EXPECT_GT(at(-4, 4), at(4, -4) + 0.3) << "the north-western flank is lit";
  EXPECT_GT(at(0.1, 0.1), at(-30, -20)) << "the top is paler than the deep bed";
  EXPECT_NEAR(at(45, 25), 3 * 0.165, 0.02) << "no soundings, no colour";
  EXPECT_THAT([] { draw_depths(SoundingGrid(LocalFrame(), 1).depths(), "", ""); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no soundings")));
}

// Depths that grow uniformly become colours that change uniformly: no step is much larger than the mean step.
TEST(SoundingGrid, IsDrawnWithoutBands) {
  const TestFolder folder;
  const std::filesystem::path file = folder / "ramp.png";
  SoundingGrid grid(LocalFrame(), 1);
  constexpr int cells = 225;
  for (int east = 0; east < cells; ++east)
    for (int north = 0; north < 20; ++north) {
      Sounding s;
      s.position_m = {east + 0.5, north + 0.5, -20 - 0.001 * east};
      grid.add(s);
    }
  draw_depths(grid.depths(), "a ramp", label_font()).write_png(file, "");
  const OIIO::ImageBuf image(file.string());
  int left = 0;  // the background ends where the map begins
  const int row = 108 + 40;
  while (left < image.spec().width && brightness(image, left + 2, row) < 1.5f) ++left;
  const auto at = [&](int cell, int channel) {
    return image.getchannel(left + 3 + 4 * cell, row, 0, channel);
  };
  for (int cell = 2; cell + 2 < cells; ++cell) {
    float step = 0;
    for (int channel = 0; channel < 3; ++channel)
      step = std::max(step, std::abs(at(cell, channel) - at(cell - 1, channel)));
    EXPECT_LT(step, 0.02f) << cell;
  }
  EXPECT_GT(brightness(image, left + 8, row), brightness(image, left + 4 * cells - 8, row) + 1);
}

}  // namespace
}  // namespace tubefoot
