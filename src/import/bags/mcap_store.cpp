// SPDX-License-Identifier: GPL-3.0-or-later
// Reads MCAP files (mcap.dev/spec): schemas, channels, chunks and messages of the data section. It checks
// the checksums of chunks and of the data section. It checks the total decompressed size first.
#include "import/bags/mcap_store.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>

#include "files/memory_at_hand.hpp"
#include "geometry/steps/stop.hpp"
#include "import/bags/bag_limits.hpp"
#include "import/bags/sonar_messages.hpp"
#include "import/bags/unpacking.hpp"

namespace tubefoot {
namespace {

enum Opcode : std::uint8_t {
  invalid = 0x00,
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  data_end = 0x0f,
};
constexpr std::uint64_t record_head = 9;    // opcode and length
constexpr std::uint64_t message_head = 22;  // channel, sequence and two times
constexpr std::uint64_t footer_bytes = 20;
constexpr std::uint64_t in_no_chunk = std::numeric_limits<std::uint64_t>::max();

/// Reads the fields of a record, which are little-endian and packed. Throws if the record ends before a
/// field.
class Fields {
 public:
  Fields(std::span<const std::uint8_t> bytes, const SourcePlace& place, std::string what)
      : left_(bytes), place_(place), what_(std::move(what)) {}

  template <class T>
  T number() {
    std::uint64_t value = 0;
    const auto bytes = take(sizeof(T));
    for (std::size_t k = 0; k < sizeof(T); ++k) value |= std::uint64_t{bytes[k]} << (8 * k);
    return static_cast<T>(value);
  }
  std::string text() {
    const auto bytes = take(number<std::uint32_t>());
    return {bytes.begin(), bytes.end()};
  }
  std::span<const std::uint8_t> take(std::uint64_t count) {
    if (count > left_.size())
      throw InputError(place_, fmt::format("{}: needs {} bytes, but {} are left: the file is damaged", what_,
                                           count, left_.size()));
    const auto front = left_.first(count);
    left_ = left_.subspan(count);
    return front;
  }

