// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/steps/steps.hpp"

#include <mutex>
#include <string_view>

namespace tubefoot {
namespace {

/// Work with fewer steps is not listed. Its progress is not informative, and it may be so short that listing
/// it costs time.
constexpr std::size_t fewest_listed = 8;

struct List {
  std::mutex mutex;
  Steps *first = nullptr, *last = nullptr;
};
List& list() {
  static List all;
  return all;
}

}  // namespace

Steps::Steps(const char* what, std::size_t total) : what_(what), total_(total) {
  stop_if_wanted();
  if (total_ < fewest_listed) return;
  since_ = std::chrono::steady_clock::now();
  const std::lock_guard lock(list().mutex);
  before_ = list().last;
  (before_ != nullptr ? before_->after_ : list().first) = this;
  list().last = this;
}

Steps::~Steps() {
  if (total_ < fewest_listed) return;
  const std::lock_guard lock(list().mutex);
  (before_ != nullptr ? before_->after_ : list().first) = after_;
  (after_ != nullptr ? after_->before_ : list().last) = before_;
}

std::optional<Steps::AtHand> Steps::at_hand() {
  const std::lock_guard lock(list().mutex);
  const Steps* first = list().first;
  if (first == nullptr) return std::nullopt;
  AtHand all{first->what_, 0, 0, first->since_};
  for (const Steps* steps = first; steps != nullptr; steps = steps->after_)
    if (std::string_view(steps->what_) == all.what) {
      all.done += steps->done_.load(std::memory_order_relaxed);
      all.total += steps->total_;
    }
  return all;
}

}  // namespace tubefoot
