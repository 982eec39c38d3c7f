// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/stored_pings.hpp"

#include <utility>

namespace tubefoot {
namespace {

class StoredPings : public PackedPings {
 public:
  StoredPings(std::shared_ptr<const PingStore> store, std::size_t sensor, const OutputChannel& channel)
      : store_(std::move(store)), sensor_(sensor), channel_(channel) {}
  PingEnergies values(std::size_t ping, std::size_t chunk) const override {
    std::shared_ptr<const double> values = store_->values(ping, {sensor_, channel_.name, chunk});
    const double* first = values.get();
    return {{first, channel_.values / channel_.chunks}, std::move(values)};
  }
  std::vector<unsigned char> chunk(std::size_t ping, std::size_t chunk) const override {
    return store_->chunk(ping, {sensor_, channel_.name, chunk});
  }

 private:
  std::shared_ptr<const PingStore> store_;
  std::size_t sensor_;
  OutputChannel channel_;
};

}  // namespace

RecordedChannel recorded_channel(const std::shared_ptr<const PingStore>& store, std::size_t sensor,
                                 const std::string& channel) {
  const OutputChannel* found = store->find(sensor, channel);
  if (found == nullptr) return {};
  if (store->is_packed()) return {{}, std::make_shared<const StoredPings>(store, sensor, *found), store};
  return {store->in_memory(sensor, channel), nullptr, store};
}

}  // namespace tubefoot
