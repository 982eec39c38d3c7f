// SPDX-License-Identifier: GPL-3.0-or-later
// Tests invalid combinations of `tubefoot import`: options without an object, references with tables of
// other lengths, and folders with links to the outside. It also imports the kept originals again.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bags/recordings.hpp"
#include "files/file_hash.hpp"
#include "files/usage_error.hpp"
#include "fixtures/foreign_echoes.hpp"
#include "fixtures/program.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "foreign_arrays.hpp"
#include "import/candidate_file.hpp"
#include "import/foreign_file.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using Words = std::vector<std::string>;

std::string hash_of(const std::string& bytes) {
  Sha256 hash;
  hash.update(bytes);
  return hash.hex_digest();
}

struct ImportRefusals : testing::Test {
  TestFolder folder;
  std::string out = (folder / "candidate.nc").string(),
              like = write_foreign(folder / "like.nc", least_echoes()).string();

  /// A picture of three beams with four samples, one row per beam, with distinct values.
  static std::string picture(double first = 1) {
    std::vector<double> values;
    for (int k = 0; k < 12; ++k) values.push_back(first + k * 7 % 12);
    return npy_bytes("<f8", {3, 4}, values);
  }
  Outcome import(Words results, const Words& options = {}) const {
    results.insert(results.begin(), "import");
    results.insert(results.end(), {"--like", like, "-o", out});
    if (std::ranges::find(options, "--profile") == options.end())
      results.insert(results.end(), {"--scale", "energy"});
    results.insert(results.end(), options.begin(), options.end());
    return run_program(results);
  }
  std::string refusal_of(const Words& results, const Words& options = {}) const {
    SCOPED_TRACE(fmt::format("{}", fmt::join(options, " ")));
    const Outcome outcome = import(results, options);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out << outcome.err;
    EXPECT_FALSE(fs::exists(out));
    EXPECT_FALSE(fs::exists(folder / "candidate.originals"));
    return outcome.err;
  }
  std::vector<double> energies(const std::string& of) const {
    return read_echo_file(of).sensors.at(0).energy;
  }
  bool has(const char* variable) const {
    return read_whole_echo_file(out).more.at(0).variable(variable) != nullptr;
  }
};

TEST_F(ImportRefusals, AFanInPixelsHasNeitherOrderNorAxes) {
  const std::string fan =
      folder.write("fan.npy", npy_bytes("<f8", {4, 4}, std::vector<double>(16, 1))).string();
  const Words cartesian{"--cartesian", "2:4:1"};
  for (const Words& idle : {Words{"--order", "two-sided"},
                            {"--order", "range-first"},
                            {"--azimuths", "even"},
                            {"--ranges", "1:4"},
                            {"--range-origin", "edges"},
                            {"--flip-range"},
                            {"--no-flip-range"},
                            {"--resample"},
                            {"--range-variable", "r"},
                            {"--azimuth-variable", "a"}}) {
    Words options = cartesian;
    options.insert(options.end(), idle.begin(), idle.end());
    EXPECT_THAT(refusal_of({fan, fan}, options), AllOf(HasSubstr(idle[0] + " "), HasSubstr("--cartesian")))
        << idle[0];
  }
  EXPECT_EQ(import({fan, fan}, cartesian).exit_code, 0);
}

TEST_F(ImportRefusals, OptionsWithoutAnObjectAreRefused) {
  const auto refused = [&](const std::string& file, const std::string& bytes, const Words& options,
                           const std::string& why) {
    const std::string at = folder.write(file, bytes).string();
    EXPECT_THAT(refusal_of({at, at}, options), AllOf(HasSubstr(options[0]), HasSubstr(why))) << file;
  };
  const std::string csv = "1,2,3,4\n5,6,7,8\n9,10,11,12\n", npz = npz_bytes({{"a", picture()}}),
                    cdr = recordings::projected(recordings::small_sonar());
  for (const char* option : {"--variable", "--range-variable", "--azimuth-variable"}) {
    refused("a.csv", csv, {option, "x"}, "text");
    refused("a.npy", picture(), {option, "x"}, "NPY");
    refused("a.cdr", cdr, {option, "x"}, "ROS");
  }
  const std::string png("\x89PNG\r\n\x1a\n");
  for (const char* option : {"--range-variable", "--azimuth-variable"})
    refused("a.png", png, {option, "x"}, "picture");
  refused("a.csv", csv, {"--topic", "/sonar"}, "text");
  refused("a.npy", picture(), {"--topic", "/sonar"}, "NPY");
  refused("a.npz", npz, {"--topic", "/sonar"}, "NPZ");
  refused("a.png", png, {"--topic", "/sonar"}, "picture");
  refused("a.nc", bytes_of(like), {"--topic", "/sonar"}, "netCDF");
  refused("a.npy", picture(), {"--range-origin", "edges"}, "needs ranges");
  // The assumption of a profile is not an option of the user.
  const std::string at = folder.write("a.npy", picture()).string();
  EXPECT_EQ(import({at, at}, {"--profile", "oceansim", "--order", "beam-first"}).exit_code, 0);
}

