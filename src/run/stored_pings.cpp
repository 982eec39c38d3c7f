// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/stored_pings.hpp"

#include <utility>

namespace tubefoot {
namespace {

class StoredPings : public PackedPings {
 public:
  StoredPings(std::shared_ptr<const PingStore> store, std::size_t sensor, bool bound)
      : store_(std::move(store)), sensor_(sensor), bound_(bound) {}
  PingEnergies values(std::size_t ping, std::size_t channel) const override {
    std::shared_ptr<const double> values = store_->values(ping, {sensor_, channel, bound_});
    const double* first = values.get();
    return {{first, store_->values_a_chunk(sensor_)}, std::move(values)};
  }
  std::vector<unsigned char> chunk(std::size_t ping, std::size_t channel) const override {
    return store_->chunk(ping, {sensor_, channel, bound_});
  }

 private:
  std::shared_ptr<const PingStore> store_;
  std::size_t sensor_;
  bool bound_;
};

}  // namespace

std::shared_ptr<const PackedPings> packed_pings(const std::shared_ptr<const PingStore>& store,
                                                std::size_t sensor, bool bound) {
  if (!store->is_packed()) return nullptr;
  return std::make_shared<const StoredPings>(store, sensor, bound);
}

std::span<const double> in_memory(const std::shared_ptr<const PingStore>& store, std::size_t sensor) {
  if (store->is_packed()) return {};
  return store->energy(sensor);
}

}  // namespace tubefoot
