// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the structure of KMALL files: counts of recordings by an independent walk, damage at each byte, and
// datagrams that are divided into parts.
#include "kmall/kmall_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "fixtures/kmall_builder.hpp"
#include "fixtures/kmall_recordings.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "kmall/kmall_survey.hpp"

namespace tubefoot {
namespace {

using namespace kmall_for_tests;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct KmallFiles : testing::Test {
  TestFolder folder;

  KmallFile read(const std::string& bytes) const { return KmallFile(folder.write("line.kmall", bytes)); }
  std::string error_of(const std::string& bytes) const {
    const std::string message = refusal<InputError>([&] { read(bytes); });
    EXPECT_THAT(message, HasSubstr((folder / "line.kmall").string() + ": "));
    return message;
  }
  static std::string text(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }
};

/// A few datagrams of each kind that readers of the structure distinguish.
std::vector<std::string> few_datagrams() {
  return {datagram("#IIP", 0, begin_s, "text"), part_of("#MRZ", 3, begin_s + 1, 1, 1, "body of a ping"),
          datagram("#SPO", 0, begin_s + 1.5, ""), part_of("#MWC", 2, begin_s + 2, 1, 1, "column")};
}

std::string joined(const std::vector<std::string>& datagrams) {
  std::string bytes;
  for (const std::string& one : datagrams) bytes += one;
  return bytes;
}

std::string changed(std::string bytes, std::size_t at, std::uint32_t to) {
  std::memcpy(bytes.data() + at, &to, sizeof to);
  return bytes;
}

/// Counts datagrams by their lengths.
std::map<std::string, std::size_t> counted(const std::string& bytes) {
  std::map<std::string, std::size_t> counts;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at, sizeof length);
    ++counts[bytes.substr(at + 4, 4)];
    at += length;
  }
  return counts;
}

TEST_F(KmallFiles, CountTheDatagramsOfEachRecording) {
  std::vector<std::filesystem::path> files{repository_recording};
  for (const auto& file : shared_recordings()) files.push_back(file);
  for (std::filesystem::path file : files)
    for (const char* extension : {".kmall", ".kmwcd"}) {
      SCOPED_TRACE(file.replace_extension(extension).string());
      const KmallFile kmall(file);
      EXPECT_EQ(kmall.counts(), counted(bytes_of(file)));
      EXPECT_EQ(kmall.incomplete(), 0u);
    }
  if (files.size() == 1) GTEST_SKIP() << "only the recording of the repository is tested: " << no_recordings;
}

TEST_F(KmallFiles, GiveHeadersAndBodies) {
  KmallFile file = read(joined(few_datagrams()));
  EXPECT_EQ(file.path(), folder / "line.kmall");
  ASSERT_EQ(file.records("#MRZ").size(), 1u);
  const KmallRecord ping = file.records("#MRZ")[0];
  EXPECT_EQ(ping.type, "#MRZ");
  EXPECT_EQ(ping.version, 3u);
  EXPECT_NEAR(ping.time_s, begin_s + 1, 1e-6);
  EXPECT_EQ(text(file.body(ping)), "body of a ping");
  EXPECT_EQ(text(file.body(file.records("#IIP").at(0))), "text");
  EXPECT_EQ(text(file.body(file.records("#MWC").at(0))), "column");
  EXPECT_EQ(text(file.body(file.records("#SPO").at(0))), "");
  EXPECT_NEAR(file.records("#SPO").at(0).time_s, begin_s + 1.5, 1e-6);
  EXPECT_TRUE(file.records("#SKM").empty());
  EXPECT_THAT(file.error(ping, "is wrong").what(), HasSubstr("datagram #MRZ at byte 28: is wrong"));
}

TEST_F(KmallFiles, TruncatedAnywhereNameTheOffset) {
  const std::vector<std::string> datagrams = few_datagrams();
  const std::string whole = joined(datagrams);
  std::size_t border = 0, next = 0;
  for (std::size_t length = 1; length < whole.size(); ++length) {
    SCOPED_TRACE(length);
    if (length == border + datagrams[next].size()) {
      border = length;
      EXPECT_EQ(read(whole.substr(0, length)).counts(), counted(whole.substr(0, length)));
      ++next;
      continue;
    }
    const std::string message = error_of(whole.substr(0, length));
    if (border > 0 || length >= 24)
      EXPECT_THAT(message, AllOf(HasSubstr("is truncated"), HasSubstr(fmt::format("byte {}", border))));
    else
      EXPECT_THAT(message, HasSubstr(fmt::format("it has {} bytes", length)));
  }
  EXPECT_EQ(next + 1, datagrams.size());
}

