// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the program: from call TUBEFOOT_FAIL_AT on, whatever writes below TUBEFOOT_FAIL_BELOW fails as
// on a full disk. With TUBEFOOT_FAIL_ONCE only that call fails. At the end the number of calls met stands in the file
// TUBEFOOT_FAIL_COUNT.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static long met;  // calls are counted across threads
static const char* below;
static long fail_at = -1;
static int once;

__attribute__((constructor)) static void begin(void) {
  below = getenv("TUBEFOOT_FAIL_BELOW");
  const char* at = getenv("TUBEFOOT_FAIL_AT");
  fail_at = at ? atol(at) : -1;
  once = getenv("TUBEFOOT_FAIL_ONCE") != NULL;
}

__attribute__((destructor)) static void end(void) {
  const char* name = getenv("TUBEFOOT_FAIL_COUNT");
  FILE* file = name ? fopen(name, "w") : NULL;
  if (file == NULL) return;
  fprintf(file, "%ld\n", met);
  fclose(file);
}

static int here(const char* path) { return below && path && strncmp(path, below, strlen(below)) == 0; }

static int here_fd(int fd) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return 0;
  path[length] = 0;
  return here(path);
}

static int fails(int counted) {
  if (!counted) return 0;
  const long call = __atomic_fetch_add(&met, 1, __ATOMIC_SEQ_CST);
  if (fail_at < 0 || (once ? call != fail_at : call < fail_at)) return 0;
  errno = ENOSPC;
  return 1;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void* bytes, size_t count) {
  return fails(here_fd(fd)) ? -1 : REAL(write)(fd, bytes, count);
}
ssize_t pwrite(int fd, const void* bytes, size_t count, off_t at) {
  return fails(here_fd(fd)) ? -1 : REAL(pwrite)(fd, bytes, count, at);
}
ssize_t pwrite64(int fd, const void* bytes, size_t count, off64_t at) {
  return fails(here_fd(fd)) ? -1 : REAL(pwrite64)(fd, bytes, count, at);
}
ssize_t writev(int fd, const struct iovec* parts, int count) {
  return fails(here_fd(fd)) ? -1 : REAL(writev)(fd, parts, count);
}
int ftruncate(int fd, off_t size) { return fails(here_fd(fd)) ? -1 : REAL(ftruncate)(fd, size); }
int ftruncate64(int fd, off64_t size) { return fails(here_fd(fd)) ? -1 : REAL(ftruncate64)(fd, size); }
int posix_fallocate(int fd, off_t at, off_t size) {
  return fails(here_fd(fd)) ? ENOSPC : REAL(posix_fallocate)(fd, at, size);
}
int posix_fallocate64(int fd, off64_t at, off64_t size) {
  return fails(here_fd(fd)) ? ENOSPC : REAL(posix_fallocate64)(fd, at, size);
}
int fallocate(int fd, int mode, off_t at, off_t size) {
  return fails(here_fd(fd)) ? -1 : REAL(fallocate)(fd, mode, at, size);
}
int fallocate64(int fd, int mode, off64_t at, off64_t size) {
  return fails(here_fd(fd)) ? -1 : REAL(fallocate64)(fd, mode, at, size);
}
int fsync(int fd) { return fails(here_fd(fd)) ? -1 : REAL(fsync)(fd); }
int fdatasync(int fd) { return fails(here_fd(fd)) ? -1 : REAL(fdatasync)(fd); }
int mkdir(const char* path, mode_t mode) { return fails(here(path)) ? -1 : REAL(mkdir)(path, mode); }
int rename(const char* from, const char* to) { return fails(here(to)) ? -1 : REAL(rename)(from, to); }
int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  return fails(here(to)) ? -1 : REAL(renameat2)(a, from, b, to, flags);
}

// fopen() writes by calls inside the C library that no preloaded function sees, so each stream's own calls
// are met instead.
FILE* fopen(const char* path, const char* mode) {
  return fails(here(path) && mode[0] != 'r') ? NULL : REAL(fopen)(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  return fails(here(path) && mode[0] != 'r') ? NULL : REAL(fopen64)(path, mode);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  return fails(here_fd(fileno(file))) ? 0 : REAL(fwrite)(bytes, size, count, file);
}
int fflush(FILE* file) { return fails(file && here_fd(fileno(file))) ? EOF : REAL(fflush)(file); }
int fclose(FILE* file) {
  const int failed = fails((fcntl(fileno(file), F_GETFL) & O_ACCMODE) != O_RDONLY && here_fd(fileno(file)));
  const int result = REAL(fclose)(file);
  if (failed) errno = ENOSPC;
  return failed ? EOF : result;
}

static int opens(const char* path, int flags) { return fails((flags & O_CREAT) != 0 && here(path)); }
#define OPEN(name)                                     \
  int name(const char* path, int flags, ...) {         \
    va_list rest;                                      \
    va_start(rest, flags);                             \
    const mode_t mode = va_arg(rest, mode_t);          \
    va_end(rest);                                      \
    return opens(path, flags) ? -1 : REAL(name)(path, flags, mode); \
  }
OPEN(open)
OPEN(open64)
