// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>

// This header defines a thread-safe cache of values by number. The cache keeps the values that were used
// last, up to a limit of bytes.

namespace tubefoot {

/// Values by number, which the cache loads at their first use. The cache keeps the values that were used
/// last while their sum of bytes does not exceed the limit. A value in use stays in the cache beyond the
/// limit, because removing it would free no memory. Thread-safe. If several threads request a value, one of
/// them loads it once.
template <class Value>
class BoundedCache {
 public:
  struct Loaded {
    std::shared_ptr<const Value> value;
    std::size_t bytes = 0;
  };

  BoundedCache(std::size_t most_bytes, std::function<Loaded(std::size_t)> load)
      : most_bytes_(most_bytes), load_(std::move(load)) {}

  /// Returns a value. Throws the exception of the loading function; the next request then loads the value
  /// again.
  std::shared_ptr<const Value> get(std::size_t number) {
    std::promise<std::shared_ptr<const Value>> promise;
    std::shared_future<std::shared_ptr<const Value>> future;
    bool mine = false;
    {
      const std::lock_guard lock(mutex_);
      const auto [entry, is_new] = entries_.try_emplace(number);
      mine = is_new;
      if (mine) entry->second.future = promise.get_future().share();
      entry->second.last_use = ++uses_;
      future = entry->second.future;
    }
    if (mine) load(number, promise);
    return future.get();
  }

  std::size_t loads() const {
    const std::lock_guard lock(mutex_);
    return loads_;
  }
  std::size_t bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
  }
  std::size_t most_bytes_held() const {
    const std::lock_guard lock(mutex_);
    return most_held_;
  }

 private:
  struct Entry {
    std::shared_future<std::shared_ptr<const Value>> future;
    std::size_t bytes = 0;
    std::uint64_t last_use = 0;
    bool loaded = false;
  };

  void load(std::size_t number, std::promise<std::shared_ptr<const Value>>& promise) {
    Loaded loaded;
    try {
      loaded = load_(number);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      entries_.erase(number);
      promise.set_exception(std::current_exception());
      return;
    }
    promise.set_value(loaded.value);
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_.at(number);
    entry.bytes = loaded.bytes;
    entry.loaded = true;
    bytes_ += loaded.bytes;
    ++loads_;
    loaded.value.reset();
    most_held_ = std::max(most_held_, bytes_);
    forget_oldest(number);
  }

  void forget_oldest(std::size_t but) {
    while (bytes_ > most_bytes_) {
      auto oldest = entries_.end();
      for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
        if (entry->first == but || !entry->second.loaded) continue;
        if (entry->second.future.get().use_count() > 1) continue;  // in use
        if (oldest == entries_.end() || entry->second.last_use < oldest->second.last_use) oldest = entry;
      }
      if (oldest == entries_.end()) return;
      bytes_ -= oldest->second.bytes;
      entries_.erase(oldest);
    }
  }

  const std::size_t most_bytes_;
  const std::function<Loaded(std::size_t)> load_;
  mutable std::mutex mutex_;
  std::map<std::size_t, Entry> entries_;
  std::size_t bytes_ = 0, loads_ = 0, most_held_ = 0;
  std::uint64_t uses_ = 0;
};

}  // namespace tubefoot
