// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/reserved_space.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>

#include "files/checked_file.hpp"

namespace tubefoot {
ReservedSpace::ReservedSpace(const std::filesystem::path& file) : file_(file) {
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw write_error(file, errno);
}

ReservedSpace::~ReservedSpace() {
  struct stat now {};
  if (fstat(descriptor_, &now) == 0 && ftruncate(descriptor_, now.st_size) != 0)
    errno = 0;  // an error only leaves unused space
  close(descriptor_);
}

void ReservedSpace::reserve(std::uintmax_t bytes) {
  if (const int error = reserve_beyond(descriptor_, bytes); error != 0) throw write_error(file_, error);
}

int reserve_beyond(int descriptor, std::uintmax_t bytes) {
  struct stat now {};
  if (fstat(descriptor, &now) != 0) return errno;
  const std::uintmax_t wanted = static_cast<std::uintmax_t>(now.st_size) + bytes;
  rlimit limit{};  // some file systems reserve space beyond this limit
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && wanted > limit.rlim_cur)
    return EFBIG;
  int status = 0;
  do {
    status = fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(wanted));
  } while (status != 0 && errno == EINTR);
  if (status == 0) return 0;
  if (errno != EOPNOTSUPP && errno != ENOSYS) return errno;
  struct statvfs disk {};
  if (fstatvfs(descriptor, &disk) != 0) return errno;
  return static_cast<std::uintmax_t>(disk.f_bavail) * disk.f_frsize < bytes ? ENOSPC : 0;
}

}  // namespace tubefoot
