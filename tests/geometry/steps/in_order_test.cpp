// SPDX-License-Identifier: GPL-3.0-or-later
// Tests parallel work whose results are used in order: for any number of threads, after exceptions, and
// after a request to stop.

#include "geometry/steps/in_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>

namespace tubefoot {
namespace {

using testing::ElementsAreArray;

/// Work of varying length, so that threads overtake each other.
std::string made_of(std::size_t item) {
  std::size_t sum = item;
  for (std::size_t k = 0; k < item * 7919 % 101 * 200; ++k) sum = sum * 6364136223846793005u + 1;
  return std::to_string(item) + (sum == 1 ? "!" : "");
}

struct InOrder : testing::Test {
  ~InOrder() override { stop_requested = false; }
};

TEST_F(InOrder, EveryUseSeesAllItemsInOrderForAnyNumberOfThreads) {
  for (const std::size_t threads : {1u, 2u, 5u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<std::size_t> first, second;
    std::string text;
    Steps steps("items", 300);
    in_order(
        steps, 100, 400, 1, made_of,
        [&](std::size_t item, std::string& made) {
          first.push_back(item);
          made += ",";
        },
        [&](std::size_t item, const std::string& made) {
          second.push_back(item);
          text += made;
        });
    std::vector<std::size_t> all(300);
    std::iota(all.begin(), all.end(), 100u);
    EXPECT_THAT(first, ElementsAreArray(all));
    EXPECT_THAT(second, ElementsAreArray(all));
    std::string expected;
    for (const std::size_t item : all) expected += std::to_string(item) + ",";
    EXPECT_EQ(text, expected);
    EXPECT_EQ(Steps::at_hand()->done, 300u);
  }
}

TEST_F(InOrder, NothingIsDoneOfNoItems) {
  Steps steps("items", 0);
  in_order(
      steps, 7, 7, 1, [](std::size_t) -> int { throw std::logic_error("no item"); },
      [](std::size_t, int) { ADD_FAILURE(); });
}

/// Counts its living instances.
struct Counted {
  explicit Counted(std::atomic<int>& alive) : alive_(alive) { ++alive_; }
  Counted(Counted&& other) : alive_(other.alive_) { ++alive_; }
  ~Counted() { --alive_; }
  std::atomic<int>& alive_;
};

TEST_F(InOrder, FewLargeItemsAreAtHand) {
  std::atomic<int> alive = 0, most = 0;
  Steps steps("items", 200);
  in_order(
      steps, 0, 200, std::size_t{1} << 30,
      [&](std::size_t) {
        Counted made(alive);
        most = std::max<int>(most, alive);
        return made;
      },
      [&](std::size_t, const Counted&) { std::this_thread::yield(); });
  EXPECT_EQ(alive, 0);
  EXPECT_LE(most, 3) << "two, and one that is moved to its place";
}

TEST_F(InOrder, WhatIsThrownEndsTheWorkAndLeavesNothing) {
  for (const bool in_use : {false, true}) {
    std::atomic<int> alive = 0;
    std::vector<std::size_t> used;
    Steps steps("items", 1000);
    EXPECT_THROW(in_order(
                     steps, 0, 1000, 1,
                     [&](std::size_t item) {
                       if (!in_use && item == 60) throw std::runtime_error("no room");
                       return Counted(alive);
                     },
                     [&](std::size_t item, const Counted&) {
                       if (in_use && item == 60) throw std::runtime_error("no room");
                       used.push_back(item);
                     }),
                 std::runtime_error);
    EXPECT_EQ(alive, 0);
    EXPECT_LE(used.size(), 60u);
    std::vector<std::size_t> begun(used.size());
    std::iota(begun.begin(), begun.end(), 0u);
    EXPECT_THAT(used, ElementsAreArray(begun)) << "what was used are the first items";
  }
}

TEST_F(InOrder, StopsWhereSomebodyWantsToStop) {
  std::atomic<int> made = 0;
  Steps steps("items", 100'000);
  EXPECT_THROW(in_order(
                   steps, 0, 100'000, 1,
                   [&](std::size_t item) {
                     if (item == 50) stop_requested = true;
                     return ++made;
                   },
                   [](std::size_t, int) {}),
               Interrupted);
  EXPECT_LT(made, 1000);
}

}  // namespace
}  // namespace tubefoot
