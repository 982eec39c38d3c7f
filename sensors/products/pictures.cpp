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

std::vector<std::string> fan_picture_products() {
  return {"sequence.png",          "sequence.gif",          "png",         "exr",
          "sequence-received.png", "sequence-received.gif", "received.png"};
}
std::vector<std::string> two_sided_picture_products() { return {"png", "exr", "received.png"}; }

std::vector<fs::path> write_two_sided_pictures(const fs::path& folder, const Recording& recording,
                                               const std::optional<ReceiverOutput>& receiver_output,
                                               const PictureSettings& settings,
                                               std::vector<std::string>& warnings,
                                               const OmittedProducts& omitted) {
  check(recording);
  if (!settings.wants(PictureSettings::Which::sequence)) return {};
  const bool ideal = !omitted.contains("png"),
             as_received = receiver_output && !omitted.contains("received.png");
  const std::string stem = stem_of(*recording.sensor);
  std::vector<fs::path> files;
  const auto new_file = [&](const std::string& ending) {
    files.emplace_back(stem + ending);
    return folder / files.back();
  };
  std::optional<Waterfall> waterfall;
  if (ideal || as_received) waterfall.emplace(recording, font_for(stem, warnings));
  if (ideal) waterfall->draw().write_png(new_file(".png"), stem, settings.bits);
  if (!omitted.contains("exr")) write_two_sided_exr(new_file(".exr"), recording);
  if (as_received)
    waterfall->draw(&*receiver_output).write_png(new_file("-received.png"), stem, settings.bits);
  return files;
}

std::vector<fs::path> write_fan_pictures(const fs::path& folder, const Recording& recording,
                                         const std::optional<ReceiverOutput>& receiver_output,
                                         const PictureSettings& settings, PictureSettings::Which otherwise,
                                         std::vector<std::string>& warnings, const OmittedProducts& omitted) {
  check(recording);
  using Which = PictureSettings::Which;
  if (!settings.wants(Which::sequence, otherwise)) return {};
  const bool each_ping = settings.wants(Which::all, otherwise);
  const std::string stem = stem_of(*recording.sensor);
  std::vector<fs::path> files;
  std::optional<std::string> found_font;
  const auto font = [&]() -> const std::string& {
    if (!found_font) found_font = font_for(stem, warnings);
    return *found_font;
  };
  std::optional<CameraSequence> sequence;
  std::optional<CameraAnimation> animated;
  const auto write_sequence = [&](const std::string& product, const ReceiverOutput* as_received) {
    const std::string picture = product + ".png", animation = product + ".gif";
    if ((recording.pings() > 1 || !each_ping) && !omitted.contains(picture)) {
      files.emplace_back(stem + "-" + picture);
      if (!sequence) sequence.emplace(recording, font());
      sequence->draw(as_received).write_png(folder / files.back(), stem, settings.bits);
    }
    if (!settings.animated || recording.pings() == 1 || omitted.contains(animation)) return;
    files.emplace_back(stem + "-" + animation);
    if (!animated) animated.emplace(recording, font());
    animated->write(folder / files.back(), as_received);
  };
  write_sequence("sequence", nullptr);
  if (receiver_output) write_sequence("sequence-received", &*receiver_output);
  const bool ideal = !omitted.contains("png"), exr = !omitted.contains("exr"),
             as_received = receiver_output && !omitted.contains("received.png");
  if (!each_ping || !(ideal || exr || as_received)) return files;
  const auto name = [&](std::size_t ping, const char* ending) {
    return fs::path(fmt::format("{}-{:04}{}", stem, recording.number_of(ping), ending));
  };
  std::optional<CameraFrames> frames;
  if (ideal || as_received) frames.emplace(recording, font());
  Steps steps("pictures", recording.pings());
  tbb::parallel_for(std::size_t{0}, recording.pings(), [&](std::size_t ping) {
    const std::string what = fmt::format("{}, ping {}", stem, recording.number_of(ping));
    if (ideal) frames->draw(ping).write_png(folder / name(ping, ".png"), what, settings.bits);
    if (as_received)
      frames->draw(ping, &*receiver_output)
          .write_png(folder / name(ping, "-received.png"), what + ", as received", settings.bits);
    if (exr) write_fan_exr(folder / name(ping, ".exr"), recording, ping);
    steps.done();
  });
  for (std::size_t ping = 0; ping < recording.pings(); ++ping) {
    if (ideal) files.push_back(name(ping, ".png"));
    if (exr) files.push_back(name(ping, ".exr"));
    if (as_received) files.push_back(name(ping, "-received.png"));
  }
  return files;
}

WritingCost cost_of_fan_pictures(const Recording& recording, bool receiver_output,
                                 const PictureSettings& settings, PictureSettings::Which otherwise,
                                 const OmittedProducts& omitted) {
  using Which = PictureSettings::Which;
  constexpr double sheet_s = 0.25, animation_frame_s = 0.06, first_frame_s = 0.25, frame_s = 0.05,
                   picture_bytes = 6e5, gif_bytes = 1e5;
  const auto looks = [&](const char* ideal, const char* received) {
    return (omitted.contains(ideal) ? 0.0 : 1.0) +
           (!receiver_output || omitted.contains(received) ? 0.0 : 1.0);
  };
  const double pings = static_cast<double>(recording.pings());
  WritingCost cost;
  if (!settings.wants(Which::sequence, otherwise)) return cost;
  const double sheets = looks("sequence.png", "sequence-received.png");
  cost += {sheets * sheet_s, 0, sheets * picture_bytes};
  const double frames = looks("sequence.gif", "sequence-received.gif") *
                        static_cast<double>(animation_frames(recording.pings()).size());
  if (settings.animated) cost += {0, frames * animation_frame_s, frames * gif_bytes};
  const double pictures = looks("png", "received.png");
  if (settings.wants(Which::all, otherwise)) {
    cost += {pictures > 0 ? first_frame_s : 0, pictures * frame_s * pings, pings * pictures * picture_bytes};
    if (!omitted.contains("exr")) cost += {0, 0, 4.0 * pings * static_cast<double>(recording.cells())};
  }
  return cost;
}

WritingCost cost_of_two_sided_pictures(const Recording& recording, bool receiver_output,
                                       const PictureSettings& settings, const OmittedProducts& omitted) {
  constexpr double waterfall_s = 0.25, waterfall_bytes = 1e6, exr_cell_s = 6e-8;
  if (!settings.wants(PictureSettings::Which::sequence)) return {};
  const double looks =
      (omitted.contains("png") ? 0 : 1) + (receiver_output && !omitted.contains("received.png") ? 1 : 0);
  WritingCost cost;
  if (!omitted.contains("exr")) cost += cost_by_cells(recording, exr_cell_s, 4);
  cost += {looks * waterfall_s, 0, looks * waterfall_bytes};
  return cost;
}

}  // namespace tubefoot
