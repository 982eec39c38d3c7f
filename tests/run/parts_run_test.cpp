// SPDX-License-Identifier: GPL-3.0-or-later
// Tests runs in independent shards. The joined shards equal the single run, to the byte, also after kills
// and for any number of shards.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

using Words = std::vector<std::string>;

struct Parts : testing::Test {
  TestFolder folder;
  const fs::path results = folder / "results";

  Parts() {
    folder.write("thing.obj", tetrahedron);
    write_scene(11);
  }
  /// With three pings of a camera before them: no number of shards divides the pings of both.
  void write_scene(std::size_t sidescan_pings, std::string_view more = "") const {
    folder.write("scene.toml", std::string(small_scene) + "samples = 64\npings = 3\n" +
                                   short_pings(sidescan_pings) + std::string(more));
  }
  Outcome run(const fs::path& output, const Words& more = {}, const Surroundings& surroundings = {}) const {
    Words words{"run", (folder / "scene.toml").string(), "-o", output.string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, surroundings);
  }
  Outcome part(int number, int of, Words more = {}, const Surroundings& surroundings = {}) const {
    more.insert(more.end(), {"--shard", fmt::format("{}/{}", number, of)});
    return run(results, more, surroundings);
  }
  fs::path file(int number, int of) const {
    return folder / fmt::format("results.part-{}-of-{}", number, of);
  }
  void all_parts(int of, const Words& more = {}) const {
    for (int number = of; number >= 1; --number) {
      const Outcome outcome = part(number, of, more);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.signal << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr(fmt::format("shard {} of {}", number, of)));
    }
  }
  Outcome join(const Words& more = {}) const {
    Words words{"join", (folder / "scene.toml").string(), "-o", results.string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  void expect_refused(const std::string& why) const {
    const Outcome outcome = join();
    EXPECT_EQ(outcome.exit_code, 2) << outcome.signal << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(why));
    EXPECT_FALSE(fs::exists(results));
    EXPECT_FALSE(fs::exists(folder / "results.partial"));
  }
  /// Compares all files except for the process data in stats.json.
  static void expect_same(const fs::path& a, const fs::path& b) {
    ASSERT_EQ(names_below(a), names_below(b));
    for (const std::string& name : names_below(a))
      if (name != "stats.json") {
        EXPECT_TRUE(bytes_of(a / name) == bytes_of(b / name)) << name;
      }
    auto stats_a = nlohmann::json::parse(bytes_of(a / "stats.json")),
         stats_b = nlohmann::json::parse(bytes_of(b / "stats.json"));
    for (auto* stats : {&stats_a, &stats_b})
      for (const char* of_this_run : {"seconds", "peak_memory_mb", "threads", "parts"})
        stats->erase(of_this_run);
    EXPECT_EQ(stats_a, stats_b);
  }
  std::set<std::string> names() const { return names_below(folder.path()); }
};

TEST_F(Parts, JoinToTheBytesOfOneRun) {
  const fs::path whole = folder / "whole";
  for (const Words& requested : std::vector<Words>{{},
                                                   {"--reference", "--tolerance", "1e-6", "--sensor", "side"},
                                                   {"--labels", "--seed", "7"},
                                                   {"--labels", "--label-level", "6", "--pings", "1:2"},
                                                   {"--engine", "ray", "--rays", "500", "--pings", "1:2"}}) {
    ASSERT_EQ(run(whole, requested).exit_code, 0);
    for (const int of : {1, 3, 7}) {
      SCOPED_TRACE(fmt::format("{} parts, {}", of, fmt::join(requested, " ")));
      all_parts(of, requested);
      EXPECT_FALSE(fs::exists(results));
      const Outcome joined = join();  // `join` knows the options of the shards
      ASSERT_EQ(joined.exit_code, 0) << joined.signal << joined.err;
      expect_same(whole, results);
      EXPECT_EQ(nlohmann::json::parse(bytes_of(results / "stats.json")).at("parts"), of);
      for (const std::string& name : names()) EXPECT_EQ(name.find(".part"), name.npos) << name;
      fs::remove_all(results);
    }
  }
}

TEST_F(Parts, JoinToTheReceivedDataOfOneRun) {
  write_scene(11, "speckle = \"rayleigh\"\nnoise_level_db = 90\ntvg_spreading = 30\n");
  const fs::path whole = folder / "whole";
  ASSERT_EQ(run(whole).exit_code, 0);
  EXPECT_EQ(NetcdfReader(whole / "echoes.nc").values("/side", "received").size(), 11u * 2 * 40);
  EXPECT_THAT(NetcdfReader(whole / "echoes.nc").variables("/camera"),
              testing::Not(testing::Contains("received")));
  all_parts(3);
  ASSERT_EQ(join().exit_code, 0);
  expect_same(whole, results);
}

