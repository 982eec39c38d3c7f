// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/temporary_buffer.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

// Tests that a temporary buffer returns its contents, in memory and on disk, from any start position.
TEST(TemporaryBuffer, GivesBackWhatWasPutWhereverOneBegins) {
  const TestFolder folder;
  for (const std::size_t numbers : {std::size_t{3}, std::size_t{100000}, std::size_t{1000003}}) {
    TemporaryBuffer temporary_buffer(folder / "made.bin");
    for (std::uint32_t k = 0; k < numbers; ++k) temporary_buffer.put(k);
    ASSERT_EQ(temporary_buffer.size(), 4 * numbers);
    const auto at = [&](std::size_t first, std::size_t count) {
      std::vector<std::uint32_t> read(count);
      temporary_buffer.read(4 * first, read.data(), 4 * count);
      for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(read[k], first + k);
    };
    at(0, numbers);
    at(numbers / 2, numbers - numbers / 2);
    for (std::size_t first = 0; first + 2 < numbers; first += 997) at(first, 2);
    at(numbers, 0);
    std::uint32_t none = 0;
    EXPECT_THROW(temporary_buffer.read(4 * numbers - 3, &none, 4), std::out_of_range);
    EXPECT_THROW(temporary_buffer.read(4 * numbers + 1, &none, 0), std::out_of_range);
    temporary_buffer.put(std::uint32_t(numbers));  // writing continues after a read
    at(numbers - 1, 2);
    std::string all;
    temporary_buffer.replay([&](std::span<const char> some) { all.append(some.data(), some.size()); });
    ASSERT_EQ(all.size(), temporary_buffer.size());
    std::uint32_t last = 0;
    std::memcpy(&last, all.data() + all.size() - 4, 4);
    EXPECT_EQ(last, numbers);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "it has no name";
}

}  // namespace
}  // namespace tubefoot
