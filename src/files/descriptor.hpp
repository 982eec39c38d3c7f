// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <utility>

namespace tubefoot {

/// A file descriptor of the operating system, closed by the destructor.
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

/// Opens a file that only tubefoot uses. It never follows a link and never waits for the other end of a
/// pipe. On failure it returns an empty descriptor and sets errno.
Descriptor open_own(const std::filesystem::path& file, int flags, mode_t mode = 0666);

/// Takes the exclusive lock of a file for this descriptor, until it is closed or the process ends in any
/// way. Returns false if another open file holds the lock.
/// The lock belongs to the open file description. Unlike process numbers, such locks are visible to the
/// server of a shared disk and to all containers with access to the file. Throws std::system_error if the
/// file system has no locks. `file` must be open for writing.
bool take_lock(const Descriptor& file);
/// Returns whether another open file holds the lock.
bool is_locked_by_another(const Descriptor& file);
/// Returns whether `name` still refers to this open file. After a wait for a lock, the locked file may have
/// been removed.
bool is_still_at(const std::filesystem::path& name, const Descriptor& file);

}  // namespace tubefoot
