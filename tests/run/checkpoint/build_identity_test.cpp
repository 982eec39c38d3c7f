// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that builds that may compute different bits do not work together. The other build is a copy of the
// program with a different hash of its sources, as if one line differed.
#include "run/checkpoint/build_identity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "fixtures/mpirun.hpp"
#include "fixtures/world/long_run.hpp"
#include "run/checkpoint/ping_store.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

struct Builds : LongRun {
  const std::string sources = build_identity().at("sources").get<std::string>(),
                    others = std::string(sources.size(), '0');

  Builds() : LongRun(1000) {}
  /// Makes a copy of the program next to its libraries.
  fs::path other_build() const {
    std::string program = bytes_of(TUBEFOOT_PROGRAM);
    std::size_t found = 0;
    for (std::size_t at; (at = program.find(sources)) != program.npos; ++found)
      program.replace(at, sources.size(), others);
    EXPECT_EQ(found, 1u) << "the program holds the hash of its sources once";
    const fs::path copy = folder.write("tubefoot", program);
    fs::permissions(copy, fs::perms(0755));
    if (fs::exists(TUBEFOOT_MPI_LIBRARY))
      fs::copy_file(TUBEFOOT_MPI_LIBRARY, folder / "libtubefoot_mpi.so", fs::copy_options::skip_existing);
    return copy;
  }
  std::vector<std::string> run_here(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{
        "run", (folder / "scene.toml").string(), "-o", results.string(), "--threads", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(Builds, GoOnWithTheirOwnRunsOnly) {
  ASSERT_EQ(run_program(run_here(), stopped_at(5, SIGINT)).exit_code, 1);
  const std::string kept = bytes_of(partial);
  Surroundings elsewhere;
  elsewhere.program = other_build();
  const Outcome refused = run_program(run_here({"--resume"}), elsewhere);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("another build of tubefoot (sources " + sources + ", here " + others + ")"),
                    HasSubstr("continue with that build, or delete the .partial file")));
  EXPECT_TRUE(bytes_of(partial) == kept);
  EXPECT_FALSE(fs::exists(results));
  const Outcome again = run_program(run_here({"--resume"}));
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(Builds, ShareNoRun) {
  if (!fs::exists(TUBEFOOT_MPIRUN) || !fs::exists(TUBEFOOT_MPI_LIBRARY))
    GTEST_SKIP() << "Open MPI is not installed: libopenmpi-dev, openmpi-bin";
  const fs::path other = other_build();
  folder.write("start", "#!/bin/sh\n[ $OMPI_COMM_WORLD_RANK = 1 ] && exec " + other.string() +
                            " \"$@\"\nexec " + std::string(TUBEFOOT_PROGRAM) + " \"$@\"\n");
  fs::permissions(folder / "start", fs::perms(0755));
  Surroundings surroundings;
  surroundings.before = mpirun(2);
  surroundings.program = (folder / "start").string();
  const Outcome refused = run_program(run_here(), surroundings);
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("rank 1 on "), HasSubstr("uses a different build of tubefoot than rank 0"),
                    HasSubstr("sources " + sources + ", here " + others)));
  EXPECT_FALSE(fs::exists(results));
}

TEST_F(Builds, TellWhatTheyAre) {
  EXPECT_THAT(run_program({"--version"}).out, HasSubstr("sources: " + sources + "\n"));
  ASSERT_EQ(run_program(run_here()).exit_code, 0);
  const auto stats = nlohmann::json::parse(bytes_of(results / "stats.json"));
  EXPECT_EQ(stats["build"]["sources"], sources);
  // The identity contains nothing of the build machine or the build time.
  EXPECT_EQ(stats["build"].dump().find(TUBEFOOT_SOURCE_DIR), std::string::npos);
}

TEST(TheDifferenceOfBuilds, IsReportedWhateverItIs) {
  const nlohmann::ordered_json ours{{"sources", "a"}, {"compiler", "GNU 12"}, {"flags", "-O2"}};
  EXPECT_EQ(difference_of_builds({{"sources", "a"}, {"compiler", "GNU 13"}, {"flags", "-O3"}}, ours),
            "compiler GNU 13, here GNU 12; flags -O3, here -O2");
  EXPECT_EQ(difference_of_builds(nullptr, ours),
            "sources unknown, here a; compiler unknown, here GNU 12; flags unknown, here -O2");
}

}  // namespace
}  // namespace tubefoot
