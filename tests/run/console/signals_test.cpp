// SPDX-License-Identifier: GPL-3.0-or-later
// What signals and limits do to a run: it goes on where it can, else it ends in order, its pings kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "fixtures/world/long_run.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

struct Signals : LongRun {
  const std::set<std::string> input{"scene.toml", "thing.obj"};
  Signals() : LongRun(3000) {}
  Outcome run(const Surroundings& surroundings = {}, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", (folder / "scene.toml").string(), "-o", results.string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, surroundings);
  }
};

TEST_F(Signals, AClosedPipeForProgressEndsNoRun) {
  Surroundings unread;
  unread.unread = {STDERR_FILENO};
  const Outcome outcome = run(unread);
  EXPECT_EQ(outcome.signal, 0);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("wrote"));
  EXPECT_TRUE(fs::exists(results / "echoes.nc"));
  EXPECT_FALSE(fs::exists(partial));
}

TEST_F(Signals, AClosedPipeForWhatWasAskedIsAFailureOnceAllElseIsDone) {
  Surroundings unread;
  unread.unread = {STDOUT_FILENO};
  const Outcome outcome = run(unread);
  EXPECT_EQ(outcome.signal, 0);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write to standard output: Broken pipe"));
  EXPECT_TRUE(fs::exists(results / "echoes.nc"));
  EXPECT_FALSE(fs::exists(partial));
  for (const char* command : {"check", "presets"}) {
    std::vector<std::string> words{command};
    if (words[0] == "check") words.push_back((folder / "scene.toml").string());
    const Outcome other = run_program(words, unread);
    EXPECT_EQ(other.exit_code, 1) << command << other.signal;
    EXPECT_THAT(other.err, HasSubstr("cannot write to standard output"));
  }
}

TEST_F(Signals, AFileTooLargeIsSaidAndLosesNothing) {
  folder.write("scene.toml", small_scene);
  ASSERT_EQ(run().exit_code, 0);
  std::size_t largest = 0;
  for (const std::string& name : names_below(results))
    largest = std::max<std::size_t>(largest, fs::file_size(results / name));
  fs::remove_all(results);
  // Too little for the ping; enough for it, but not for its picture.
  for (const std::size_t bytes : {std::size_t{4096}, largest - 1}) {
    SCOPED_TRACE(bytes);
    Surroundings limited;
    limited.largest_file_bytes = bytes;
    const Outcome outcome = run(limited);
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("cannot"));
    std::set<std::string> there = input;
    if (bytes == 4096) {
      EXPECT_THAT(outcome.err, HasSubstr("File too large"));
    } else {
      there.insert("results.partial");
      EXPECT_THAT(outcome.err, AllOf(HasSubstr("1 of 1 pings are kept"), HasSubstr("--resume")));
    }
    EXPECT_EQ(names_below(folder.path()), there);
    const Outcome again = run({}, {"--resume"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    fs::remove_all(results);
  }
}

TEST_F(Signals, AClosedTerminalAndAUsedUpLimitEndARunAsSigtermDoes) {
  for (const int signal : {SIGTERM, SIGHUP, SIGXCPU}) {
    SCOPED_TRACE(signal);
    const Outcome outcome = run(stopped_at(5, signal));
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("interrupted: "), HasSubstr("of 3000 pings are kept in"),
                                   HasSubstr("--resume")));
    EXPECT_GE(done(), 5u);
    std::set<std::string> there = input;
    there.insert("results.partial");
    EXPECT_EQ(names_below(folder.path()), there);
    fs::remove(partial);
  }
}

TEST_F(Signals, ThatAreIgnoredByWhoStartsItStayIgnored) {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGXCPU}) {
    SCOPED_TRACE(signal);
    Surroundings surroundings = stopped_at(5, signal);
    surroundings.ignored = {signal};
    const Outcome outcome = run(surroundings);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.signal << outcome.err;
    EXPECT_TRUE(fs::exists(results / "echoes.nc"));
    fs::remove_all(results);
  }
}

// Who presses Ctrl-\ wants the program dead, and its core: it is left alone.
TEST_F(Signals, SigquitEndsItWhereItStandsAndLosesNothing) {
  Surroundings surroundings = stopped_at(5, SIGQUIT);
  surroundings.before = {"/bin/sh", "-c", "ulimit -c 0; exec \"$@\"", "sh"};
  EXPECT_EQ(run(surroundings).signal, SIGQUIT);
  EXPECT_GE(done(), 5u);
  EXPECT_EQ(run({}, {"--resume"}).exit_code, 0);
}

// It ends before its first ping, and says so: what was kept before is told again.
TEST_F(Signals, WhatWasKeptBeforeIsToldAgain) {
  run(stopped_at(5, SIGTERM));
  const std::size_t kept = done();
  ASSERT_GE(kept, 5u);
  write_scene(3000);
  Surroundings at_once;
  at_once.signal = SIGTERM;
  at_once.interrupt_once_said = [](const std::string& err) {
    return err.find("going on after") != std::string::npos;
  };
  const Outcome outcome = run(at_once, {"--resume"});
  if (outcome.exit_code == 0) return;  // over before the signal came
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("interrupted: "), HasSubstr("of 3000 pings are kept in")));
  EXPECT_GE(done(), kept);
}

}  // namespace
}  // namespace tubefoot
