// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <deque>

namespace tubefoot {

/// A list whose elements keep their addresses while it grows, and their memory when it is cleared. A
/// std::deque would release its blocks and allocate them again for every tube. next() returns an old element,
/// which the caller overwrites.
template <class T>
class ReusedList {
 public:
  void clear() { size_ = 0; }
  T& next() {
    if (size_ == elements_.size()) elements_.emplace_back();
    return elements_[size_++];
  }

 private:
  std::deque<T> elements_;
  std::size_t size_ = 0;
};

}  // namespace tubefoot
