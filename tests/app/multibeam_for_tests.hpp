// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/program.hpp"

// A flat bed under a multibeam, and the soundings that a run writes.
namespace tubefoot::multibeam_for_tests {

inline constexpr double degree = std::numbers::pi / 180;

/// A CSV file by column name, as texts.
inline std::vector<std::map<std::string, std::string>> rows_of(const std::filesystem::path& file) {
  std::istringstream text(bytes_of(file));
  const auto cells_of = [](const std::string& row) {
    std::vector<std::string> cells;
    std::istringstream stream(row);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = cells_of(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(text, line)) {
    const std::vector<std::string> values = cells_of(line);
    if (values.size() != names.size()) throw std::runtime_error("a row of another length: " + line);
    rows.emplace_back();
    for (std::size_t k = 0; k < names.size(); ++k) rows.back()[names[k]] = values[k];
  }
  return rows;
}

struct CsvSounding {
  std::size_t ping, beam;
  double east, north, up, range, angle_deg;
};

inline std::vector<CsvSounding> soundings_in(const std::filesystem::path& file) {
  std::vector<CsvSounding> soundings;
  for (const auto& row : rows_of(file)) {
    const auto number = [&](const char* name) { return std::stod(row.at(name)); };
    soundings.push_back({std::size_t(number("ping")), std::size_t(number("beam")), number("east_m"),
                         number("north_m"), number("up_m"), number("slant_range_m"),
                         number("beam_angle_deg_starboard_positive")});
  }
  return soundings;
}

inline void run(const TestFolder& folder, const std::string& scene) {
  folder.write("scene.toml", scene);
  const Outcome outcome =
      run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string(), "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

inline constexpr double height_m = 20, step_m = 0.05;

inline std::string flat_scene(const std::string& pose) {
  std::string scene = fmt::format(R"(
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 400
length_m = 400
[trajectory]
kind = "fixed"
position_m = [3, -2, {}]
{}
)",
                                  height_m, pose);
  for (const char* detection : {"first_return", "energy_centroid", "maximum"})
    scene += fmt::format(
        "[[sensors]]\nname = \"{0}\"\npreset = \"reson-8101\"\ndetection = \"{0}\"\nrange_min_m = 1\n"
        "range_max_m = 91\nsamples = 1800\n",
        detection);
  return scene;
}

}  // namespace tubefoot::multibeam_for_tests
