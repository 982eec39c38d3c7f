// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/steps/long_call.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>

namespace tubefoot {
namespace {

struct LongCall : testing::Test {
  ~LongCall() override { stop_requested = false; }
};

TEST_F(LongCall, ReturnsWhatTheCallReturnsAndThrowsWhatItThrows) {
  const auto words = std::make_unique<std::string>("as they are");
  EXPECT_EQ(long_call([text = *words] { return text; }), "as they are");
  EXPECT_THROW(long_call([]() -> int { throw std::runtime_error("no"); }), std::runtime_error);
}

TEST_F(LongCall, IsNotWaitedForWhenSomebodyWantsToStop) {
  const auto go_on = std::make_shared<std::atomic<bool>>(true);
  std::thread asks([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop_requested = true;
  });
  EXPECT_THROW(long_call([go_on] {
                 while (*go_on) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                 return 0;
               }),
               Interrupted);
  asks.join();
  EXPECT_THROW(long_call([] { return 0; }), Interrupted) << "nor is another begun";
  *go_on = false;
}

}  // namespace
}  // namespace tubefoot
