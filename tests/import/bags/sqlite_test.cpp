// SPDX-License-Identifier: GPL-3.0-or-later
// Tests SQLite files of rosbag2, and recordings in folders: order of messages, damage, malicious schemas
// and metadata.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "import/bags/bag.hpp"
#include "recordings.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using namespace recordings;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

Bytes ping(int mark) {
  Sonar sonar = small_sonar();
  sonar.data[0] = static_cast<char>(mark);
  return projected(sonar);
}

class SqliteBag : public testing::Test {
 protected:
  std::vector<double> marks(const fs::path& path, const std::optional<std::string>& topic = std::nullopt) {
    std::vector<double> found;
    for (const ForeignFrame& frame : read_bag(path, topic).frames) found.push_back(frame.values.at(0));
    return found;
  }
  void refused(const fs::path& path, const std::string& what) {
    expect_refused<InputError>([&] { read_bag(path); }, what);
  }
  fs::path good(const std::string& name, int mark = 50) {
    Database(folder / name).tables().topic(1, "/sonar", projected_type).message(1, mark, ping(mark));
    return folder / name;
  }

  TestFolder folder;
};

TEST_F(SqliteBag, MessagesComeInTheOrderOfTheirTimes) {
  Database(folder / "r.db3")
      .tables()
      .topic(1, "/words", "std_msgs/msg/String")
      .topic(4, "/sonar", projected_type)
      .message(4, 3000, ping(30))
      .message(1, 5, "x")
      .message(4, 1000, ping(10))
      .message(4, 2000, zstd(ping(20)));
  EXPECT_THAT(marks(folder / "r.db3"), ElementsAre(10, 20, 30));
  EXPECT_EQ(read_bag(folder / "r.db3").frames.at(0).time_s, 100.25) << "the message's own time";
  expect_refused<UsageError>([&] { read_bag(folder / "r.db3", "/none"); },
                             "/words  std_msgs/msg/String  1 messages");
}

TEST_F(SqliteBag, WriteAheadLogsThatAreDoneAreNoMatter) {
  {
    Database database(folder / "r.db3");
    database.run("PRAGMA journal_mode=WAL")
        .tables()
        .topic(1, "/sonar", projected_type)
        .message(1, 5, ping(50));
  }
  ASSERT_FALSE(fs::exists(folder / "r.db3-wal"));
  EXPECT_THAT(marks(folder / "r.db3"), ElementsAre(50));
  EXPECT_FALSE(fs::exists(folder / "r.db3-shm")) << "nothing is written beside it";
  const Bytes packed = zstd(bytes_of(folder / "r.db3"));
  EXPECT_THAT(marks(folder.write("r.db3.zstd", packed)), ElementsAre(50));
  folder.write("r.db3-wal", "changes");
  refused(folder / "r.db3", "'r.db3-wal' contains changes that are not yet in the file");
}

TEST_F(SqliteBag, ASchemaIsNotTrusted) {
  const auto refused_with = [&](const std::string& sql, const std::string& what) {
    Database(folder / "r.db3").tables().topic(1, "/sonar", projected_type).message(1, 5, ping(50)).run(sql);
    refused(folder / "r.db3", what);
  };
  refused_with(
      "ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT id, topic_id, timestamp, "
      "zeroblob(1000000000) AS data FROM m",
      "has a view, 'messages', which tubefoot does not read");
  refused_with("CREATE TABLE more(a, b BLOB GENERATED ALWAYS AS (zeroblob(9)))",
               "a table with computed columns, 'more'");
  refused_with("CREATE VIRTUAL TABLE more USING fts5(a)", "a virtual table, 'more");
  refused_with("DROP TABLE messages", "no such table: messages");
  refused_with("ALTER TABLE messages DROP COLUMN data", "no such column: data");
  refused_with("UPDATE messages SET data = 'text'", "is not a sequence of bytes (BLOB)");
  refused_with("UPDATE messages SET data = 7", "is not a sequence of bytes (BLOB)");
  refused_with("UPDATE topics SET serialization_format = 'json'", "is serialized as 'json'");
}

TEST_F(SqliteBag, DamageIsRefusedOrHarmless) {
  const fs::path file = good("r.db3");
  const Bytes whole = bytes_of(file);
  int read = 0;
  for (std::size_t length = 0; length < whole.size(); length += length < 200 ? 1 : 397)
    EXPECT_THROW(read_bag(folder.write("r.db3", whole.substr(0, length))), InputError) << length;
  for (std::size_t at = 0; at < whole.size(); at += at < 200 ? 1 : 37) {
    Bytes damaged = whole;
    damaged[at] = static_cast<char>(~damaged[at]);
    folder.write("r.db3", damaged);
    try {
      read_bag(folder / "r.db3");
      ++read;  // a pixel, free space, or bytes that the reader ignores
    } catch (const InputError&) {
    } catch (const UsageError&) {
    }
  }
  EXPECT_GT(read, 0);
}

