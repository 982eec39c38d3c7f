// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/written.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tubefoot {
namespace {

using testing::ElementsAre;

TEST(WrittenLines, TellASequenceOnce) {
  EXPECT_THAT(written_lines("out", {"echoes.nc", "camera-0000.png", "camera-0000.exr", "camera-0001.png",
                                    "camera-0001.exr", "camera-0002.png", "camera-0002.exr", "stats.json"}),
              ElementsAre("wrote out/echoes.nc", "wrote out/camera-0000.png to camera-0002.png (3 files)",
                          "wrote out/camera-0000.exr to camera-0002.exr (3 files)", "wrote out/stats.json"));
  EXPECT_THAT(
      written_lines("out", {"side-line-01.xtf", "side-line-01-mosaic.tif", "side-line-02.xtf",
                            "side-line-02-mosaic.tif", "side-line-03.xtf", "side-line-03-mosaic.tif"}),
      ElementsAre("wrote out/side-line-01.xtf to side-line-03.xtf (3 files)",
                  "wrote out/side-line-01-mosaic.tif to side-line-03-mosaic.tif (3 files)"));
}

TEST(WrittenLines, TellFewAndOthersOneByOne) {
  EXPECT_THAT(written_lines("a b", {"camera-0000.png", "camera-0001.png"}),
              ElementsAre("wrote a b/camera-0000.png", "wrote a b/camera-0001.png"));
  // The name of a sensor may end in a number. One digit is no sequence.
  EXPECT_THAT(written_lines("o", {"s1.png", "s2.png", "s3.png", "s1-0007.png", "s2-0007.png"}),
              ElementsAre("wrote o/s1.png", "wrote o/s2.png", "wrote o/s3.png", "wrote o/s1-0007.png",
                          "wrote o/s2-0007.png"));
  EXPECT_THAT(written_lines("o", {}), ElementsAre());
}

}  // namespace
}  // namespace tubefoot
