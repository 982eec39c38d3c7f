// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the program: tells what a disk would hold if the power failed after any call that changes
// names below TUBEFOOT_POWER_BELOW or brings something to the disk. The file "log" in the folder
// TUBEFOOT_POWER_LOG gets a line "call NAME" for each, then what it brought to the disk ("bytes ID COPY" of a
// file, copied into that folder; "names ID" of a folder), then a line "entry FOLDER ID TYPE NAME" for each
// name there is. An ID is of one file's life: its number, which is given again, and when it was made. Nothing
// is really brought to the disk.
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static const char *below, *log_folder;
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static __thread int inside;  // a call that is made by one of these
static long copies;
static FILE* log_file;

static int here(const char* path) {
  return log_file && !inside && path && strncmp(path, below, strlen(below)) == 0;
}

static int here_fd(int fd) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return 0;
  path[length] = 0;
  return here(path);
}

static void id_of(int folder, const char* name, char* id, char* type) {
  struct statx status;
  memset(&status, 0, sizeof status);
  statx(folder, name, AT_SYMLINK_NOFOLLOW | (name[0] ? 0 : AT_EMPTY_PATH), STATX_BASIC_STATS | STATX_BTIME,
        &status);
  sprintf(id, "%llu-%lld.%u", (unsigned long long)status.stx_ino, (long long)status.stx_btime.tv_sec,
          status.stx_btime.tv_nsec);
  *type = S_ISDIR(status.stx_mode) ? 'd' : S_ISREG(status.stx_mode) ? 'f' : 'o';
}

static void list(const char* path) {
  DIR* folder = opendir(path);
  if (folder == NULL) return;
  char own[80], id[80], type;
  id_of(dirfd(folder), "", own, &type);
  for (struct dirent* entry; (entry = readdir(folder)) != NULL;) {
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
    id_of(dirfd(folder), entry->d_name, id, &type);
    fprintf(log_file, "entry %s %s %c %s\n", own, id, type, entry->d_name);
    char sub[4096];
    snprintf(sub, sizeof sub, "%s/%s", path, entry->d_name);
    if (type == 'd') list(sub);
  }
  closedir(folder);
}

/// `synced`: a file or folder that is now on the disk, or -1.
static void note(const char* call, int synced) {
  const int before = errno;
  pthread_mutex_lock(&mutex);
  inside = 1;
  fprintf(log_file, "call %s\n", call);
  if (synced >= 0) {
    char id[80], type;
    id_of(synced, "", id, &type);
    if (type == 'd') {
      fprintf(log_file, "names %s\n", id);
    } else {
      char from[64], to[4096];
      static char bytes[1 << 16];
      snprintf(from, sizeof from, "/proc/self/fd/%d", synced);
      snprintf(to, sizeof to, "%s/copy-%ld", log_folder, copies);
      const int in = REAL(open)(from, O_RDONLY), out = REAL(open)(to, O_WRONLY | O_CREAT, 0666);
      for (ssize_t count; (count = read(in, bytes, sizeof bytes)) > 0;)
        if (write(out, bytes, (size_t)count) != count) abort();
      close(in), close(out);
      fprintf(log_file, "bytes %s copy-%ld\n", id, copies++);
    }
  }
  list(below);
  fflush(log_file);
  inside = 0;
  pthread_mutex_unlock(&mutex);
  errno = before;
}

__attribute__((constructor)) static void begin(void) {
  below = getenv("TUBEFOOT_POWER_BELOW");
  log_folder = getenv("TUBEFOOT_POWER_LOG");
  if (below == NULL || log_folder == NULL) return;
  char name[4096];
  snprintf(name, sizeof name, "%s/log", log_folder);
  log_file = REAL(fopen)(name, "we");
  note("begin", -1);
}

int fsync(int fd) {
  if (!here_fd(fd)) return REAL(fsync)(fd);
  note("fsync", fd);
  return 0;
}
int fdatasync(int fd) {
  if (!here_fd(fd)) return REAL(fdatasync)(fd);
  note("fdatasync", fd);
  return 0;
}

// The result of the call itself, noted where it succeeded.
#define NOTED(relevant, name, arguments)                     \
  const int met = (relevant), result = REAL(name) arguments; \
  if (met && result >= 0) note(#name, -1);                   \
  return result

int mkdir(const char* path, mode_t mode) { NOTED(here(path), mkdir, (path, mode)); }
int rmdir(const char* path) { NOTED(here(path), rmdir, (path)); }
int unlink(const char* path) { NOTED(here(path), unlink, (path)); }
int remove(const char* path) { NOTED(here(path), remove, (path)); }
int unlinkat(int fd, const char* path, int flags) {
  NOTED(here(path) || here_fd(fd), unlinkat, (fd, path, flags));
}
int rename(const char* from, const char* to) { NOTED(here(to), rename, (from, to)); }
int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  NOTED(here(to), renameat2, (a, from, b, to, flags));
}
int ftruncate(int fd, off_t size) { NOTED(here_fd(fd), ftruncate, (fd, size)); }
int ftruncate64(int fd, off64_t size) { NOTED(here_fd(fd), ftruncate64, (fd, size)); }

#define OPEN(name)                                                          \
  int name(const char* path, int flags, ...) {                              \
    va_list rest;                                                           \
    va_start(rest, flags);                                                  \
    const mode_t mode = va_arg(rest, mode_t);                               \
    va_end(rest);                                                           \
    NOTED((flags & O_CREAT) != 0 && here(path), name, (path, flags, mode)); \
  }
OPEN(open)
OPEN(open64)

FILE* fopen(const char* path, const char* mode) {
  FILE* file = REAL(fopen)(path, mode);
  if (file && mode[0] != 'r' && here(path)) note("fopen", -1);
  return file;
}
FILE* fopen64(const char* path, const char* mode) {
  FILE* file = REAL(fopen64)(path, mode);
  if (file && mode[0] != 'r' && here(path)) note("fopen64", -1);
  return file;
}
