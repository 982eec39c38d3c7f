// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/certified/receiver_pair_reference.hpp"
#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// The four channels of a receiver pair: [channel][beam][sample], with one beam per fan. With a reference,
/// also their bounds.
class ReceiverPairRows {
 public:
  ReceiverPairRows(const Transmission& transmission, std::size_t s)
      : samples_(static_cast<std::size_t>(transmission.sensor(s).samples().count)),
        beams_(static_cast<std::size_t>(transmission.beams(s))),
        all_{{int(4 * beams_), int(samples_), std::vector<double>(4 * beams_ * samples_)}, {}} {}
  void set(std::size_t fan, const ReceiverPairEcho& echo) {
    set(fan, rows_of(echo).energy, all_.echo.energy);
  }
  void set(std::size_t fan, const CertifiedEcho& found) {
    all_.bound.resize(all_.echo.energy.size());
    set(fan, found.echo.energy, all_.echo.energy);
    set(fan, found.bound, all_.bound);
    all_.bins_over += found.bins_over;
    if (!(found.worst_ratio > all_.worst_ratio)) return;
    all_.worst_ratio = found.worst_ratio;
    all_.worst_beam = int(fan);  // the worst bound may be in any channel
    all_.worst_sample = found.worst_sample;
  }
  void add_to(PingSums& sums, const Transmission& transmission, std::size_t s, std::size_t order) const {
    if (all_.bound.empty()) return sums.add(transmission, s, order, all_.echo.energy);
    sums.add(transmission, s, all_, order);
  }

 private:
  /// `channels`: [channel][sample].
  void set(std::size_t fan, std::span<const double> channels, std::vector<double>& all) const {
    for (std::size_t channel = 0; channel < 4; ++channel)
      std::ranges::copy(channels.subspan(channel * samples_, samples_),
                        all.begin() + std::ptrdiff_t((channel * beams_ + fan) * samples_));
  }

  std::size_t samples_, beams_;
  CertifiedEcho all_;
};

}  // namespace tubefoot
