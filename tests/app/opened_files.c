// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the program: every file that it opens stands in the file TUBEFOOT_OPENED, one name a line, as the
// system knows it (links followed), after "r " or, if it may be written to, "w ".
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static int list = -1;

__attribute__((constructor)) static void begin(void) {
  const char* name = getenv("TUBEFOOT_OPENED");
  if (name) list = REAL(open)(name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
}

static int noted(int descriptor, int flags) {
  char link[64], path[4096], line[4200];
  if (list < 0 || descriptor < 0) return descriptor;
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return descriptor;
  path[length] = 0;
  const int bytes = snprintf(line, sizeof line, "%c %s\n", (flags & O_ACCMODE) == O_RDONLY ? 'r' : 'w', path);
  if (write(list, line, (size_t)bytes) != bytes) abort();
  return descriptor;
}

static mode_t mode_of(int flags, va_list rest) {
  return flags & (O_CREAT | __O_TMPFILE) ? va_arg(rest, mode_t) : 0;
}

#define OPEN(name)                                        \
  int name(const char* path, int flags, ...) {            \
    va_list rest;                                         \
    va_start(rest, flags);                                \
    const mode_t mode = mode_of(flags, rest);             \
    va_end(rest);                                         \
    return noted(REAL(name)(path, flags, mode), flags);   \
  }
#define OPENAT(name)                                             \
  int name(int folder, const char* path, int flags, ...) {       \
    va_list rest;                                                \
    va_start(rest, flags);                                       \
    const mode_t mode = mode_of(flags, rest);                    \
    va_end(rest);                                                \
    return noted(REAL(name)(folder, path, flags, mode), flags);  \
  }
#define FOPEN(name)                                                                                        \
  FILE* name(const char* path, const char* mode) {                                                         \
    FILE* file = REAL(name)(path, mode);                                                                   \
    if (file) noted(fileno(file), mode[0] == 'r' && strchr(mode, '+') == NULL ? O_RDONLY : O_RDWR);        \
    return file;                                                                                           \
  }

OPEN(open)
OPEN(open64)
OPENAT(openat)
OPENAT(openat64)
FOPEN(fopen)
FOPEN(fopen64)
