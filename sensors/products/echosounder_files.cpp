// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/echosounder_files.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>

#include "files/checked_file.hpp"
#include "sensors/detection/bottom_detection.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/echogram.hpp"
#include "sensors/pictures/image_file.hpp"
#include "sensors/products/noise_floor.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

DetectionRule rule_of(const EchosounderDescription& sounder) {
  DetectionRule rule;
  rule.method = detection_method_from_name(sounder.detection);
  rule.relative_db = sounder.detection_threshold_db;
  return rule;
}

/// Not a number where nothing was detected.
double range_of(const std::optional<Detection>& bottom) {
  return bottom ? bottom->range_m : std::numeric_limits<double>::quiet_NaN();
}

/// Empty for what is not known.
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : ""; }

void append_line(std::string& text, const Recording& recording, std::size_t ping,
                 const std::optional<Detection>& bottom) {
  const double altitude_m = ping < recording.altitude_m.size() ? recording.altitude_m[ping]
                                                               : std::numeric_limits<double>::quiet_NaN();
  fmt::format_to(std::back_inserter(text), "{},{:.9g},", ping, recording.ping_time_s[ping]);
  if (bottom) {
    const glm::dvec3 place = sounding_position(recording.ping_pose[ping], {0, 0, -1}, bottom->range_m);
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}",
                   bottom->range_m, bottom->range_sigma_m, bottom->energy_j, bottom->quality, place.x,
                   place.y, place.z);
  } else {
    text += ",,,,,,";
  }
  const glm::dvec3 own = recording.ping_pose[ping].position_m;
  fmt::format_to(std::back_inserter(text), ",{:.9g},{:.9g},{:.9g},{},{}\n", own.x, own.y, own.z,
                 cell(altitude_m), bottom ? name_of(bottom->flags) : "none");
}

void write_exr_of(const fs::path& file, const Recording& recording, const std::vector<float>& energies) {
  const RangeSamples& samples = recording.sensor->samples();
  OIIO::ParamValueList attributes;
  attributes.attribute("sensor", recording.sensor->description().name);
  attributes.attribute("quantity", "echo energy [J] for a source of 1 J/sr at 1 m");
  attributes.attribute("rows", "pings, the first on top");
  attributes.attribute("columns", "range samples, the nearest first");
  attributes.attribute("slant_range_first_m", OIIO::TypeDesc::DOUBLE, 1, &samples.first_m);
  attributes.attribute("slant_range_step_m", OIIO::TypeDesc::DOUBLE, 1, &samples.step_m);
  write_exr(file, samples.count, static_cast<int>(recording.pings()), energies, attributes);
}

}  // namespace

std::vector<fs::path> write_echosounder_files(const fs::path& folder, const Recording& recording,
                                              const RunContext& run, std::vector<std::string>& warnings) {
  check(recording);
  const Sensor& sensor = *recording.sensor;
  const std::string stem = sensor.description().name;
  const DetectionRule rule = rule_of(std::get<EchosounderDescription>(sensor.description().kind));
  const std::optional<Heard> heard = heard_by(recording, run);
  const std::vector<double> floor_j = noise_floor_j(recording, run);
  std::vector<float> energies, received;
  std::vector<double> bottoms, ideal_bottoms;
  std::string csv =
      "ping,time_s,range_m,range_sigma_m,energy_j,quality,bottom_east_m,bottom_north_m,bottom_up_m,"
      "sensor_east_m,sensor_north_m,sensor_up_m,true_altitude_m,status\n";
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    const std::span<const double> energy = recording.energy_of(ping);
    energies.insert(energies.end(), energy.begin(), energy.end());
    const std::optional<Detection> ideal = detect_bottom(energy, sensor.samples(), rule);
    ideal_bottoms.push_back(range_of(ideal));
    const std::vector<double> own =
        heard ? heard->energy_of(ping) : std::vector<double>(energy.begin(), energy.end());
    received.insert(received.end(), own.begin(), own.end());
    recording.let_go(ping);
    std::vector<double> standing_out = own;
    for (std::size_t k = 0; k < own.size(); ++k)
      if (own[k] < floor_j[k]) standing_out[k] = 0;
    const std::optional<Detection> bottom = detect_bottom(standing_out, sensor.samples(), rule);
    bottoms.push_back(range_of(bottom));
    append_line(csv, recording, ping, bottom);
  }

  const std::string& font = label_font();
  if (font.empty())
    warnings.push_back(fmt::format(
        "the pictures of '{}' have no labels: no font was found (on Debian, install fonts-dejavu-core)",
        stem));
  std::vector<fs::path> files{stem + ".csv", stem + ".png", stem + ".exr"};
  write_file(folder / files[0], csv);
  draw_echogram(recording, energies, ideal_bottoms, font).write_png(folder / files[1], stem);
  write_exr_of(folder / files[2], recording, energies);
  if (heard) {
    files.emplace_back(stem + "-received.png");
    draw_echogram(recording, received, bottoms, font, heard->said).write_png(folder / files.back(), stem);
  }
  return files;
}

}  // namespace tubefoot
