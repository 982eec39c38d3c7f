// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that texts of pictures do not overlap and stay inside their picture, for any sonar, number of pings
// and range gate.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "fixtures/test_folder.hpp"
#include "fixtures/world/recordings.hpp"
#include "sensors/kinds/kind_interferometric.hpp"
#include "sensors/pictures/camera_picture.hpp"
#include "sensors/pictures/depth_picture.hpp"
#include "sensors/pictures/echogram.hpp"
#include "sensors/pictures/mosaic_picture.hpp"
#include "sensors/pictures/phase_picture.hpp"
#include "sensors/pictures/waterfall_picture.hpp"

namespace tubefoot {
namespace {

/// `least`: number of required texts: titles, scales with units, and some ticks of each axis
void expect_apart(const Canvas& canvas, std::size_t least, const std::string& what) {
  if (label_font().empty()) GTEST_SKIP() << "no font is installed";
  const std::vector<PixelBox>& texts = canvas.texts();
  EXPECT_GE(texts.size(), least) << what;
  for (std::size_t a = 0; a < texts.size(); ++a) {
    EXPECT_GE(texts[a].left, 0) << what << ", text " << a;
    EXPECT_GE(texts[a].top, 0) << what << ", text " << a;
    EXPECT_LE(texts[a].right, canvas.width()) << what << ", text " << a;
    EXPECT_LE(texts[a].bottom, canvas.height()) << what << ", text " << a;
    EXPECT_LT(texts[a].left, texts[a].right);
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_FALSE(texts[a].left < texts[b].right && texts[b].left < texts[a].right &&
                   texts[a].top < texts[b].bottom && texts[b].top < texts[a].bottom)
          << what << ": texts " << b << " and " << a;
  }
}

ReceiverOutput wordy(const Recording& recording) {
  ReceiverOutput receiver_output;
  receiver_output.energy_of = [&](std::size_t ping) {
    const PingEnergies kept = recording.energy_of(ping);
    const std::span<const double> energy = kept;
    return std::vector<double>(energy.begin(), energy.end());
  };
  receiver_output.said =
      "as received: speckle of 3 looks, noise of 48 dB re 1 uPa, a pulse of 24 us, 16 bits";
  return receiver_output;
}

TEST(Labels, OfFansStayApart) {
  for (const double width_deg : {0.3, 29.0, 90.0, 180.0, 360.0})
    for (const auto& [start_m, length_m] :
         std::vector<std::pair<double, double>>{{0.84, 5}, {37.5, 0.05}, {0, 2000}}) {
      SensorDescription description = samples::camera(width_deg < 1 ? 1 : 12, 8);
      auto& camera = description.kind.edit<DidsonDescription>();
      camera.horizontal_deg = width_deg;
      camera.window_start_m = start_m;
      camera.window_length_m = length_m;
      auto made = samples::silent(description, 1);
      std::ranges::fill(made.energies, 1e-9);
      const ReceiverOutput receiver_output = wordy(made.recording);
      // Title, subtitle, footer; seven of the legend; a range; an angle.
      expect_apart(
          draw_camera_frame(made.recording, 0, label_font(), width_deg == 29 ? nullptr : &receiver_output),
          12, fmt::format("{} degrees, {} and {} m", width_deg, start_m, length_m));
    }
}

TEST(Labels, OfSequencesStayApartAndAreAllThere) {
  for (const int pings : {1, 3, 20})
    for (const double width_deg : {0.3, 29.0, 180.0, 360.0})
      for (const double later_s : {0.0, 86400.0}) {
        SensorDescription description = samples::camera(8, 8);
        description.kind.edit<DidsonDescription>().horizontal_deg = width_deg;
        auto made = samples::silent(description, pings);
        for (double& time : made.recording.ping_time_s) time += later_s;
        std::ranges::fill(made.energies, 1e-9);
        expect_apart(draw_camera_sequence(made.recording, label_font()), 9 + std::size_t(pings),
                     fmt::format("{} pings of {} degrees from {} s on", pings, width_deg, later_s));
      }
}

TEST(Labels, OfWaterfallsAndPhasesStayApart) {
  for (const double range_m : {0.8, 12.0, 1500.0})
    for (const int pings : {1, 2, 7, 1000})
      for (const double spacing_m : {0.0, 0.001, 0.5, 12.5}) {
        SensorDescription description = samples::sidescan(16);
        InterferometricDescription receiver_pair;
        static_cast<SidescanDescription&>(receiver_pair) = description.kind.as<SidescanDescription>();
        for (const bool phases : {false, true}) {
          if (phases && (spacing_m > 0 || pings == 1000)) continue;  // no difference for phases
          if (phases)
            description.kind = receiver_pair;
          else
            description.kind.edit<SidescanDescription>();
          if (phases) {
            auto& keys = description.kind.edit<InterferometricDescription>();
            keys.range_min_m = 0.4;
            keys.range_max_m = range_m;
          } else {
            auto& keys = description.kind.edit<SidescanDescription>();
            keys.range_min_m = 0.4;
            keys.range_max_m = range_m;
          }
          auto made = samples::silent(description, pings);
          for (int k = 0; k < pings; ++k)
            made.recording.ping_pose[std::size_t(k)].position_m = {0, spacing_m * k, -5};
          made.energies.assign(made.energies.size() * made.recording.channels(), 1e-9);
          made.recording.energy = made.energies;
          const ReceiverOutput receiver_output = wordy(made.recording);
          const std::string what = fmt::format("{} m, {} pings {} m apart", range_m, pings, spacing_m);
          if (phases) {
            expect_apart(draw_phases(made.recording, label_font()), 14, what + ", phases");
            continue;
          }
          expect_apart(Waterfall(made.recording, label_font()).draw(), 16, what);
          expect_apart(Waterfall(made.recording, label_font()).draw(&receiver_output), 16,
                       what + ", received");
        }
      }
}

TEST(Labels, OfEchogramsStayApart) {
  for (const double range_m : {0.8, 12.0, 1500.0})
    for (const int pings : {1, 2, 7, 5000}) {
      SensorDescription description = samples::camera(1, 40);
      auto& camera = description.kind.edit<DidsonDescription>();
      camera.window_start_m = 0.4;
      camera.window_length_m = range_m;
      const auto made = samples::silent(description, pings);
      const std::vector<float> energy(made.energies.size(), 1e-9f);
      const std::vector<double> bottom(std::size_t(pings), 0.6);
      for (const char* said :
           {"", "as received: speckle of 3 looks, noise of 48 dB re 1 uPa, a pulse of 24 us"})
        expect_apart(draw_echogram(made.recording, energy, bottom, label_font(), said), 14,
                     fmt::format("{} m, {} pings", range_m, pings));
    }
}

TEST(Labels, OfMapsStayApart) {
  for (const double cell_m : {0.01, 0.5, 100.0})
    for (const double origin_m : {0.0, -999.97, 5'432'100.0})
      for (const auto& [columns, rows] :
           std::vector<std::pair<int, int>>{{1, 1}, {1, 300}, {300, 1}, {40, 40}, {700, 30}}) {
        CellMeans cells(cell_m);
        for (int column = 0; column < columns; ++column)
          for (int row = 0; row < rows; ++row)
            cells.add(origin_m + (column + 0.5) * cell_m, origin_m + (row + 0.5) * cell_m, 1 + column + row);
        const std::string what =
            fmt::format("{} x {} cells of {} m from {} m on", columns, rows, cell_m, origin_m);
        const std::string title =
            "a sidescan of a long name   mosaic, cells of " + fmt::format("{} m", cell_m);
        expect_apart(draw_mosaic(cells, 0, title, label_font()), 11, what);
        expect_apart(draw_depths(cells, title, label_font()), 8, what + ", depths");
      }
}

TEST(Labels, AreLeftOutWhereTheyWouldTouchOrLeaveThePicture) {
  if (label_font().empty()) GTEST_SKIP() << "no font is installed";
  Canvas canvas(200, 60, {}, label_font());
  canvas.text(100, 30, "first", 17, {1, 1, 1}, Anchor::centre);
  canvas.label(110, 36, "second", 17, {1, 1, 1});
  canvas.label(2, 30, "left", 17, {1, 1, 1}, Anchor::right);
  canvas.label(100, 2, "above", 17, {1, 1, 1}, Anchor::centre);
  EXPECT_EQ(canvas.texts().size(), 1u);
  canvas.label(10, 30, "far", 17, {1, 1, 1});
  EXPECT_EQ(canvas.texts().size(), 2u);
}

TEST(Labels, HaveFontsThatLieDeepInTheirFolders) {
  const std::filesystem::path font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  if (!std::filesystem::exists(font)) GTEST_SKIP() << "fonts-dejavu-core is not installed";
  const TestFolder home;
  const std::filesystem::path deep = home / ".local/share/fonts/of mine/sans";
  std::filesystem::create_directories(deep);
  std::filesystem::copy_file(font, deep / "Mine-Regular.ttf");
  home.write(".local/share/fonts/of mine/Broken-Regular.ttf", "no font");
  setenv("HOME", home.path().c_str(), 1);
  const std::string found = find_font({"Broken-Regular", "Mine-Regular"});
  EXPECT_EQ(found, (deep / "Mine-Regular.ttf").string());
  EXPECT_GT(text_width("12.5 m", 20, found), 40);
}

}  // namespace
}  // namespace tubefoot
