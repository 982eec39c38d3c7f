// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/tiff_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>

#include "files/advised_command.hpp"
#include "files/input_registry.hpp"

// Counts the directories of a TIFF (TIFF 6.0, section 2). The header contains the offset of the first
// directory, and each directory contains that of the next. BigTIFF has the same structure with 64 bits.
namespace tubefoot {
namespace {

class Chain {
 public:
  explicit Chain(InputFile& file) : in_(file.stream()) {
    std::array<char, 4> head{};
    in_.read(head.data(), head.size());
    little_ = head[0] == 'I';
    big_ = head[2] == 43 || head[3] == 43;
  }

  /// Returns the number of directories, at most `most` + 1.
  int count(int most) {
    in_.seekg(big_ ? 8 : 4);
    int directories = 0;
    for (std::uint64_t at = number(big_ ? 8 : 4); in_ && at != 0 && directories <= most; ++directories) {
      in_.seekg(static_cast<std::streamoff>(at));
      const std::uint64_t entries = number(big_ ? 8 : 2);
      if (entries > 65535) break;  // not a valid directory
      in_.seekg(static_cast<std::streamoff>(entries * (big_ ? 20 : 12)), std::ios::cur);
      at = number(big_ ? 8 : 4);
    }
    return directories;
  }

 private:
  std::uint64_t number(int bytes) {
    std::uint64_t value = 0;
    for (int k = 0; k < bytes; ++k) {
      const auto byte = static_cast<std::uint64_t>(static_cast<unsigned char>(in_.get()));
      value = little_ ? value | byte << 8 * k : value << 8 | byte;
    }
    return in_ ? value : 0;
  }

  std::istream& in_;
  bool little_ = true, big_ = false;
};

}  // namespace

void refuse_long_tiff(const std::filesystem::path& file) {
  constexpr int most = 1000;
  InputFile input(file);
  if (Chain(input).count(most) > most)
    throw InputError({file.string(), 0, 0},
                     fmt::format("has a chain of more than {} pictures: extract the first with {}", most,
                                 advised_command("gdal_translate", file)));
}

}  // namespace tubefoot
