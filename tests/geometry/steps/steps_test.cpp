// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/steps/steps.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <thread>

namespace tubefoot {
namespace {

/// The fixture resets the stop request at the end of each test.
struct StepsTest : testing::Test {
  ~StepsTest() override {
    stop_requested = false;
    stop_requested_of_thread = nullptr;
  }
};

TEST_F(StepsTest, TellTheOldestAndItsLike) {
  EXPECT_FALSE(Steps::at_hand());
  std::optional<Steps> images(std::in_place, "images", 20);
  Steps tubes("tubes", 100), more("tubes", 50), few("pieces", 3);
  tubes.done();
  more.done();
  more.done();
  few.done();
  images->done();
  auto at_hand = Steps::at_hand();
  ASSERT_TRUE(at_hand);
  EXPECT_EQ(std::string(at_hand->what), "images");
  EXPECT_EQ(at_hand->done, 1u);
  EXPECT_EQ(at_hand->total, 20u);
  images.reset();
  at_hand = Steps::at_hand();
  ASSERT_TRUE(at_hand);
  EXPECT_EQ(std::string(at_hand->what), "tubes");
  EXPECT_EQ(at_hand->done, 3u);
  EXPECT_EQ(at_hand->total, 150u);
}

TEST_F(StepsTest, EndWhereSomebodyWantsToStop) {
  Steps steps("tubes", 10);
  EXPECT_NO_THROW(steps.done());
  stop_requested = true;
  EXPECT_THROW(steps.done(), Interrupted);
  EXPECT_THROW(Steps("tubes", 10), Interrupted);
  stop_requested = false;
  EXPECT_NO_THROW(steps.done());
  EXPECT_EQ(Steps::at_hand()->total, 10u) << "what was not begun is not at hand";
}

TEST_F(StepsTest, OfOneThreadAreStoppedAlone) {
  const std::atomic<bool> stop = true;
  std::thread([&stop] {
    stop_requested_of_thread = &stop;
    EXPECT_THROW(stop_if_wanted(), Interrupted);
    stop_requested_of_thread = nullptr;
    EXPECT_NO_THROW(stop_if_wanted());
  }).join();
  EXPECT_NO_THROW(stop_if_wanted());
}

}  // namespace
}  // namespace tubefoot
