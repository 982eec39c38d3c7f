// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <stdexcept>

#include "sensors/pictures/camera_picture.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/image_file.hpp"
#include "sensors/pictures/scanline_picture.hpp"
#include "sensors/pictures/waterfall_picture.hpp"
#include "sensors/recordings/recording.hpp"

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
  const auto samples = static_cast<std::size_t>(recording.sensor->samples().count);
  ScanlinePicture picture(
      file, static_cast<int>(2 * samples), static_cast<int>(recording.pings()),
      exr_spec(
          exr_attributes(recording, "pings, the first on top",
                         "port samples, the farthest first, then starboard samples, the nearest first")));
  std::vector<float> row(2 * samples);
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    const std::span<const double> energy = recording.energy_of(ping);
    for (std::size_t k = 0; k < samples; ++k) {
      row[samples - 1 - k] = static_cast<float>(energy[k]);
      row[samples + k] = static_cast<float>(energy[samples + k]);
    }
    picture.add_row(row.data());
    recording.let_go(ping);
  }
  picture.finish();
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
                                     std::vector<std::string>* warnings, const Heard* heard) {
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
    if (heard) {
      files.push_back(stem + "-received.png");
      draw_waterfall(recording, font, heard).write_png(folder / files.back(), stem);
    }
    return files;
  }
  const auto* camera = std::get_if<DidsonDescription>(&recording.sensor->description().kind);
  const bool sequence_alone = camera && camera->pictures == "sequence";
  if (recording.pings() > 1 || sequence_alone) {
    files.push_back(stem + "-sequence.png");
    draw_camera_sequence(recording, font).write_png(folder / files.back(), stem);
    if (heard) {
      files.push_back(stem + "-sequence-received.png");
      draw_camera_sequence(recording, font, heard).write_png(folder / files.back(), stem);
    }
  }
  if (sequence_alone) return files;
  const auto name = [&](std::size_t ping, const char* type) {
    return fs::path(fmt::format("{}-{:04}.{}", stem, ping, type));
  };
  const auto received_name = [&](std::size_t ping) {
    return fs::path(fmt::format("{}-{:04}-received.png", stem, ping));
  };
  tbb::parallel_for(std::size_t{0}, recording.pings(), [&](std::size_t ping) {
    draw_camera_frame(recording, ping, font)
        .write_png(folder / name(ping, "png"), fmt::format("{}, ping {}", stem, ping));
    if (heard)
      draw_camera_frame(recording, ping, font, heard)
          .write_png(folder / received_name(ping), fmt::format("{}, ping {}, as received", stem, ping));
    write_camera_exr(folder / name(ping, "exr"), recording, ping);
    recording.let_go(ping);
  });
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    files.insert(files.end(), {name(ping, "png"), name(ping, "exr")});
    if (heard) files.push_back(received_name(ping));
  }
  return files;
}

}  // namespace tubefoot
