// SPDX-License-Identifier: GPL-3.0-or-later
// Tests exhausted memory or threads: the program reports it in its own messages, or continues with the
// available threads.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

/// Expects that the program ended by itself: successfully, or with its own message.
void expect_done_or_told(const Outcome& outcome) {
  EXPECT_EQ(outcome.signal, 0) << outcome.err;
  EXPECT_THAT(outcome.exit_code, AnyOf(0, 1)) << outcome.err;
  if (outcome.exit_code == 1) {
    EXPECT_THAT(outcome.err, AnyOf(HasSubstr("memory"), HasSubstr("cannot start a thread")));
  }
  for (const char* words : {"std::", "what()", "terminate", "Resource temporarily", "pthread_create"})
    EXPECT_THAT(outcome.err, Not(HasSubstr(words)));
}

struct Exhaustion : testing::Test {
  TestFolder folder;
  const fs::path scene = folder.write("scene.toml", small_scene);
  Exhaustion() { folder.write("thing.obj", tetrahedron); }
  /// Names and bytes of all files except stats.json, which contains seconds and threads.
  std::map<std::string, std::string> contents(const std::string& output) const {
    std::map<std::string, std::string> all;
    for (const std::string& name : names_below(folder / output))
      if (name != "stats.json") all[name] = bytes_of(folder / output / name);
    return all;
  }
  std::vector<std::string> run_words(const std::string& output) const {
    return {"run", scene.string(), "-o", (folder / output).string(), "--threads", "4"};
  }
};

// The libraries take addresses when they are loaded, and more in their initializers. The command --version
// also loads those that other commands load on demand.
TEST_F(Exhaustion, OfAddressesIsReportedBeforeAnyLibraryFails) {
#ifdef TUBEFOOT_SANITIZED
  GTEST_SKIP() << "sanitizers set aside terabytes of addresses";
#endif
  constexpr int not_loaded = 127;
  const auto outcome_with = [](std::size_t megabytes) {
    Surroundings meagre;
    meagre.largest_memory_bytes = megabytes << 20;
    return run_program({"--version"}, meagre);
  };
  // With too few addresses the loader itself reports the error. Bisection finds the limit at which the
  // libraries load.
  std::size_t too_few = 290, enough = 900;
  while (enough - too_few > 10) {
    const std::size_t middle = (too_few + enough) / 20 * 10;
    (outcome_with(middle).exit_code == not_loaded ? too_few : enough) = middle;
  }
  int told = 0, done = 0;
  for (std::size_t megabytes = enough; megabytes <= 900 && done < 5; megabytes += 10) {
    SCOPED_TRACE(megabytes);
    const Outcome outcome = outcome_with(megabytes);
    expect_done_or_told(outcome);
    ++(outcome.exit_code == 0 ? done : told);
  }
  EXPECT_GT(told, 5);
  EXPECT_EQ(done, 5);
}

TEST_F(Exhaustion, OfAddressesIsReportedByEveryCommand) {
#ifdef TUBEFOOT_SANITIZED
  GTEST_SKIP() << "sanitizers set aside terabytes of addresses";
#endif
  int done = 0;
  bool runs = false;
  for (std::size_t megabytes = 480; megabytes <= 1000; megabytes += 40) {
    runs = !runs;
    const std::vector<std::string> words = runs ? run_words(fmt::format("out-{}", megabytes))
                                                : std::vector<std::string>{"check", scene.string()};
    SCOPED_TRACE(fmt::format("{} with {} MB", words[0], megabytes));
    Surroundings meagre;
    meagre.largest_memory_bytes = megabytes << 20;
    const Outcome outcome = run_program(words, meagre);
    expect_done_or_told(outcome);
    if (outcome.exit_code == 0) ++done;
    if (outcome.exit_code != 0) {
      EXPECT_FALSE(fs::exists(folder / fmt::format("out-{}", megabytes)));
    }
  }
  EXPECT_GT(done, 0);
}

TEST_F(Exhaustion, OfThreadsLeavesARunWithThoseThereAre) {
  ASSERT_EQ(run_program(run_words("whole")).exit_code, 0);
  const auto whole = contents("whole");
  int done = 0, fewer = 0;
  // Below 4 the initializers of the libraries have too few threads. The encoder of pictures starts further
  // ones, so the outcome for about 8 depends on the order in which threads end.
  for (const int most : {0, 3, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16}) {
    SCOPED_TRACE(most);
    Surroundings few;
    few.before = {"/usr/bin/env", std::string("LD_PRELOAD=") + TUBEFOOT_FEW_THREADS,
                  fmt::format("TUBEFOOT_MOST_THREADS={}", most)};
    const std::string output = fmt::format("out-{}", most);
    const Outcome outcome = run_program(run_words(output), few);
    expect_done_or_told(outcome);
    if (outcome.exit_code != 0) continue;
    ++done;
    if (outcome.err.find("of 4 threads:") != std::string::npos) ++fewer;
    EXPECT_EQ(contents(output), whole);
  }
  EXPECT_GT(done, 4);
  EXPECT_GT(fewer, 0);
}

}  // namespace
}  // namespace tubefoot