TEST_F(ImportRefusals, AFullDiskLeavesWhatWasThere) {
  const std::string at = folder.write("a.npy", picture()).string();
  ASSERT_EQ(import({at, at}).exit_code, 0);
  const std::string earlier = bytes_of(out);
  const auto before = names_below(folder.path());
  Surroundings full_disk;
  full_disk.largest_file_bytes = 1000;  // more than a picture, less than an echo file
  const Outcome outcome =
      run_program({"import", at, at, "--like", like, "-o", out, "--scale", "energy"}, full_disk);
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("candidate"));
  EXPECT_EQ(bytes_of(out), earlier);
  EXPECT_EQ(names_below(folder.path()), before);
}

TEST_F(ImportRefusals, AFileWithoutAPictureIsNoPing) {
  refusal_of({folder.write("none.npz", npz_bytes({})).string()});
}

TEST_F(ImportRefusals, PointsHaveTheirOwnAxes) {
  const std::string npz = npz_bytes({{"map", npy_bytes("<f8", {2, 2, 3}, std::vector<double>(12, 1))},
                                     {"ranges", npy_bytes("<f8", {2}, {1, 2})}});
  ReadOptions options;
  options.arrays = {"map", "ranges", "", true};
  expect_refused<UsageError>([&] { read_foreign_file(folder.write("map.npz", npz), options); },
                             "--range-variable");
}

TEST_F(ImportRefusals, NoMoreEnergiesAreWrittenThanThereAre) {
  const WholeEchoFile reference = read_whole_echo_file(like);
  CandidateEchoes candidate;
  candidate.axes = axes_of(reference, 0);
  candidate.pings = 2;
  candidate.ping_of_reference = {0, 1};
  candidate.energy.assign(2 * 3 * 4, 1);
  write_candidate(out, candidate, reference, 0);
  candidate.energy.resize(3 * 4);
  EXPECT_THROW(write_candidate(out, candidate, reference, 0), std::logic_error);
}

