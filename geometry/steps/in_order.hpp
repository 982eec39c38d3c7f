// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <vector>

#include "geometry/steps/steps.hpp"

namespace tubefoot {

/// The items [first, end) of work whose results are put down in order: `make(item)` on all threads, several
/// at a time; then each of `uses`, `use(item, made)`, one item after the other, so that what they write is
/// the same for any number of threads. Uses are at different items at a time, the first of them ahead: what
/// one changes is its own, but for `made`, which goes from one to the next.
///
/// No more items are at hand than fill 128 MiB, if each is of `bytes_an_item`, but always two.
/// What is thrown, Interrupted included, ends the work and is thrown on.
template <class Make, class... Uses>
void in_order(std::size_t first, std::size_t end, std::size_t bytes_an_item, const Make& make,
              const Uses&... uses) {
  using Filter = tbb::filter<void, std::size_t>;
  using tbb::filter_mode;
  constexpr std::size_t most_bytes = std::size_t{128} << 20, items_a_thread = 4;
  const auto threads = static_cast<std::size_t>(std::max(tbb::this_task_arena::max_concurrency(), 1));
  const std::size_t at_hand = std::clamp<std::size_t>(most_bytes / std::max<std::size_t>(bytes_an_item, 1), 2,
                                                      items_a_thread * threads);
  // What goes through TBB are numbers, which nobody has to free when something throws. An item is taken in
  // when one is through, and they get through in order: its place is free by then.
  std::vector<std::optional<std::invoke_result_t<const Make&, std::size_t>>> made(at_hand);
  Filter chain = tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order,
                                                     [&](tbb::flow_control& flow) {
                                                       if (first >= end) flow.stop();
                                                       return first++;
                                                     }) &
                 tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, [&](std::size_t item) {
                   stop_if_wanted();
                   made[item % at_hand].emplace(make(item));
                   return item;
                 });
  const auto add = [&](const auto& use) {
    chain = chain & tbb::make_filter<std::size_t, std::size_t>(filter_mode::serial_in_order,
                                                               [&made, &use, at_hand](std::size_t item) {
                                                                 use(item, *made[item % at_hand]);
                                                                 return item;
                                                               });
  };
  (add(uses), ...);
  tbb::parallel_pipeline(
      at_hand, chain & tbb::make_filter<std::size_t, void>(
                           filter_mode::serial_in_order, [&](std::size_t k) { made[k % at_hand].reset(); }));
}

/// The same as steps of long work: each item that is through is one.
template <class Make, class... Uses>
void in_order(Steps& steps, std::size_t first, std::size_t end, std::size_t bytes_an_item, const Make& make,
              const Uses&... uses) {
  in_order(first, end, bytes_an_item, make, uses..., [&](std::size_t, const auto&) { steps.done(); });
}

}  // namespace tubefoot
