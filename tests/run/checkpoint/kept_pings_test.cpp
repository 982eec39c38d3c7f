// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the checkpoint of an interrupted run. If the file is damaged, of another version or of another
// scene, the run computes the pings again or rejects the file. It never uses wrong pings.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "fixtures/world/long_run.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

struct KeptPings : LongRun {
  std::string kept;  ///< a file with some pings
  KeptPings() : LongRun(600) {
    run(stopped_at(20, SIGKILL));
    kept = bytes_of(partial);
  }
  Outcome run(const Surroundings& surroundings = {}) const {
    return run_program(
        {"run", (folder / "scene.toml").string(), "-o", results.string(), "--quiet", "--resume"},
        surroundings);
  }
  /// Expects that the run rejects the file with its path, and leaves the file unchanged.
  void expect_refused(const std::string& bytes, const std::string& why) const {
    folder.write("results.partial", bytes);
    const Outcome outcome = run();
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("results.partial"), HasSubstr(why), HasSubstr("delete it")));
    EXPECT_TRUE(bytes_of(partial) == bytes);
    EXPECT_FALSE(fs::exists(results));
  }
};

TEST_F(KeptPings, OfAnotherVersionAreRefused) {
  const std::string version = "\"version\":\"";
  ASSERT_NE(kept.find(version), std::string::npos);
  std::string other = kept;
  other[other.find(version) + version.size()] = '9';
  expect_refused(other, "is damaged");  // an unknown version: its checksum does not match
  const std::string format = "tubefoot pings ";
  ASSERT_TRUE(kept.starts_with(format));
  other = kept;
  other[format.size()] = '1';
  expect_refused(other, "is not a checkpoint of this version");
}

TEST_F(KeptPings, CutAnywhereAreRefused) {
  for (const std::size_t bytes : {std::size_t{17}, std::size_t{300}, kept.size() - 1})
    expect_refused(kept.substr(0, bytes), "");
  expect_refused(kept + "x", "is cut short");
}

TEST_F(KeptPings, WithOneBitTurnedEndInTheSameOrAreRefused) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  folder.write("results.partial", kept);
  ASSERT_EQ(run().exit_code, 0);
  const std::string whole = bytes_of(results / "echoes.nc");
  const std::size_t end_of_pings = kept.find_last_not_of('\0');  // the rest is space for the other pings
  const std::size_t before_pings = 600 * (3 * sizeof(std::uint64_t) + sizeof(PingCounts));
  int refused = 0, ended = 0;
  for (int k = 0; k < 8; ++k) {
    // Half of the cases lie before the energies: in the header, the identity, the checksums.
    const std::size_t end = k % 4 == 0 ? 600 : k % 2 == 0 ? before_pings : end_of_pings;
    const std::size_t at = std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
    const int bit = static_cast<int>(random() % 8);
    SCOPED_TRACE(fmt::format("bit {} of byte {}", bit, at));
    std::string damaged = kept;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
    fs::remove_all(results);
    folder.write("results.partial", damaged);
    const Outcome outcome = run();
    if (outcome.exit_code == 0) {
      ++ended;
      EXPECT_TRUE(bytes_of(results / "echoes.nc") == whole);
    } else {
      ++refused;
      EXPECT_EQ(outcome.exit_code, 2) << outcome.signal << outcome.err;
      EXPECT_THAT(outcome.err, AllOf(HasSubstr("results.partial"), HasSubstr("delete it")));
    }
  }
  std::cout << refused << " refused, " << ended << " ended\n";
  EXPECT_GT(ended, 0);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace tubefoot