/// Their values lie along dimensions of another file, which have other lengths.
TEST_F(ImportRefusals, TablesOfAReferenceThatAreNotAsLongAreLeftOut) {
  ForeignGroup group = least_echoes();
  group.dimensions.emplace_back("xyz", 1);
  group.variables["sensor_position"] = {{"ping", "xyz"}, "m", {1, 2}};
  group.variables["sensor_gain"] = {{"ping", "beam"}, "1", {1, 2, 3, 4, 5, 6}};
  group.variables["sensor_depth"] = {{"ping"}, "m", {7, 8}};
  write_foreign(like, group);
  const std::string at = folder.write("a.npy", picture()).string();
  ASSERT_EQ(import({at, at}).exit_code, 0);
  EXPECT_FALSE(has("sensor_position"));
  EXPECT_TRUE(has("sensor_gain"));
  const std::string wider =
      folder.write("wide.npy", npy_bytes("<f8", {7, 4}, std::vector<double>(28, 1))).string();
  const Outcome outcome = import({wider, wider}, {"--order", "beam-first", "--azimuths", "-12:12"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_FALSE(has("sensor_gain"));
  EXPECT_THAT(read_whole_echo_file(out).more.at(0).variable("sensor_depth")->values,
              testing::ElementsAre(7, 8));
}

TEST_F(ImportRefusals, AxesThatAreNoAxesOfAPictureAreRefusedBeforeTheyAreCopied) {
  const std::vector<double> values(20 * 4, 1), line(25, 1);
  const std::string npz = npz_bytes({{"image", npy_bytes("<f8", {20, 2, 2}, values)},
                                     {"long", npy_bytes("<f8", {25}, line)},
                                     {"good", npy_bytes("<f8", {2}, {1, 2})}});
  ReadOptions options;
  options.arrays = {"image", "long", "", false};
  const auto read = [&] { return read_foreign_file(folder.write("a.npz", npz), options); };
  expect_refused<InputError>(read, "'long' (25)");
  options.arrays = {"image", "good", "long", false};
  expect_refused<InputError>(read, "'long' (25)");
  options.arrays.azimuth_variable = "good";
  EXPECT_EQ(read().frames.size(), 20u);
  // A row of a two-sided picture has the ranges of both sides.
  const std::string sides = npz_bytes({{"image", npy_bytes("<f8", {5, 6}, std::vector<double>(30, 1))},
                                       {"r", npy_bytes("<f8", {3}, {1, 2, 3})}});
  options.arrays = {"image", "r", "", false};
  EXPECT_EQ(read_foreign_file(folder.write("b.npz", sides), options).frames.at(0).range_m.size(), 3u);
}

/// The farthest row comes first, and the ranges of the file state this. The profile does not reverse them
/// again.
TEST_F(ImportRefusals, RangesOfAFileAreNotTurnedAgainByItsProfile) {
  const std::vector<double> truth = energies(like);
  std::vector<double> rows;
  for (std::size_t ping = 0; ping < 2; ++ping)
    for (std::size_t s = 4; s-- > 0;)
      for (std::size_t b = 0; b < 3; ++b) rows.push_back(truth[(ping * 3 + b) * 4 + s]);
  const std::string npz = folder
                              .write("a.npz", npz_bytes({{"image", npy_bytes("<f8", {2, 4, 3}, rows)},
                                                         {"r", npy_bytes("<f8", {4}, {3.5, 3, 2.5, 2})}}))
                              .string();
  const Words options{"--profile",  "stonefish", "--azimuths",       "even",
                      "--variable", "image",     "--range-variable", "r"};
  const Outcome outcome = import({npz}, options);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(energies(out), truth);
}

struct LinkedFolders : ImportRefusals {
  /// A recording of two messages in `bag`.
  fs::path bag() const {
    using namespace recordings;
    const fs::path made = folder / "bag";
    fs::create_directory(made);
    folder.write("bag/r_0.mcap", mcap::file(mcap::schema(1, projected_type) + mcap::channel(1, 1, "/sonar") +
                                            mcap::message(1, 0, projected(small_sonar())) +
                                            mcap::message(1, 1, projected(small_sonar()))));
    folder.write("bag/metadata.yaml",
                 "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - r_0.mcap\n");
    return made;
  }
};

TEST_F(LinkedFolders, OfARecordingOnlyItsFilesAreKept) {
  const std::string made = bag().string();
  folder.write("bag/diary.txt", "private");
  fs::create_symlink(folder.write("secret", "secret"), folder / "bag/linked");
  const Outcome outcome = import({made});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(bytes_of(folder / "candidate.originals/list.txt"),
              AllOf(HasSubstr("  bag/metadata.yaml\n"), HasSubstr("  bag/r_0.mcap\n"),
                    Not(HasSubstr("diary")), Not(HasSubstr("linked"))));
  EXPECT_FALSE(fs::exists(folder / "candidate.originals" / hash_of("secret")));
}

TEST_F(LinkedFolders, LinksOutOfAFolderAreRefused) {
  const std::string made = bag().string();
  fs::rename(folder / "bag/r_0.mcap", folder / "elsewhere.mcap");
  fs::create_symlink(folder / "elsewhere.mcap", folder / "bag/r_0.mcap");
  EXPECT_THAT(refusal_of({made}), AllOf(HasSubstr("metadata.yaml:4"), HasSubstr("elsewhere.mcap")));
  fs::remove(folder / "bag/r_0.mcap");
  fs::rename(folder / "elsewhere.mcap", folder / "bag/r_1.mcap");
  fs::create_symlink("r_1.mcap", folder / "bag/r_0.mcap");
  EXPECT_EQ(import({made}).exit_code, 0) << "links within are none of that";
  fs::remove(out);
  fs::remove_all(folder / "candidate.originals");
  fs::rename(folder / "bag/metadata.yaml", folder / "elsewhere.yaml");
  fs::create_symlink(folder / "elsewhere.yaml", folder / "bag/metadata.yaml");
  EXPECT_THAT(refusal_of({made}), HasSubstr("elsewhere.yaml"));

  fs::create_directory(folder / "frames");
  folder.write("frames/1.npy", picture());
  fs::create_symlink(folder.write("other.npy", picture()), folder / "frames/2.npy");
  EXPECT_THAT(refusal_of({(folder / "frames").string()}), AllOf(HasSubstr("2.npy"), HasSubstr("other.npy")));
}

struct Again : ImportRefusals {
  /// Imports six pictures, three of each ping, and returns the folder of originals.
  fs::path kept(const Words& options = {}) const {
    Words pictures;
    for (int k = 1; k <= 6; ++k)
      pictures.push_back(folder.write(fmt::format("f{}.npy", k), picture(10 * k)).string());
    const Outcome outcome = import(pictures, options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return folder / "candidate.originals";
  }
  Outcome again(const fs::path& results, const Words& options = {}) const {
    Words words{"import",  results.string(), "--like", like, "-o", (folder / "again.nc").string(),
                "--scale", "energy"};
    words.insert(words.end(), options.begin(), options.end());
    return run_program(words);
  }
};

TEST_F(Again, OriginalsMakeTheSameOnceMore) {
  const fs::path originals = kept();
  const Outcome outcome = again(originals);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<double> first = energies(out);
  EXPECT_EQ(first.size(), 6u * 12);
  EXPECT_EQ(energies((folder / "again.nc").string()), first);
  // The order of hashes differs from the order of names.
  Words hashes;
  for (int k = 1; k <= 6; ++k) hashes.push_back(hash_of(picture(10 * k)));
  EXPECT_FALSE(std::ranges::is_sorted(hashes));
}

TEST_F(Again, AListOfAzimuthsIsNoPicture) {
  const std::string csv = folder.write("beams.csv", "azimuth_deg\n-10\n0\n10\n").string();
  const fs::path originals = kept({"--azimuths", csv});
  const Outcome outcome =
      again(originals, {"--azimuths", (originals / (hash_of(bytes_of(csv)) + ".csv")).string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(energies((folder / "again.nc").string()), energies(out));
}

TEST_F(Again, OriginalsThatAreNotWhatTheyWereAreRefused) {
  const fs::path originals = kept();
  const std::string list = bytes_of(originals / "list.txt"), name = hash_of(picture(30)) + ".npy";
  const auto refused = [&](const std::string& words) {
    const Outcome outcome = again(originals);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(words));
    EXPECT_FALSE(fs::exists(folder / "again.nc"));
  };
  const auto write = [&](const std::string& file, const std::string& bytes) {
    folder.write("candidate.originals/" + file, bytes);
  };
  write(name, picture(40));
  refused("has changed: its bytes do not match the hash");
  fs::remove(originals / name);
  refused(name);
  write(name, picture(30));
  write("list.txt", list + "not a hash  f7.npy\n");
  refused("list.txt:7");
  write("list.txt", list + hash_of(picture(30)) + "  bag/r_0.mcap\n");
  refused("recording");
  write("list.txt", list.substr(0, list.size() - 1));
  EXPECT_EQ(again(originals).exit_code, 0);
}

TEST_F(Again, ARecordingThatWasPackedIsStillOne) {
  using namespace recordings;
  const std::string packed =
      folder
          .write("r.mcap.zstd",
                 zstd(mcap::file(mcap::schema(1, projected_type) + mcap::channel(1, 1, "/sonar") +
                                 mcap::message(1, 0, projected(small_sonar())) +
                                 mcap::message(1, 1, projected(small_sonar())))))
          .string();
  ASSERT_EQ(import({packed}).exit_code, 0);
  const Outcome outcome = again(folder / "candidate.originals");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(energies((folder / "again.nc").string()), energies(out));
}

}  // namespace
}  // namespace tubefoot