TEST_F(KmallFiles, WithDamagedLengthsNameTheOffset) {
  const std::string whole = joined(few_datagrams());
  for (const std::size_t at : {std::size_t{0}, std::size_t{28}}) {
    SCOPED_TRACE(at);
    const std::string place = fmt::format("at byte {}", at);
    for (const std::uint32_t length : {0u, 1u, 20u, 23u})
      EXPECT_THAT(error_of(changed(whole, at, length)), AllOf(HasSubstr("is damaged"), HasSubstr(place),
                                                              HasSubstr(fmt::format("{} bytes", length))));
    for (const std::size_t length : {whole.size() - at + 1, std::size_t{0xffff'ffff}})
      EXPECT_THAT(error_of(changed(whole, at, std::uint32_t(length))),
                  AllOf(HasSubstr("is truncated"), HasSubstr(place), HasSubstr("copy the file again")));
    EXPECT_THAT(error_of(changed(whole, at, 27)), AllOf(HasSubstr("is damaged"), HasSubstr(place)));
  }
}

TEST_F(KmallFiles, WithADamagedTrailerNameTheOffset) {
  const std::vector<std::string> datagrams = few_datagrams();
  std::size_t at = 0;
  for (const std::string& one : datagrams) {
    for (std::size_t byte = 1; byte <= 4; ++byte) {
      std::string damaged = joined(datagrams);
      damaged[at + one.size() - byte] ^= 1;
      EXPECT_THAT(error_of(damaged), HasSubstr(fmt::format("at byte {} does not end with its length", at)));
    }
    at += one.size();
  }
}

TEST_F(KmallFiles, OfAnotherKindAreRejected) {
  EXPECT_THAT(error_of(""), HasSubstr("is empty"));
  EXPECT_THAT(error_of("time_s,east_m,north_m\n0,0,0\n1,0,0\n"), HasSubstr("is not a KMALL file"));
  EXPECT_THAT(error_of(std::string(100, '\0')), HasSubstr("is not a KMALL file"));
  const std::string whole = joined(few_datagrams());
  for (const char* type : {"MRZ#", "#mrz", "#MR1", "#M Z", "\x1b[2J"}) {
    std::string first = whole, second = whole;
    first.replace(4, 4, type);
    second.replace(28 + 4, 4, type);
    EXPECT_THAT(error_of(first), HasSubstr("is not a KMALL file"));
    EXPECT_THAT(error_of(second), AllOf(HasSubstr("is damaged"), HasSubstr("at byte 32")));
    EXPECT_THAT(error_of(second), Not(HasSubstr("\x1b")));
  }
  EXPECT_THROW(KmallFile(folder / "missing.kmall"), InputError);
  EXPECT_THROW(KmallFile(folder.path()), InputError);
}

TEST_F(KmallFiles, WithoutRoomForTheNumberOfAPartAreDamaged) {
  for (std::size_t bytes = 0; bytes < 4; ++bytes)
    for (const char* type : {"#MRZ", "#MWC"})
      EXPECT_THAT(error_of(datagram(type, 3, begin_s, std::string(bytes, '\1'))),
                  AllOf(HasSubstr("is damaged"), HasSubstr("at byte 0")));
}

const std::string divided_body = "This body is divided into several parts.";

TEST_F(KmallFiles, JoinTheParts) {
  for (const std::size_t parts : {2u, 3u, 7u}) {
    KmallFile file = read(joined(divided("#MWC", 2, begin_s, divided_body, parts)));
    ASSERT_EQ(file.records("#MWC").size(), 1u);
    EXPECT_EQ(file.records("#MWC")[0].parts.size(), parts);
    EXPECT_EQ(text(file.body(file.records("#MWC")[0])), divided_body);
    EXPECT_EQ(file.incomplete(), 0u);
  }
}

TEST_F(KmallFiles, JoinThePartsBetweenOtherDatagrams) {
  const auto column = divided("#MWC", 2, begin_s, divided_body, 3),
             ping = divided("#MRZ", 3, begin_s, "soundings in parts", 2);
  const std::string position = datagram("#SPO", 0, begin_s, "p");
  const std::string next = part_of("#MWC", 2, begin_s + 1, 1, 1, "next");
  KmallFile file =
      read(joined({position, column[0], ping[0], position, column[1], column[2], next, position, ping[1]}));
  ASSERT_EQ(file.records("#MWC").size(), 2u);
  EXPECT_EQ(text(file.body(file.records("#MWC")[0])), divided_body);
  EXPECT_EQ(text(file.body(file.records("#MWC")[1])), "next");
  ASSERT_EQ(file.records("#MRZ").size(), 1u);
  EXPECT_EQ(text(file.body(file.records("#MRZ")[0])), "soundings in parts");
  EXPECT_EQ(file.records("#SPO").size(), 3u);
  EXPECT_EQ(file.incomplete(), 0u);
}

TEST_F(KmallFiles, LeaveOutAndCountDatagramsThatLackAPart) {
  const std::string before = part_of("#MWC", 2, begin_s - 1, 1, 1, "before"),
                    after = part_of("#MWC", 2, begin_s + 1, 1, 1, "after");
  const auto parts = divided("#MWC", 2, begin_s, divided_body, 3);
  for (const std::vector<std::size_t>& kept :
       {std::vector<std::size_t>{0, 1}, {0, 2}, {1, 2}, {0}, {1}, {2}}) {
    SCOPED_TRACE(testing::PrintToString(kept));
    std::string bytes = before;
    for (const std::size_t k : kept) bytes += parts[k];
    KmallFile file = read(bytes + after);
    ASSERT_EQ(file.records("#MWC").size(), 2u);
    EXPECT_EQ(text(file.body(file.records("#MWC")[0])), "before");
    EXPECT_EQ(text(file.body(file.records("#MWC")[1])), "after");
    EXPECT_EQ(file.incomplete(), 1u);
    EXPECT_EQ(read(bytes).records("#MWC").size(), 1u) << "at the end of the file";
    EXPECT_EQ(read(bytes).incomplete(), 1u) << "at the end of the file";
  }
}

TEST_F(KmallFiles, DoNotJoinPartsOfDifferentPings) {
  const auto one = divided("#MWC", 2, begin_s, divided_body, 2),
             two = divided("#MWC", 2, begin_s + 1, divided_body, 2);
  KmallFile file = read(joined({one[0], two[1], two[0], two[1]}));
  ASSERT_EQ(file.records("#MWC").size(), 1u);
  EXPECT_NEAR(file.records("#MWC")[0].time_s, begin_s + 1, 1e-6);
  EXPECT_EQ(file.incomplete(), 2u);
  EXPECT_EQ(read(part_of("#MWC", 2, begin_s, 0, 1, "x")).incomplete(), 1u) << "a datagram of 0 parts";
  KmallFile other_number =
      read(part_of("#MWC", 2, begin_s, 3, 1, "x") + part_of("#MWC", 2, begin_s, 4, 3, "y") +
           part_of("#MWC", 2, begin_s, 4, 4, "z"));
  EXPECT_TRUE(other_number.records("#MWC").empty()) << "parts 1 of 3, 3 of 4 and 4 of 4";
  EXPECT_EQ(other_number.incomplete(), 1u);
}

TEST(KmallLimits, AreThoseOfTheDocumentation) {
  std::ifstream in(std::string(TUBEFOOT_SOURCE_DIR) + "/docs/limits.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(page, testing::HasSubstr(fmt::format(
                        "| datagrams of a survey line; bytes of a datagram with all parts | {}; {} |",
                        most_kmall_datagrams, most_kmall_record_bytes)));
  EXPECT_THAT(page, testing::HasSubstr(fmt::format("| modes of a survey line | {} |", most_kmall_modes)));
}

}  // namespace
}  // namespace tubefoot
