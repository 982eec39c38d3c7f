// SPDX-License-Identifier: GPL-3.0-or-later
// Tests MCAP files: order of messages, chunks, compression, checksums, damage, and limits on unpacked
// sizes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "fixtures/processor_time.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "import/bags/bag.hpp"
#include "recordings.hpp"

namespace tubefoot {
namespace {

using namespace recordings;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// The first value of the picture is `mark`.
Bytes ping_without_time(int mark) {
  Sonar sonar = small_sonar();
  sonar.data[0] = static_cast<char>(mark);
  sonar.sec = 0;
  sonar.nanosec = 0;  // the time of the recording is used
  return projected(sonar);
}

class Mcap : public testing::Test {
 protected:
  ForeignData read(const Bytes& bytes, const std::optional<std::string>& topic = std::nullopt) {
    return read_bag(folder.write("r.mcap", bytes), topic);
  }
  std::vector<double> marks(const Bytes& bytes, const std::optional<std::string>& topic = std::nullopt) {
    std::vector<double> found;
    for (const ForeignFrame& frame : read(bytes, topic).frames) found.push_back(frame.values.at(0));
    return found;
  }
  void refused(const Bytes& bytes, const std::string& what) {
    expect_refused<InputError>([&] { read(bytes); }, what);
  }