/// Makes the root page of the messages a child of itself: an infinite tree.
TEST_F(SqliteBag, ATableWithoutEndIsRefused) {
  {
    Database database(folder / "r.db3");
    database.run("PRAGMA page_size=512").tables().topic(1, "/sonar", projected_type);
    for (int k = 0; k < 200; ++k) database.message(1, k, ping(k % 200));
  }
  Bytes bytes = bytes_of(folder / "r.db3");
  int trees = 0;
  for (std::size_t page = 1; page < bytes.size() / 512; ++page) {
    const std::size_t at = page * 512;
    if (bytes[at] != 5) continue;  // the inner page of a table
    ++trees;
    const auto cells = static_cast<std::size_t>(static_cast<unsigned char>(bytes[at + 4]));
    for (std::size_t k = 0; k < cells; ++k) {
      const auto high = static_cast<unsigned char>(bytes[at + 12 + 2 * k]),
                 low = static_cast<unsigned char>(bytes[at + 13 + 2 * k]);
      const std::size_t cell = at + high * 256u + low;
      // All children are the first child.
      if (k > 0)
        bytes.replace(cell, 4, bytes,
                      at + static_cast<unsigned char>(bytes[at + 12]) * 256u +
                          static_cast<unsigned char>(bytes[at + 13]),
                      4);
    }
  }
  ASSERT_GT(trees, 0);
  folder.write("r.db3", bytes);
  try {
    EXPECT_LE(read_bag(folder / "r.db3").frames.size(), bytes.size() / 4);
  } catch (const InputError&) {
  }
}

TEST_F(SqliteBag, ItsOwnDefinitionIsHeldAgainstOurs) {
  Database(folder / "r.db3")
      .tables()
      .topic(1, "/sonar", "sensor_msgs/msg/Image")
      .message(1, 5, camera_image(1, 1, "mono8", 1, "a"))
      .run(
          "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT "
          "NOT NULL, "
          "encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)")
      .run(
          "INSERT INTO message_definitions VALUES (1, 'sensor_msgs/msg/Image', 'ros2msg', 'uint32 "
          "width\nuint32 height', '')");
  refused(folder / "r.db3", "field 1 is 'uint32 width', expected 'int32 header.stamp.sec'");
}

class BagFolder : public SqliteBag {
 protected:
  void metadata(const std::string& files, const std::string& more = "") {
    folder.write("metadata.yaml",
                 "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n" + more +
                     "  relative_file_paths:\n" + files);
  }
};

TEST_F(BagFolder, AllItsFilesAreOneRecording) {
  good("r_0.db3", 40);
  good("r_1.db3", 30);
  folder.write("r_2.db3.zstd", zstd(bytes_of(good("r_2.db3", 35))));
  fs::remove(folder / "r_2.db3");
  folder.write("r_3.mcap", mcap::file(mcap::schema(1, projected_type) + mcap::channel(1, 1, "/sonar") +
                                      mcap::message(1, 1, ping(1))));
  metadata("    - r_0.db3\n    - bag/r_1.db3\n    - r_2.db3.zstd\n    - r_3.mcap\n", "  message_count: 4\n");
  EXPECT_TRUE(is_bag(folder.path()));
  EXPECT_THAT(marks(folder.path()), ElementsAre(1, 30, 35, 40));
  metadata("    - r_0.db3\n",
           "  message_count: 9\n  compression_format: zstd\n  compression_mode: MESSAGE\n");
  EXPECT_THAT(read_bag(folder.path()).noticed,
              Contains("metadata.yaml lists 9 messages, but the files have 1"));
}

TEST_F(BagFolder, WhatItsMetadataMayNotSay) {
  good("r_0.db3");
  metadata("    - r_1.db3\n");
  refused(folder.path(), "r_1.db3: cannot be opened");
  metadata("    - r_0.db3\n    - r_0.db3\n");
  refused(folder.path(), "metadata.yaml:6:7: relative_file_paths: 'r_0.db3' is named twice");
  metadata("    - ..\n");
  refused(folder.path(), "expected the name of a file");
  metadata("    - ../../../../etc/passwd\n");
  refused(folder.path(), "passwd: cannot be opened");  // in the folder, for any path before its name
  metadata("    []\n");
  refused(folder.path(), "has no relative_file_paths");
  metadata("    - r_0.db3\n", "  compression_format: lz4\n");
  refused(folder.path(), "compression_format: tubefoot does not read 'lz4'");
  folder.write("metadata.yaml", "a: [1, 2");
  refused(folder.path(), "is not YAML");
  folder.write("metadata.yaml", Bytes(100'000, '['));
  refused(folder.path(), "is not YAML");
  folder.write("metadata.yaml", "");
  refused(folder.path(), "has no rosbag2_bagfile_information");
  fs::remove(folder / "metadata.yaml");
  EXPECT_FALSE(is_bag(folder.path()));
  refused(folder.path(), "is a folder without metadata.yaml");
}

TEST_F(BagFolder, WhatIsNoRecordingIsRefused) {
  refused(folder.write("r.db3", "no database"), "is not a ROS 2 recording");
  refused(folder.write("r.mcap", ""), "is not a ROS 2 recording");
  refused(folder.write("r.db3.zstd", zstd("no database")), "is not a ROS 2 recording");
  refused(folder / "none.db3", "cannot be opened");
  EXPECT_TRUE(is_bag("a/b.db3"));
  EXPECT_TRUE(is_bag("a/b.mcap.zstd"));
  EXPECT_FALSE(is_bag("a/b.npy"));
}

}  // namespace
}  // namespace tubefoot
