// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the file of a checkpoint or of a shard. It keeps finished pings, and accepts nothing else as a ping
// after cuts, changed bits or other layouts.
#include "run/checkpoint/ping_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

StoreLayout layout() {
  StoreLayout made;
  made.sensors = {{4, {{"energy", 30}, {"energy_bound", 30}}}, {4, {{"energy", 3}, {"energy_bound", 3}}}};
  made.groups = {{{0, 1}, 4}};
  return made;
}

std::string packed(std::size_t ping) {
  PingValues made;
  made.clear(layout(), 0);
  for (const std::span<double> values :
       {made.of(0, "energy"), made.of(0, "energy_bound"), made.of(1, "energy")})
    for (std::size_t k = ping; k < values.size(); k += 2) values[k] = 1e-9 * double(ping + k + 1);
  return packed_ping(layout(), {0, ping}, {}, made);
}

/// Makes a file with pings 0, 2 and 3.
fs::path made_in(const TestFolder& folder) {
  const fs::path path = folder / "out.part-1-of-1";
  PingFile file(path, "shard");
  file.begin("me");
  for (const std::size_t ping : {2, 0, 3}) file.append(packed(ping));
  return path;
}

/// Returns which pings exist, and checks that each has its original values.
std::vector<bool> there(const PingFile& file) {
  std::vector<bool> found;
  PingValues room;
  for (std::size_t ping = 0; ping < 4; ++ping) {
    found.push_back(file.has({0, ping}));
    if (!found.back()) continue;
    const std::string bytes = file.read({0, ping});
    EXPECT_TRUE(bytes == packed(ping));
    unpack_ping(bytes, layout(), room);
  }
  return found;
}

TEST(PingFiles, AreGoneOnWith) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  {
    PingFile file(path, "shard");
    EXPECT_EQ(file.identity(), "me");
    EXPECT_EQ(file.pings(), 3u);
    file.look_through(layout());
    EXPECT_EQ(there(file), (std::vector<bool>{true, false, true, true}));
    EXPECT_THROW(PingFile{path}, StoreInUse);
    file.begin("me");
    file.append(packed(1));
  }
  PingFile file(path, "shard");
  file.look_through(layout());
  EXPECT_EQ(there(file), (std::vector<bool>{true, true, true, true}));
}

// The end of the program or a full disk may cut the file at any byte.
TEST(PingFiles, CutAnywhereKeepWhatIsWholeAndGoOn) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  const std::string good = bytes_of(path);
  const std::size_t head = good.size() - packed(0).size() - packed(2).size() - packed(3).size();
  for (std::size_t bytes = 0; bytes < good.size(); ++bytes) {
    SCOPED_TRACE(bytes);
    folder.write(path.filename().string(), good.substr(0, bytes));
    if (bytes > 0 && bytes < 32) {
      EXPECT_THROW(PingFile{path}, UnusableStore);
      continue;
    }
    PingFile file(path, "shard");
    EXPECT_EQ(file.identity().empty(), bytes < head);
    if (!file.identity().empty()) file.look_through(layout());
    file.begin("me");
    file.append(packed(1));
    file.look_through(layout());
    const std::vector<bool> found = there(file);
    EXPECT_TRUE(found[1]);
    EXPECT_EQ(found[2], bytes >= head + packed(2).size());
    EXPECT_FALSE(found[3]);
  }
}

TEST(PingFiles, WithAnyBitTurnedHaveThePingsThatWereThereOrFewer) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  const std::string good = bytes_of(path);
  std::size_t lost = 0, refused = 0;
  for (std::size_t at = 0; at < good.size(); ++at)
    for (const int bit : {0, 7}) {
      SCOPED_TRACE(at);
      std::string damaged = good;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
      folder.write(path.filename().string(), damaged);
      try {
        PingFile file(path, "shard");
        if (file.identity().empty()) continue;  // its length is that of a file that was just begun
        EXPECT_EQ(file.identity(), "me");
        file.look_through(layout());
        const std::vector<bool> found = there(file);
        EXPECT_FALSE(found[1]);
        const auto whole = std::ranges::count(found, true);
        EXPECT_LT(whole, 3);
        lost += whole < 3;
        if (whole == 2 && !found[2]) {
          EXPECT_TRUE(file.may_have_damaged({0, 2}));
        }
      } catch (const UnusableStore&) {
        ++refused;
      }
    }
  EXPECT_GT(lost, 100u);
  EXPECT_GT(refused, 30u);
}

