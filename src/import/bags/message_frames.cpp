// SPDX-License-Identifier: GPL-3.0-or-later
// Converts messages of sonars and simulators to frames: ProjectedSonarImage, RawSonarImage, Image and
// ImagingSonar. It checks sizes and derives ranges and azimuths from the fields of a message.
#include "import/bags/message_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "files/limits.hpp"
#include "files/shown.hpp"
#include "import/bags/elements.hpp"
#include "import/bags/message_error.hpp"

namespace tubefoot {
namespace {

std::optional<double> seconds(const ros::Time& time) {
  if (time.sec == 0 && time.nanosec == 0) return std::nullopt;
  return time.sec + 1e-9 * time.nanosec;
}

void check_cells(std::uint64_t cells) {
  if (cells == 0) throw MessageError("has no samples");
  if (cells > static_cast<std::uint64_t>(limits::ping_cells))
    throw MessageError(fmt::format("has {} samples, but a ping has at most {}", cells, limits::ping_cells));
}

void note_what_is_no_number(const ForeignFrame& frame, Notices& notices) {
  const auto odd = std::ranges::count_if(frame.values, [](double value) { return !std::isfinite(value); });
  if (odd > 0)
    notices.add("numbers", fmt::format("{} of {} values are not finite", odd, frame.values.size()));
}

template <class T>
void require_finite(const std::vector<T>& list, std::string_view name) {
  for (std::size_t k = 0; k < list.size(); ++k)
    if (!std::isfinite(list[k]))
      throw MessageError(fmt::format("{}: entry {} is {}, which is not a finite number", name, k, list[k]));
}

/// Numbers of beams and of samples per beam in SonarImageData.
struct Samples {
  std::size_t beams = 0, each = 0;
};

Samples read_samples(const ros::SonarImageData& image, std::uint64_t said_each, std::string_view who_said,
                     ForeignFrame& frame) {
  if (image.dtype >= element_types)
    throw MessageError(fmt::format("image.dtype is {}, expected 0 (uint8) to 9 (float64)", image.dtype));
  const auto type = static_cast<ElementType>(image.dtype);
  const std::size_t size = bytes_of(type);
  if (image.beam_count == 0) throw MessageError("image.beam_count is 0: the message has no picture");
  const std::uint64_t row = std::uint64_t{image.beam_count} * size;
  if (image.data.size() % row != 0)
    throw MessageError(
        fmt::format("image.data has {} bytes, which cannot be divided into the same number of {} values for "
                    "each of {} beams",
                    image.data.size(), name_of(type), image.beam_count));
  const Samples samples{image.beam_count, static_cast<std::size_t>(image.data.size() / row)};
  if (said_each != 0 && samples.each != said_each)
    throw MessageError(fmt::format("image.data has {} samples for each of {} beams, but {} is {}",
                                   samples.each, samples.beams, who_said, said_each));
  check_cells(std::uint64_t{samples.beams} * samples.each);
  append_elements(type, image.is_bigendian, image.data, frame.values);
  frame.eight_bits = type == ElementType::u8;
  return samples;
}

/// Reads beam directions. According to the message definition Z is forward and X up, so that Y is to
/// starboard, and beams lie on the Y-Z plane. Directions on the X-Y plane follow another convention.
void read_directions(const std::vector<ros::Vector3>& directions, bool forward_is_x, ForeignFrame& frame,
                     Notices& notices) {
  double steepest = 0;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const auto [x, y, z] = directions[k];
    const double length = std::hypot(x, y, z);
    if (!std::isfinite(length) || length == 0)
      throw MessageError(
          fmt::format("beam_directions: entry {} is ({}, {}, {}), which is not a direction", k, x, y, z));
    frame.azimuth_rad.push_back(std::atan2(y, forward_is_x ? x : z));
    if (!forward_is_x) steepest = std::max(steepest, std::abs(std::asin(std::clamp(x / length, -1.0, 1.0))));
  }
  constexpr double rounding = 1e-6;
  if (steepest > rounding)
    notices.add("elevation",
                fmt::format("beam directions deviate from the plane of the fan by up to {:.3g} degrees: the "
                            "azimuths are those of their projections onto the plane",
                            steepest * 180 / M_PI));
}

ForeignFrame frame_of_message(const ros::ProjectedSonarImage& message, Notices& notices) {
  ForeignFrame frame;
  require_finite(message.ranges, "ranges");
  const Samples samples = read_samples(message.image, message.ranges.size(), "the number of ranges", frame);
  const auto& directions = message.beam_directions;
  if (!directions.empty() && directions.size() != samples.beams)
    throw MessageError(fmt::format("beam_directions has {} entries, but image.beam_count is {}",
                                   directions.size(), samples.beams));
  const bool flat = !directions.empty() &&
                    std::ranges::all_of(directions, [](const auto& d) { return d.z == 0; }) &&
                    std::ranges::any_of(directions, [](const auto& d) { return d.x != 0; });
  read_directions(directions, flat, frame, notices);
  if (flat)
    notices.add(
        "flat",
        "all beam directions have z = 0, but the message's own convention is Z forward and Y starboard. They "
        "are read as DAVE writes them: azimuth = atan2(y, x), and rows are samples and columns are beams, "
        "contrary to the convention. DAVE may write its columns in the reverse order of its directions and "
        "does not define the positive side: test whether the picture is mirrored");
  else
    notices.add(
        "rows",
        "rows are beams and columns are samples, as the message defines; azimuths are positive to starboard");
  frame.rows = flat ? samples.each : samples.beams;
  frame.columns = flat ? samples.beams : samples.each;
  frame.range_m.assign(message.ranges.begin(), message.ranges.end());
  if (message.ranges.empty()) notices.add("ranges", "the messages have no ranges: give them with --ranges");
  if (directions.empty())
    notices.add("azimuths", "the messages have no beam directions: give the azimuths with --azimuths");
  frame.time_s = seconds(message.header.stamp);
  return frame;
}

ForeignFrame frame_of_message(const ros::RawSonarImage& message, Notices& notices) {
  ForeignFrame frame;
  const Samples samples = read_samples(message.image, message.samples_per_beam, "samples_per_beam", frame);
  frame.rows = samples.beams;
  frame.columns = samples.each;
  const double speed = message.ping_info.sound_speed, rate = message.sample_rate;
  if (speed > 0 && rate > 0 && std::isfinite(speed) && std::isfinite(rate)) {
    for (std::size_t k = 0; k < samples.each; ++k)
      frame.range_m.push_back((static_cast<double>(k) + message.sample0) * speed / (2 * rate));
    notices.add("ranges",
                fmt::format("ranges are (sample + {}) x {} m/s / (2 x {} Hz), as the message defines; the "
                            "definition does not say whether this is the edge or the centre of a bin",
                            message.sample0, speed, rate));
  } else {
    notices.add("ranges", "sound_speed or sample_rate is 0 in the messages: give the ranges with --ranges");
  }
  const auto& angles = message.rx_angles;
  require_finite(angles, "rx_angles");
  if (!angles.empty() && angles.size() != samples.beams)
    throw MessageError(
        fmt::format("rx_angles has {} entries, but image.beam_count is {}", angles.size(), samples.beams));
  frame.azimuth_rad.assign(angles.begin(), angles.end());
  notices.add("rows", angles.empty() ? "rows are beams and columns are samples, as the message defines; "
                                       "there are no rx_angles: give the azimuths with --azimuths"
                                     : "rows are beams and columns are samples, as the message defines; "
                                       "azimuths are rx_angles, positive to starboard");
  const auto some = [](const std::vector<float>& list) {
    return std::ranges::any_of(list, [](float value) { return value != 0; });
  };
  if (some(message.tx_angles))
    notices.add(
        "tx_angles",
        "the fan is steered (tx_angles): rx_angles are cone angles, but tubefoot uses them as azimuths");
  if (some(message.tx_delays))
    notices.add("tx_delays",
                "beams were transmitted at different times (tx_delays), but their ranges do not contain "
                "these delays");
  frame.time_s = seconds(message.header.stamp);
  return frame;
}

struct Encoding {
  std::string_view name;
  ElementType type;
  std::size_t channels;
};
/// Encodings of sensor_msgs/image_encodings.hpp that a sonar may use.
constexpr std::array encodings{
    Encoding{"mono8", ElementType::u8, 1},   Encoding{"8UC1", ElementType::u8, 1},
    Encoding{"mono16", ElementType::u16, 1}, Encoding{"16UC1", ElementType::u16, 1},
    Encoding{"16SC1", ElementType::i16, 1},  Encoding{"32SC1", ElementType::i32, 1},
    Encoding{"32FC1", ElementType::f32, 1},  Encoding{"64FC1", ElementType::f64, 1},
    Encoding{"rgb8", ElementType::u8, 3},    Encoding{"bgr8", ElementType::u8, 3},
    Encoding{"8UC3", ElementType::u8, 3},    Encoding{"rgba8", ElementType::u8, 4},
    Encoding{"bgra8", ElementType::u8, 4},   Encoding{"8UC4", ElementType::u8, 4}};

ForeignFrame frame_of_message(const ros::Image& message, Notices& notices) {
  const auto encoding = std::ranges::find(encodings, message.encoding, &Encoding::name);
  if (encoding == encodings.end()) {
    std::string known;
    for (const Encoding& each : encodings) known += (known.empty() ? "" : ", ") + std::string(each.name);
    throw MessageError(
        fmt::format("encoding is '{}', expected one of {}", shown_line(message.encoding), known));
  }
  const std::uint64_t cells = std::uint64_t{message.width} * message.height;
  check_cells(cells);
  const std::uint64_t row = std::uint64_t{message.width} * encoding->channels * bytes_of(encoding->type);
  if (message.step < row)
    throw MessageError(fmt::format("step is {} bytes, but a row of {} pixels of '{}' has {}", message.step,
                                   message.width, encoding->name, row));
  if (message.data.size() != std::uint64_t{message.step} * message.height)
    throw MessageError(fmt::format("data has {} bytes, but {} rows of {} bytes have {}", message.data.size(),
                                   message.height, message.step,
                                   std::uint64_t{message.step} * message.height));
  ForeignFrame frame;
  frame.rows = message.height;
  frame.columns = message.width;
  frame.eight_bits = encoding->type == ElementType::u8;
  frame.values.reserve(cells);
  std::vector<std::uint8_t> grey;
  for (std::size_t y = 0; y < message.height; ++y) {
    auto bytes = std::span(message.data).subspan(y * message.step, row);
    if (encoding->channels > 1) {
      grey.clear();
      for (std::size_t x = 0; x < message.width; ++x) {
        const auto pixel = bytes.subspan(x * encoding->channels, encoding->channels);
        if (pixel[0] != pixel[1] || pixel[1] != pixel[2])
          throw MessageError(
              fmt::format("pixel {} of row {} has a colour ({}, {}, {}): a colour map cannot be inverted; "
                          "record the picture before the colour map is applied",
                          x, y, pixel[0], pixel[1], pixel[2]));
        grey.push_back(pixel[0]);
      }
      bytes = grey;
    }
    append_elements(encoding->type, message.is_bigendian != 0, bytes, frame.values);
  }
  if (encoding->channels > 1)
    notices.add("grey", fmt::format("pixels are '{}', but all of them are grey and are read as grey",
                                    encoding->name));
  notices.add("axes",
              "sensor_msgs/Image has neither ranges nor azimuths: give them with --ranges and --azimuths, "
              "and the meaning of the rows with --order");
  frame.time_s = seconds(message.header.stamp);
  return frame;
}

ForeignFrame frame_of_message(const ros::ImagingSonar& message, Notices&) {
  throw MessageError(fmt::format(
      "HoloOcean's ROS message has two lists (image_azimuth with {} entries, image_range with {}) for {} x "
      "{} bins, but no matrix of intensities, so it does not contain the picture. Save the array that "
      "HoloOcean returns in Python (numpy.save), and import that file",
      message.image_azimuth.size(), message.image_range.size(), message.bins_azimuth, message.bins_range));
}

}  // namespace

void Notices::add(const std::string& kind, const std::string& text) {
  const auto known = std::ranges::find(notices_, kind, &Notice::kind);
  if (known != notices_.end())
    ++known->messages;
  else
    notices_.push_back({kind, text, 1});
}

std::vector<std::string> Notices::told(std::size_t messages) const {
  std::vector<std::string> told;
  for (const Notice& notice : notices_)
    told.push_back(notice.messages == messages
                       ? notice.text
                       : fmt::format("{} (in {} of {} messages)", notice.text, notice.messages, messages));
  return told;
}

ForeignFrame frame_of(const ros::Message& message, Notices& notices) {
  ForeignFrame frame = std::visit([&](const auto& any) { return frame_of_message(any, notices); }, message);
  note_what_is_no_number(frame, notices);
  return frame;
}

}  // namespace tubefoot
