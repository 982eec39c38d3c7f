// SPDX-License-Identifier: GPL-3.0-or-later
#include "refraction_figures.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>

#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
constexpr int refracted_pings = 100;

double seconds_of(const Survey& survey) {
  const auto start = std::chrono::steady_clock::now();
  const RunRequest request = request_of(survey.scene.description.run);
  PingStore store(layout_of(survey, request));
  simulate(survey, request, store, {});
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void refraction_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const fs::path scenes = TUBEFOOT_SCENES;
  SceneDescription description = read_scene_file(scenes / "survey/scene.toml");
  SensorDescription& line = description.sensors.front();
  // Fewer pings over the same track.
  line.ping_interval_s *= static_cast<double>(line.pings.value_or(1)) / refracted_pings;
  line.pings = refracted_pings;
  const auto straight = open_survey(description);
  description.water.profile = "cast";
  description.water.profile_file = scenes / "refraction/cast.csv";
  description.water.refraction_tolerance_db = 0.1;
  const auto refracted = open_survey(description);
  std::array<double, 5> ratios;
  seconds_of(*straight);
  for (double& ratio : ratios) {
    const double even = seconds_of(*straight);
    ratio = seconds_of(*refracted) / even;
  }
  std::ranges::sort(ratios);
  figure("refraction_over_straight", ratios[ratios.size() / 2]);
}

}  // namespace tubefoot