// The position of the next ping is then found by its header.
TEST(PingFiles, WithADamagedHeaderKeepThePingsAfterIt) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  std::string bytes = bytes_of(path);
  bytes[bytes.find(packed(2)) + 3] ^= 1;
  folder.write(path.filename().string(), bytes);
  PingFile file(path);
  EXPECT_EQ(file.pings(), 2u);
  file.look_through(layout());
  EXPECT_EQ(there(file), (std::vector<bool>{true, false, false, true}));
  EXPECT_TRUE(file.may_have_damaged({0, 2}));
  EXPECT_FALSE(file.may_have_damaged({0, 3}));
}

// The search reads windows of 1 MiB. In the longest case, the border of a window lies inside a header.
TEST(PingFiles, KeepThePingsAfterForeignBytes) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  const std::string good = bytes_of(path);
  const std::size_t first = good.find(packed(2));
  for (const std::size_t foreign : {std::size_t{1}, sizeof(PackedHead) + 1, (std::size_t{1} << 20) - 15}) {
    SCOPED_TRACE(foreign);
    folder.write(path.filename().string(),
                 good.substr(0, first) + std::string(foreign, 'x') + good.substr(first));
    PingFile file(path);
    file.look_through(layout());
    EXPECT_EQ(there(file), (std::vector<bool>{true, false, true, true}));
  }
}

TEST(PingFiles, EndAfterTheLastWholePingWhenARunContinues) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  const std::string good = bytes_of(path);
  folder.write(path.filename().string(), good.substr(0, good.size() - 1));
  PingFile file(path);
  file.look_through(layout());
  file.begin("me");
  EXPECT_EQ(file.bytes(), good.size() - packed(3).size());
  EXPECT_EQ(fs::file_size(path), file.bytes());
}

TEST(PingFiles, WithASecondHardLinkAreRefused) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  fs::create_hard_link(path, folder / "other");
  EXPECT_THROW(PingFile{path}, UnusableStore);
  fs::remove(folder / "other");
  EXPECT_EQ(PingFile(path).pings(), 3u);
}

TEST(PingFiles, ThatContainAnotherPingInItsPlaceAreNotRead) {
  TestFolder folder;
  const fs::path path = made_in(folder);
  PingFile file(path);
  file.look_through(layout());
  std::fstream bytes(path, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekp(std::streamoff(bytes_of(path).find(packed(0))));
  bytes.write(packed(2).data(), sizeof(PackedHead));
  bytes.close();
  EXPECT_THROW(file.read({0, 0}), DamagedPing);
}

TEST(PingFiles, OfAnotherScenesLengthsAreRefused) {
  TestFolder folder;
  PingFile file(made_in(folder), "shard");
  StoreLayout other = layout();
  other.groups[0].pings = 2;
  EXPECT_THROW(file.look_through(other), UnusableStore);
  EXPECT_FALSE(file.has({0, 0}));
  EXPECT_FALSE(file.has({0, 1}));
}

TEST(PingFiles, OfOtherOutputChannelsAreRefused) {
  TestFolder folder;
  PingFile file(made_in(folder), "shard");
  StoreLayout other = layout();
  other.sensors[1].channels.push_back({"gradient.speed", 3});
  EXPECT_THROW(file.look_through(other), UnusableStore);
  other.sensors[1].channels.resize(1);
  EXPECT_THROW(file.look_through(other), UnusableStore);
}

}  // namespace
}  // namespace tubefoot
