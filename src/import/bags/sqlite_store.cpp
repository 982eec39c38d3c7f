// SPDX-License-Identifier: GPL-3.0-or-later
// Reads .db3 files of rosbag2_storage_sqlite3. Tables: topics (id, name, type, serialization_format, ...),
// messages (id, topic_id, timestamp, data) and, since ROS 2 Iron, message_definitions.
#include "import/bags/sqlite_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "files/sqlite_file.hpp"
#include "import/bags/bag_limits.hpp"

namespace tubefoot {
namespace {

const SqliteWords words{"rosbag2 recording",
                        "a recording has only plain tables: write it again with ros2 bag convert",
                        "wait until ros2 bag record ends, or open the file once with sqlite3 and close it"};

/// A .db3 file of rosbag2_storage_sqlite3.
class SqliteStore : public MessageStore {
 public:
  explicit SqliteStore(SqliteFile database) : database_(std::move(database)) {
    std::map<std::int64_t, std::size_t> by_id;
    database_.ask("SELECT id, name, type, serialization_format FROM topics", {},
                  [&](const SqliteFile::Row& row) {
                    constexpr std::size_t most_topics = 65535;  // the limit of MCAP
                    if (topics_.size() == most_topics) database_.fail("it has more than 65535 topics");
                    if (!by_id.emplace(row.integer(0), topics_.size()).second)
                      database_.fail(fmt::format("two topics have the number {}", row.integer(0)));
                    ids_.push_back(row.integer(0));
                    topics_.push_back({row.text(1), row.text(2), row.text(3), {}, 0});
                  });
    std::uint64_t rows = 0;
    database_.ask("SELECT topic_id FROM messages", {}, [&](const SqliteFile::Row& row) {
      count(++rows);
      if (const auto found = by_id.find(row.integer(0)); found != by_id.end())
        ++topics_[found->second].messages;
    });
    std::multimap<std::string, BagTopic*> of_type;
    for (BagTopic& topic : topics_) of_type.emplace(topic.type, &topic);
    if (database_.has_table("message_definitions"))
      database_.ask("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions", {},
                    [&](const SqliteFile::Row& row) {
                      if (row.text(1) != "ros2msg") return;
                      const auto [from, to] = of_type.equal_range(row.text(0));
                      for (auto one = from; one != to; ++one) one->second->definition = row.text(2);
                    });
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<MessagePlace> messages(std::size_t topic) override {
    std::vector<MessagePlace> found;
    std::uint64_t rows = 0;
    database_.ask("SELECT topic_id, rowid, timestamp, length(data) FROM messages", {},
                  [&](const SqliteFile::Row& row) {
                    count(++rows);
                    if (row.integer(0) != ids_[topic]) return;
                    const auto bytes = static_cast<std::uint64_t>(std::max<std::int64_t>(row.integer(3), 0));
                    found.push_back({row.integer(2), static_cast<std::uint64_t>(row.integer(1)), 0, bytes});
                  });
    std::ranges::sort(found, {}, &MessagePlace::outer);
    return found;
  }

  std::span<const std::uint8_t> read(const MessagePlace& message) override {
    if (message.bytes > std::min<std::uint64_t>(database_.bytes(), limits::message_bytes))
      database_.fail(fmt::format("message {} has {} bytes, but at most {} are possible: it is damaged",
                                 message.outer, message.bytes,
                                 std::min<std::uint64_t>(database_.bytes(), limits::message_bytes)));
    const std::int64_t row_id[] = {static_cast<std::int64_t>(message.outer)};
    bool found = false;
    database_.ask("SELECT data FROM messages WHERE rowid = ?", row_id, [&](const SqliteFile::Row& row) {
      if (!row.is_blob(0))
        database_.fail(fmt::format("message {} is not a sequence of bytes (BLOB)", message.outer));
      const auto bytes = row.blob(0);
      bytes_.assign(bytes.begin(), bytes.end());
      found = true;
    });
    if (!found)
      database_.fail(fmt::format("message {} is listed but missing: the file is damaged", message.outer));
    return bytes_;
  }

 private:
  /// Checks the number of rows. In a damaged file, pages that belong to several tables produce rows without
  /// end; each valid row takes a few bytes.
  void count(std::uint64_t rows) const {
    constexpr std::uint64_t least_row = 4;
    if (rows > database_.bytes() / least_row)
      database_.fail("it has more messages than its size permits: it is damaged");
    if (rows > limits::bag_messages)
      database_.fail(
          fmt::format("it has more than {} messages: split it with ros2 bag convert", limits::bag_messages));
  }

  SqliteFile database_;
  std::vector<BagTopic> topics_;
  std::vector<std::int64_t> ids_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<MessageStore> open_sqlite_store(const std::filesystem::path& file) {
  return std::make_unique<SqliteStore>(SqliteFile(file, words));
}

std::unique_ptr<MessageStore> open_sqlite_store(const std::filesystem::path& file,
                                                std::vector<std::uint8_t> bytes) {
  return std::make_unique<SqliteStore>(SqliteFile(file, std::move(bytes), words));
}

}  // namespace tubefoot
