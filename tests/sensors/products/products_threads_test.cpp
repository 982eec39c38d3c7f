// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that each file of each kind of sensor has the same bytes with one thread and with several threads,
// and from packed energies.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <map>
#include <set>

#include "fixtures/world/packed_recording.hpp"
#include "fixtures/world/recordings.hpp"
#include "sensors/kinds/kind_echosounder.hpp"
#include "sensors/kinds/kind_imaging.hpp"
#include "sensors/kinds/kind_interferometric.hpp"
#include "sensors/kinds/kind_multibeam.hpp"
#include "sensors/kinds/kind_scanning.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Not;

/// A sonar with noise and speckle, so that a file with values of another ping would differ.
template <class Kind>
SensorDescription sonar(const char* name, Kind kind) {
  SensorDescription description;
  description.name = name;
  description.kind = std::move(kind);
  description.signal.speckle = "rayleigh";
  description.signal.noise_level_db = 90;
  return description;
}

/// Pings of an irregular seabed on two lines, all different.
samples::OwnedRecording survey(const SensorDescription& description, int pings) {
  auto made = samples::silent(description, pings);
  Recording& recording = made.recording;
  const auto cells = recording.cells(), channels = recording.channels();
  const auto count = static_cast<std::size_t>(made.sensor->samples().count);
  made.energies.assign(static_cast<std::size_t>(pings) * channels * cells, 0.0);
  for (std::size_t k = 0; k < made.energies.size(); ++k) {
    const std::size_t ping = k / (channels * cells), beam = k % cells / count, sample = k % count;
    const double bottom = static_cast<double>(count) * (0.5 + 0.02 * std::sin(0.7 * double(ping + beam))),
                 off = (static_cast<double>(sample) - bottom) / 4;
    made.energies[k] = 1e-9 * std::exp(-off * off) + (sample > count / 3 ? 1e-15 * double(k * 7919 % 97) : 0);
  }
  recording.energy = made.energies;
  recording.altitude_m.assign(static_cast<std::size_t>(pings), 4.0);
  recording.line_starts = {0, static_cast<std::size_t>(pings) / 2};
  recording.surfaces = [beams = made.sensor->beams().size(), count](std::size_t ping) {
    return std::vector<int>(beams, static_cast<int>(count - ping % 3));
  };
  return made;
}

std::map<std::string, std::string> files_by(int threads, const Recording& recording, const RunContext& run) {
  const TestFolder folder;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
  tbb::task_arena arena(threads);
  std::map<std::string, std::string> files;
  arena.execute([&] {
    std::vector<std::string> warnings;
    const SensorKind& kind = kind_of(recording.sensor->description());
    for (const auto& file : kind.write_products(folder.path(), recording, run, warnings))
      files[file.string()] = bytes_of(folder.path() / file);
  });
  return files;
}

/// Returns the names of all files of the recording. Fails for each file that differs with four threads or
/// with packed energies.
std::set<std::string> same_files(const Recording& recording, const LocalFrame& frame) {
  RunContext run;
  run.frame = frame;
  run.start_unix_s = 1735689600;
  run.seed = 5;
  run.pictures.animated = true;
  const auto alone = files_by(1, recording, run), together = files_by(4, recording, run);
  EXPECT_EQ(together.size(), alone.size());
  for (const auto& [name, bytes] : alone) {
    EXPECT_GT(bytes.size(), 0u) << name;
    const auto other = together.find(name);
    EXPECT_TRUE(other != together.end() && other->second == bytes) << name << " is another by four threads";
  }
  EXPECT_TRUE(files_by(2, samples::packed(recording), run) == alone) << "files are others of packed energies";
  std::set<std::string> names;
  for (const auto& file : alone) names.insert(file.first);
  return names;
}

const LocalFrame tangent = LocalFrame::at_lat_lon(48.25, -4.5, 10);
const LocalFrame map = LocalFrame::projected("EPSG:32602", 500000, 6'000'000, 0, {});

TEST(ProductsByThreads, OfACamera) {
  const auto made = survey(sonar("camera", samples::camera(48, 512).kind.as<DidsonDescription>()), 7);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("camera.ddf"), Contains("camera-0006-received.png"), Contains("camera-0006.exr"),
                    Contains("camera-sequence-received.gif")));
}

TEST(ProductsByThreads, OfAnImagingSonar) {
  ImagingDescription fan;
  fan.beams = 32;
  fan.samples = 100;
  const auto made = survey(sonar("imaging", fan), 5);
  EXPECT_THAT(same_files(made.recording, tangent), Contains("imaging-0004.png"));
}

TEST(ProductsByThreads, OfAScanningSonar) {
  ScanningDescription scan;
  scan.step_deg = 6;
  scan.samples = 80;
  const auto made = survey(sonar("scanning", scan), 5);
  EXPECT_THAT(same_files(made.recording, tangent), Contains("scanning-steps.csv"));
}

TEST(ProductsByThreads, OfASidescan) {
  const auto made = survey(sonar("sidescan", samples::sidescan(200).kind.as<SidescanDescription>()), 60);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("sidescan-line-02.xtf"), Contains("sidescan-waterfall.png"),
                    Contains("sidescan-mosaic.tif"), Contains("sidescan-line-01-mosaic.tif"),
                    Contains("sidescan.exr"), Contains("sidescan-received.png")));
}

TEST(ProductsByThreads, OfAnInterferometricSonar) {
  InterferometricDescription receiver_pair;
  receiver_pair.samples = 100;
  receiver_pair.phase_noise = true;
  const auto made = survey(sonar("staff", receiver_pair), 40);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("staff-soundings.csv"), Contains("staff-phase-received.png"),
                    Contains("staff-coherence.exr")));
}

TEST(ProductsByThreads, OfAnEchosounder) {
  EchosounderDescription sounder;
  sounder.samples = 200;
  const auto made = survey(sonar("sounder", sounder), 50);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("sounder.csv"), Contains("sounder-received.png")));
}

TEST(ProductsByThreads, OfAMultibeamOnATangentPlaneAndOnAMap) {
  MultibeamDescription fan;
  fan.beams = 31;
  fan.samples = 300;
  fan.range_max_m = 20;
  auto made = survey(sonar("fan", fan), 150);
  for (const LocalFrame& frame : {tangent, map})
    EXPECT_THAT(same_files(made.recording, frame),
                AllOf(Contains("fan-sonar.nc"), Contains("fan-line-01.gsf"), Contains("fan-line-02.gsf"),
                      Contains("fan-line-01.xtf"), Contains("fan-line-02.xtf"), Not(Contains("fan.gsf")),
                      Not(Contains("fan.xtf")), Contains("fan-soundings.csv"), Contains("fan-soundings.gpkg"),
                      Contains("fan-depth.tif"), Contains("fan-depth-ideal.png")));
}

}  // namespace
}  // namespace tubefoot
