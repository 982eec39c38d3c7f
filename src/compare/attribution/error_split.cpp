// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/attribution/error_split.hpp"

#include <algorithm>

#include "geometry/steps/stop.hpp"

namespace tubefoot {

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) {
  error += other.error;
  difference += other.difference;
  energy += other.energy;
  return *this;
}

ErrorSums& ErrorSplit::sums_of(std::size_t owner, std::size_t group) {
  if (sums_.size() < (owner + 1) * groups_) sums_.resize((owner + 1) * groups_);
  return sums_[owner * groups_ + group];
}

void ErrorSplit::add(std::size_t group, std::span<const OwnerShare> shares, const ErrorSums& bin) {
  if (shares.size() == 1) {
    sums_of(shares.front().owner, group) += bin;
    return;
  }
  for (const OwnerShare& share : shares) sums_of(share.owner, group) += {0, 0, share.share * bin.energy};
  if (bin.error == 0) return;
  mixed_.push_back({group, shares_.size(), shares.size(), bin});
  shares_.insert(shares_.end(), shares.begin(), shares.end());
}

std::vector<ErrorSums> ErrorSplit::finish(std::size_t owners, int rounds) {
  sums_.resize(std::max(sums_.size(), owners * groups_));
  std::vector<ErrorSums> alone(sums_.size() / groups_);
  for (std::size_t k = 0; k < sums_.size(); ++k) alone[k / groups_] += sums_[k];
  std::vector<ErrorSums> all = alone;
  std::vector<double> rate(all.size(), 1), weight;
  const auto weigh = [&](const Mixed& mixed) {
    weight.assign(mixed.count, 0);
    double total = 0;
    for (std::size_t k = 0; k < mixed.count; ++k) {
      const OwnerShare& share = shares_[mixed.first + k];
      total += weight[k] = share.share * rate[share.owner];
    }
    for (std::size_t k = 0; k < mixed.count; ++k)
      weight[k] = total > 0 ? weight[k] / total : shares_[mixed.first + k].share;
  };
  for (int round = 0; round < rounds && !mixed_.empty(); ++round) {
    stop_if_wanted();
    for (std::size_t owner = 0; owner < all.size(); ++owner) all[owner].error = alone[owner].error;
    for (const Mixed& mixed : mixed_) {
      weigh(mixed);
      for (std::size_t k = 0; k < mixed.count; ++k)
        all[shares_[mixed.first + k].owner].error += weight[k] * mixed.bin.error;
    }
    for (std::size_t owner = 0; owner < all.size(); ++owner)
      rate[owner] = all[owner].energy > 0 ? all[owner].error / all[owner].energy : 0;
  }
  std::vector<ErrorSums> table = sums_;
  for (const Mixed& mixed : mixed_) {
    weigh(mixed);
    for (std::size_t k = 0; k < mixed.count; ++k) {
      const OwnerShare& share = shares_[mixed.first + k];
      table[share.owner * groups_ + mixed.group] +=
          {weight[k] * mixed.bin.error, weight[k] * mixed.bin.difference, 0};
    }
  }
  return table;
}

}  // namespace tubefoot
