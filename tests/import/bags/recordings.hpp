// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

// Writes recordings and messages byte by byte from their specifications (OMG CDR, mcap.dev/spec, the tables
// of rosbag2). It shares no code with the readers.
namespace tubefoot::recordings {

using Bytes = std::string;

/// Plain CDR: numbers at multiples of their size, counted from the end of the four bytes of the
/// encapsulation.
class Cdr {
 public:
  explicit Cdr(bool big_endian = false) : big_(big_endian) {}

  template <class T>
  Cdr& number(T value) {
    while (body_.size() % sizeof(T) != 0) body_ += '\xee';
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof raw);
    if (big_ != (std::endian::native == std::endian::big)) std::reverse(raw, raw + sizeof raw);
    body_.append(raw, sizeof raw);
    return *this;
  }
  Cdr& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    body_ += value;
    body_ += '\0';
    return *this;
  }
  template <class T>
  Cdr& list(const std::vector<T>& values) {
    number(static_cast<std::uint32_t>(values.size()));
    for (const T value : values) number(value);
    return *this;
  }
  Cdr& bytes(const Bytes& values) {
    number(static_cast<std::uint32_t>(values.size()));
    body_ += values;
    return *this;
  }
  /// Offset of the next byte in the whole message.
  std::size_t size() const { return 4 + body_.size(); }
  Bytes done() const { return Bytes{'\0', big_ ? '\0' : '\1', '\0', '\0'} + body_; }

 private:
  bool big_;
  Bytes body_;
};

struct Sonar {
  bool big_endian = false;       ///< byte order of the message
  bool big_endian_data = false;  ///< byte order of image.data
  std::int32_t sec = 100;
  std::uint32_t nanosec = 250'000'000;
  std::string frame_id = "sonar";  ///< its length shifts all later fields
  std::vector<double> directions;  ///< x, y, z of each
  std::vector<float> ranges;
  std::uint32_t dtype = 0, beams = 0;
  Bytes data;
};

/// Fields of marine_acoustic_msgs/msg/ProjectedSonarImage in their order.
inline Bytes projected(const Sonar& sonar) {
  Cdr cdr(sonar.big_endian);
  cdr.number(sonar.sec).number(sonar.nanosec).text(sonar.frame_id);
  cdr.number(900e3f).number(1500.0f).list<float>({0.1f}).list<float>({0.2f, 0.3f});
  cdr.number(static_cast<std::uint32_t>(sonar.directions.size() / 3));
  for (const double each : sonar.directions) cdr.number(each);
  cdr.list(sonar.ranges);
  cdr.number(static_cast<std::uint8_t>(sonar.big_endian_data)).number(sonar.dtype).number(sonar.beams);
  return cdr.bytes(sonar.data).done();
}

/// Beams `spacing` radians apart about forward, in the Y-Z plane, port first (Y is to starboard).
inline std::vector<double> fan(std::size_t beams, double spacing = 0.1) {
  std::vector<double> directions;
  for (std::size_t k = 0; k < beams; ++k) {
    const double azimuth = (static_cast<double>(k) - (static_cast<double>(beams) - 1) / 2) * spacing;
    directions.insert(directions.end(), {0, std::sin(azimuth), std::cos(azimuth)});
  }
  return directions;
}

/// Three beams of four samples; sample s of beam b is 10 b + s.
inline Sonar small_sonar() {
  Sonar sonar;
  sonar.directions = fan(3);
  sonar.ranges = {1.0f, 1.5f, 2.0f, 2.5f};
  sonar.beams = 3;
  for (int b = 0; b < 3; ++b)
    for (int s = 0; s < 4; ++s) sonar.data += static_cast<char>(10 * b + s);
  return sonar;
}

inline Bytes camera_image(std::uint32_t height, std::uint32_t width, const std::string& encoding,
                          std::uint32_t step, const Bytes& data, bool big_endian_data = false,
                          bool big_endian = false) {
  return Cdr(big_endian)
      .number(std::int32_t{7})
      .number(std::uint32_t{500'000'000})
      .text("camera")
      .number(height)
      .number(width)
      .text(encoding)
      .number(static_cast<std::uint8_t>(big_endian_data))
      .number(step)
      .bytes(data)
      .done();
}

template <class T>
Bytes little(T value) {
  Bytes bytes;
  for (std::size_t k = 0; k < sizeof value; ++k)
    bytes += static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * k)) & 0xff);
  return bytes;
}

