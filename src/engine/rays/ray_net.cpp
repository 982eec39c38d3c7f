// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_net.hpp"

#include <algorithm>
#include <bit>
#include <utility>

// Constructs the scrambled Sobol' points of a net. Gaussian elimination over the binary digits reorders the
// points, so that their numbers follow the cells of a grid.

namespace tubefoot {
namespace {

constexpr int digits = 32;

/// Multiplies the digits of a word by a random lower triangular matrix with ones on the diagonal. Digit 0 is
/// the first one after the binary point.
class Scrambling {
 public:
  Scrambling(std::uint64_t key, int used_digits) {
    for (int d = 0; d < used_digits; ++d) {
      const std::uint32_t one = 1u << (digits - 1 - d);
      column_[d] =
          one |
          (std::uint32_t(splitmix::mixed(key + splitmix::golden * std::uint64_t(d + 1)) >> 32) & (one - 1));
    }
    shift_ = std::uint32_t(splitmix::mixed(key) >> 32);
  }
  std::uint32_t operator()(std::uint32_t word) const {
    std::uint32_t sum = 0;
    for (; word != 0; word &= word - 1) sum ^= column_[std::size_t(std::countl_zero(word & (~word + 1)))];
    return sum;
  }
  std::uint32_t shift() const { return shift_; }

 private:
  std::array<std::uint32_t, digits> column_{};
  std::uint32_t shift_ = 0;
};

}  // namespace

RayNet::RayNet(std::uint64_t key, std::uint32_t first, int column_bits, int row_bits)
    : bits_(column_bits + row_bits) {
  const int known = std::max<int>(bits_, std::bit_width(first));
  const Scrambling across(splitmix::mixed(key + 1), known), along(splitmix::mixed(key + 2), known);
  x_ = across.shift();
  y_ = along.shift();
  std::array<std::uint32_t, most_bits> cell{};  // per bit of a point's number: its cell, row before column
  const auto cell_of = [&](std::uint32_t x, std::uint32_t y) {
    return std::uint32_t((std::uint64_t(x) >> (digits - column_bits)) |
                         (std::uint64_t(y) >> (digits - row_bits) << column_bits));
  };
  std::uint32_t direction = 1u << (digits - 1);  // of the second dimension: x + 1, Pascal's triangle
  for (int bit = 0; bit < known; ++bit, direction ^= direction >> 1) {
    const std::uint32_t x = across(1u << (digits - 1 - bit)), y = along(direction);
    if (bit < bits_) {
      x_of_bit_[bit] = x;
      y_of_bit_[bit] = y;
      cell[bit] = cell_of(x, y);
    } else if ((first >> bit & 1) != 0) {
      x_ ^= x;
      y_ ^= y;
    }
  }
  // Finds the combination of the number's bits that moves a point by one bit of its cell. There is always
  // exactly one, because the points are a net.
  for (int bit = 0; bit < bits_; ++bit) {
    int with = bit;
    while ((cell[with] >> bit & 1) == 0) ++with;
    std::swap(cell[bit], cell[with]);
    std::swap(x_of_bit_[bit], x_of_bit_[with]);
    std::swap(y_of_bit_[bit], y_of_bit_[with]);
    for (int other = 0; other < bits_; ++other)
      if (other != bit && (cell[other] >> bit & 1) != 0) {
        cell[other] ^= cell[bit];
        x_of_bit_[other] ^= x_of_bit_[bit];
        y_of_bit_[other] ^= y_of_bit_[bit];
      }
  }
  for (std::uint32_t at = cell_of(x_, y_); at != 0; at &= at - 1) {
    x_ ^= x_of_bit_[std::countr_zero(at)];
    y_ ^= y_of_bit_[std::countr_zero(at)];
  }
  // Blocks of four by four cells, or as near to that as the numbers of rows and columns permit.
  const int rows = std::min(row_bits, std::max(2, 4 - column_bits)),
            columns = std::min(column_bits, 4 - rows);
  const auto x_of_cell = x_of_bit_, y_of_cell = y_of_bit_;
  int bit = 0;
  const auto take = [&](int from, int to) {
    for (; from < to; ++from, ++bit) {
      x_of_bit_[bit] = x_of_cell[from];
      y_of_bit_[bit] = y_of_cell[from];
    }
  };
  take(column_bits, column_bits + rows);
  take(0, columns);
  take(columns, column_bits);
  take(column_bits + rows, bits_);
  first_.x.fill(x_);
  first_.y.fill(y_);
  for (std::uint32_t k = 0; k < std::uint32_t(RayPacket::size); ++k)
    for (int b = 0; b < std::min(bits_, 4); ++b)
      if ((k >> b & 1) != 0) {
        first_.x[k] ^= x_of_bit_[b];
        first_.y[k] ^= y_of_bit_[b];
      }
}

NetBlock RayNet::block(std::uint32_t t) const {
  std::uint32_t x = 0, y = 0;
  for (t >>= 4; t != 0; t &= t - 1) {
    const auto bit = std::size_t(std::countr_zero(t) + 4);
    x ^= x_of_bit_[bit];
    y ^= y_of_bit_[bit];
  }
  NetBlock block;
  for (int k = 0; k < RayPacket::size; ++k) {
    block.x[k] = first_.x[k] ^ x;
    block.y[k] = first_.y[k] ^ y;
  }
  return block;
}

}  // namespace tubefoot
