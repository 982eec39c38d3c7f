// SPDX-License-Identifier: GPL-3.0-or-later
// Tests runs of several processes with mpirun. Together they write the same files as one process, also
// after one of them was killed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "fixtures/mpirun.hpp"
#include "fixtures/world/long_run.hpp"
#include "run/checkpoint/ping_store.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t pings = 1500;

std::size_t times(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Returns the ranks of the runs in a folder.
std::set<pid_t> ranks_at_work(const fs::path& folder) {
  std::set<pid_t> found;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream stream(entry.path() / "cmdline", std::ios::binary);
    const std::string words((std::istreambuf_iterator<char>(stream)), {});
    if (words.starts_with(TUBEFOOT_PROGRAM) && words.find(folder.string()) != words.npos)
      found.insert(std::stoi(name));
  }
  return found;
}

/// Reads the rank of a process from its environment.
int rank_of(pid_t process) {
  std::ifstream stream(fs::path("/proc") / std::to_string(process) / "environ", std::ios::binary);
  for (std::string entry; std::getline(stream, entry, '\0');)
    if (entry.starts_with("OMPI_COMM_WORLD_RANK=")) return std::stoi(entry.substr(21));
  return -1;
}

struct Ranks : LongRun {
  Sending sending = Sending::as_usual;

