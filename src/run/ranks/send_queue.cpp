// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/ranks/send_queue.hpp"

#include <utility>

namespace tubefoot {

void SendQueue::put(std::string result) {
  std::unique_lock lock(mutex_);
  room_.wait(lock, [this] { return open_ || held_bytes_ + unsent_bytes_ < most_bytes_; });
  held_bytes_ += result.size();
  results_.push_back(std::move(result));
}

std::vector<std::string> SendQueue::take(std::size_t unsent) {
  const std::lock_guard lock(mutex_);
  // The link takes over the queued results.
  unsent_bytes_ = unsent + std::exchange(held_bytes_, 0);
  if (unsent_bytes_ < most_bytes_) room_.notify_all();
  return std::exchange(results_, {});
}

void SendQueue::open() {
  const std::lock_guard lock(mutex_);
  open_ = true;
  room_.notify_all();
}

}  // namespace tubefoot