TEST_F(Parts, RememberTheFilesThatTheyOmit) {
  const fs::path whole = folder / "whole";
  ASSERT_EQ(run(whole, {"--without", "side-waterfall.png,exr"}).exit_code, 0);
  all_parts(3, {"--without", "side-waterfall.png,exr"});
  ASSERT_EQ(join({"--keep-shards"}).exit_code, 0);
  expect_same(whole, results);
  EXPECT_TRUE(fs::exists(results / "side.png"));
  EXPECT_FALSE(fs::exists(results / "side.exr"));
  ASSERT_EQ(join({"--without", "png"}).exit_code, 0);  // the option of join takes precedence
  EXPECT_TRUE(fs::exists(results / "side.exr"));
  EXPECT_FALSE(fs::exists(results / "side.png"));
}

TEST_F(Parts, RejectUnknownNamesOfOmittedFiles) {
  const Outcome outcome = part(1, 2, {"--without", "side-waterfal.png"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean 'side-waterfall.png'?"));
  EXPECT_FALSE(fs::exists(file(1, 2)));
}

TEST_F(Parts, OfMoreThanThereArePingsJoin) {
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  all_parts(16);  // of 14 pings
  ASSERT_EQ(join({"--keep-shards"}).exit_code, 0);
  expect_same(folder / "whole", results);
  EXPECT_TRUE(fs::exists(file(16, 16)));
}

TEST_F(Parts, ThatWereKilledGoOn) {
  constexpr std::size_t pings = 3000;
  write_scene(pings);
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  for (const int signal : {SIGKILL, SIGINT}) {
    ASSERT_EQ(part(1, 2).exit_code, 0);
    Surroundings surroundings;
    surroundings.signal = signal;
    surroundings.interrupt_when = [&] {
      std::error_code none_yet;
      const auto bytes = fs::file_size(file(2, 2), none_yet);
      return !none_yet && bytes > 20000;
    };
    const Outcome stopped = part(2, 2, {}, surroundings);
    EXPECT_NE(stopped.exit_code, 0);
    if (signal == SIGINT) {
      EXPECT_THAT(stopped.err,
                  AllOf(HasSubstr("interrupted: "), HasSubstr("pings of shard 2 of 2 are stored in"),
                        HasSubstr("--resume")));
    } else {  // as if it had been writing one
      fs::resize_file(file(2, 2), fs::file_size(file(2, 2)) - 7);
    }
    expect_refused("shard 2 of 2");
    EXPECT_THAT(part(2, 2).err, HasSubstr("add --resume to continue"));
    const Outcome other = part(2, 2, {"--resume", "--arithmetic", "filtered"});
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_THAT(other.err, HasSubstr("arithmetic = \"fixed\", not \"filtered\""));
    const Outcome again = part(2, 2, {"--resume"});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.err, HasSubstr("continuing after "));
    EXPECT_EQ(part(2, 2, {"--resume"}).exit_code, 0) << "it is whole";
    const Outcome joined = join();
    ASSERT_EQ(joined.exit_code, 0) << joined.err;
    expect_same(folder / "whole", results);
    fs::remove_all(results);
  }
}

TEST_F(Parts, ThatAreNotAllThereAreRefused) {
  expect_refused("there are no shards for");
  all_parts(3);
  fs::remove(file(2, 3));
  expect_refused("of 3 shards, 2 is missing");
  fs::copy_file(file(1, 3), file(2, 3));
  expect_refused("contains shard 1 of 3");
  fs::remove(file(2, 3));
  fs::copy_file(file(1, 3), file(1, 4));
  expect_refused("shards of a run with 3 shards and of a run with 4 shards");
}

TEST_F(Parts, OfAnotherRunAreRefused) {
  all_parts(2);
  ASSERT_EQ(part(1, 2, {"--resume"}).exit_code, 0);
  fs::remove(file(2, 2));
  ASSERT_EQ(part(2, 2, {"--arithmetic", "filtered"}).exit_code, 0);
  expect_refused("shard 2 of 2 ('" + file(2, 2).string() + "') had arithmetic = \"filtered\", not \"fixed\"");
  for (const int k : {1, 2}) {
    fs::remove(file(k, 2));
    ASSERT_EQ(part(k, 2, {"--labels", "--label-level", k == 1 ? "20" : "12"}).exit_code, 0);
  }
  expect_refused("label_level_db = 12");
  for (const int k : {1, 2}) fs::remove(file(k, 2));
  ASSERT_EQ(part(1, 2).exit_code, 0);
  folder.write("thing.obj", std::string(tetrahedron) + "v 9 9 9\n");
  ASSERT_EQ(part(2, 2).exit_code, 0);
  expect_refused("has changed since shard 1 of 2");
  folder.write("thing.obj", tetrahedron);
  expect_refused("has changed since shard 2 of 2");
}

TEST_F(Parts, AreNotTakenFromALinkOrAFileOfSomethingElse) {
  all_parts(2);
  fs::rename(file(2, 2), folder / "elsewhere");
  fs::create_symlink(folder / "elsewhere", file(2, 2));
  expect_refused("it is a symbolic link");
  fs::remove(file(2, 2));
  folder.write(file(2, 2).filename().string(), "mine");
  expect_refused("is not a shard");
  const Outcome outcome = part(2, 2, {"--resume"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("is not a shard"));
  EXPECT_EQ(bytes_of(file(2, 2)), "mine");
}

TEST_F(Parts, AreNotComputedTwiceAtATimeNorJoinedMeanwhile) {
  write_scene(200000);
  Surroundings surroundings;
  surroundings.interrupt_when = [&] {
    std::error_code none_yet;
    if (fs::file_size(file(1, 1), none_yet) < 20000 || none_yet) return false;
    EXPECT_THAT(part(1, 1).err, HasSubstr("another process is computing shard 1 of 1"));
    expect_refused("another process is computing shard 1 of 1");
    return true;
  };
  EXPECT_EQ(part(1, 1, {}, surroundings).exit_code, 1);
}

TEST_F(Parts, NeedSettingsThatDoNotDependOnTheMachine) {
  const auto refused = [&](const Words& words, const std::string& why) {
    const Outcome outcome = run(results, words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(why));
  };
  refused({"--shard", "1/2", "--tolerance", "10%"}, "tubefoot advise");
  for (const char* word : {"0/2", "3/2", "1", "1/", "/2", "1/2/3", "1/x", "01/2", "-1/2", "1/10001"})
    refused({"--shard", word}, "expected the number of the shard and the number of shards");
  Surroundings surroundings;
  surroundings.before = {"/usr/bin/env", "OMPI_COMM_WORLD_SIZE=2", "OMPI_COMM_WORLD_RANK=0"};
  EXPECT_THAT(run(results, {"--shard", "1/2"}, surroundings).err, HasSubstr("mpirun divides one run"));
  EXPECT_EQ(names(), (std::set<std::string>{"scene.toml", "thing.obj"}));
}

// After a change of any byte of a shard file, by anyone, the result is the same or there is none.
TEST_F(Parts, WithAnyByteChangedJoinToTheSameOrAreRefused) {
  const Words small{"--sensor", "side",   "--pings", "0:1",        "--engine",
                    "ray",      "--rays", "20",      "--pictures", "none"};
  all_parts(1, small);
  const std::string good = bytes_of(file(1, 1));
  ASSERT_EQ(join({"--pictures", "none", "--keep-shards"}).exit_code, 0);
  const std::string whole = bytes_of(results / "echoes.nc");
  int refused = 0, joined = 0;
  // This test changes some bytes. The test PingFiles changes all bytes of a file. Most changes are in the
  // header and in the pings.
  for (std::size_t at = 0; at<good.size(); at += at> 40 && at < good.size() - 600 ? 97 : 5) {
    SCOPED_TRACE(at);
    fs::remove_all(results);
    std::string damaged = good;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    folder.write(file(1, 1).filename().string(), damaged);
    const Outcome outcome = join({"--quiet", "--pictures", "none", "--keep-shards"});
    if (outcome.exit_code == 0) {
      ++joined;
      EXPECT_TRUE(bytes_of(results / "echoes.nc") == whole);
    } else {
      ++refused;
      EXPECT_EQ(outcome.exit_code, 2) << outcome.signal << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("results.part-1-of-1"));
    }
  }
  EXPECT_GT(refused, 20);
  EXPECT_EQ(joined, 0) << "all of it has sums";
}

TEST_F(Parts, SayWhichPingIsDamagedAndMeasureItAgain) {
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  all_parts(2);
  std::string damaged = bytes_of(file(1, 2));
  damaged[damaged.size() - 3] =
      static_cast<char>(~damaged[damaged.size() - 3]);  // the last ping that was written
  folder.write(file(1, 2).filename().string(), damaged);
  expect_refused("is damaged at ping ");
  ASSERT_EQ(part(1, 2, {"--resume"}).exit_code, 0);
  ASSERT_EQ(join().exit_code, 0);
  expect_same(folder / "whole", results);
}

TEST_F(Parts, MeetAFullDiskWithWhatTheyHave) {
  write_scene(3000);
  Surroundings small_disk;
  small_disk.largest_file_bytes = 100000;
  const Outcome outcome = part(1, 1, {}, small_disk);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("cannot write the shard"),
                    HasSubstr("of 3003 pings of shard 1 of 1 are stored"), HasSubstr("--resume")));
  ASSERT_EQ(part(1, 1, {"--resume", "--quiet"}).exit_code, 0);
  ASSERT_EQ(join({"--quiet"}).exit_code, 0);
}

}  // namespace
}  // namespace tubefoot
