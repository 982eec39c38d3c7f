// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/base64.hpp"

#include <gtest/gtest.h>

namespace tubefoot {
namespace {

// RFC 4648, 10.
TEST(Base64, HasTheStandardsExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace tubefoot
