// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a bright target, 12 m to port of the track and ahead of its middle. Each file of a sidescan run
// shows the target at this position.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "fixtures/program.hpp"

namespace tubefoot {
namespace {

constexpr int pings = 60, samples = 400;
constexpr double range_m = 20, spacing_m = 0.2;

/// 5 m above a dark seabed, 12 m long to the north, past a sphere that lies `tx_m` to starboard, 8 m from
/// the start.
std::string scene_with_target(double tx_m, bool georeferenced = true) {
  return fmt::format(R"({}[water]
sound_speed_m_s = 1500
[[materials]]
name = "mud"
lambert_db = -60
[[materials]]
name = "steel"
lambert_db = -5
[[terrain]]
kind = "flat"
material = "mud"
width_m = 100
length_m = 60
[[objects]]
name = "target"
shape = "sphere"
material = "steel"
radius_m = 0.3
position_m = [{}, 8, 0.3]
[trajectory]
kind = "line"
start_m = [0, 0, 5]
end_m = [0, 12, 5]
speed_m_s = 2
[[sensors]]
name = "fish"
kind = "sidescan"
pings = {}
ping_interval_s = 0.1
along_track_deg = 1
samples = {}
range_min_m = 1
range_max_m = {}
pulse_length_us = 50
tvg_spreading = 40
)",
                     georeferenced ? "[georeference]\norigin_lat_lon_deg = [48, -4]\n" : "", tx_m, pings,
                     samples, range_m);
}

/// Middle of the brightest pixels.
struct Brightest {
  double x = 0, y = 0;
  int width = 0, height = 0;
};

/// Examines the pixels that are at least `off_middle` columns from the middle column.
Brightest brightest_of(const std::filesystem::path& file, int off_middle = 0) {
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::runtime_error("no picture " + file.string());
  const OIIO::ImageSpec spec = input->spec();
  std::vector<float> pixels(std::size_t(spec.width) * spec.height * spec.nchannels);
  input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data());
  Brightest found{0, 0, spec.width, spec.height};
  float most = -1;
  int count = 0;
  for (int y = 0; y < spec.height; ++y)
    for (int x = 0; x < spec.width; ++x) {
      const float value = pixels[(std::size_t(y) * spec.width + x) * spec.nchannels];
      if (value < most || std::abs(x - spec.width / 2) < off_middle) continue;
      if (value > most) count = 0;
      most = value;
      found.x = (found.x * count + x) / (count + 1);
      found.y = (found.y * count + y) / (count + 1);
      ++count;
    }
  return found;
}

/// Number of the strongest sample in an XTF file, its channel and its ping.
struct XtfEcho {
  unsigned ping = 0, channel = 0, sample = 0, pings = 0;
};

XtfEcho loudest_of_xtf(const std::string& bytes) {
  const auto number = [&](std::size_t at, int size) {
    unsigned value = 0;
    for (int k = size; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes.at(at + k));
    return value;
  };
  XtfEcho found;
  unsigned most = 0;
  for (std::size_t begin = 1024; begin < bytes.size(); begin += number(begin + 10, 4)) {
    if (number(begin, 2) != 0xFACE) throw std::runtime_error("no packet");
    if (number(begin + 2, 1) != 0) continue;
    ++found.pings;
    std::size_t at = begin + 256;
    for (unsigned channel = 0; channel < 2; ++channel) {
      const unsigned count = number(at + 42, 4);
      for (unsigned k = 0; k < count; ++k)
        if (const unsigned value = number(at + 64 + 2 * k, 2); value > most) {
          most = value;
          // The samples of the port channel are stored from far to near.
          found = {number(begin + 28, 4), number(at, 2), channel == 0 ? count - 1 - k : k, found.pings};
        }
      at += 64 + 2 * count;
    }
  }
  return found;
}

/// Runs the scene into `folder` and returns the messages of the program.
std::string run(const TestFolder& folder, const std::string& scene) {
  folder.write("scene.toml", scene);
  const Outcome outcome =
      run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "results").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.err;
}

