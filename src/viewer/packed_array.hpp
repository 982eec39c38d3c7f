// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// Writes arrays into a page, each in a script element of its own that no browser runs: differences between
/// neighbours, bytes of equal weight side by side, deflate, base64. data.js reads them.
class PackedArrays {
 public:
  explicit PackedArrays(std::string& html) : html_(html) {}

  /// Numbers that often are near to the one `stride` places before.
  void add(const char* name, std::vector<std::uint32_t> values, std::size_t stride = 1);
  void add(const char* name, const std::vector<std::uint16_t>& values);
  /// Floats of which so many bits after the point are kept: to within half of 2^-bits of each.
  void add(const char* name, std::vector<float> values, int bits);
  /// Places in metres, in whole steps of `unit_m`.
  void add_places(const char* name, const std::vector<glm::dvec3>& places, glm::dvec3 from, double unit_m);

 private:
  void write(const char* name, const char* type, const char* bytes, std::size_t count, std::size_t size,
             std::size_t stride, double unit);
  std::string& html_;
};

}  // namespace tubefoot
