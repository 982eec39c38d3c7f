// SPDX-License-Identifier: GPL-3.0-or-later
#include "viewer/packed_array.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <stdexcept>

#include "files/base64.hpp"

namespace tubefoot {
namespace {

static_assert(std::endian::native == std::endian::little,
              "pages contain little-endian numbers, like browsers");

/// Replaces each value by its difference from the value `stride` places before, modulo 2^32.
void take_differences(std::vector<std::uint32_t>& values, std::size_t stride) {
  for (std::size_t k = values.size(); k-- > stride;) values[k] -= values[k - stride];
}

/// Rounds to the nearest float whose significand has so many fractional bits.
float rounded(float value, int bits) {
  constexpr int all = 23;
  if (bits >= all || !std::isfinite(value)) return value;
  const std::uint32_t unit = 1u << (all - bits);
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(value) + unit / 2) & ~(unit - 1));
}

std::string deflated(const std::string& bytes) {
  uLongf length = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(length, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &length,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                Z_DEFAULT_COMPRESSION) != Z_OK)
    throw std::runtime_error("cannot compress the data of the page: not enough memory");
  packed.resize(length);
  return packed;
}

}  // namespace

void PackedArrays::write(const char* name, const char* type, const char* bytes, std::size_t count,
                         std::size_t size, std::size_t stride, double unit) {
  std::string planes(count * size, '\0');
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t b = 0; b < size; ++b) planes[b * count + k] = bytes[k * size + b];
  html_ += fmt::format(
      "<script type=\"text/plain\" class=\"array\" data-name=\"{}\" data-type=\"{}\" data-stride=\"{}\" "
      "data-unit=\"{:.17g}\">",
      name, type, stride, unit);
  html_ += base64(deflated(planes));
  html_ += "</script>\n";
}

void PackedArrays::add(const char* name, std::vector<std::uint32_t> values, std::size_t stride) {
  take_differences(values, stride);
  write(name, "Uint32Array", reinterpret_cast<const char*>(values.data()), values.size(), 4, stride, 0);
}

void PackedArrays::add(const char* name, const std::vector<std::uint16_t>& values) {
  write(name, "Uint16Array", reinterpret_cast<const char*>(values.data()), values.size(), 2, 0, 0);
}

void PackedArrays::add(const char* name, std::vector<float> values, int bits) {
  for (float& value : values) value = rounded(value, bits);
  write(name, "Float32Array", reinterpret_cast<const char*>(values.data()), values.size(), 4, 0, 0);
}

void PackedArrays::add_places(const char* name, const std::vector<glm::dvec3>& places, glm::dvec3 from,
                              double unit_m) {
  std::vector<std::uint32_t> steps;
  steps.reserve(3 * places.size());
  for (const glm::dvec3& place : places)
    for (int k = 0; k < 3; ++k)
      steps.push_back(
          static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround((place[k] - from[k]) / unit_m))));
  take_differences(steps, 3);
  write(name, "Int32Array", reinterpret_cast<const char*>(steps.data()), steps.size(), 4, 3, unit_m);
}

}  // namespace tubefoot
