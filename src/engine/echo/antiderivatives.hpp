// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace tubefoot {

/// Coefficients of integrals from 0 to x, for i < terms. The integrals of x^i (1, x, x^2, x^3) are x^(i + 1)
/// reciprocal[i] (1, first[i] x, second[i] x^2, third[i] x^3).
template <int terms>
struct Antiderivatives {
  std::array<double, terms> reciprocal{}, first{}, second{}, third{};
  constexpr Antiderivatives() {
    for (int i = 0; i < terms; ++i) {
      reciprocal[i] = 1.0 / (i + 1);
      first[i] = double(i + 1) / (i + 2);
      second[i] = double(i + 1) / (i + 3);
      third[i] = double(i + 1) / (i + 4);
    }
  }
};

}  // namespace tubefoot
