// SPDX-License-Identifier: GPL-3.0-or-later
// Tests messages in the text form of `ros2 topic echo`: pictures, truncated lists, errors with line
// numbers, and aliases.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/input_error.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/test_folder.hpp"
#include "import/bags/bag.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

const std::string printed = R"(header:
  stamp:
    sec: 12
    nanosec: 500000000
  frame_id: sonar
ping_info:
  frequency: 900000.0
  sound_speed: 1500.0
  tx_beamwidths: []
  rx_beamwidths:
  - 0.009999999776482582
beam_directions:
- x: 0.0
  y: -1.0
  z: 1.0
- x: 0.0
  y: 1.0
  z: 1.0
ranges:
- 1.0
- 2.5
image:
  is_bigendian: false
  dtype: 0
  beam_count: 2
  data:
  - 7
  - 255
  - 0
  - 9
---
)";

class PrintedMessages : public testing::Test {
 protected:
  ForeignData read(const std::string& text) { return read_bag(folder.write("m.yaml", text)); }
  void refused(const std::string& from, const std::string& to, const std::string& what) {
    std::string text = printed;
    ASSERT_NE(text.find(from), text.npos);
    text.replace(text.find(from), from.size(), to);
    expect_refused<InputError>([&] { read(text); }, what);
  }
  TestFolder folder;
};

TEST_F(PrintedMessages, AreReadAsTheyArePrinted) {
  const ForeignData data = read(printed + printed);
  ASSERT_THAT(data.frames, SizeIs(2));
  const ForeignFrame& frame = data.frames[1];
  EXPECT_EQ(frame.rows, 2u);
  EXPECT_EQ(frame.columns, 2u);
  EXPECT_THAT(frame.values, ElementsAre(7, 255, 0, 9));
  EXPECT_THAT(frame.range_m, ElementsAre(1, 2.5));
  EXPECT_THAT(frame.azimuth_rad, ElementsAre(-M_PI / 4, M_PI / 4));
  EXPECT_EQ(frame.time_s, 12.5);
  EXPECT_THAT(read(printed.substr(0, printed.size() - 4)).frames, SizeIs(1)) << "without the last ---";
}

TEST_F(PrintedMessages, ImagesAndRawImagesAreReported) {
  const std::string head = "header: {stamp: {sec: 1, nanosec: 0}, frame_id: ''}\n";
  const ForeignFrame image =
      read(head + "height: 1\nwidth: 2\nencoding: mono8\nis_bigendian: 0\nstep: 2\ndata: [5, 6]\n---\n")
          .frames.at(0);
  EXPECT_THAT(image.values, ElementsAre(5, 6));
  const ForeignFrame raw =
      read(head +
           "ping_info: {frequency: 1.0, sound_speed: 1500.0, tx_beamwidths: [], rx_beamwidths: "
           "[]}\nsample_rate: 750.0\n"
           "samples_per_beam: 2\nsample0: 1\ntx_delays: []\ntx_angles: []\nrx_angles: [.5]\n"
           "image: {is_bigendian: false, dtype: 1, beam_count: 1, data: [255, 1]}\n")
          .frames.at(0);
  EXPECT_THAT(raw.values, ElementsAre(-1, 1));
  EXPECT_THAT(raw.range_m, ElementsAre(1, 2));
}

TEST_F(PrintedMessages, WhatWasCutOffInPrintingIsReported) {
  refused("  - 0\n", "  - '...'\n", "m.yaml:29:5: data: the list was cut off when it was printed");
  refused("ranges:\n- 1.0\n- 2.5\n", "ranges: '<sequence type: float, length: 2>'\n", "ranges is not a list");
}

TEST_F(PrintedMessages, WhatIsWrongIsNamedByItsLine) {
  refused("ranges:\n- 1.0\n- 2.5\n", "", "has no 'ranges'");
  refused("- 2.5", "- 2.5m", "m.yaml:21:3: ranges: '2.5m' is not a number of the field's type");
  refused("  - 255", "  - 256", "m.yaml:28:5: data: '256' is not a number");
  refused("  - 255", "  - -1", "data: '-1' is not a number");
  refused("beam_count: 2", "beam_count: 2e9", "beam_count: '2e9' is not a number");
  refused("is_bigendian: false", "is_bigendian: 0", "expected true or false");
  refused("  - 255\n", "", "m.yaml:1: image.data has 3 bytes");
  refused("header:", "header: [", "is not a message as ros2 topic echo prints it (YAML)");
  expect_refused<InputError>([&] { read(printed + "data: hello\n---\n"); },
                             "m.yaml:32: is not a message that tubefoot reads");
  expect_refused<InputError>([&] { read(""); }, "has no message");
  expect_refused<InputError>([&] { read(std::string(100'000, '[')); }, "is not a message as");
}

/// Nested aliases, each ten times the previous one, are 10^10 numbers. The reader counts them without
/// expanding them.
TEST_F(PrintedMessages, AliasesWithoutEndAreRefused) {
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int k = 1; k < 10; ++k) {
    const std::string before = "*a" + std::to_string(k - 1);
    text += "a" + std::to_string(k) + ": &a" + std::to_string(k) + " [" + before;
    for (int n = 1; n < 10; ++n) text += ", " + before;
    text += "]\n";
  }
  expect_refused<InputError>(
      [&] {
        read(text + printed.substr(0, printed.find("ranges:")) + "ranges: *a9\n" +
             printed.substr(printed.find("image:")));
      },
      "ranges: expected a number");
}

}  // namespace
}  // namespace tubefoot
