// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/descriptor.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace tubefoot {
namespace {

/// Returns a lock of the whole file, including later growth. The process number must be 0 for a lock of an
/// open file description.
struct flock whole_file() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    close();
    number_ = std::exchange(other.number_, -1);
  }
  return *this;
}

void Descriptor::close() {
  if (number_ >= 0) ::close(std::exchange(number_, -1));
}

Descriptor open_own(const std::filesystem::path& file, int flags, mode_t mode) {
  return Descriptor(open(file.c_str(), flags | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, mode));
}

bool take_lock(const Descriptor& file) {
  struct flock lock = whole_file();
  int status = 0;
  do {
    status = fcntl(file.number(), F_OFD_SETLK, &lock);
  } while (status != 0 && errno == EINTR);
  if (status == 0) return true;
  if (errno == EAGAIN || errno == EACCES) return false;
  throw std::system_error(errno, std::generic_category());
}

bool is_locked_by_another(const Descriptor& file) {
  struct flock lock = whole_file();
  return fcntl(file.number(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

bool is_still_at(const std::filesystem::path& name, const Descriptor& file) {
  struct stat opened {
  }, named{};
  return fstat(file.number(), &opened) == 0 && lstat(name.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace tubefoot
