// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

namespace tubefoot {

/// Reserves disk space so that an open file can grow by `bytes`. The size of the file does not change.
/// Returns 0, or the errno of the failure (no space left, file too large). On a file system without
/// reservations it checks the free space, which other programs may use in the meantime.
int reserve_beyond(int descriptor, std::uintmax_t bytes);

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

  /// Calls reserve_beyond(). On failure it throws std::runtime_error with the file and the reason, and the
  /// file is unchanged.
  void reserve(std::uintmax_t bytes);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace tubefoot
