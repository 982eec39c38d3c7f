// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a killed run leaves its finished pings under another name. `--resume` completes them to the
// result of an uninterrupted run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "fixtures/world/long_run.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t pings = 3000;

struct Resume : LongRun {
  Resume() : LongRun(pings) {}
  Outcome run(const fs::path& output, const std::vector<std::string>& more = {},
              const Surroundings& surroundings = {}) const {
    std::vector<std::string> words{"run", (folder / "scene.toml").string(), "-o", output.string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, surroundings);
  }
  /// Ends a run by a signal after it has finished `enough` pings.
  Outcome stopped(int signal, std::size_t enough, const std::vector<std::string>& more = {}) const {
    return run(results, more, stopped_at(enough, signal));
  }
  static void expect_same(const fs::path& a, const fs::path& b) {
    ASSERT_EQ(names_below(a), names_below(b));
    for (const std::string& name : names_below(a)) {
      if (name == "stats.json") continue;  // it contains the elapsed seconds
      EXPECT_TRUE(bytes_of(a / name) == bytes_of(b / name)) << name;
    }
  }
};

TEST_F(Resume, MakesTheSameBytesWhereverTheRunWasKilled) {
  struct Case {
    std::vector<std::string> engine;
    std::size_t count;
    std::vector<std::size_t> kills;
  };
  for (const auto& [engine, count, kills] :
       std::vector<Case>{{{}, pings, {1, 300}},
                         {{"--engine", "ray", "--rays", "500"}, pings, {300}},
                         {{"--reference"}, 40, {3}},
                         {{"--labels"}, 400, {3}}}) {
    const fs::path whole = folder / "whole";
    write_scene(count);
    ASSERT_EQ(run(whole, engine).exit_code, 0);
    for (const std::size_t enough : kills) {
      SCOPED_TRACE(enough);
      EXPECT_EQ(stopped(SIGKILL, enough, engine).signal, SIGKILL);
      EXPECT_FALSE(fs::exists(results));
      const std::size_t kept = done();
      EXPECT_GE(kept, enough);
      ASSERT_LT(kept, count) << "the run was over before it was killed";
      std::vector<std::string> again = engine;
      again.emplace_back("--resume");
      const Outcome outcome = run(results, again);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("continuing after " + std::to_string(kept) + " finished pings"));
      EXPECT_FALSE(fs::exists(partial));
      expect_same(whole, results);
      fs::remove_all(results);
    }
  }
}

TEST_F(Resume, InterruptedRunsSayHowToGoOn) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Outcome outcome = stopped(signal, 5);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.signal;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("interrupted: "), HasSubstr("of 3000 pings are stored in"),
                                   HasSubstr("results.partial"), HasSubstr("--resume")));
    EXPECT_EQ(names_below(folder.path()),
              (std::set<std::string>{"scene.toml", "thing.obj", "results.partial"}));
    fs::remove(partial);
  }
}

TEST_F(Resume, FinishedPingsAreNeverThrownAway) {
  stopped(SIGKILL, 5);
  const std::size_t kept = done();
  const Outcome anew = run(results);
  EXPECT_EQ(anew.exit_code, 2);
  EXPECT_THAT(anew.err, AllOf(HasSubstr("contains"), HasSubstr("of 3000 pings"), HasSubstr("--resume")));
  const Outcome other = run(results, {"--resume", "--arithmetic", "filtered"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("arithmetic = \"fixed\", not \"filtered\""));
  folder.write("thing.obj", std::string(tetrahedron) + "v 9 9 9\n");
  const Outcome changed = run(results, {"--resume"});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_THAT(changed.err, HasSubstr("has changed since"));
  EXPECT_EQ(done(), kept);
  folder.write("thing.obj", tetrahedron);
  EXPECT_EQ(run(results, {"--resume"}).exit_code, 0);
}

// If a page did not reach the disk, the run computes the ping again.
TEST_F(Resume, DamagedPingsAreMeasuredAgain) {
  const fs::path whole = folder / "whole";
  ASSERT_EQ(run(whole).exit_code, 0);
  stopped(SIGKILL, 300);
  {
    // The finished pings lie one after the other.
    const std::string bytes = bytes_of(partial);
    const std::size_t end = bytes.size() - 1;
    std::fstream file(partial, std::ios::in | std::ios::out | std::ios::binary);
    for (std::size_t k = 0; k < 10; ++k) {
      const std::size_t at = end - 1000 * k - 20;
      file.seekp(static_cast<std::streamoff>(at));
      file.put(static_cast<char>(bytes[at] ^ 0x55));
    }
  }
  const std::size_t before = done();
  const Outcome outcome = run(results, {"--resume"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("after " + std::to_string(before) + " finished")));
  expect_same(whole, results);
}

TEST_F(Resume, RefusesFilesThatAreNoPings) {
  stopped(SIGKILL, 5);
  const std::string good = bytes_of(partial);
  for (const std::string& bad :
       {std::string("hello"), "x" + good, "x" + good.substr(1), good.substr(0, 20)}) {
    folder.write("results.partial", bad);
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--resume"}}) {
      const Outcome outcome = run(results, more);
      EXPECT_EQ(outcome.exit_code, 2);
      EXPECT_THAT(outcome.err, AllOf(HasSubstr("results.partial"), HasSubstr("delete it")));
      EXPECT_EQ(bytes_of(partial), bad);
    }
  }
}

TEST_F(Resume, BeginsWhereThereIsNothingToGoOnWith) { EXPECT_EQ(run(results, {"--resume"}).exit_code, 0); }

// The run reserves the disk space before it computes anything.
TEST_F(Resume, FullDiskIsMetBeforeTheFirstPing) {
  Surroundings small_disk;
  small_disk.largest_file_bytes = 100000;
  const Outcome outcome = run(results, {}, small_disk);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("results.partial"), HasSubstr("cannot reserve")));
  EXPECT_EQ(names_below(folder.path()), (std::set<std::string>{"scene.toml", "thing.obj"}));
}

}  // namespace
}  // namespace tubefoot
