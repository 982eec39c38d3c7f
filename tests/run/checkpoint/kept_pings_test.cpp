// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the checkpoint of an interrupted run. If the file is damaged, of another version or of another
// scene, the run computes the pings again or rejects the file. It never uses wrong pings.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
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
  expect_refused(other, "but of another version, which can finish it");
}

// A kill or a power failure may end the file at any byte.
TEST_F(KeptPings, CutAnywhereEndInTheSame) {
  expect_refused(kept.substr(0, 17), "is not a checkpoint of this version");
  folder.write("results.partial", kept);
  ASSERT_EQ(run().exit_code, 0);
  const std::string whole = bytes_of(results / "echoes.nc");
  for (const std::string& cut :
       {kept.substr(0, 300), kept.substr(0, kept.size() / 2), kept.substr(0, kept.size() - 1), kept + "x"}) {
    fs::remove_all(results);
    folder.write("results.partial", cut);
    const Outcome outcome = run();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(bytes_of(results / "echoes.nc") == whole);
  }
}

TEST_F(KeptPings, WithOneBitTurnedEndInTheSameOrAreRefused) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  folder.write("results.partial", kept);
  ASSERT_EQ(run().exit_code, 0);
  const std::string whole = bytes_of(results / "echoes.nc");
  std::uint64_t identity_bytes = 0;
  std::memcpy(&identity_bytes, kept.data() + 16, sizeof identity_bytes);
  const std::size_t before_pings = 32 + identity_bytes;
  int refused = 0, ended = 0;
  for (int k = 0; k < 8; ++k) {
    // Half of the cases lie in the header and the identity, and the others in the pings.
    const bool early = k % 2 == 0;
    const std::size_t at = std::uniform_int_distribution<std::size_t>(
        early ? 0 : before_pings, (early ? before_pings : kept.size()) - 1)(random);
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
