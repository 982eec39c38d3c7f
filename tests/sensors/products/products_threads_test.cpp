// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that each file of each kind of sensor has the same bytes with one thread and with several threads,
// and from packed energies.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <map>
#include <set>

#include "fixtures/world/irregular_surveys.hpp"
#include "fixtures/world/packed_recording.hpp"
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

const LocalFrame tangent = samples::tangent_frame();
const LocalFrame map = LocalFrame::projected("EPSG:32602", 500000, 6'000'000, 0, {});

TEST(ProductsByThreads, OfACamera) {
  const auto made = samples::irregular_survey(
      samples::sonar("camera", samples::camera(48, 512).kind.as<DidsonDescription>()), 7);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("camera.ddf"), Contains("camera-0006-received.png"), Contains("camera-0006.exr"),
                    Contains("camera-sequence-received.gif")));
}

TEST(ProductsByThreads, OfAnImagingSonar) {
  ImagingDescription fan;
  fan.beams = 32;
  fan.samples = 100;
  const auto made = samples::irregular_survey(samples::sonar("imaging", fan), 5);
  EXPECT_THAT(same_files(made.recording, tangent), Contains("imaging-0004.png"));
}

TEST(ProductsByThreads, OfAScanningSonar) {
  ScanningDescription scan;
  scan.step_deg = 6;
  scan.samples = 80;
  const auto made = samples::irregular_survey(samples::sonar("scanning", scan), 5);
  EXPECT_THAT(same_files(made.recording, tangent), Contains("scanning-steps.csv"));
}

TEST(ProductsByThreads, OfASidescan) {
  const auto made = samples::irregular_survey(
      samples::sonar("sidescan", samples::sidescan(200).kind.as<SidescanDescription>()), 60);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("sidescan-line-02.xtf"), Contains("sidescan-waterfall.png"),
                    Contains("sidescan-mosaic.tif"), Contains("sidescan-line-01-mosaic.tif"),
                    Contains("sidescan.exr"), Contains("sidescan-received.png")));
}

TEST(ProductsByThreads, OfAnInterferometricSonar) {
  InterferometricDescription receiver_pair;
  receiver_pair.samples = 100;
  receiver_pair.phase_noise = true;
  const auto made = samples::irregular_survey(samples::sonar("staff", receiver_pair), 40);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("staff-soundings.csv"), Contains("staff-phase-received.png"),
                    Contains("staff-coherence.exr")));
}

TEST(ProductsByThreads, OfAnEchosounder) {
  EchosounderDescription sounder;
  sounder.samples = 200;
  const auto made = samples::irregular_survey(samples::sonar("sounder", sounder), 50);
  EXPECT_THAT(same_files(made.recording, tangent),
              AllOf(Contains("sounder.csv"), Contains("sounder-received.png")));
}

TEST(ProductsByThreads, OfAMultibeamOnATangentPlaneAndOnAMap) {
  MultibeamDescription fan;
  fan.beams = 31;
  fan.samples = 300;
  fan.range_max_m = 20;
  auto made = samples::irregular_survey(samples::sonar("fan", fan), 150);
  for (const LocalFrame& frame : {tangent, map})
    EXPECT_THAT(same_files(made.recording, frame),
                AllOf(Contains("fan-sonar.nc"), Contains("fan-line-01.gsf"), Contains("fan-line-02.gsf"),
                      Contains("fan-line-01.xtf"), Contains("fan-line-02.xtf"), Not(Contains("fan.gsf")),
                      Not(Contains("fan.xtf")), Contains("fan-soundings.csv"), Contains("fan-soundings.gpkg"),
                      Contains("fan-depth.tif"), Contains("fan-depth-ideal.png")));
}

}  // namespace
}  // namespace tubefoot
