// SPDX-License-Identifier: GPL-3.0-or-later
// Tests estimates of the remaining time with a clock that the test sets. They are correct to a factor of
// 1.5 after a tenth of the work, and absent before they are meaningful.
#include "run/console/time_left.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include "run/ping_order.hpp"

namespace tubefoot {
namespace {

/// Returns the end times of the steps in order, if `threads` threads each take the next step when they are
/// free.
std::vector<double> ends(std::size_t steps, int threads, double once_s,
                         const std::function<double(std::size_t)>& takes) {
  std::multiset<double> free;
  for (int k = 0; k < threads; ++k) free.insert(once_s);
  std::vector<double> ends;
  for (std::size_t step = 0; step < steps; ++step) {
    const double end = *free.begin() + takes(step);
    free.erase(free.begin());
    free.insert(end);
    ends.push_back(end);
  }
  std::ranges::sort(ends);
  return ends;
}

/// The worst ratio of an estimate to the remaining time, in either direction, and the number of steps done
/// at the first estimate.
struct Worst {
  double ratio = 1;
  std::size_t first_shown = 0, shown = 0;
};
Worst worst(const std::vector<double>& ends, int threads, double afterwards_s = 0) {
  Worst worst;
  TimeLeft left(ends.size(), threads, afterwards_s);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    left.step(ends[k]);
    for (const double now : {ends[k], (ends[k] + ends[k + 1]) / 2}) {
      const auto estimate = left.seconds(now);
      if (!estimate) continue;
      if (worst.shown++ == 0) worst.first_shown = k + 1;
      const double truth = ends.back() - now + afterwards_s;
      // Errors in the last second do not matter.
      if (std::abs(*estimate - truth) > 0.05 * ends.back())
        worst.ratio = std::max({worst.ratio, *estimate / truth, truth / std::max(*estimate, 1e-9)});
    }
  }
  return worst;
}

constexpr double requested = 1.5;

TEST(TimeLeft, IsWithinAFactorOfOneAndAHalfOnceATenthIsDone) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> rough(0, 0.5);
  for (const int threads : {1, 2, 8}) {
    const auto steady = worst(ends(400, threads, 0, [](std::size_t) { return 1.0; }), threads);
    EXPECT_LE(steady.ratio, requested) << threads;
    EXPECT_GE(steady.first_shown, 40u);
    EXPECT_LE(steady.first_shown, 60u);
    EXPECT_LE(worst(ends(400, threads, 0, [&](std::size_t) { return rough(random); }), threads).ratio,
              requested)
        << threads;
  }
}

// This is like a scene that the first ping refines.
TEST(TimeLeft, LeavesOutWhatHappensOnce) {
  for (const int threads : {1, 4}) {
    const Worst once = worst(ends(400, threads, 60, [](std::size_t) { return 1.0; }), threads);
    EXPECT_LE(once.ratio, requested) << threads;
    EXPECT_GT(once.shown, 100u);
  }
}

TEST(TimeLeft, IncludesWhatComesAfterwards) {
  EXPECT_LE(worst(ends(100, 1, 0, [](std::size_t) { return 0.01; }), 1, 33.7).ratio, requested);
  TimeLeft left(20, 1, 33.7);
  for (int k = 1; k <= 10; ++k) left.step(k);
  EXPECT_NEAR(*left.seconds(10), 10 + 33.7, 1e-9);
}

TEST(TimeLeft, SaysNothingBeforeItMeansSomething) {
  TimeLeft left(147'940, 2);
  EXPECT_FALSE(left.seconds(1));
  left.step(0.035);
  EXPECT_FALSE(left.seconds(0.04));  // of one step: 1 h 27 min
  for (int k = 2; k < 14'794; ++k) left.step(0.035 + 1e-5 * k);
  EXPECT_FALSE(left.seconds(0.2));
  left.step(0.2);
  EXPECT_NEAR(*left.seconds(0.2), 1.5, 0.5);

  EXPECT_FALSE(time_left(1, 147'940, 0.035));
  EXPECT_FALSE(time_left(14'793, 147'940, 0.2));
  EXPECT_NEAR(*time_left(14'794, 147'940, 0.2), 1.8, 1e-6);
  EXPECT_FALSE(time_left(1, 8, 1));
  EXPECT_NEAR(*time_left(2, 8, 1), 3, 1e-9);
}

// Sensors of one scene: a ping of one takes two hundred times as long as one of the other.
TEST(TimeLeft, IsRightForSensorsWhosePingsTakeDifferentTimes) {
  const std::size_t pings[] = {2000, 300};
  const PingOrder order(pings);
  const auto takes = [&](std::size_t place) { return order[place].first == 0 ? 0.01 : 2.0; };
  EXPECT_LE(worst(ends(order.size(), 1, 0, takes), 1).ratio, requested);
}

TEST(PingOrder, HasEachPingOnce) {
  for (const std::vector<std::size_t>& pings :
       {std::vector<std::size_t>{}, {0}, {1}, {5}, {3, 0, 100}, {1000, 1, 31, 32, 33}, {0, 7, 0}}) {
    const PingOrder order(pings);
    std::set<std::pair<std::size_t, std::size_t>> met;
    for (std::size_t place = 0; place < order.size(); ++place) met.insert(order[place]);
    std::size_t all = 0;
    for (const std::size_t count : pings) all += count;
    EXPECT_EQ(order.size(), all);
    EXPECT_EQ(met.size(), all);
    for (const auto& [group, ping] : met) EXPECT_LT(ping, pings.at(group));
  }
}

}  // namespace
}  // namespace tubefoot
