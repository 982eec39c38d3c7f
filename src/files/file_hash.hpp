// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace tubefoot {

/// SHA-256 of a stream of bytes (FIPS 180-4).
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void update(std::string_view bytes);
  /// Returns the digest of all bytes up to now, as 64 lower-case hexadecimal digits. More bytes may follow.
  std::string hex_digest() const;

 private:
  evp_md_ctx_st* state_;
};

/// Returns the digest of a file's bytes. Throws InputError if the file cannot be read.
std::string sha256_of(const std::filesystem::path& file);

}  // namespace tubefoot