  const Bytes heads = mcap::schema(1, projected_type) + mcap::channel(1, 1, "/sonar");
  TestFolder folder;
};

TEST_F(Mcap, MessagesComeInTheOrderOfTheirTimes) {
  const Bytes messages = mcap::message(1, 3'000'000'000, ping_without_time(30)) +
                         mcap::message(1, 1'000'000'000, ping_without_time(10)) +
                         mcap::message(1, 2'000'000'000, ping_without_time(20)) +
                         mcap::message(1, 1'000'000'000, ping_without_time(11));
  for (const bool checked : {false, true}) {
    const ForeignData data = read(mcap::file(heads + messages, checked));
    ASSERT_THAT(data.frames, SizeIs(4));
    EXPECT_EQ(data.frames[0].values.at(0), 10);
    EXPECT_EQ(data.frames[1].values.at(0), 11) << "equal times: as they stand";
    EXPECT_EQ(data.frames[2].values.at(0), 20);
    EXPECT_EQ(data.frames[3].values.at(0), 30);
    EXPECT_EQ(data.frames[2].time_s, 2.0);
    EXPECT_THAT(data.noticed, testing::Not(Contains(HasSubstr("time")))) << "pings have the reference's";
  }
}

TEST_F(Mcap, ChunksOfEveryCompressionAreRead) {
  for (const char* compression : {"", "lz4", "zstd"}) {
    SCOPED_TRACE(compression);
    const Bytes first = mcap::chunk(
        heads + mcap::message(1, 5, ping_without_time(50)) + mcap::message(1, 1, ping_without_time(10)),
        compression);
    const Bytes second = mcap::chunk(mcap::message(1, 3, ping_without_time(30)), compression);
    // Records between chunks that the reader skips: an index, metadata, and unknown future records.
    const Bytes others =
        mcap::record(7, "index") + mcap::record(12, "metadata") + mcap::record(0x90, "private");
    EXPECT_THAT(marks(mcap::file(first + others + second + others, true)), ElementsAre(10, 30, 50));
  }
}

TEST_F(Mcap, MessagesMayBePackedEachByItself) {
  EXPECT_THAT(marks(mcap::file(heads + mcap::message(1, 5, zstd(ping_without_time(50))))), ElementsAre(50));
  refused(mcap::file(heads + mcap::message(1, 5, zstd(ping_without_time(50)).substr(0, 40))),
          "its zstd data are damaged or cut off");
}

TEST_F(Mcap, AWholeFileMayBePacked) {
  const Bytes file = zstd(mcap::file(heads + mcap::message(1, 5, ping_without_time(50))));
  EXPECT_THAT(read_bag(folder.write("r.mcap.zstd", file)).frames, SizeIs(1));
  for (std::size_t length = 0; length < file.size(); ++length)
    EXPECT_THROW(read_bag(folder.write("r.mcap.zstd", file.substr(0, length))), InputError) << length;
}

TEST_F(Mcap, CutAtEveryLengthAFileIsRefused) {
  for (const char* compression : {"", "lz4", "zstd"}) {
    const Bytes file =
        mcap::file(mcap::chunk(heads + mcap::message(1, 5, ping_without_time(50)), compression), true);
    ASSERT_THAT(marks(file), ElementsAre(50));
    for (std::size_t length = 0; length < file.size(); ++length) {
      SCOPED_TRACE(length);
      EXPECT_THROW(read(file.substr(0, length)), InputError);
      if (length == file.size() - mcap::magic.size()) continue;  // this prefix is complete
      EXPECT_THROW(read(file.substr(0, length) + mcap::magic), InputError) << "with its end put on";
    }
  }
}

TEST_F(Mcap, AByteThatIsNotAsItWasIsFoundByTheChecksums) {
  const Bytes chunk = mcap::chunk(heads + mcap::message(1, 5, ping_without_time(50)));
  const Bytes file = mcap::file(chunk, true);
  const std::size_t begin = file.find(chunk), end = begin + chunk.size();
  for (std::size_t at = begin; at < end; ++at) {
    Bytes damaged = file;
    damaged[at] ^= 1;
    EXPECT_THROW(read(damaged), InputError) << at;
  }
  const Bytes records = heads + mcap::message(1, 5, ping_without_time(50));
  refused(mcap::file(mcap::chunk(records, "", records.size(), crc(records) ^ 1)), "the stored checksum is");
  EXPECT_THAT(marks(mcap::file(mcap::chunk(records, "", records.size(), 0))), ElementsAre(50))
      << "0: none is given";
  const Bytes data = mcap::magic + mcap::header() + records;
  refused(data + mcap::record(15, little(crc(data) ^ 1)) + mcap::footer() + mcap::magic,
          "the stored checksum of the data is");
}

TEST_F(Mcap, SizesThatLieAreRefused) {
  const Bytes records = heads + mcap::message(1, 5, ping_without_time(50));
  for (const char* compression : {"lz4", "zstd"}) {
    const Bytes packed = std::string(compression) == "lz4" ? lz4(records) : zstd(records);
    refused(mcap::file(mcap::chunk(packed, compression, records.size() - 1, 0)), "");
    refused(mcap::file(mcap::chunk(packed, compression, records.size() + 1, 0)), "its header declares");
    refused(mcap::file(mcap::chunk(packed, compression, 0, 0)), "");
    refused(mcap::file(mcap::chunk(packed, compression, ~std::uint64_t{0}, 0)), "are allowed");
    refused(mcap::file(mcap::chunk(packed, compression, std::uint64_t{1} << 30, 0)), "its header declares");
  }
  refused(mcap::file(mcap::chunk(records, "", records.size() + 1, 0)), "its header declares");
  refused(mcap::file(mcap::chunk(records, "snappy", records.size(), 0)),
          "is compressed with 'snappy', which tubefoot does not read");
  Bytes record = mcap::record(12, "x");
  record.replace(1, 8, little(~std::uint64_t{0}));
  refused(mcap::file(record), "has 18446744073709551615 bytes");
  refused(mcap::file(mcap::chunk(record)), "needs 18446744073709551615 bytes");
  Bytes text = mcap::schema(1, "x");
  text.replace(11, 4, little(std::uint32_t{0xffffffff}));
  refused(mcap::file(text), "needs 4294967295 bytes");
}

/// 1 GiB of zeros packs into about 30 kB: the reader rejects it for its size or its content, and never
/// stores it.
TEST_F(Mcap, ABombOfZerosIsRefused) {
  const Bytes zeros = zstd(Bytes(std::size_t{64} << 20, '\0'));
  ASSERT_LT(zeros.size(), 10'000u);
  refused(mcap::file(mcap::chunk(zeros, "zstd", std::uint64_t{64} << 20, 0)), "has the opcode 0");
  refused(mcap::file(mcap::chunk(zeros, "zstd", 1000, 0)), "unpacks to");
  refused(mcap::file(heads + mcap::message(1, 0, zeros)), "follow its last field");
}

/// Many zeros before pictures in each of two chunks, and messages whose times alternate between the chunks.
TEST_F(Mcap, ChunksAreUnpackedOnceWhateverTheOrderOfTimes) {
  constexpr int messages = 300;
  Bytes records = heads;
  std::vector<double> expected;
  for (int part = 0; part < 2; ++part) {
    Bytes chunk;
    for (int k = 0; k < messages; ++k)
      chunk += mcap::message(1, static_cast<std::uint64_t>(2 * k + part), ping_without_time(2 * k + part));
    chunk += mcap::schema(7 + part, "a/msg/B", Bytes(std::size_t{15} << 20, ' '));
    chunk += mcap::schema(9 + part, "a/msg/C", Bytes(std::size_t{15} << 20, ' '));
    records += mcap::chunk(chunk, "zstd");
  }
  for (int k = 0; k < 2 * messages; ++k) expected.push_back(static_cast<unsigned char>(k));
  std::vector<double> found;
  EXPECT_LT(processor_seconds([&] { found = marks(mcap::file(records)); }), hostile_input_s);
  EXPECT_EQ(found, expected);
}

/// 80 chunks of 32 MiB each in a file of a few hundred kilobytes.
TEST_F(Mcap, ChunksThatUnpackToFarMoreThanTheFileAreRefused) {
  const Bytes large = mcap::schema(9, "a/msg/B", Bytes((std::size_t{16} << 20) - 100, ' '));
  const Bytes chunk = mcap::chunk(large + large, "zstd");
  Bytes records = heads;
  for (int k = 0; k < 80; ++k) records += chunk;
  EXPECT_LT(processor_seconds([&] {
              refused(mcap::file(records + mcap::message(1, 5, ping_without_time(50))),
                      "too many for its size");
            }),
            hostile_input_s);
}

/// The same for messages that are compressed individually.
TEST_F(Mcap, MessagesThatUnpackToFarMoreThanTheFileAreRefused) {
  const Bytes image = zstd(camera_image(8192, 8192, "mono8", 8192, Bytes(std::size_t{8192} * 8192, '\0')));
  Bytes records = mcap::schema(1, image_type) + mcap::channel(1, 1, "/sonar");
  for (std::uint64_t k = 0; k < 40; ++k) records += mcap::message(1, k, image);
  const std::string said = refusal<InputError>([&] { read(mcap::file(records)); });
  EXPECT_THAT(said, testing::AnyOf(HasSubstr("too many for its size"), HasSubstr("of memory")));
}

TEST_F(Mcap, TensOfThousandsOfChannelsAreReadInTime) {
  Bytes records = heads;
  for (int k = 2; k < 65'000; ++k)
    records += mcap::channel(k, 1, "/some/long/name/of/a/topic/that/is/like/others/" + std::to_string(k));
  EXPECT_LT(processor_seconds([&] {
              EXPECT_THAT(marks(mcap::file(records + mcap::message(1, 5, ping_without_time(50)))),
                          ElementsAre(50));
            }),
            hostile_input_s);
}

/// Repeated schemas take no more space. New channels do, for any content.
TEST_F(Mcap, OnlyWhatIsNewIsCountedAgainstTheMost) {
  constexpr std::size_t most = std::size_t{16} << 20;
  const auto packed = [](const Bytes& record) { return mcap::chunk(record, "zstd"); };
  const Bytes large = packed(mcap::schema(9, "a/msg/B", Bytes(most - 100, ' ')));
  Bytes repeated = heads, many = heads;
  for (int k = 0; k < 66; ++k) repeated += large;
  EXPECT_THAT(marks(mcap::file(repeated + mcap::message(1, 5, ping_without_time(50)))), ElementsAre(50));
  const Bytes metadata = mcap::text(Bytes(most - 100, ' '));
  for (int k = 2; k < 68; ++k)
    many += packed(mcap::record(4, little(static_cast<std::uint16_t>(k)) + little(std::uint16_t{1}) +
                                       mcap::text("/sonar") + mcap::text("cdr") + metadata));
  refused(mcap::file(many + mcap::message(1, 5, ping_without_time(50))), "more than a gigabyte");
}

TEST_F(Mcap, WhatStandsWhereItMayNotIsRefused) {
  const Bytes message = mcap::message(1, 5, ping_without_time(50));
  refused(mcap::file(message), "refers to channel 1, which is not defined before it");
  refused(mcap::file(mcap::channel(1, 7, "/sonar")), "refers to schema 7, which is not defined before it");
  refused(mcap::file(heads + mcap::schema(1, "another/msg/Type")), "two schemas have the number 1");
  refused(mcap::file(heads + mcap::channel(1, 1, "/other")), "two channels have the number 1");
  EXPECT_THAT(marks(mcap::file(heads + heads + message)), ElementsAre(50)) << "the same once more is allowed";
  refused(mcap::file(heads + mcap::chunk(mcap::chunk(message))), "is not allowed in a chunk");
  refused(mcap::file(mcap::header()), "a second header");
  refused(mcap::magic + heads + mcap::record(15, little(0u)) + mcap::footer() + mcap::magic,
          "does not begin with a header");
  refused(mcap::magic + mcap::header() + heads + message + mcap::footer() + mcap::magic,
          "has no record that ends its data");
  refused(mcap::magic + mcap::header() + heads + message + mcap::record(15, little(0u)) + mcap::magic, "");
  const Bytes late = mcap::record(15, little(0u)) + message;
  refused(mcap::magic + mcap::header() + heads + late + mcap::footer() + mcap::magic,
          "follows the end of the data");
  refused(mcap::magic + mcap::magic, "without a footer");
  refused(mcap::magic, "no magic bytes at its end");
  // The reader trusts only the data section. The summary may contain anything.
  const Bytes summary = mcap::schema(1, "another/msg/Type") + mcap::record(11, "statistics");
  EXPECT_THAT(marks(mcap::magic + mcap::header() + heads + message + mcap::record(15, little(0u)) + summary +
                    mcap::footer() + mcap::magic),
              ElementsAre(50));
}

TEST_F(Mcap, ATopicIsChosenOrTold) {
  const Bytes two = heads + mcap::schema(2, image_type) + mcap::channel(2, 2, "/camera") +
                    mcap::schema(3, "std_msgs/msg/String") + mcap::channel(3, 3, "/words") +
                    mcap::message(3, 0, "x") + mcap::message(1, 5, ping_without_time(50)) +
                    mcap::message(2, 5, camera_image(1, 1, "mono8", 1, "a"));
  EXPECT_THAT(marks(mcap::file(two), "/sonar"), ElementsAre(50));
  EXPECT_THAT(marks(mcap::file(two), "/camera"), ElementsAre('a'));
  for (const char* what :
       {"choose one", "/sonar  marine_acoustic_msgs/msg/ProjectedSonarImage  1 messages",
        "/camera  sensor_msgs/msg/Image  1 messages", "/words  std_msgs/msg/String  1 messages"})
    expect_refused<UsageError>([&] { read(mcap::file(two)); }, what);
  expect_refused<UsageError>([&] { read(mcap::file(two), "/soner"); },
                             "has no topic '/soner'; it has:\n  /sonar");
  expect_refused<InputError>([&] { read(mcap::file(two), "/words"); },
                             "type std_msgs/msg/String, which tubefoot does not read");
  refused(mcap::file(mcap::schema(3, "std_msgs/msg/String") + mcap::channel(3, 3, "/words")),
          "has no topic with sonar pictures");
  refused(mcap::file(""), "it has none");
  refused(mcap::file(heads), "has no topic with sonar pictures");  // no message
  // The lists of HoloOcean are no picture. The reader takes the picture next to them.
  const Bytes lists = mcap::schema(4, "holoocean_interfaces/msg/ImagingSonar") +
                      mcap::channel(4, 4, "/lists") +
                      mcap::message(4, 1, Bytes("\0\1\0\0", 4) + Bytes(24, '\0'));
  EXPECT_THAT(marks(mcap::file(heads + lists + mcap::message(1, 5, ping_without_time(50)))), ElementsAre(50));
  refused(mcap::file(lists), "but no matrix");
  // Two publishers are two channels of one topic.
  EXPECT_THAT(
      marks(mcap::file(heads + mcap::channel(2, 1, "/sonar") + mcap::message(2, 9, ping_without_time(90)) +
                       mcap::message(1, 5, ping_without_time(50)))),
      ElementsAre(50, 90));
  const Bytes json =
      mcap::schema(1, projected_type) + mcap::channel(1, 1, "/sonar", "json") + mcap::message(1, 5, "{}");
  refused(mcap::file(json), "is serialized as 'json'");
}

TEST_F(Mcap, AMessageThatIsWrongIsNamed) {
  refused(mcap::file(heads + mcap::message(1, 5, ping_without_time(50)) +
                     mcap::message(1, 6, ping_without_time(60).substr(0, 50))),
          "message 2 of '/sonar' (marine_acoustic_msgs/msg/ProjectedSonarImage): ");
}

constexpr const char* definition = R"(# Single scan
std_msgs/Header header
PingInfo ping_info
geometry_msgs/Vector3[] beam_directions
float32[] ranges  # metres
SonarImageData image
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: marine_acoustic_msgs/PingInfo
float32 frequency
float32 sound_speed
float32[] tx_beamwidths
float32[] rx_beamwidths
================================================================================
MSG: marine_acoustic_msgs/SonarImageData
bool is_bigendian
uint32 DTYPE_UINT8 = 0
uint32 DTYPE_INT8=1
uint32 dtype
uint32 beam_count
uint8[] data
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
)";

TEST_F(Mcap, AnotherDefinitionOfTheSameNameIsRefused) {
  const auto with = [](const Bytes& text) {
    return mcap::file(mcap::schema(1, projected_type, text) + mcap::channel(1, 1, "/sonar") +
                      mcap::message(1, 5, ping_without_time(50)));
  };
  const auto changed = [](const Bytes& from, const Bytes& to) {
    Bytes text = definition;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(marks(with(definition)), ElementsAre(50));
  refused(with(changed("float32 frequency", "uint64 ping_no\nfloat32 frequency")),
          "field 4 is 'uint64 ping_info.ping_no', expected 'float32 ping_info.frequency'");
  refused(with(changed("float32[] ranges", "float64[] ranges")),
          "is 'float64[] ranges', expected 'float32[] ranges'");
  refused(with(changed("float64 y\n", "")), "expected 'float64 beam_directions[].y'");
  refused(with(changed("uint8[] data", "uint8[] data\nuint8 more")),
          "field 16 is 'uint8 image.more', expected none");
  EXPECT_THAT(marks(with(changed("uint8[] data", "byte[] data"))), ElementsAre(50)) << "another word for it";
  EXPECT_THAT(marks(with(changed("MSG: std_msgs/Header", "MSG: std_msgs/Other"))), ElementsAre(50))
      << "not whole";
}

}  // namespace
}  // namespace tubefoot
