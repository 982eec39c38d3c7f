// SPDX-License-Identifier: GPL-3.0-or-later
#include "multibeam_figures.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>

#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/received.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
constexpr int pings = 120;  // the energies are kept in memory

double seconds_of_a_line(const Survey& survey, const fs::path& folder) {
  fs::remove_all(folder);
  fs::create_directory(folder);
  const auto start = std::chrono::steady_clock::now();
  const RunRequest request = request_of(survey.scene.description.run);
  const auto store = std::make_shared<PingStore>(layout_of(survey, request));
  simulate(survey, request, *store, {});
  const std::vector<Recording> recordings = recordings_of(survey, store);
  const RunContext run{survey.scene.frame, 0, 1, survey.scene.description.water, "benchmark"};
  std::vector<std::string> warnings;
  write_echoes(folder / "echoes.nc", recordings, {"benchmark", "", "tube", "fixed", "", {}});
  for (const Recording& recording : recordings)
    kind_of(recording.sensor->description()).write_products(folder, recording, run, warnings);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Median of three runs of the first pings of a scene, with their files.
double median_seconds(const char* scene) {
  SceneDescription description = read_scene_file(fs::path(TUBEFOOT_SCENES) / scene);
  description.sensors.front().pings = pings;
  const auto survey = open_survey(description);
  const fs::path folder = fs::temp_directory_path() / "tubefoot-bench-multibeam";
  std::array<double, 3> seconds;
  for (double& s : seconds) s = seconds_of_a_line(*survey, folder);
  fs::remove_all(folder);
  std::ranges::sort(seconds);
  return seconds[1];
}

}  // namespace

void multibeam_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  figure("mbes_pings_per_s", pings / median_seconds("multibeam/real-grid.toml"));
  const auto real_time = read_scene_file(fs::path(TUBEFOOT_SCENES) / "multibeam/real-time.toml");
  figure("multibeam_real_time_factor",
         pings * real_time.sensors.front().ping_interval_s / median_seconds("multibeam/real-time.toml"));
}

}  // namespace tubefoot
