// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/scene_truth.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "run/run_steps.hpp"
#include "run/simulation.hpp"

namespace tubefoot {

WholeEchoFile truth_of_scene(SceneDescription description, const std::optional<std::string>& sensor,
                             std::size_t pings, const std::filesystem::path& folder) {
  RunRequest request = requested({}, description);
  request.selection.sensor = sensor;
  const auto survey = open_survey(description, facets_for(request), request.coarseness);
  std::size_t most = 0;
  for (const SensorPings& one : survey->sensors)
    if (!sensor || one.sensor->description().name == *sensor) most = std::max(most, one.poses.size());
  request.selection.pings =
      fmt::format("0:{}", std::clamp<std::size_t>(pings, 1, std::max<std::size_t>(most, 1)) - 1);
  SimulationStats stats;
  const std::vector<Recording> recordings = simulate(*survey, request, stats);
  const std::filesystem::path file = folder / "reference.nc";
  write_echoes(file, recordings, provenance_of(survey->scene, request));
  WholeEchoFile truth = read_whole_echo_file(file);
  std::filesystem::remove(file);
  return truth;
}

}  // namespace tubefoot
