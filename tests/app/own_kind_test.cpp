// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a user-defined kind of sensor, a sonar that a motor rotates. The program reads it from a scene file
// with its keys and errors, runs it, and writes echoes and its own product.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

#include "files/checked_file.hpp"
#include "fixtures/program.hpp"
#include "fixtures/world/echoes.hpp"
#include "run/run_steps.hpp"
#include "run/simulation.hpp"
#include "scene/file/sensor_ranges.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/model/angles.hpp"
#include "viewer/view_gather.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct TurningKeys {
  double frequency_khz = 675;
  int steps = 12;
  double sector_deg = 12, height_deg = 20;
  double step_s = 0.002;  ///< from one direction to the next
  int samples = 100;
  double range_min_m = 1, range_max_m = 8;
  static const SensorSection& kind();
};

/// One beam that a motor rotates, with one transmission per direction.
class TurningSonar : public Sensor {
 public:
  explicit TurningSonar(const SensorDescription& description) : Sensor(description) {
    const auto& scan = description.kind.as<TurningKeys>();
    frequency_khz_ = scan.frequency_khz;
    samples_ = {scan.range_min_m, (scan.range_max_m - scan.range_min_m) / scan.samples, scan.samples};
    const double half_rad = radians(scan.sector_deg) / 2, width_rad = 2 * half_rad / scan.steps;
    const std::vector<double> edges = even_edges(-half_rad, half_rad, scan.steps);
    const double corner_rad =
        height_of_corners(radians(scan.height_deg) / 2, width_rad, description.cone_tolerance);
    for (std::uint32_t step = 0; step < static_cast<std::uint32_t>(scan.steps); ++step) {
      beams_.push_back({-half_rad + (step + 0.5) * width_rad, 0, width_rad, radians(scan.height_deg)});
      Transmission transmission;
      transmission.delay_s = step * scan.step_s;
      transmission.beams = {step};
      transmission.sectors.push_back({{edges[step], edges[step + 1]},
                                      {-corner_rad, corner_rad},
                                      glm::dmat3(forward_axis, starboard_axis, up_axis)});
      transmission.beam_of_tube = {0};
      transmission.fans.push_back({0, 1, 1, forward_axis, starboard_axis, up_axis});
      transmissions_.push_back(transmission);
    }
  }
};

class TurningKind : public SensorKind {
 public:
  TurningKind() : SensorKind("turning") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using S = TurningKeys;
    section.kind<S>("kind", name(), "A turning beam.",
                    {field("frequency_khz", &S::frequency_khz, {.ranges = {frequency}}),
                     field("steps", &S::steps, {.ranges = {{.lo = 1, .hi = 4096}}}),
                     field("sector_deg", &S::sector_deg, {.ranges = {sector(180, true)}}),
                     field("height_deg", &S::height_deg, {.ranges = {sector(90, false)}}),
                     field("step_s", &S::step_s, {.ranges = {{.lo = 0, .hi = 1}}}),
                     field("samples", &S::samples, {.ranges = {range_samples}}),
                     field("range_min_m", &S::range_min_m, {.ranges = {sonar_range}}),
                     field("range_max_m", &S::range_max_m, {.ranges = {sonar_range}})});
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& scan = sensor.kind.as<TurningKeys>();
    check_ranges(scan.range_min_m, scan.range_max_m, table);
    if (scan.steps * scan.step_s > sensor.ping_interval_s)
      throw InputError(table.place_of("step_s"),
                       "a turn takes longer than 'ping_interval_s': lower 'step_s'");
  }
  SensorFigures figures(const SensorDescription& sensor) const override {
    const auto& scan = sensor.kind.as<TurningKeys>();
    return {scan.frequency_khz,
            scan.steps,
            scan.samples,
            scan.steps,
            (scan.range_max_m - scan.range_min_m) / scan.samples,
            scan.sector_deg / scan.steps,
            scan.range_max_m};
  }
  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<TurningSonar>(sensor);
  }
  std::vector<std::filesystem::path> write_products(const std::filesystem::path& folder,
                                                    const Recording& recording, const RunContext&,
                                                    std::vector<std::string>&) const override {
    std::string text = "ping,step,energy_j\n";
    const auto samples = static_cast<std::size_t>(recording.sensor->samples().count);
    for (std::size_t ping = 0; ping < recording.pings(); ++ping)
      for (std::size_t step = 0; step < recording.sensor->beams().size(); ++step) {
        const PingEnergies kept = recording.energy_of(ping);
        const auto own = kept.values().subspan(step * samples, samples);
        text += fmt::format("{},{},{}\n", ping, step, std::accumulate(own.begin(), own.end(), 0.0));
      }
    const std::filesystem::path file = recording.sensor->description().name + "-scan.csv";
    write_file(folder / file, text);
    return {file};
  }
  std::vector<std::string> files_left_out(const Recording&, const RunContext& run) const override {
    if (run.frame.is_georeferenced()) return {};
    return {"no scan.kml is written: add [georeference]"};
  }
};

