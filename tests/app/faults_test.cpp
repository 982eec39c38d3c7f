// SPDX-License-Identifier: GPL-3.0-or-later
// Tests faults during a run: a kill, a full disk, limited memory and changed input. Nothing is lost, no
// partial file has a final name, and the message states the remedy.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include "fixtures/world/long_run.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

struct Faults : LongRun {
  Faults() : LongRun(200) {}
  std::vector<std::string> words(const fs::path& output, const std::vector<std::string>& more) const {
    std::vector<std::string> all{"run", (folder / "scene.toml").string(), "-o", output.string(), "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Outcome run(const fs::path& output, const std::vector<std::string>& more = {},
              const Surroundings& surroundings = {}) const {
    return run_program(words(output, more), surroundings);
  }
  /// Runs the program after shell settings: variables, or `ulimit -v N;`.
  Outcome run_after(const std::string& before, const std::vector<std::string>& more = {}) const {
    std::string line = before + " exec '" + std::string(TUBEFOOT_PROGRAM) + "'";
    for (const std::string& word : words(results, more)) line += " '" + word + "'";
    TestFolder said;
    const std::string command =
        fmt::format("( {} ) > '{}' 2> '{}'", line, (said / "out").string(), (said / "err").string());
    const int status = std::system(command.c_str());
    Outcome outcome;
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    outcome.out = bytes_of(said / "out");
    outcome.err = bytes_of(said / "err");
    return outcome;
  }
  /// Names and bytes of all files except stats.json, which contains the seconds.
  static std::map<std::string, std::string> contents(const fs::path& of) {
    std::map<std::string, std::string> all;
    for (const std::string& name : names_below(of))
      if (name != "stats.json") all[name] = bytes_of(of / name);
    return all;
  }
  /// Expects no files except the input, an optional result and an optional checkpoint.
  void expect_no_litter() const {
    for (const auto& entry : fs::directory_iterator(folder.path()))
      EXPECT_THAT(entry.path().filename().string(),
                  AnyOf("scene.toml", "thing.obj", "results", "results.partial", "whole"));
  }
};

// The test may kill each resumed run again: before its first ping, between two pings, while files are
// written, and while an earlier result is replaced.
TEST_F(Faults, KilledAtAHundredRandomMomentsItEndsInTheSameBytes) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  const Clock::time_point start = Clock::now();
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  const double whole_s = std::chrono::duration<double>(Clock::now() - start).count();
  const auto whole = contents(folder / "whole");
  std::vector<std::string> arguments{TUBEFOOT_PROGRAM};
  for (const std::string& word : words(results, {"--resume"})) arguments.push_back(word);
  std::vector<char*> pointers;
  for (std::string& word : arguments) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  int killed = 0, ended = 0;
  while (killed < 100) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      const int nowhere = open("/dev/null", O_RDWR);
      dup2(nowhere, STDIN_FILENO), dup2(nowhere, STDOUT_FILENO), dup2(nowhere, STDERR_FILENO);
      execv(pointers[0], pointers.data());
      _exit(127);
    }
    std::this_thread::sleep_for(
        std::chrono::duration<double>(std::uniform_real_distribution(0.0, 1.2 * whole_s)(random)));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) {
      ++killed;
    } else {
      ASSERT_EQ(WEXITSTATUS(status), 0) << "a killed run must always be resumable";
      ++ended;
    }
    if (fs::exists(results)) {
      ASSERT_EQ(contents(results), whole);
    }
    ASSERT_FALSE(WIFEXITED(status) && !fs::exists(results));
    if (fs::exists(results) && random() % 2 == 0) fs::remove_all(results);
  }
  const Outcome outcome = run(results, {"--resume"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(contents(results), whole);
  expect_no_litter();
  std::cout << ended << " runs ended before they were killed\n";
}

// A disk becomes full at any call, or rejects a single call. The earlier result stays unchanged, or the new
// result is complete.
TEST_F(Faults, EveryWritingCallMayFail) {
  const std::string scene = replaced(small_scene, "beams = 4", "beams = 1\nsamples = 4");
  folder.write("scene.toml", scene);
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  const auto whole = contents(folder / "whole");
  folder.write("scene.toml", replaced(scene, "A tetrahedron", "An earlier one"));
  ASSERT_EQ(run(results).exit_code, 0);
  const fs::path earlier = folder / "earlier-results";
  fs::rename(results, earlier);
  const auto before = contents(earlier);
  ASSERT_NE(before, whole);
  folder.write("scene.toml", scene);
  const auto shim = [&](long at, bool once) {
    return fmt::format(
        "LD_PRELOAD='{}' TUBEFOOT_FAIL_BELOW='{}' TUBEFOOT_FAIL_AT={} TUBEFOOT_FAIL_COUNT='{}' {}",
        TUBEFOOT_FAILING_CALLS, folder.path().string(), at, (folder / "count").string(),
        once ? "TUBEFOOT_FAIL_ONCE=1" : "");
  };
  fs::copy(earlier, results, fs::copy_options::recursive);
  const Outcome counting = run_after(shim(-1, false));
  ASSERT_EQ(counting.exit_code, 0) << counting.err;
  ASSERT_EQ(contents(results), whole);
  const long calls = std::stol(bytes_of(folder / "count"));
  std::cout << calls << " calls\n";
  ASSERT_GT(calls, 10);
  // Tests every call if TUBEFOOT_EVERY_CALL is set, else about forty of each kind.
  const char* every = std::getenv("TUBEFOOT_EVERY_CALL");
  const long stride = every != nullptr ? 1 : std::max(1L, calls / 40);
  int tried = 0, refused = 0;
  for (const bool once : {false, true})
    for (long at = 0; at < calls; at += stride) {
      ++tried;
      SCOPED_TRACE(fmt::format("call {} of {}{}", at, calls, once ? ", once" : " and all after it"));
      fs::remove_all(results);
      fs::remove(partial);
      fs::copy(earlier, results, fs::copy_options::recursive);
      const Outcome outcome = run_after(shim(at, once));
      if (outcome.exit_code == 0) {  // a call that is unnecessary or has an alternative
        EXPECT_EQ(contents(results), whole);
        continue;
      }
      ++refused;
      EXPECT_THAT(outcome.exit_code, AnyOf(1, 2)) << outcome.err;
      EXPECT_THAT(outcome.err, AllOf(HasSubstr(folder.path().string()), HasSubstr("cannot")));
      EXPECT_THAT(outcome.err, AnyOf(HasSubstr("--resume"), HasSubstr("choose another -o")));
      // If the disk also fails to restore the earlier result, the new result is there, complete.
      EXPECT_TRUE(contents(results) == before || contents(results) == whole);
      fs::remove(folder / "count");
      for (const auto& entry : fs::directory_iterator(folder.path()))
        EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
      if (tried % 5 == 0) {
        const Outcome again = run(results, {"--resume"});
        EXPECT_EQ(again.exit_code, 0) << again.err;
        EXPECT_EQ(contents(results), whole);
      }
    }
  EXPECT_GT(refused, tried / 2);
}

TEST_F(Faults, OutOfMemoryIsSaidAndLosesNothing) {
#ifdef TUBEFOOT_SANITIZED
  GTEST_SKIP() << "sanitizers set aside terabytes of addresses";
#endif
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  const auto whole = contents(folder / "whole");
  int short_of_memory = 0, enough = 0, megabytes = 200;
  const auto limit = [&] { return fmt::format("ulimit -v {};", megabytes * 1024); };
  // With less memory the libraries do not load, or end before main.
  while (megabytes < 2000 &&
         std::system(
             fmt::format("( {} exec '{}' --version ) > /dev/null 2>&1", limit(), TUBEFOOT_PROGRAM).c_str()) !=
             0)
    megabytes += 10;
  const int least = megabytes;
  for (const int more : {5, 15, 30, 50, 80, 120, 200, 400, 1000, 7000}) {
    megabytes = least + more;
    SCOPED_TRACE(megabytes);
    fs::remove_all(results);
    const Outcome outcome = run_after(limit(), {"--threads", "2"});
    if (outcome.exit_code == 0) {
      ++enough;
      EXPECT_EQ(contents(results), whole);
      continue;
    }
    ++short_of_memory;
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    // OpenEXR does not report which resource zlib lacked.
    EXPECT_THAT(outcome.err, AnyOf(HasSubstr("memory"), HasSubstr("Data compression (zlib) failed")));
    EXPECT_FALSE(fs::exists(results));
    const Outcome again = run(results, {"--resume"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(contents(results), whole);
  }
  EXPECT_GT(enough, 0);
  EXPECT_GT(short_of_memory, 0);
}

// The first signal requests a stop. The second ends the run at once, for either of the two signals.
TEST_F(Faults, InterruptedTwiceItEndsAtOnceAndIsResumable) {
  write_scene(1000);
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  const auto whole = contents(folder / "whole");
  for (const int second : {SIGINT, SIGTERM}) {
    std::vector<std::string> arguments{TUBEFOOT_PROGRAM};
    for (const std::string& word : words(results, {})) arguments.push_back(word);
    std::vector<char*> pointers;
    for (std::string& word : arguments) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      const int nowhere = open("/dev/null", O_RDWR);
      dup2(nowhere, STDIN_FILENO), dup2(nowhere, STDOUT_FILENO), dup2(nowhere, STDERR_FILENO);
      execv(pointers[0], pointers.data());
      _exit(127);
    }
    int status = 0;
    while (done() < 5 && waitpid(child, &status, WNOHANG) == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    // Both signals arrive while the process is stopped, so that it cannot end between them.
    kill(child, SIGSTOP);
    kill(child, SIGINT);
    kill(child, SIGCONT);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    kill(child, second);
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) {
      EXPECT_EQ(WTERMSIG(status), second);
    } else {
      EXPECT_EQ(WEXITSTATUS(status), 1) << "the first was followed before the second came";
    }
    EXPECT_FALSE(fs::exists(results));
    EXPECT_GE(done(), 5u);
    const Outcome outcome = run(results, {"--resume"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(contents(results), whole);
    expect_no_litter();
    fs::remove_all(results);
  }
}

TEST_F(Faults, InputThatChangesDuringTheRunIsNoticed) {
  write_scene(1000);
  const std::string scene = bytes_of(folder / "scene.toml");
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  const auto whole = contents(folder / "whole");
  for (const std::string name : {"thing.obj", "scene.toml"}) {
    SCOPED_TRACE(name);
    const std::string good = bytes_of(folder / name);
    for (const std::string& changed : {name == "thing.obj" ? good + "\n" : std::string()}) {
      Surroundings somebody_edits;
      somebody_edits.signal = 0;
      somebody_edits.interrupt_when = [&] {
        if (done() == 0) return false;
        folder.write(name, changed);
        return true;
      };
      const Outcome outcome = run(results, {}, somebody_edits);
      EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
      EXPECT_THAT(outcome.err, AllOf(HasSubstr("was changed during the run"), HasSubstr("--resume"),
                                     HasSubstr("1000 of 1000 pings are stored")));
      EXPECT_FALSE(fs::exists(results));
      EXPECT_EQ(run(results, {"--resume"}).exit_code, 2) << "it is still another";
      folder.write(name, good);
      const Outcome again = run(results, {"--resume"});
      EXPECT_EQ(again.exit_code, 0) << again.err;
      EXPECT_EQ(contents(results), whole);
      fs::remove_all(results);
    }
  }
}

// A run that was killed at its start may leave such files. They contain nothing that can be lost.
TEST_F(Faults, FilesWithoutPingsAreBegunAnew) {
  folder.write("results.partial", "");
  EXPECT_EQ(run(results).exit_code, 0);
  EXPECT_FALSE(fs::exists(partial));
}

}  // namespace
}  // namespace tubefoot
