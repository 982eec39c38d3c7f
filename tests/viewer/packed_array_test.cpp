// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the packed numbers of a viewer page. Unpacking by the method of data.js gives all numbers with the
// stated accuracy.
#include "viewer/packed_array.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <random>
#include <regex>

namespace tubefoot {
namespace {

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    held = held << 6 | std::uint32_t(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes += char(held >> (bits -= 8) & 255);
  }
  return bytes;
}

struct Unpacked {
  std::string name, type;
  std::size_t stride = 0;
  double unit = 0;
  std::string bytes;  ///< of one number after another

  template <class T>
  std::vector<T> numbers() const {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    if constexpr (std::is_integral_v<T>)
      for (std::size_t k = stride; stride > 0 && k < values.size(); ++k) values[k] += values[k - stride];
    return values;
  }
};

Unpacked unpacked(const std::string& html) {
  static const std::regex element(
      "<script type=\"text/plain\" class=\"array\" data-name=\"(\\w+)\" data-type=\"(\\w+)\" "
      "data-stride=\"(\\d+)\" data-unit=\"([^\"]+)\">([^<]*)</script>\n");
  std::smatch parts;
  if (!std::regex_match(html, parts, element)) throw std::runtime_error("no array: " + html.substr(0, 200));
  Unpacked array{parts[1], parts[2], std::stoul(parts[3]), std::stod(parts[4]), {}};
  const std::string packed = from_base64(parts[5]);
  std::string planes(1 << 22, '\0');
  uLongf length = planes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(planes.data()), &length,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  const std::size_t size = array.type == "Uint16Array" ? 2 : 4, count = length / size;
  array.bytes.resize(length);
  for (std::size_t b = 0; b < size; ++b)
    for (std::size_t k = 0; k < count; ++k) array.bytes[k * size + b] = planes[b * count + k];
  return array;
}

TEST(PackedArrays, HoldWholeNumbersAsTheyAre) {
  std::mt19937 random(5);
  std::vector<std::uint32_t> large;
  std::vector<std::uint16_t> small;
  for (int k = 0; k < 3000; ++k) {
    large.push_back(static_cast<std::uint32_t>(random()));
    small.push_back(static_cast<std::uint16_t>(random()));
  }
  for (const std::size_t stride : {1, 2, 3}) {
    std::string html;
    PackedArrays(html).add("numbers", large, stride);
    EXPECT_EQ(unpacked(html).name, "numbers");
    EXPECT_EQ(unpacked(html).numbers<std::uint32_t>(), large);
  }
  std::string html;
  PackedArrays(html).add("numbers", small);
  EXPECT_EQ(unpacked(html).numbers<std::uint16_t>(), small);
  html.clear();
  PackedArrays(html).add("none", std::vector<std::uint32_t>());
  EXPECT_TRUE(unpacked(html).numbers<std::uint32_t>().empty());
}

TEST(PackedArrays, RoundNoMoreThanRequested) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> decades(-30, 30);
  std::vector<float> values{0, 1, 0.99999994f, -2.5f, std::numeric_limits<float>::infinity()};
  for (int k = 0; k < 3000; ++k) values.push_back(float(std::pow(10, decades(random))));
  for (const int bits : {16, 20, 23}) {
    std::string html;
    PackedArrays(html).add("floats", values, bits);
    const auto found = unpacked(html).numbers<float>();
    ASSERT_EQ(found.size(), values.size());
    double worst = 0;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (std::isfinite(values[k]) && values[k] != 0)
        worst = std::max(worst, std::abs(double(found[k]) / values[k] - 1));
    EXPECT_LE(worst, std::ldexp(1, -bits - 1));
    if (bits == 23) {
      EXPECT_EQ(found, values);
    }
    EXPECT_EQ(found[0], 0);
    EXPECT_EQ(found[4], values[4]);
  }
}

TEST(PackedArrays, HoldPlacesToHalfAStepAndThoseNearEachOtherInFewBytes) {
  std::vector<glm::dvec3> places;
  for (int k = 0; k < 20000; ++k) places.push_back({500 + 0.01 * k, -80 - 0.003 * (k % 100), 7 + 0.001 * k});
  std::string html;
  constexpr double unit_m = 1e-4;
  PackedArrays(html).add_places("places", places, {510, -80, 7}, unit_m);
  const Unpacked array = unpacked(html);
  EXPECT_EQ(array.unit, unit_m);
  const auto steps = array.numbers<std::int32_t>();
  ASSERT_EQ(steps.size(), 3 * places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_NEAR(510 + steps[3 * k] * unit_m, places[k].x, 0.51 * unit_m);
    EXPECT_NEAR(-80 + steps[3 * k + 1] * unit_m, places[k].y, 0.51 * unit_m);
    EXPECT_NEAR(7 + steps[3 * k + 2] * unit_m, places[k].z, 0.51 * unit_m);
  }
  EXPECT_LT(html.size(), places.size()) << "twelve bytes each as they are";
}

}  // namespace
}  // namespace tubefoot