struct SidescanRun : testing::TestWithParam<double> {};

TEST_P(SidescanRun, TargetAheadIsOnItsSideInEveryFile) {
  const double tx_m = GetParam();
  const bool port = tx_m < 0;
  const TestFolder folder;
  run(folder, scene_with_target(tx_m));
  const std::filesystem::path results = folder / "results";
  const double slant_m =
      std::hypot(12, 4.7) - 0.3;  // of the front of the sphere, within its radius of the brightest point
  const double step_m = (range_m - 1) / samples;
  const double target_ping = 8 / spacing_m;

  const XtfEcho echo = loudest_of_xtf(bytes_of(results / "fish.xtf"));
  EXPECT_EQ(echo.pings, unsigned(pings));
  EXPECT_EQ(echo.channel, port ? 0u : 1u);
  EXPECT_NEAR(echo.ping, target_ping, 2);
  EXPECT_NEAR(echo.sample * step_m, slant_m, 0.3);

  for (const std::string name : {"fish-waterfall.png", "fish.exr"}) {
    const Brightest at = brightest_of(results / name, 150);  // below the fish the seabed is white, too
    EXPECT_EQ(at.width, 2 * samples) << name;
    EXPECT_EQ(at.height, pings) << name;
    EXPECT_NEAR(at.y, target_ping, 2) << name;  // the first ping is the first row
    const double sample = port ? samples - 1 - at.x : at.x - samples;
    EXPECT_NEAR(1 + sample * step_m, slant_m, 0.3) << name;
  }

  GDALAllRegister();
  const std::unique_ptr<GDALDataset> map(
      GDALDataset::Open((results / "fish-mosaic.tif").c_str(), GDAL_OF_RASTER));
  ASSERT_TRUE(map);
  EXPECT_NE(map->GetSpatialRef(), nullptr);
  std::vector<float> cells(std::size_t(map->GetRasterXSize()) * map->GetRasterYSize());
  ASSERT_EQ(map->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, map->GetRasterXSize(), map->GetRasterYSize(),
                                            cells.data(), map->GetRasterXSize(), map->GetRasterYSize(),
                                            GDT_Float32, 0, 0),
            CE_None);
  const auto loudest = std::max_element(cells.begin(), cells.end()) - cells.begin();
  double transform[6];
  ASSERT_EQ(map->GetGeoTransform(transform), CE_None);
  const double column = 0.5 + double(loudest % map->GetRasterXSize()),
               row = 0.5 + double(loudest / map->GetRasterXSize());
  // On a flat map the front of the sphere, 4.7 m below the sonar, lies nearer than its foot.
  EXPECT_NEAR(transform[0] + column * transform[1], port ? -11.5 : 11.5, 0.6);
  EXPECT_NEAR(transform[3] + row * transform[5], 8, 0.6);

  // The map lies between the axis and the legend. No other pixel is as red as its strongest cell.
  const Brightest at = brightest_of(results / "fish-mosaic.png");
  constexpr int axis = 112, legend = 148;
  const double middle = (axis + at.width - legend) / 2.0;
  EXPECT_EQ(at.x < middle, port) << at.x << " of " << at.width;
  EXPECT_GT(std::abs(at.x - middle), 0.2 * (at.width - axis - legend));

  const auto stats = nlohmann::json::parse(bytes_of(results / "stats.json"));
  EXPECT_TRUE(stats["warnings"].empty()) << stats["warnings"];
}

INSTANTIATE_TEST_SUITE_P(BothSides, SidescanRun, testing::Values(-12.0, 12.0));

TEST(SidescanWithoutGeoreference, SaysWhatIsMissing) {
  const TestFolder folder;
  EXPECT_THAT(run(folder, scene_with_target(-12, false)), testing::HasSubstr("add [georeference]"));
  EXPECT_FALSE(std::filesystem::exists(folder / "results/fish.xtf"));
  EXPECT_TRUE(std::filesystem::exists(folder / "results/fish-mosaic.tif"));
}

}  // namespace
}  // namespace tubefoot