  Ranks() : LongRun(pings) {}
  void SetUp() override {
    if (!fs::exists(TUBEFOOT_MPIRUN) || !fs::exists(TUBEFOOT_MPI_LIBRARY))
      GTEST_SKIP() << "Open MPI is not installed: libopenmpi-dev, openmpi-bin";
    write_scene(pings);
  }
  /// With three pings of the camera before them.
  void write_scene(std::size_t sidescan_pings) const {
    folder.write("scene.toml", std::string(small_scene) + "pings = 3\n" + short_pings(sidescan_pings));
  }
  std::vector<std::string> command(const fs::path& output, const std::vector<std::string>& more) const {
    std::vector<std::string> words{
        "run", (folder / "scene.toml").string(), "-o", output.string(), "--threads", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Outcome alone(const fs::path& output, const std::vector<std::string>& more = {}) const {
    return run_program(command(output, more));
  }
  Outcome on_ranks(int ranks, const fs::path& output, const std::vector<std::string>& more = {},
                   const Surroundings& given = {}) const {
    Surroundings surroundings = given;
    surroundings.before = mpirun(ranks, sending);
    return run_program(command(output, more), surroundings);
  }
  static void expect_same(const fs::path& a, const fs::path& b) {
    ASSERT_EQ(names_below(a), names_below(b));
    for (const std::string& name : names_below(a))
      if (name != "stats.json") {
        EXPECT_TRUE(bytes_of(a / name) == bytes_of(b / name)) << name;
      }
    auto stats_a = nlohmann::json::parse(bytes_of(a / "stats.json")),
         stats_b = nlohmann::json::parse(bytes_of(b / "stats.json"));
    for (auto* stats : {&stats_a, &stats_b})
      for (const char* of_this_run :
           {"seconds", "peak_memory_mb", "ranks", "threads", "pings_kept_from_before"})
        stats->erase(of_this_run);
    EXPECT_EQ(stats_a, stats_b);
  }
};

TEST_F(Ranks, MakeTheBytesOfOneProcess) {
  const fs::path whole = folder / "whole";
  ASSERT_EQ(alone(whole).exit_code, 0);
  for (const int ranks : {1, 2, 3}) {
    SCOPED_TRACE(ranks);
    const Outcome outcome = on_ranks(ranks, results);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(times(outcome.out, "echoes.nc"), 1) << outcome.out;
    EXPECT_EQ(times(outcome.err, "pings 1503/1503"), 1) << outcome.err;
    expect_same(whole, results);
    const auto stats = nlohmann::json::parse(bytes_of(results / "stats.json"));
    EXPECT_EQ(stats.value("ranks", 1), ranks);
  }
  EXPECT_FALSE(fs::exists(partial));
}

// Rank 0 distributes work while the others send results. No rank may wait for a rank that waits.
TEST_F(Ranks, MakeTheBytesOfOneProcessWhereEverySendWaitsForItsReceiver) {
  const fs::path whole = folder / "whole";
  ASSERT_EQ(alone(whole).exit_code, 0);
  sending = Sending::nothing_ahead;
  for (const int ranks : {2, 3}) {
    SCOPED_TRACE(ranks);
    const Outcome outcome = on_ranks(ranks, results);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.signal << outcome.err;
    expect_same(whole, results);
  }
}

TEST_F(Ranks, Sample) {
  const std::vector<std::string> rays{"--engine", "ray", "--rays", "500"};
  const fs::path whole = folder / "whole";
  ASSERT_EQ(alone(whole, rays).exit_code, 0);
  const Outcome outcome = on_ranks(2, results, rays);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(bytes_of(whole / "echoes.nc") == bytes_of(results / "echoes.nc"));
}

TEST_F(Ranks, TellWhoseEnergiesAreAsOneProcessDoes) {
  const fs::path whole = folder / "whole";
  ASSERT_EQ(alone(whole, {"--labels"}).exit_code, 0);
  const Outcome outcome = on_ranks(2, results, {"--labels"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_same(whole, results);
}

// The choice for a tolerance depends on measured times, so that another run may choose differently.
TEST_F(Ranks, ComputeWhatTheFirstChoseForATolerance) {
  const Outcome outcome = on_ranks(2, results, {"--tolerance", "10%"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string chosen = nlohmann::json::parse(bytes_of(results / "stats.json"))["tolerance"]["options"];
  std::istringstream words(chosen);
  const std::vector<std::string> options{std::istream_iterator<std::string>(words), {}};
  const fs::path whole = folder / "whole";
  ASSERT_EQ(alone(whole, options).exit_code, 0) << chosen;
  EXPECT_TRUE(bytes_of(whole / "echoes.nc") == bytes_of(results / "echoes.nc")) << chosen;
}

// Any rank may die, and any rank may resume.
TEST_F(Ranks, KeepWhatWasFinishedWhenOneDies) {
  const fs::path whole = folder / "whole";
  ASSERT_EQ(alone(whole).exit_code, 0);
  for (const int dying : {1, 0}) {
    SCOPED_TRACE(dying);
    Surroundings surroundings;
    surroundings.signal = 0;
    surroundings.interrupt_when = [&] {
      if (done() < 100) return false;
      for (const pid_t process : ranks_at_work(folder.path()))
        if (rank_of(process) == dying) return kill(process, SIGKILL) == 0;
      return false;
    };
    const Outcome died = on_ranks(2, results, {}, surroundings);
    EXPECT_NE(died.exit_code, 0);
    EXPECT_TRUE(ranks_at_work(folder.path()).empty());
    EXPECT_FALSE(fs::exists(results));
    const std::size_t kept = done();
    EXPECT_GE(kept, 100u);
    ASSERT_LT(kept, pings) << "the run was over before the rank died";
    if (dying == 1) {
      EXPECT_THAT(died.err, HasSubstr("--resume"));
    }
    const Outcome again = dying == 1 ? alone(results, {"--resume"}) : on_ranks(3, results, {"--resume"});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(times(again.err, "continuing after"), 1) << again.err;
    expect_same(whole, results);
    fs::remove_all(results);
  }
}

TEST_F(Ranks, StopWhenRequestedAndSayHowToGoOn) {
  write_scene(20 * pings);  // more pings than are done before mpirun passes the signal on
  for (const bool one_rank_only : {false, true}) {
    SCOPED_TRACE(one_rank_only);
    sending = one_rank_only ? Sending::nothing_ahead : Sending::as_usual;
    Surroundings surroundings;
    surroundings.signal = one_rank_only ? 0 : SIGINT;  // to mpirun, as from the keyboard
    surroundings.interrupt_when = [&] {
      if (done() < 50) return false;
      if (!one_rank_only) return true;
      for (const pid_t process : ranks_at_work(folder.path()))
        if (rank_of(process) == 1) return kill(process, SIGTERM) == 0;
      return false;
    };
    const Outcome outcome = on_ranks(2, results, {}, surroundings);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("interrupted: "), HasSubstr("of 30003 pings are stored in"),
                                   HasSubstr("--resume")));
    EXPECT_EQ(names_below(folder.path()),
              (std::set<std::string>{"scene.toml", "thing.obj", "results.partial"}));
    fs::remove(partial);
  }
}

TEST_F(Ranks, ReportErrorsOnceAndAsOneProcessDoes) {
  const auto complaint = [&](const std::string& text, std::vector<std::string> more = {}) {
    const Outcome one = alone(results, more), three = on_ranks(3, results, more);
    EXPECT_NE(one.exit_code, 0);
    EXPECT_EQ(three.exit_code, one.exit_code) << three.err;
    EXPECT_EQ(times(three.err, text), 1) << three.err;
    EXPECT_THAT(one.err, HasSubstr(text));
  };
  complaint("--engine", {"--engine", "magic"});
  sending = Sending::nothing_ahead;
  complaint("use --engine tube", {"--reference", "--engine", "ray"});
  fs::remove(folder / "thing.obj");
  complaint("thing.obj");
}

// Nodes with different files must not mix their pings.
TEST_F(Ranks, RefuseToMixScenes) {
  folder.write("other.toml", bytes_of(folder / "scene.toml") + "# another\n");
  folder.write("start", "#!/bin/sh\n[ $OMPI_COMM_WORLD_RANK = 1 ] && scene=other || scene=scene\nexec " +
                            std::string(TUBEFOOT_PROGRAM) + " run " + folder.path().string() +
                            "/$scene.toml -o " + results.string() + "\n");
  fs::permissions(folder / "start", fs::perms(0755));
  Surroundings surroundings;
  surroundings.before = mpirun(2);
  surroundings.program = (folder / "start").string();
  const Outcome outcome = run_program({}, surroundings);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(times(outcome.err, "rank 1 on "), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("has a different command or scene"));
  EXPECT_FALSE(fs::exists(results));
}

// The program itself needs no MPI.
TEST_F(Ranks, AreNotLinkedIntoTheProgram) {
  Surroundings surroundings;
  surroundings.program = "/usr/bin/ldd";
  const Outcome needs = run_program({TUBEFOOT_PROGRAM}, surroundings);
  ASSERT_EQ(needs.exit_code, 0) << needs.err;
  EXPECT_THAT(needs.out, AllOf(HasSubstr("libtbb"), Not(HasSubstr("libmpi")), Not(HasSubstr("open-pal"))));
}

}  // namespace
}  // namespace tubefoot
