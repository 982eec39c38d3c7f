// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/receiver/quantisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tubefoot {

Quantiser::Quantiser(double bottom, double top, int bits) : bottom_(bottom) {
  if (bits < 1 || bits > 16)
    throw std::invalid_argument(
        fmt::format("quantisation: the number of bits is {}, but must be 1 to 16", bits));
  largest_ = static_cast<std::uint16_t>((1u << bits) - 1);
  step_ = (top - bottom) / largest_;
  if (!(step_ > 0 && std::isfinite(step_)) || bottom + step_ == bottom)
    throw std::invalid_argument(
        fmt::format("quantisation: the range is {} to {}, but must be finite and increasing", bottom, top));
}

std::uint16_t Quantiser::code(double value) const {
  if (std::isnan(value)) throw std::invalid_argument("quantisation: the value is not a number");
  const double nearest = std::round((value - bottom_) / step_);
  return static_cast<std::uint16_t>(std::clamp(nearest, 0.0, double(largest_)));
}

}  // namespace tubefoot
