// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "sensors/camera_file_rows.hpp"
#include "sensors/samples.hpp"

// A strict reader of DIDSON and ARIS files that knows nothing of the writers: only the tables of the formats.
namespace tubefoot::camera_file {

/// What a field says: a number, or a text.
struct Value {
  Value() = default;
  Value(std::string told) : text(std::move(told)) {}
  Value(const char* told) : text(told) {}
  template <typename Number>
  requires std::is_arithmetic_v<Number> Value(Number told) : number(static_cast<double>(told)) {}

  double number = 0;
  std::string text;
};
using Fields = std::map<std::string, Value>;

inline std::size_t size_of(const Row& row) {
  switch (row.type) {
    case Type::u16:
      return 2;
    case Type::u64:
    case Type::f64:
      return 8;
    case Type::text:
      return row.size;
    default:
      return 4;
  }
}

/// Rows must tile the record, so that no byte of it goes unlooked at.
inline std::size_t tiled_size(const std::vector<Row>& rows) {
  std::size_t end = 0;
  for (const Row& row : rows) {
    if (row.offset != end) throw std::logic_error("the table has a gap before " + row.name);
    end += size_of(row);
  }
  return end;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : bytes_(samples::bytes_of(file)) {
    const std::uint64_t signature = integer(0, 4);
    aris = signature == 0x05464444;
    if (!aris && signature != 0x03464444) throw std::runtime_error("no DDF_03 or DDF_05 signature");
    file_header_size = aris ? 1024 : 512;
    frame_header_size = aris ? 1024 : 256;
    if (tiled_size(file_rows()) != file_header_size || tiled_size(frame_rows()) != frame_header_size)
      throw std::logic_error("a table does not fill its header");
    const Fields header = file_fields();
    beams = static_cast<std::size_t>(header.at("NumRawBeams").number);
    samples_per_beam = static_cast<std::size_t>(header.at("SamplesPerChannel").number);
    const std::size_t frame_size = frame_header_size + beams * samples_per_beam;
    if (bytes_.size() < file_header_size || (bytes_.size() - file_header_size) % frame_size != 0)
      throw std::runtime_error("the file does not end with a frame");
    frames = (bytes_.size() - file_header_size) / frame_size;
  }

  Fields file_fields() const { return decode(aris ? aris_file_rows : ddf_file_rows, 0); }
  Fields frame_fields(std::size_t frame) const {
    return decode(aris ? aris_frame_rows : ddf_frame_rows, start_of(frame));
  }
  double number(std::size_t frame, const std::string& name) const {
    return frame_fields(frame).at(name).number;
  }
  /// file_beam 0 is the starboard-most.
  std::uint8_t amplitude(std::size_t frame, std::size_t sample, std::size_t file_beam) const {
    return byte(start_of(frame) + frame_header_size + sample * beams + file_beam);
  }
  std::size_t size() const { return bytes_.size(); }

  bool aris = false;
  std::size_t file_header_size = 0, frame_header_size = 0, beams = 0, samples_per_beam = 0, frames = 0;

 private:
  const std::vector<Row>& file_rows() const { return aris ? aris_file_rows : ddf_file_rows; }
  const std::vector<Row>& frame_rows() const { return aris ? aris_frame_rows : ddf_frame_rows; }
  std::size_t start_of(std::size_t frame) const {
    return file_header_size + frame * (frame_header_size + beams * samples_per_beam);
  }
  std::uint8_t byte(std::size_t offset) const { return static_cast<std::uint8_t>(bytes_.at(offset)); }
  std::uint64_t integer(std::size_t offset, std::size_t size) const {
    std::uint64_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = value << 8 | byte(offset + i);
    return value;
  }

  Fields decode(const std::vector<Row>& rows, std::size_t start) const {
    Fields fields;
    for (const Row& row : rows) {
      const std::size_t offset = start + row.offset;
      Value value;
      if (row.type == Type::text) {
        std::string text = bytes_.substr(offset, row.size);
        text.erase(text.find_last_not_of('\0') + 1);  // what follows the zeros, if anything does, is kept
        value = text;
      } else {
        const std::uint64_t raw = integer(offset, size_of(row));
        if (row.type == Type::f32)
          value = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
        else if (row.type == Type::f64)
          value = std::bit_cast<double>(raw);
        else if (row.type == Type::i32)
          value = static_cast<double>(static_cast<std::int32_t>(raw));
        else
          value = static_cast<double>(raw);
      }
      if (!fields.emplace(row.name, value).second) throw std::logic_error("two rows are called " + row.name);
    }
    return fields;
  }

  std::string bytes_;
};

/// All fields must be as told, single-precision ones after rounding; those not told must be 0 or empty.
inline void expect_fields(const Fields& fields, Fields told) {
  for (const auto& [name, value] : fields) {
    const auto wanted = told.extract(name);
    EXPECT_EQ(value.number, wanted ? wanted.mapped().number : 0) << name;
    EXPECT_EQ(value.text, wanted ? wanted.mapped().text : "") << name;
  }
  for (const auto& [name, value] : told) ADD_FAILURE() << "no field " << name;
}

/// As a single-precision field keeps it.
inline double single(double value) { return static_cast<double>(static_cast<float>(value)); }

}  // namespace tubefoot::camera_file
