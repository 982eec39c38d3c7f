// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// Writes compressed arrays into a page; data.js reads them. Each array is in a script element that
/// browsers do not execute. The steps are differences of neighbours, bytes of equal weight grouped
/// together, deflate, and base64.
class PackedArrays {
 public:
  explicit PackedArrays(std::string& html) : html_(html) {}

  /// Adds numbers that are often close to the number `stride` places before.
  void add(const char* name, std::vector<std::uint32_t> values, std::size_t stride = 1);
  void add(const char* name, const std::vector<std::uint16_t>& values);
  /// Adds floats with so many fractional bits of the significand. The relative error is at most half of
  /// 2^-bits.
  void add(const char* name, std::vector<float> values, int bits);
  /// Adds positions in metres relative to `from`, in integer steps of `unit_m`.
  void add_places(const char* name, const std::vector<glm::dvec3>& places, glm::dvec3 from, double unit_m);

 private:
  void write(const char* name, const char* type, const char* bytes, std::size_t count, std::size_t size,
             std::size_t stride, double unit);
  std::string& html_;
};

}  // namespace tubefoot
