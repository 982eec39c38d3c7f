// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the pictures of fans and of two-sided sonars: PNG in decibels and EXR with linear energies, for the
// recording and for the receiver's output. Estimates their cost.

#include "sensors/products/pictures.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <stdexcept>

#include "geometry/steps/in_order.hpp"
#include "sensors/pictures/camera_animation.hpp"
#include "sensors/pictures/camera_picture.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/image_file.hpp"
#include "sensors/pictures/scanline_picture.hpp"
#include "sensors/pictures/waterfall_picture.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Attributes of an EXR: the meaning and extent of its rows and columns.
OIIO::ParamValueList exr_attributes(const Recording& recording, const char* rows, const char* columns) {
  const Sensor& sensor = *recording.sensor;
  OIIO::ParamValueList attributes;
  attributes.attribute("sensor", sensor.description().name);
  attributes.attribute("quantity", "received energy density [J/m^2] for a source of 1 J/sr at 1 m");
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

void write_fan_exr(const fs::path& file, const Recording& recording, std::size_t ping) {
  const auto beams = recording.sensor->beams().size();
  const auto samples = static_cast<std::size_t>(recording.sensor->samples().count);
  const PingEnergies energy = recording.energy_of(ping);
  std::vector<float> values(beams * samples);
  for (std::size_t beam = 0; beam < beams; ++beam)
    for (std::size_t sample = 0; sample < samples; ++sample)
      values[sample * beams + beam] = static_cast<float>(energy[beam * samples + sample]);
  auto attributes =
      exr_attributes(recording, "range samples, nearest first", "beams, from port to starboard");
  attributes.attribute("ping", static_cast<int>(recording.number_of(ping)));
  attributes.attribute("ping_time_s", OIIO::TypeDesc::DOUBLE, 1, &recording.ping_time_s[ping]);
  write_exr(file, static_cast<int>(beams), static_cast<int>(samples), values, attributes);
}

void write_two_sided_exr(const fs::path& file, const Recording& recording) {
  const auto samples = static_cast<std::size_t>(recording.sensor->samples().count);
  ScanlinePicture picture(
      file, static_cast<int>(2 * samples), static_cast<int>(recording.pings()),
      exr_spec(exr_attributes(recording, "pings, first ping on top",
                              "port samples, farthest first, then starboard samples, nearest first")));
  const auto row_of = [&](std::size_t ping) {
    const PingEnergies energy = recording.energy_of(ping);
    std::vector<float> row(2 * samples);
    for (std::size_t k = 0; k < samples; ++k) {
      row[samples - 1 - k] = static_cast<float>(energy[k]);
      row[samples + k] = static_cast<float>(energy[samples + k]);
    }
    return row;
  };
  Steps steps("pings of a picture", recording.pings());
  in_order(steps, 0, recording.pings(), sizeof(float) * recording.cells(), row_of,
           [&](std::size_t, const std::vector<float>& row) { picture.add_row(row.data()); });
  picture.finish();
}

/// Checks a sensor's name for use as a file name: it must not lead to another folder.
std::string stem_of(const Sensor& sensor) {
  const std::string& name = sensor.description().name;
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
    throw std::runtime_error(
        fmt::format("the sensor name '{}' cannot be the name of a picture file: rename the sensor", name));
  return name;
}

}  // namespace

const std::string& font_for(const std::string& sensor, std::vector<std::string>& warnings) {
  const std::string& font = label_font();
  if (font.empty())
    warnings.push_back(
        fmt::format("the pictures of '{}' have no labels, because no font was found: on Debian, install "
                    "fonts-dejavu-core",
                    sensor));
  return font;
}

std::vector<fs::path> write_two_sided_pictures(const fs::path& folder, const Recording& recording,
                                               const std::optional<ReceiverOutput>& receiver_output,
                                               const PictureSettings& settings,
                                               std::vector<std::string>& warnings) {
  check(recording);
  if (!settings.wants(PictureSettings::Which::sequence)) return {};
  const std::string stem = stem_of(*recording.sensor);
  const std::string& font = font_for(stem, warnings);
  std::vector<fs::path> files{stem + ".png", stem + ".exr"};
  const Waterfall waterfall(recording, font);
  waterfall.draw().write_png(folder / files[0], stem, settings.bits);
  write_two_sided_exr(folder / files[1], recording);
  if (receiver_output) {
    files.push_back(stem + "-received.png");
    waterfall.draw(&*receiver_output).write_png(folder / files.back(), stem, settings.bits);
  }
  return files;
}