const SensorSection& TurningKeys::kind() {
  static const TurningKind kind;
  return kind;
}

SensorSections with_turning() {
  SensorSections kinds = sensor_kinds();
  kinds.push_back(&TurningKeys::kind());
  return kinds;
}

SceneDescription scene_with(const std::string& keys) {
  return read_scene_text(R"([[materials]]
name = "sand"
[[terrain]]
kind = "fractal"
width_m = 20
length_m = 20
cell_m = 1
rms_height_m = 0.1
[trajectory]
kind = "fixed"
position_m = [0, 0, 1.5]
[[sensors]]
name = "sonar"
tilt_deg = 20
pings = 2
)" + keys,
                         "scene.toml", with_turning());
}

/// Returns the files that a run writes.
std::vector<std::filesystem::path> run_into(const TestFolder& folder, const Survey& survey) {
  SimulationStats stats;
  const RunRequest request = request_of(survey.scene.description.run);
  const std::vector<Recording> recordings = simulate(survey, request, stats);
  std::vector<std::string> warnings;
  return write_result_files(folder.path(), survey, request, recordings, warnings);
}

std::string error_of(const std::string& keys) {
  try {
    scene_with(keys);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OwnKind, IsReadWithItsKeysAndItsMistakes) {
  const SceneDescription scene = scene_with("kind = \"turning\"\nsteps = 7\n");
  EXPECT_EQ(scene.sensors.front().kind.as<TurningKeys>().steps, 7);
  EXPECT_EQ(kind_of(scene.sensors.front()).name(), "turning");
  EXPECT_THAT(error_of("kind = \"turing\"\n"), HasSubstr("scene.toml:16:8: "));
  EXPECT_THAT(error_of("kind = \"turing\"\n"), HasSubstr("did you mean \"turning\"?"));
  EXPECT_THAT(error_of("kind = \"turning\"\nsteps = 0\n"),
              HasSubstr("scene.toml:17:9: 'steps' must be 1 to 4096"));
  EXPECT_THAT(error_of("kind = \"turning\"\nswath_deg = 3\n"),
              HasSubstr("'swath_deg' applies to kind = \"multibeam\", not to kind = \"turning\""));
  EXPECT_THAT(error_of("kind = \"imaging\"\nsteps = 3\n"), HasSubstr("applies to kind = \"turning\""));
  EXPECT_THAT(error_of("kind = \"turning\"\nstep_s = 0.5\n"),
              HasSubstr("scene.toml:17:10: a turn takes longer"));
  EXPECT_THROW(read_scene_text("[[sensors]]\nname = \"s\"\nkind = \"turning\"\n", "scene.toml"), InputError);
  std::vector<std::string> documented;
  for (const SceneKey& key : scene_file_keys(with_turning()))
    if (key.kind == "kind = \"turning\"") documented.push_back(key.name);
  EXPECT_THAT(documented, ElementsAre("frequency_khz", "steps", "sector_deg", "height_deg", "step_s",
                                      "samples", "range_min_m", "range_max_m"));
}

// At one position, a full rotation of the beam receives the same as a fan of such beams.
TEST(OwnKind, RunsAndWritesWhatItSaysItWrites) {
  const TestFolder folder, of_fan;
  const auto survey = open_survey(scene_with("kind = \"turning\"\n"));
  EXPECT_THAT(files_left_out(*survey), ElementsAre("no scan.kml is written: add [georeference]"));
  EXPECT_THAT(run_into(folder, *survey), testing::Contains(std::filesystem::path("sonar-scan.csv")));
  run_into(of_fan, *open_survey(scene_with(R"(kind = "imaging"
frequency_khz = 675
beams = 12
horizontal_deg = 12
vertical_deg = 20
samples = 100
range_min_m = 1
range_max_m = 8
)")));
  const Echoes scan = read_echoes(folder / "echoes.nc"), fan = read_echoes(of_fan / "echoes.nc");
  ASSERT_EQ(scan.pings, 2u);
  ASSERT_EQ(scan.beams, 12u);
  EXPECT_GT(scan.total(), 0);
  EXPECT_LT(largest_relative_difference(scan, fan), 1e-9);
  EXPECT_THAT(read_echo_file(folder / "echoes.nc").sensors.front().name, "sonar");

  std::ifstream csv(folder / "sonar-scan.csv");
  const std::string text{std::istreambuf_iterator<char>(csv), {}};
  EXPECT_THAT(text, HasSubstr(fmt::format("\n1,11,{}\n", scan.beam_total(1, 11))));

  const ViewData view = gather_view(Transmissions(*survey, request_of(survey->scene.description.run)), 0,
                                    PingRange{0, 0}, true);
  EXPECT_EQ(view.kind, "turning");
  EXPECT_EQ(view.layout, PictureLayout::fan);
  EXPECT_GT(view.footprints.size(), 0u);
}

}  // namespace
}  // namespace tubefoot
