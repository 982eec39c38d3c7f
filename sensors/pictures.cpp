// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <stdexcept>

#include "sensors/camera_picture.hpp"
#include "sensors/canvas.hpp"
#include "sensors/recording.hpp"
#include "sensors/waterfall_picture.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// What an EXR says about itself: where its rows and columns lie.
OIIO::ParamValueList exr_attributes(const Recording& recording, const char* rows, const char* columns) {
  const Sensor& sensor = *recording.sensor;
  OIIO::ParamValueList attributes;
  attributes.attribute("sensor", sensor.description().name);
  attributes.attribute("quantity", "echo energy [J] for a source of 1 J/sr at 1 m");
  attributes.attribute("rows", rows);
  attributes.attribute("columns", columns);
  const auto number = [&](const char* name, double value) {
    attributes.attribute(name, OIIO::TypeDesc::DOUBLE, 1, &value);
  };
  number("frequency_khz", sensor.frequency_khz());
  number("sound_speed_m_s", recording.sound_speed_m_s);
  number("slant_range_first_m", sensor.samples().first_m);
  number("slant_range_step_m", sensor.samples().step_m);
  return attributes;
}

void write_camera_exr(const fs::path& file, const Recording& recording, std::size_t ping) {
  const auto beams = recording.sensor->beams().size();
  const auto samples = static_cast<std::size_t>(recording.sensor->samples().count);
  const std::span<const double> energy = recording.energy_of(ping);
  std::vector<float> values(beams * samples);
  for (std::size_t beam = 0; beam < beams; ++beam)
    for (std::size_t sample = 0; sample < samples; ++sample)
      values[sample * beams + beam] = static_cast<float>(energy[beam * samples + sample]);
  auto attributes =
      exr_attributes(recording, "range samples, the nearest first", "beams, from port to starboard");
  attributes.attribute("ping", static_cast<int>(ping));
  attributes.attribute("ping_time_s", OIIO::TypeDesc::DOUBLE, 1, &recording.ping_time_s[ping]);
  write_exr(file, static_cast<int>(beams), static_cast<int>(samples), values, attributes);
}

void write_sidescan_exr(const fs::path& file, const Recording& recording) {
  const auto pings = recording.ping_time_s.size();
  const auto samples = static_cast<std::size_t>(recording.sensor->samples().count);
  std::vector<float> values;
  values.reserve(pings * 2 * samples);
  for (std::size_t ping = 0; ping < pings; ++ping) {
    const std::span<const double> port = recording.energy_of(ping);
    for (std::size_t k = samples; k-- > 0;) values.push_back(static_cast<float>(port[k]));
    for (std::size_t k = 0; k < samples; ++k) values.push_back(static_cast<float>(port[samples + k]));
  }
  write_exr(file, static_cast<int>(2 * samples), static_cast<int>(pings), values,
            exr_attributes(recording, "pings, the first on top",
                           "port samples, the farthest first, then starboard samples, the nearest first"));
}

/// A sensor's name becomes a file name: it must not lead elsewhere.
std::string stem_of(const Sensor& sensor) {
  const std::string& name = sensor.description().name;
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
    throw std::runtime_error(fmt::format("sensor name '{}' cannot be the name of a picture file", name));
  return name;
}

}  // namespace

std::vector<fs::path> write_pictures(const fs::path& folder, const Recording& recording,
                                     std::vector<std::string>* warnings) {
  check(recording);
  const std::string stem = stem_of(*recording.sensor);
  const std::string& font = label_font();
  if (font.empty() && warnings)
    warnings->push_back(fmt::format(
        "the pictures of '{}' have no labels: no font was found (on Debian, install fonts-dejavu-core)",
        stem));

  std::vector<fs::path> files;
  const auto& kind = recording.sensor->description().kind;
  if (std::holds_alternative<SidescanDescription>(kind) ||
      std::holds_alternative<InterferometricDescription>(kind)) {
    files = {stem + ".png", stem + ".exr"};
    draw_waterfall(recording, font).write_png(folder / files[0], stem);
    write_sidescan_exr(folder / files[1], recording);
    return files;
  }
  for (std::size_t ping = 0; ping < recording.ping_time_s.size(); ++ping) {
    const fs::path png = fmt::format("{}-{:04}.png", stem, ping),
                   exr = fmt::format("{}-{:04}.exr", stem, ping);
    draw_camera_frame(recording, ping, font).write_png(folder / png, fmt::format("{}, ping {}", stem, ping));
    write_camera_exr(folder / exr, recording, ping);
    files.insert(files.end(), {png, exr});
  }
  return files;
}

}  // namespace tubefoot
