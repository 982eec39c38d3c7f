// SPDX-License-Identifier: GPL-3.0-or-later
// Tests progress messages on standard error if it is no terminal (for terminals see Stop.*).
#include "run/console/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <string>

#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

using testing::MatchesRegex;

/// Standard error, as a pipe that the test reads.
class SaidOnStandardError {
 public:
  SaidOnStandardError() {
    std::fflush(stderr);
    before_ = dup(STDERR_FILENO);
    if (before_ < 0 || pipe(ends_) != 0 || dup2(ends_[1], STDERR_FILENO) < 0)
      throw std::runtime_error("no pipe");
  }
  ~SaidOnStandardError() {
    std::fflush(stderr);
    dup2(before_, STDERR_FILENO);
    for (const int end : {before_, ends_[0], ends_[1]}) close(end);
  }
  SaidOnStandardError(const SaidOnStandardError&) = delete;
  SaidOnStandardError& operator=(const SaidOnStandardError&) = delete;

  /// Returns the next line, or an empty string if none comes within this time.
  std::string line(int at_most_ms) {
    std::string line;
    for (char next = 0; next != '\n';) {
      pollfd waiting{ends_[0], POLLIN, 0};
      if (poll(&waiting, 1, at_most_ms) != 1 || read(ends_[0], &next, 1) != 1) return {};
      if (next != '\n') line += next;
    }
    return line;
  }

 private:
  int before_ = -1, ends_[2] = {-1, -1};
};

/// far longer than the delay of the first line of a long step
constexpr int long_ms = 60'000, at_once_ms = 0;

TEST(Progress, TellsStepsOfOthersWhileTheyTakeLong) {
  SaidOnStandardError said;
  const Progress progress("writing", false);
  Steps pictures("pictures", 160);
  for (int k = 0; k < 40; ++k) pictures.done();
  EXPECT_THAT(said.line(long_ms), MatchesRegex("writing: pictures 40/160, [^,]* left"));
}

TEST(Progress, ShowsNoEstimateBeforeATenthIsDone) {
  SaidOnStandardError said;
  const Progress progress("measuring", false);
  Steps footprints("footprints", 147'940);
  footprints.done();
  EXPECT_EQ(said.line(long_ms), "measuring: footprints 1/147940");
}

TEST(Progress, TellsThatItStillWorksWhereNobodyTellsSteps) {
  SaidOnStandardError said;
  const Progress progress("writing", false);
  EXPECT_THAT(said.line(long_ms), MatchesRegex("writing, for [0-9]+ s"));
}

TEST(Progress, TellsEveryTenth) {
  SaidOnStandardError said;
  Progress progress("pings", 40, false);
  for (int tenth = 1; tenth <= 10; ++tenth) {
    for (int k = 0; k < 4; ++k) progress.step();
    EXPECT_THAT(said.line(long_ms), MatchesRegex("pings " + std::to_string(4 * tenth) + "/40.*"));
  }
  EXPECT_EQ(said.line(at_once_ms), "");
}

TEST(Progress, IsSilentIfQuiet) {
  SaidOnStandardError said;
  {
    Progress progress("pings", 10, true);
    for (int k = 0; k < 10; ++k) progress.step();
  }
  EXPECT_EQ(said.line(at_once_ms), "");
}

}  // namespace
}  // namespace tubefoot
