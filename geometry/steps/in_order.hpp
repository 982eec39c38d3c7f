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

/// Processes the items [first, end) in parallel and uses the results in order. `make(item)` runs on all
/// threads, several items at a time. Each of `uses`, `use(item, made)`, then runs for one item after the
/// other. Their output is therefore the same for any number of threads. Different uses may process different
/// items at the same time, in the order of `uses`. Each use must change only its own data, except `made`,
/// which passes from one use to the next.
///
/// The number of items in progress is limited to 128 MiB in total, for `bytes_an_item` per item, and is at
/// least two. An exception, Interrupted included, ends the work and is rethrown.
template <class Make, class... Uses>
void in_order(std::size_t first, std::size_t end, std::size_t bytes_an_item, const Make& make,
              const Uses&... uses) {
  using Filter = tbb::filter<void, std::size_t>;
  using tbb::filter_mode;
  constexpr std::size_t most_bytes = std::size_t{128} << 20, items_a_thread = 4;
  const auto threads = static_cast<std::size_t>(std::max(tbb::this_task_arena::max_concurrency(), 1));
  const std::size_t at_hand = std::clamp<std::size_t>(most_bytes / std::max<std::size_t>(bytes_an_item, 1), 2,
                                                      items_a_thread * threads);
  // Only numbers pass through TBB, so an exception leaves nothing to release. A new item enters when an item
  // is finished. Items finish in order, so the place of the new item is free by then.
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

/// The same as steps of long work: each finished item is one step.
template <class Make, class... Uses>
void in_order(Steps& steps, std::size_t first, std::size_t end, std::size_t bytes_an_item, const Make& make,
              const Uses&... uses) {
  in_order(first, end, bytes_an_item, make, uses..., [&](std::size_t, const auto&) { steps.done(); });
}

}  // namespace tubefoot
