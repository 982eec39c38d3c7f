// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the effect of signals and limits on a run. The run continues if it can. Otherwise it ends in order
// and keeps its pings.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

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
  std::vector<std::string> footprints_to(const fs::path& output) const {
    return {"footprints",   (folder / "scene.toml").string(), "--sensor", "camera", "--quiet", "-o",
            output.string()};
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

TEST_F(Signals, AClosedPipeForWhatWasRequestedIsAFailureOnceAllElseIsDone) {
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
  // The limit is too small for the ping, or large enough for the ping but not for its picture.
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
      EXPECT_THAT(outcome.err, AllOf(HasSubstr("1 of 1 pings are stored"), HasSubstr("--resume")));
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
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("interrupted: "), HasSubstr("of 3000 pings are stored in"),
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

// A user who presses Ctrl-\ wants to end the program with a core file, so that the program does not handle
// this signal.
TEST_F(Signals, SigquitEndsItWhereItStandsAndLosesNothing) {
  Surroundings surroundings = stopped_at(5, SIGQUIT);
  surroundings.before = {"/bin/sh", "-c", "ulimit -c 0; exec \"$@\"", "sh"};
  EXPECT_EQ(run(surroundings).signal, SIGQUIT);
  EXPECT_GE(done(), 5u);
  EXPECT_EQ(run({}, {"--resume"}).exit_code, 0);
}

// The run ends before its first ping and reports so. It reports the earlier pings again.
TEST_F(Signals, WhatWasKeptBeforeIsReportedAgain) {
  run(stopped_at(5, SIGTERM));
  const std::size_t kept = done();
  ASSERT_GE(kept, 5u);
  write_scene(3000);
  Surroundings at_once;
  at_once.signal = SIGTERM;
  at_once.interrupt_once_said = [](const std::string& err) {
    return err.find("continuing after") != std::string::npos;
  };
  const Outcome outcome = run(at_once, {"--resume"});
  if (outcome.exit_code == 0) return;  // over before the signal came
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("interrupted: "), HasSubstr("of 3000 pings are stored in")));
  EXPECT_GE(done(), kept);
}

/// A program that starts with its process number in a file, and whose threads are all waiting when it is
/// observed.
struct Waiting {
  fs::path number;
  int waited = 0;

  Surroundings surroundings() const {
    Surroundings s;
    s.before = {"/bin/sh", "-c", "echo $$ > '" + number.string() + "'; exec \"$@\"", "sh"};
    return s;
  }
  pid_t process() const { return static_cast<pid_t>(std::atol(bytes_of(number).c_str())); }
  /// Returns whether none of its threads has run in the last half second. The caller calls it every 10 ms.
  bool met() {
    constexpr int often = 50;
    std::error_code gone;
    if (!fs::exists(number) || process() <= 0) return false;
    for (const auto& thread : fs::directory_iterator(fmt::format("/proc/{}/task", process()), gone)) {
      std::ostringstream status;
      status << std::ifstream(thread.path() / "status").rdbuf();
      if (status.str().find("State:\tS") == std::string::npos) waited = -1;
    }
    return ++waited > often;
  }
};

// The program waits in open(), until another process reads the pipe.
TEST_F(Signals, EndAProgramThatWaitsAfterFiveSeconds) {
  folder.write("scene.toml", small_scene);
  ASSERT_EQ(run().exit_code, 0);
  const auto before = names_below(folder.path());
  const fs::path pipe = folder / "pipe.csv";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    SCOPED_TRACE(signal);
    Waiting program{folder / "number"};
    Surroundings surroundings = program.surroundings();
    surroundings.signal = signal;
    surroundings.interrupt_when = [&] { return program.met(); };
    const Outcome outcome = run_program(footprints_to(pipe), surroundings);
    EXPECT_EQ(outcome.signal, signal) << outcome.err;
    EXPECT_GE(outcome.seconds_to_stop, 4.5);
    EXPECT_LT(outcome.seconds_to_stop, 15);
    EXPECT_THAT(outcome.err, HasSubstr("the work did not stop within 5 s"));
    fs::remove(program.number);
  }
  fs::remove(pipe);
  EXPECT_EQ(names_below(folder.path()), before);
}

TEST_F(Signals, EndAProgramThatWaitsAtTheSecond) {
  folder.write("scene.toml", small_scene);
  const fs::path pipe = folder / "pipe.csv";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  Waiting program{folder / "number"};
  Surroundings surroundings = program.surroundings();
  surroundings.signal = SIGTERM;
  bool requested = false;
  surroundings.interrupt_when = [&] {
    if (!program.met()) return false;
    if (requested) return true;
    program.waited = 0;  // the program has half a second to notice the first signal
    requested = kill(program.process(), SIGINT) == 0;
    return false;
  };
  const Outcome outcome = run_program(footprints_to(pipe), surroundings);
  EXPECT_EQ(outcome.signal, SIGTERM) << outcome.err;
  EXPECT_LT(outcome.seconds_to_stop, 3);
}

// Each variable names a pipe without a writer, so that a process that opens it waits.
TEST_F(Signals, VariablesOfLibrariesDoNotReachThem) {
  folder.write("scene.toml", small_scene);
  const std::string pipe = (folder / "settings").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  Surroundings hostile;
  hostile.before = {
      "/usr/bin/env",    "NCRCENV_RC=" + pipe,   "DAPRCFILE=" + pipe,   "GDAL_CONFIG_FILE=" + pipe,
      "CPL_LOG=" + pipe, "OPENSSL_CONF=" + pipe, "PROJ_AUX_DB=" + pipe, "HDF5_PLUGIN_PRELOAD=" + pipe};
  const Outcome outcome = run(hostile);
  EXPECT_EQ(outcome.signal, 0) << "it waited for a pipe";
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  // netCDF itself opens echo files of the classic format.
  int id = 0;
  const fs::path classic = folder / "classic.nc";
  ASSERT_EQ(nc_create(classic.c_str(), NC_CLOBBER, &id), NC_NOERR);
  ASSERT_EQ(nc_close(id), NC_NOERR);
  const Outcome compared = run_program({"compare", classic.string(), classic.string()}, hostile);
  EXPECT_EQ(compared.signal, 0) << "it waited for a pipe";
  EXPECT_EQ(compared.exit_code, 2) << compared.err;
}

}  // namespace
}  // namespace tubefoot
