// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

// Products of vectors whose components are exact numbers, intervals or balls.
namespace tubefoot {

template <class Number>
Number dot(const std::array<Number, 3>& a, const std::array<Number, 3>& b) {
  return Number(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

template <class Number>
std::array<Number, 3> cross(const std::array<Number, 3>& a, const std::array<Number, 3>& b) {
  return {Number(a[1] * b[2] - a[2] * b[1]), Number(a[2] * b[0] - a[0] * b[2]),
          Number(a[0] * b[1] - a[1] * b[0])};
}

}  // namespace tubefoot
