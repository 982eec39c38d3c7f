// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/bounded_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace tubefoot {
namespace {

using testing::ElementsAre;
using Cache = BoundedCache<std::size_t>;

struct Loads {
  std::vector<std::size_t> numbers;
  Cache::Loaded operator()(std::size_t number) {
    numbers.push_back(number);
    return {std::make_shared<const std::size_t>(number), 10};
  }
};

TEST(BoundedCache, ForgetsWhatWasUsedLongestAgo) {
  Loads loads;
  Cache cache(30, std::ref(loads));
  for (const std::size_t number : {1, 2, 3, 1, 4, 1, 3, 2}) EXPECT_EQ(*cache.get(number), number);
  EXPECT_THAT(loads.numbers, ElementsAre(1, 2, 3, 4, 2));
  EXPECT_EQ(cache.loads(), 5u);
  EXPECT_EQ(cache.bytes(), 30u);
  EXPECT_EQ(cache.most_bytes_held(), 40u) << "the new one is there before an old one goes";
}

TEST(BoundedCache, KeepsWhatIsInUse) {
  Loads loads;
  Cache cache(0, std::ref(loads));
  const auto one = cache.get(1), two = cache.get(2);
  EXPECT_EQ(cache.get(1), one);
  EXPECT_EQ(cache.get(2), two);
  EXPECT_THAT(loads.numbers, ElementsAre(1, 2));
  cache.get(3);
  cache.get(4);
  EXPECT_EQ(cache.bytes(), 30u) << "1 and 2, and the last one";
}

TEST(BoundedCache, TriesAgainAfterAFailure) {
  int tries = 0;
  Cache cache(30, [&](std::size_t number) -> Cache::Loaded {
    if (++tries == 1) throw std::runtime_error("cut off");
    return {std::make_shared<const std::size_t>(number), 10};
  });
  EXPECT_THROW(cache.get(5), std::runtime_error);
  EXPECT_EQ(cache.bytes(), 0u);
  EXPECT_EQ(*cache.get(5), 5u);
}

TEST(BoundedCache, LoadsOnceForSeveralThreads) {
  std::atomic<int> loads{0};
  Cache cache(1000, [&](std::size_t number) -> Cache::Loaded {
    ++loads;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return {std::make_shared<const std::size_t>(number), 10};
  });
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k)
    threads.emplace_back([&] {
      for (std::size_t number = 0; number < 3; ++number) EXPECT_EQ(*cache.get(number), number);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(loads, 3);
}

}  // namespace
}  // namespace tubefoot
