// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/echo_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace tubefoot {

std::size_t Echoes::sample_at(double range_m) const {
  for (std::size_t k = 0; k < samples; ++k)
    if (first_m(k) <= range_m && range_m < last_m(k)) return k;
  throw std::out_of_range("no sample at " + std::to_string(range_m) + " m");
}

double Echoes::beam_total(std::size_t ping, std::size_t beam) const {
  const auto first = energy.begin() + static_cast<std::ptrdiff_t>((ping * beams + beam) * samples);
  return std::accumulate(first, first + static_cast<std::ptrdiff_t>(samples), 0.0);
}

double Echoes::total() const { return std::accumulate(energy.begin(), energy.end(), 0.0); }

Echoes read_echoes(const std::filesystem::path& file, const std::string& sensor) {
  EchoContents contents = read_echo_file(file);
  for (SensorEchoes& echoes : contents.sensors)
    if (sensor.empty() || echoes.name == sensor) return {std::move(echoes)};
  throw std::runtime_error(file.string() + " has no sensor " + sensor);
}

Echoes echoes_in(const TestFolder& folder, const std::string& scene,
                 const std::vector<std::string>& arguments, const std::string& sensor) {
  const auto file = folder.write("scene.toml", scene);
  std::vector<std::string> words{"run", file.string(), "-o", (folder / "results").string(), "--quiet"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const Outcome outcome = run_program(words);
  if (outcome.exit_code != 0)
    throw std::runtime_error("exit code " + std::to_string(outcome.exit_code) + ", signal " +
                             std::to_string(outcome.signal) + ": " + outcome.err);
  return read_echoes(folder / "results" / "echoes.nc", sensor);
}

Echoes echoes_of(const std::string& scene, const std::vector<std::string>& arguments,
                 const std::string& sensor) {
  const TestFolder folder;
  return echoes_in(folder, scene, arguments, sensor);
}

double largest_relative_difference(const Echoes& a, const Echoes& b) {
  if (a.pings != b.pings || a.beams != b.beams || a.samples != b.samples)
    return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t k = 0; k < a.energy.size(); ++k)
    if (a.energy[k] != b.energy[k])
      worst = std::max(worst, std::abs(a.energy[k] - b.energy[k]) /
                                  std::max(std::abs(a.energy[k]), std::abs(b.energy[k])));
  return worst;
}

}  // namespace tubefoot