 private:
  std::span<const std::uint8_t> left_;
  const SourcePlace& place_;
  std::string what_;
};

std::uint32_t crc_of(std::uint32_t before, std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

class McapStore : public MessageStore {
 public:
  McapStore(ByteSource source, UnpackedBytes& unpacked) : source_(std::move(source)) { walk(unpacked); }

  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<MessagePlace> messages(std::size_t topic) override { return places_[topic]; }

  std::span<const std::uint8_t> read(const MessagePlace& place) override {
    if (place.outer != in_no_chunk) return chunk_at(place.outer, false).subspan(place.inner, place.bytes);
    bytes_ = source_.read(place.inner, place.bytes);
    return bytes_;
  }

 private:
  struct Schema {
    std::string name, encoding, data;
    bool operator==(const Schema&) const = default;
  };
  struct Channel {
    std::uint16_t schema = 0;
    std::string topic, encoding;
    std::size_t number = 0;  ///< number of the topic
  };

  [[noreturn]] void fail(const std::string& what) const { throw InputError(source_.place(), what); }
  std::string named(std::string_view kind, std::uint64_t at) const {
    return fmt::format("{} at byte {}", kind, at);
  }

  void walk(UnpackedBytes& unpacked) {
    const std::uint64_t end = source_.size() < 2 * mcap_magic.size() ? 0 : source_.size() - mcap_magic.size();
    if (end != 0 && !has_magic(0))
      fail("is not an MCAP file: it does not begin with the magic bytes of MCAP");
    if (end == 0 || !has_magic(end))
      fail(
          "has no magic bytes at its end: the recording was cut off; mcap recover writes the remaining part "
          "as a complete file");
    count_chunks(end, unpacked);
    std::uint64_t at = mcap_magic.size();
    bool has_header = false, data_ended = false;
    while (true) {
      stop_if_wanted();
      if (at + record_head > end) fail(named("a record", at) + " is cut off: the file ends without a footer");
      const auto head = source_.read(at, record_head);
      Fields fields(head, source_.place(), "record");
      const auto opcode = fields.number<std::uint8_t>();
      const auto length = fields.number<std::uint64_t>();
      const std::uint64_t body = at + record_head;
      if (length > end - body)
        fail(fmt::format("{} has {} bytes, but {} are left: the file is damaged", named("a record", at),
                         length, end - body));
      if (opcode == invalid) fail(named("a record", at) + " has the invalid opcode 0: the file is damaged");
      if (has_header == (opcode == header))
        fail(has_header ? named("there is a second header", at)
                        : "does not begin with a header: the file is damaged");
      has_header = true;
      if (opcode == footer) {
        if (length != footer_bytes || body + length != end)
          fail(named("a footer", at) + " is not at the end of the file");
        if (!data_ended) fail("has no record that ends its data section: the file is damaged");
        return;
      }
      if (!data_ended)
        data_record(opcode, body, length);
      else if (opcode == message || opcode == chunk)
        fail(named("a message", at) + " follows the end of the data section");
      if (opcode == data_end) {
        if (data_ended) fail(named("there is a second end of the data section", at));
        data_ended = true;
        check_data(at, body, length);
      }
      at = body + length;
    }
  }

  bool has_magic(std::uint64_t at) {
    const auto bytes = source_.read(at, mcap_magic.size());
    return std::equal(bytes.begin(), bytes.end(), mcap_magic.begin(),
                      [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); });
  }

  /// Adds the decompressed sizes that all chunks declare, before any is decompressed. Incomplete records
  /// and chunks that are too large are left to walk(), which reports them.
  void count_chunks(std::uint64_t end, UnpackedBytes& unpacked) {
    constexpr std::uint64_t times = 16,
                            head_of_chunk = times + 8 + 4 + 4;  // size, checksum, length of a name
    for (std::uint64_t at = mcap_magic.size(); at + record_head <= end;) {
      stop_if_wanted();
      const auto head = source_.read(at, record_head);
      Fields fields(head, source_.place(), "record");
      const auto opcode = fields.number<std::uint8_t>();
      const auto length = fields.number<std::uint64_t>();
      if (opcode == data_end || length > end - at - record_head) return;
      if (opcode == chunk && length >= head_of_chunk) {
        const auto body = source_.read(at + record_head, head_of_chunk);
        const std::string what = named("chunk", at);
        Fields of_chunk{std::span(body).subspan(times), source_.place(), what};
        const auto size = of_chunk.number<std::uint64_t>();
        of_chunk.number<std::uint32_t>();  // skips the checksum
        const bool packed = of_chunk.number<std::uint32_t>() > 0;
        if (packed && size <= limits::message_bytes) unpacked.add(size, source_.place(), what);
      }
      at += record_head + length;
    }
  }

  void data_record(std::uint8_t opcode, std::uint64_t body, std::uint64_t length) {
    if (opcode == schema || opcode == channel) {
      small(opcode, body, length);
      read_record(opcode, source_.read(body, length), body);
    } else if (opcode == message) {
      if (length < message_head)
        fail(named("a message", body) + " has an incomplete header: the file is damaged");
      const auto head = source_.read(body, message_head);
      add_message(head, in_no_chunk, body + message_head, length - message_head);
    } else if (opcode == chunk) {
      const auto records = chunk_at(body - record_head, true);
      std::uint64_t at = 0;
      while (at < records.size()) {
        stop_if_wanted();
        const std::string what = fmt::format("chunk at byte {}, record at its byte {}", body, at);
        Fields fields(records.subspan(at), source_.place(), what);
        const auto inner = fields.number<std::uint8_t>();
        const auto bytes = fields.number<std::uint64_t>();
        const auto content = fields.take(bytes);
        if (inner == message) {
          if (bytes < message_head) fail(what + " has an incomplete header: the file is damaged");
          add_message(content, body - record_head, at + record_head + message_head, bytes - message_head);
        } else if (inner == schema || inner == channel) {
          small(inner, body, bytes);
          read_record(inner, content, body);
        } else {
          fail(what + fmt::format(" has the opcode {}, which is not allowed in a chunk: the file is damaged",
                                  inner));
        }
        at += record_head + bytes;
      }
    }
  }

  void small(std::uint8_t opcode, std::uint64_t at, std::uint64_t length) const {
    if (length > limits::schema_bytes)
      fail(fmt::format("{} has {} bytes, but at most {} are allowed",
                       named(opcode == schema ? "a schema" : "a channel", at), length, limits::schema_bytes));
  }

  void read_record(std::uint8_t opcode, std::span<const std::uint8_t> content, std::uint64_t at) {
    Fields fields(content, source_.place(), named(opcode == schema ? "schema" : "channel", at));
    const auto id = fields.number<std::uint16_t>();
    if (opcode == schema) {
      Schema read;
      read.name = fields.text();
      read.encoding = fields.text();
      read.data = fields.text();
      if (id == 0) return;  // the specification requires readers to ignore schema 0
      const auto [known, is_new] = schemas_.emplace(id, read);
      if (known->second != read) fail(fmt::format("two schemas have the number {}: the file is damaged", id));
      if (is_new) count_kept(content.size());
      return;
    }
    Channel read;
    read.schema = fields.number<std::uint16_t>();
    read.topic = fields.text();
    read.encoding = fields.text();
    if (const auto known = channels_.find(id); known != channels_.end()) {
      if (known->second.topic != read.topic || known->second.schema != read.schema ||
          known->second.encoding != read.encoding)
        fail(fmt::format("two channels have the number {}: the file is damaged", id));
      return;
    }
    const auto of = schemas_.find(read.schema);
    if (read.schema != 0 && of == schemas_.end())
      fail(fmt::format("channel {} refers to schema {}, which is not defined before it", id, read.schema));
    const Schema none;
    const Schema& type = of == schemas_.end() ? none : of->second;
    const auto [same, is_new] =
        number_of_topic_.try_emplace({read.topic, type.name, read.encoding}, topics_.size());
    read.number = same->second;
    if (is_new) {
      topics_.push_back(
          {read.topic, type.name, read.encoding, type.encoding == "ros2msg" ? type.data : "", 0});
      places_.emplace_back();
    }
    count_kept(content.size());
    channels_.emplace(id, std::move(read));
  }

  /// Adds to the memory that the schemas and channels of the file occupy, and checks its limit.
  void count_kept(std::uint64_t bytes) {
    kept_ += bytes;
    if (kept_ > limits::message_bytes) fail("has more than a gigabyte of schemas and channels");
  }

  void add_message(std::span<const std::uint8_t> head, std::uint64_t outer, std::uint64_t inner,
                   std::uint64_t bytes) {
    Fields fields(head, source_.place(), "message");
    const auto id = fields.number<std::uint16_t>();
    fields.number<std::uint32_t>();
    const auto logged = fields.number<std::uint64_t>();
    const auto of = channels_.find(id);
    if (of == channels_.end())
      fail(fmt::format("a message refers to channel {}, which is not defined before it: the file is damaged",
                       id));
    BagTopic& topic = topics_[of->second.number];
    if (++counted_ > limits::bag_messages)
      fail(fmt::format("has more than {} messages: split it with ros2 bag convert", limits::bag_messages));
    ++topic.messages;
    if (!ros::is_known_type(topic.type)) return;
    if (bytes > limits::message_bytes)
      fail(fmt::format("a message of '{}' has {} bytes, but at most {} are allowed", topic.name, bytes,
                       limits::message_bytes));
    constexpr std::uint64_t last = std::numeric_limits<std::int64_t>::max();
    places_[of->second.number].push_back(
        {static_cast<std::int64_t>(std::min(logged, last)), outer, inner, bytes});
  }

  /// Returns the decompressed records of the chunk whose record begins at `at`. They are valid until
  /// another chunk is requested. The first call for a chunk checks its checksum.
  std::span<const std::uint8_t> chunk_at(std::uint64_t at, bool first_time) {
    if (chunk_at_ == at) return chunk_;
    chunk_at_.reset();
    const std::string what = named("chunk", at);
    const auto record = source_.read(at, record_head);
    const auto length = Fields(std::span(record).subspan(1), source_.place(), what).number<std::uint64_t>();
    if (length > limits::message_bytes)
      fail(fmt::format("{} has {} bytes, but at most {} are allowed", what, length, limits::message_bytes));
    require_memory(static_cast<double>(length), source_.place(), what,
                   "split the recording with ros2 bag convert");
    const auto content = source_.read(at + record_head, length);
    Fields fields(content, source_.place(), what);
    fields.number<std::uint64_t>();  // skips the first and last times
    fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string compression = fields.text();
    const auto packed = fields.take(fields.number<std::uint64_t>());
    if (size > limits::message_bytes)
      fail(fmt::format("{} unpacks to {} bytes, but at most {} are allowed", what, size,
                       limits::message_bytes));
    chunk_ = unpack_chunk(compression, packed, size, source_.place(), what);
    if (first_time && crc != 0)
      if (const std::uint32_t found = crc_of(0, chunk_); crc != found)
        fail(fmt::format("{}: the stored checksum is {:08x}, but the bytes have {:08x}: the file is damaged",
                         what, crc, found));
    chunk_at_ = at;
    return chunk_;
  }

  /// Checks the checksum of the data section, if there is one.
  void check_data(std::uint64_t end, std::uint64_t body, std::uint64_t length) {
    const auto content = source_.read(body, std::min<std::uint64_t>(length, sizeof(std::uint32_t)));
    const auto crc = Fields(content, source_.place(), "end of the data section").number<std::uint32_t>();
    if (crc == 0) return;
    std::uint32_t found = 0;
    for (std::uint64_t at = 0; at < end;) {
      stop_if_wanted();
      const std::uint64_t count = std::min<std::uint64_t>(end - at, std::uint64_t{1} << 20);
      found = crc_of(found, source_.read(at, count));
      at += count;
    }
    if (crc != found)
      fail(fmt::format(
          "the stored checksum of the data is {:08x}, but the bytes have {:08x}: the file is damaged", crc,
          found));
  }

  ByteSource source_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<BagTopic> topics_;
  std::map<std::array<std::string, 3>, std::size_t> number_of_topic_;  ///< by name, type and encoding
  std::vector<std::vector<MessagePlace>> places_;
  std::uint64_t counted_ = 0, kept_ = 0;
  std::optional<std::uint64_t> chunk_at_;
  std::vector<std::uint8_t> chunk_, bytes_;
};

}  // namespace

std::unique_ptr<MessageStore> open_mcap_store(ByteSource source, UnpackedBytes& unpacked) {
  return std::make_unique<McapStore>(std::move(source), unpacked);
}

}  // namespace tubefoot
