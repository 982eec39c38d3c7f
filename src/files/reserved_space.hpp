// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

namespace tubefoot {

/// Reserved disk space for a file that a library is writing, so that the library never meets a full disk.
/// HDF5 1.10 needs it: after it fails to close a file, the program crashes at exit.
class ReservedSpace {
 public:
  /// Opens `file` in addition to its writer and creates it if necessary. Throws std::runtime_error that
  /// names it.
  explicit ReservedSpace(const std::filesystem::path& file);
  /// Releases the space that was reserved beyond the end of the file.
  ~ReservedSpace();
  ReservedSpace(const ReservedSpace&) = delete;
  ReservedSpace& operator=(const ReservedSpace&) = delete;

  /// Reserves space so that the file can grow by `bytes`. On failure it throws std::runtime_error with the
  /// file and the reason (no space left, file too large), and the file is unchanged. On a file system
  /// without reservations it checks the free space, which other programs may use in the meantime.
  void reserve(std::uintmax_t bytes);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace tubefoot
