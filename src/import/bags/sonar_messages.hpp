// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// The ROS 2 messages of sonars and sonar simulators, and the order of their fields. Only this file defines
// them; CDR, YAML and the check of definitions use the same lists.
namespace tubefoot::ros {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
struct Header {
  Time stamp;
  std::string frame_id;
};
struct Vector3 {
  double x = 0, y = 0, z = 0;
};

struct PingInfo {
  float frequency = 0, sound_speed = 0;
  std::vector<float> tx_beamwidths, rx_beamwidths;
};
struct SonarImageData {
  bool is_bigendian = false;
  std::uint32_t dtype = 0, beam_count = 0;
  std::vector<std::uint8_t> data;
};
struct ProjectedSonarImage {
  static constexpr std::string_view name = "marine_acoustic_msgs/msg/ProjectedSonarImage";
  Header header;
  PingInfo ping_info;
  std::vector<Vector3> beam_directions;
  std::vector<float> ranges;
  SonarImageData image;
};
struct RawSonarImage {
  static constexpr std::string_view name = "marine_acoustic_msgs/msg/RawSonarImage";
  Header header;
  PingInfo ping_info;
  float sample_rate = 0;
  std::uint32_t samples_per_beam = 0, sample0 = 0;
  std::vector<float> tx_delays, tx_angles, rx_angles;
  SonarImageData image;
};
struct Image {
  static constexpr std::string_view name = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;
  std::vector<std::uint8_t> data;
};
/// Message of HoloOcean. It consists of two lists and contains no picture.
struct ImagingSonar {
  static constexpr std::string_view name = "holoocean_interfaces/msg/ImagingSonar";
  std::int64_t timestamp = 0;
  std::int32_t bins_azimuth = 0, bins_range = 0;
  std::vector<float> image_azimuth, image_range;
};

using Message = std::variant<ProjectedSonarImage, RawSonarImage, Image, ImagingSonar>;

// Visits the fields in their order. The function calls `read` with the name and the value of each field.
// For a field with fields of its own, `read` calls fields() again.

template <class Read>
void fields(Read& read, Time& time) {
  read("sec", time.sec);
  read("nanosec", time.nanosec);
}
template <class Read>
void fields(Read& read, Header& header) {
  read("stamp", header.stamp);
  read("frame_id", header.frame_id);
}
template <class Read>
void fields(Read& read, Vector3& vector) {
  read("x", vector.x);
  read("y", vector.y);
  read("z", vector.z);
}
template <class Read>
void fields(Read& read, PingInfo& ping) {
  read("frequency", ping.frequency);
  read("sound_speed", ping.sound_speed);
  read("tx_beamwidths", ping.tx_beamwidths);
  read("rx_beamwidths", ping.rx_beamwidths);
}
template <class Read>
void fields(Read& read, SonarImageData& image) {
  read("is_bigendian", image.is_bigendian);
  read("dtype", image.dtype);
  read("beam_count", image.beam_count);
  read("data", image.data);
}
template <class Read>
void fields(Read& read, ProjectedSonarImage& message) {
  read("header", message.header);
  read("ping_info", message.ping_info);
  read("beam_directions", message.beam_directions);
  read("ranges", message.ranges);
  read("image", message.image);
}
template <class Read>
void fields(Read& read, RawSonarImage& message) {
  read("header", message.header);
  read("ping_info", message.ping_info);
  read("sample_rate", message.sample_rate);
  read("samples_per_beam", message.samples_per_beam);
  read("sample0", message.sample0);
  read("tx_delays", message.tx_delays);
  read("tx_angles", message.tx_angles);
  read("rx_angles", message.rx_angles);
  read("image", message.image);
}
template <class Read>
void fields(Read& read, Image& message) {
  read("header", message.header);
  read("height", message.height);
  read("width", message.width);
  read("encoding", message.encoding);
  read("is_bigendian", message.is_bigendian);
  read("step", message.step);
  read("data", message.data);
}
template <class Read>
void fields(Read& read, ImagingSonar& message) {
  read("timestamp", message.timestamp);
  read("bins_azimuth", message.bins_azimuth);
  read("bins_range", message.bins_range);
  read("image_azimuth", message.image_azimuth);
  read("image_range", message.image_range);
}

template <class T>
inline constexpr bool is_list = false;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;

/// Supported message types, with their names in recordings.
inline constexpr std::array<std::string_view, 4> known_types{ProjectedSonarImage::name, RawSonarImage::name,
                                                             Image::name, ImagingSonar::name};

/// Returns whether a name means a known type; "sensor_msgs/Image" also means "sensor_msgs/msg/Image".
inline bool is_type(std::string_view said, std::string_view known) {
  const std::size_t package = known.find('/');
  return said == known ||
         (said.size() + 4 == known.size() && said.substr(0, package) == known.substr(0, package) &&
          said.substr(package) == known.substr(package + 4));
}

/// Returns an empty message of a type. Throws std::logic_error for an unknown type.
inline Message message_of(std::string_view type) {
  if (is_type(type, ProjectedSonarImage::name)) return ProjectedSonarImage{};
  if (is_type(type, RawSonarImage::name)) return RawSonarImage{};
  if (is_type(type, Image::name)) return Image{};
  if (is_type(type, ImagingSonar::name)) return ImagingSonar{};
  throw std::logic_error("unknown type of message");
}

inline bool is_known_type(std::string_view said) {
  for (const std::string_view known : known_types)
    if (is_type(said, known)) return true;
  return false;
}

}  // namespace tubefoot::ros
