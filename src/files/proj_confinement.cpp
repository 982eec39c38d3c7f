// SPDX-License-Identifier: GPL-3.0-or-later

// Confines PROJ to its own data folders. A finder that PROJ calls for files installs a file interface in
// each context. The interface checks every name while a ProjConfinement exists on the thread.

#include "files/proj_confinement.hpp"

#include <cpl_string.h>
#include <fcntl.h>
#include <ogr_spatialref.h>
#include <proj.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "files/gdal_messages.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// The innermost confinement of this thread.
thread_local ProjConfinement* confinement = nullptr;
/// Whether use_context() is running with GDAL's context of this thread, and whether PROJ called the finder.
thread_local bool in_use = false, asks = false;

/// Returns PROJ's data folders as absolute names without "..".
std::vector<fs::path>& data_folders() {
  static std::vector<fs::path> folders;
  return folders;
}

bool is_data(const char* name) {
  const fs::path file = fs::absolute(name).lexically_normal();
  return std::ranges::any_of(data_folders(), [&](const fs::path& folder) {
    return std::ranges::mismatch(folder, file).in1 == folder.end();
  });
}

FILE* open_data(const char* name) {
  // Without waiting for the other end of a pipe.
  const int descriptor = open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return nullptr;
  struct stat status {};
  FILE* const file =
      fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) ? fdopen(descriptor, "rb") : nullptr;
  if (file == nullptr) close(descriptor);
  return file;
}

FILE* file_of(PROJ_FILE_HANDLE* handle) { return reinterpret_cast<FILE*>(handle); }

}  // namespace

/// Functions that PROJ calls instead of those of the C library. PROJ is written in C, so that no exception
/// may leave them.
struct ProjFiles {
  static PROJ_FILE_HANDLE* open(PJ_CONTEXT*, const char* name, PROJ_OPEN_ACCESS access, void*) {
    FILE* file = nullptr;
    try {
      if (confinement == nullptr)
        file = std::fopen(name, access == PROJ_OPEN_ACCESS_READ_ONLY     ? "rb"
                                : access == PROJ_OPEN_ACCESS_READ_UPDATE ? "r+b"
                                                                         : "w+b");
      else if (may_open(name, access))
        file = open_data(name);
      else
        errno = EACCES;
    } catch (...) {
      errno = ENOMEM;
    }
    return reinterpret_cast<PROJ_FILE_HANDLE*>(file);
  }
  static std::size_t read(PJ_CONTEXT*, PROJ_FILE_HANDLE* handle, void* bytes, std::size_t count, void*) {
    return std::fread(bytes, 1, count, file_of(handle));
  }
  static std::size_t write(PJ_CONTEXT*, PROJ_FILE_HANDLE* handle, const void* bytes, std::size_t count,
                           void*) {
    return std::fwrite(bytes, 1, count, file_of(handle));
  }
  static int seek(PJ_CONTEXT*, PROJ_FILE_HANDLE* handle, long long offset, int whence, void*) {
    return fseeko(file_of(handle), static_cast<off_t>(offset), whence) == 0 ? 1 : 0;
  }
  static unsigned long long tell(PJ_CONTEXT*, PROJ_FILE_HANDLE* handle, void*) {
    return static_cast<unsigned long long>(ftello(file_of(handle)));
  }
  static void close(PJ_CONTEXT*, PROJ_FILE_HANDLE* handle, void*) { std::fclose(file_of(handle)); }
  static int exists(PJ_CONTEXT*, const char* name, void*) {
    struct stat status {};
    return stat(name, &status) == 0 ? 1 : 0;
  }
  static int make_folder(PJ_CONTEXT*, const char* name, void*) {
    return confinement == nullptr && mkdir(name, 0755) == 0 ? 1 : 0;
  }
  static int remove(PJ_CONTEXT*, const char* name, void*) {
    return confinement == nullptr && unlink(name) == 0 ? 1 : 0;
  }
  static int rename(PJ_CONTEXT*, const char* from, const char* to, void*) {
    return confinement == nullptr && std::rename(from, to) == 0 ? 1 : 0;
  }

  /// PROJ calls this function for each name without a folder, such as that of its database, and passes the
  /// context.
  static const char* finder(PJ_CONTEXT* context, const char*, void*) {
    static constexpr PROJ_FILE_API files{1,     open,   read,        write,  seek,  tell,
                                         close, exists, make_folder, remove, rename};
    proj_context_set_fileapi(context, &files, nullptr);
    if (confinement != nullptr) proj_context_set_enable_network(context, 0);
    if (in_use) asks = true;
    return nullptr;  // PROJ continues with its own folders
  }

 private:
  static bool may_open(const char* name, PROJ_OPEN_ACCESS access) {
    if (access == PROJ_OPEN_ACCESS_READ_ONLY && is_data(name)) return true;
    struct stat status {};
    if (confinement->rejected_.empty() && lstat(name, &status) == 0) confinement->rejected_ = name;
    return false;
  }
};

namespace {

/// Installs the finder for all contexts that are created later.
void install_finder() {
  char** const folders = OSRGetPROJSearchPaths();
  for (CSLConstList folder = folders; folder != nullptr && *folder != nullptr; ++folder)
    if (**folder != '\0') data_folders().push_back(fs::absolute(*folder).lexically_normal());
  CSLDestroy(folders);
  proj_context_set_file_finder(nullptr, ProjFiles::finder, nullptr);
}

/// Makes GDAL use its context of this thread for a task that needs a file without a folder.
void use_context() {
  const GdalMessages quiet;
  in_use = true;
  OGRSpatialReference crs;
  crs.importFromEPSG(4326);
  crs.importFromProj4("+proj=longlat +ellps=GRS80 +nadgrids=@tubefoot-asks +type=crs");
  in_use = false;
}

void make_proj_ask() {
  static std::once_flag once;
  std::call_once(once, install_finder);
  use_context();
  if (asks) return;
  OSRCleanup();  // the context of this thread precedes the finder, and GDAL then creates another one
  use_context();
  if (!asks)
    throw std::runtime_error(
        "GDAL uses a different PROJ library than tubefoot, so tubefoot cannot restrict the files that it "
        "reads: link both with the same PROJ library");
}

}  // namespace

ProjConfinement::ProjConfinement() : outer_(confinement) {
  confinement = this;
  try {
    if (!asks) make_proj_ask();
  } catch (...) {
    confinement = outer_;
    throw;
  }
}

ProjConfinement::~ProjConfinement() { confinement = outer_; }

}  // namespace tubefoot
