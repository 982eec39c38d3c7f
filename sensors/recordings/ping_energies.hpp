// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tubefoot {

/// Values of a ping, and the owner of their memory while they are in use. The owner is null for values that
/// stay in memory.
class PingEnergies {
 public:
  PingEnergies(std::span<const double> values, std::shared_ptr<const void> keeper = {})
      : values_(values), keeper_(std::move(keeper)) {}

  /// Deleted for temporaries, whose values would be destroyed.
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

/// Values of pings in packed form, each channel as a chunk of echoes.nc (files/hdf5_chunks.hpp), unpacked on
/// request. Thread-safe.
class PackedPings {
 public:
  virtual ~PackedPings() = default;
  /// Throws std::runtime_error if the packed data are no longer readable.
  virtual PingEnergies values(std::size_t ping, std::size_t channel) const = 0;
  virtual std::vector<unsigned char> chunk(std::size_t ping, std::size_t channel) const = 0;
};

}  // namespace tubefoot
