// SPDX-License-Identifier: GPL-3.0-or-later
#include "scaling_figures.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

#include "run/simulation.hpp"
#include "sensors/kinds/kind_imaging.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

/// Returns the text of a file of the scaling study.
std::string text_of(const char* name) {
  std::ifstream file(std::filesystem::path(TUBEFOOT_SCALING) / name);
  if (!file) throw std::runtime_error(fmt::format("cannot read '{}/{}'", TUBEFOOT_SCALING, name));
  return {std::istreambuf_iterator<char>(file), {}};
}

struct PingSeconds {
  double visibility = std::numeric_limits<double>::infinity(), whole = visibility;
};

/// `more`: files that are appended to the scene.
PingSeconds least_seconds(int beams, std::initializer_list<const char*> more) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "tubefoot-bench-scaling.toml";
  std::ofstream text(file);
  text << text_of("fan.toml");
  for (const char* name : more) text << text_of(name);
  text.close();
  SceneDescription scene = read_scene_file(file);
  std::filesystem::remove(file);
  scene.sensors.front().kind.edit<ImagingDescription>().beams = beams;
  const auto survey = open_survey(scene);
  PingSeconds least;
  constexpr int repeats = 5;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    SimulationStats stats;
    simulate(*survey, request_of(survey->scene.description.run), stats);
    least.visibility = std::min(least.visibility, stats.visibility_seconds);
    least.whole = std::min(least.whole, stats.visibility_seconds + stats.echo_seconds);
  }
  return least;
}

}  // namespace

void scaling_figures(const std::function<void(const std::string&, double)>& figure) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PingSeconds single = least_seconds(1, {}), many = least_seconds(1024, {});
  figure("beams_1024_over_1", many.visibility / single.visibility);
  figure("beams_1024_over_1_ping", many.whole / single.whole);
  const PingSeconds none = least_seconds(64, {"wall.toml"}),
                    million = least_seconds(64, {"wall.toml", "unseen.toml"});
  figure("hidden_million_over_none", million.visibility / none.visibility);
}

}  // namespace tubefoot
