// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

namespace tubefoot {

/// Disk space set aside for a file that a library is writing, so that the library never meets a full disk.
/// HDF5 1.10 needs that: a file that it cannot close crashes the program when it ends.
class ReservedSpace {
 public:
  /// Opens `file` beside its writer and creates it if need be. Throws std::runtime_error with its name.
  explicit ReservedSpace(const std::filesystem::path& file);
  /// Gives back what was reserved beyond the end.
  ~ReservedSpace();
  ReservedSpace(const ReservedSpace&) = delete;
  ReservedSpace& operator=(const ReservedSpace&) = delete;

  /// Sees to it that the file can grow by `bytes`. Throws std::runtime_error naming it and the reason (no
  /// space left, file too large) if it cannot; it is then unchanged. File systems without reservations are
  /// asked for their free space, which others may take meanwhile.
  void reserve(std::uintmax_t bytes);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace tubefoot