std::vector<fs::path> write_fan_pictures(const fs::path& folder, const Recording& recording,
                                         const std::optional<ReceiverOutput>& receiver_output,
                                         const PictureSettings& settings, PictureSettings::Which otherwise,
                                         std::vector<std::string>& warnings) {
  check(recording);
  using Which = PictureSettings::Which;
  if (!settings.wants(Which::sequence, otherwise)) return {};
  const bool each_ping = settings.wants(Which::all, otherwise);
  const std::string stem = stem_of(*recording.sensor);
  const std::string& font = font_for(stem, warnings);
  std::vector<fs::path> files;
  const auto write_sequence = [&](const std::string& part, const ReceiverOutput* as_received) {
    if (recording.pings() > 1 || !each_ping) {
      files.push_back(stem + part + ".png");
      draw_camera_sequence(recording, font, as_received)
          .write_png(folder / files.back(), stem, settings.bits);
    }
    if (!settings.animated || recording.pings() == 1) return;
    files.push_back(stem + part + ".gif");
    write_camera_animation(folder / files.back(), recording, font, as_received);
  };
  write_sequence("-sequence", nullptr);
  if (receiver_output) write_sequence("-sequence-received", &*receiver_output);
  if (!each_ping) return files;
  const auto name = [&](std::size_t ping, const char* ending) {
    return fs::path(fmt::format("{}-{:04}{}", stem, recording.number_of(ping), ending));
  };
  const CameraFrames frames(recording, font);
  Steps steps("pictures", recording.pings());
  tbb::parallel_for(std::size_t{0}, recording.pings(), [&](std::size_t ping) {
    const std::string what = fmt::format("{}, ping {}", stem, recording.number_of(ping));
    frames.draw(ping).write_png(folder / name(ping, ".png"), what, settings.bits);
    if (receiver_output)
      frames.draw(ping, &*receiver_output)
          .write_png(folder / name(ping, "-received.png"), what + ", as received", settings.bits);
    write_fan_exr(folder / name(ping, ".exr"), recording, ping);
    steps.done();
  });
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    files.insert(files.end(), {name(ping, ".png"), name(ping, ".exr")});
    if (receiver_output) files.push_back(name(ping, "-received.png"));
  }
  return files;
}

WritingCost cost_of_fan_pictures(const Recording& recording, bool receiver_output,
                                 const PictureSettings& settings, PictureSettings::Which otherwise) {
  using Which = PictureSettings::Which;
  constexpr double sheet_s = 0.25, animation_frame_s = 0.4, first_frame_s = 0.25, frame_s = 0.05,
                   picture_bytes = 6e5, gif_bytes = 1e5;
  const double looks = receiver_output ? 2 : 1, pings = static_cast<double>(recording.pings());
  WritingCost cost;
  if (!settings.wants(Which::sequence, otherwise)) return cost;
  cost += {looks * sheet_s, 0, looks * picture_bytes};
  const double frames = static_cast<double>(animation_frames(recording.pings()).size());
  if (settings.animated) cost += {looks * frames * animation_frame_s, 0, looks * frames * gif_bytes};
  if (settings.wants(Which::all, otherwise))
    cost += {first_frame_s, looks * frame_s * pings,
             pings * (looks * picture_bytes + 4.0 * static_cast<double>(recording.cells()))};
  return cost;
}

WritingCost cost_of_two_sided_pictures(const Recording& recording, bool receiver_output,
                                       const PictureSettings& settings) {
  constexpr double waterfall_s = 0.25, waterfall_bytes = 1e6, exr_cell_s = 6e-8;
  if (!settings.wants(PictureSettings::Which::sequence)) return {};
  const double looks = receiver_output ? 2 : 1;
  WritingCost cost = cost_by_cells(recording, exr_cell_s, 4);
  cost += {looks * waterfall_s, 0, looks * waterfall_bytes};
  return cost;
}

}  // namespace tubefoot
