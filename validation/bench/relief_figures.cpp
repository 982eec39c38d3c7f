// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief_figures.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "survey_figures.hpp"

namespace tubefoot {

void relief_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const std::filesystem::path scenes = TUBEFOOT_SCENES;
  const nlohmann::json patch = stats_of_run(scenes / "sand/patch.toml"),
                       ripples = stats_of_run(scenes / "sand/ripples.toml");
  figure("relief_frames_per_s",
         patch.at("pings").get<double>() / patch.at("seconds").at("simulation").get<double>());
  figure("relief_peak_mb", patch.at("peak_memory_mb").get<double>());
  const nlohmann::json& relief = ripples.at("relief");
  figure("relief_saving", relief.at("uniform_facets").get<double>() * ripples.at("pings").get<double>() /
                              relief.at("facets_made").get<double>());
}

}  // namespace tubefoot
