// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <utility>

namespace tubefoot {

/// An open file of the system, closed at the end.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept;

  explicit operator bool() const { return number_ >= 0; }
  int number() const { return number_; }
  void close();

 private:
  int number_ = -1;
};

/// Opens a file that only tubefoot is to touch: never through a link, never waiting for a pipe's other end.
/// No descriptor, and errno, where the system refuses.
Descriptor open_own(const std::filesystem::path& file, int flags, mode_t mode = 0666);

/// Makes this open file the only one that holds the file's lock, until it is closed or the process ends,
/// however it does; false where another open file holds it. Locks of open file descriptions are known to the
/// server of a shared disk and to every container that sees the file, as numbers of processes are not. Throws
/// std::system_error where the file system has no locks. `file` must be open for writing.
bool take_lock(const Descriptor& file);
/// Whether another open file holds the lock.
bool is_locked_by_another(const Descriptor& file);
/// Whether `name` still is this open file: whoever had to wait for a lock may hold that of a file that was
/// removed.
bool is_still_at(const std::filesystem::path& name, const Descriptor& file);

}  // namespace tubefoot
