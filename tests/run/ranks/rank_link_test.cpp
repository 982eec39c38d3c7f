// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the message link between ranks, independent of any run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/mpirun.hpp"
#include "fixtures/program.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

struct RankLinks : testing::Test {
  TestFolder folder;

  void SetUp() override {
    if (!fs::exists(TUBEFOOT_MPIRUN) || !fs::exists(TUBEFOOT_MPI_LIBRARY))
      GTEST_SKIP() << "Open MPI is not installed: libopenmpi-dev, openmpi-bin";
  }
  /// Messages have short portions, so that most of them take several.
  static Outcome storm(int ranks, Sending sending, const std::vector<std::string>& more = {}) {
    Surroundings surroundings;
    surroundings.before = mpirun(ranks, sending);
    surroundings.program = TUBEFOOT_RANK_STORM;
    std::vector<std::string> words{TUBEFOOT_MPI_LIBRARY, "1000"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, surroundings);
  }
};

TEST_F(RankLinks, CarryEverythingWhereAllSendBeforeAnybodyReceives) {
  for (const Sending sending : {Sending::as_usual, Sending::nothing_ahead})
    for (const int ranks : {2, 3}) {
      const Outcome outcome = storm(ranks, sending);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(outcome.out, "all 300 messages a pair arrived\n");
    }
}

// Verifies that the setting `nothing_ahead` of these tests really sends nothing before its receiver waits.
TEST_F(RankLinks, HoldAByteUntilItIsReceivedWhereNothingIsSentAhead) {
  EXPECT_EQ(storm(2, Sending::as_usual, {folder / "usual"}).out, "left at once\n");
  EXPECT_EQ(storm(2, Sending::nothing_ahead, {folder / "held"}).out, "held until it is received\n");
}

}  // namespace
}  // namespace tubefoot