inline Bytes zstd(const Bytes& bytes) {
  Bytes packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
  return packed;
}

inline Bytes lz4(const Bytes& bytes) {
  Bytes packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

inline std::uint32_t crc(const Bytes& bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

namespace mcap {

inline const Bytes magic("\x89MCAP0\r\n", 8);
inline Bytes text(const Bytes& value) { return little(static_cast<std::uint32_t>(value.size())) + value; }
inline Bytes record(int opcode, const Bytes& content) {
  return Bytes(1, static_cast<char>(opcode)) + little(std::uint64_t{content.size()}) + content;
}
inline Bytes header() { return record(1, text("ros2") + text("test")); }
inline Bytes schema(int id, const Bytes& name, const Bytes& definition = "") {
  return record(3, little(static_cast<std::uint16_t>(id)) + text(name) + text("ros2msg") + text(definition));
}
inline Bytes channel(int id, int schema, const Bytes& topic, const Bytes& encoding = "cdr") {
  return record(4, little(static_cast<std::uint16_t>(id)) + little(static_cast<std::uint16_t>(schema)) +
                       text(topic) + text(encoding) + text(""));
}
inline Bytes message(int channel, std::uint64_t time_ns, const Bytes& data) {
  return record(5, little(static_cast<std::uint16_t>(channel)) + little(std::uint32_t{0}) + little(time_ns) +
                       little(time_ns) + data);
}
/// A chunk of any compression, with the given `crc` and `size`, which need not be correct.
inline Bytes chunk(const Bytes& packed, const Bytes& compression, std::uint64_t size, std::uint32_t crc) {
  return record(6, little(std::uint64_t{0}) + little(std::uint64_t{0}) + little(size) + little(crc) +
                       text(compression) + little(std::uint64_t{packed.size()}) + packed);
}
inline Bytes chunk(const Bytes& records, const Bytes& compression = "") {
  const Bytes packed = compression == "zstd" ? zstd(records) : compression == "lz4" ? lz4(records) : records;
  return chunk(packed, compression, records.size(), crc(records));
}
inline Bytes footer() { return record(2, Bytes(20, '\0')); }
/// A whole file around records of the data section, with the checksum of the data if `checked`.
inline Bytes file(const Bytes& records, bool checked = false) {
  const Bytes data = magic + header() + records;
  return data + record(15, little(checked ? crc(data) : 0u)) + footer() + magic;
}

}  // namespace mcap

inline constexpr const char* projected_type = "marine_acoustic_msgs/msg/ProjectedSonarImage";
inline constexpr const char* raw_type = "marine_acoustic_msgs/msg/RawSonarImage";
inline constexpr const char* image_type = "sensor_msgs/msg/Image";

/// Tables as rosbag2_storage_sqlite3 makes them.
class Database {
 public:
  explicit Database(const std::filesystem::path& file) {
    std::filesystem::remove(file);
    if (sqlite3_open(file.c_str(), &database_) != SQLITE_OK) throw std::runtime_error("no database");
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  Database& run(const std::string& sql) {
    char* error = nullptr;
    if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, &error) != SQLITE_OK)
      throw std::runtime_error(sql + ": " + error);
    return *this;
  }
  Database& tables() {
    run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)");
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT "
        "NULL,serialization_format TEXT "
        "NOT NULL,offered_qos_profiles TEXT NOT NULL)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, "
        "data BLOB "
        "NOT NULL)");
    return run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  }
  Database& topic(int id, const std::string& name, const std::string& type,
                  const std::string& format = "cdr") {
    return run("INSERT INTO topics VALUES (" + std::to_string(id) + ", '" + name + "', '" + type + "', '" +
               format + "', '')");
  }
  Database& message(int topic, std::int64_t time_ns, const Bytes& data) {
    std::string hex;
    for (const char c : data) {
      constexpr char digits[] = "0123456789abcdef";
      hex += digits[static_cast<unsigned char>(c) >> 4];
      hex += digits[static_cast<unsigned char>(c) & 15];
    }
    return run("INSERT INTO messages (topic_id, timestamp, data) VALUES (" + std::to_string(topic) + ", " +
               std::to_string(time_ns) + ", x'" + hex + "')");
  }

 private:
  sqlite3* database_ = nullptr;
};

}  // namespace tubefoot::recordings
