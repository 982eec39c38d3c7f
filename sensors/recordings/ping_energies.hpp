// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tubefoot {

/// Values of a ping, and what keeps them while they are read: nothing where they lie in memory anyway.
class PingEnergies {
 public:
  PingEnergies(std::span<const double> values, std::shared_ptr<const void> keeper = {})
      : values_(values), keeper_(std::move(keeper)) {}

  /// Not of one that is just passing: its values would be gone.
  std::span<const double> values() const& { return values_; }
  std::span<const double> values() const&& = delete;
  operator std::span<const double>() const& { return values_; }
  operator std::span<const double>() const&& = delete;
  double operator[](std::size_t k) const { return values_[k]; }
  std::size_t size() const { return values_.size(); }

 private:
  std::span<const double> values_;
  std::shared_ptr<const void> keeper_;
};

/// Values of pings that are kept packed, each channel as a chunk of echoes.nc (files/hdf5_chunks.hpp), and
/// unpacked for who reads them. Thread-safe.
class PackedPings {
 public:
  virtual ~PackedPings() = default;
  /// Throws std::runtime_error where what is kept cannot be read any more.
  virtual PingEnergies values(std::size_t ping, std::size_t channel) const = 0;
  virtual std::vector<unsigned char> chunk(std::size_t ping, std::size_t channel) const = 0;
};

}  // namespace tubefoot
