// SPDX-License-Identifier: GPL-3.0-or-later

// Confines GDAL to admitted files. Guards replace the file systems of GDAL and check each name while a
// GdalAccess exists on the thread. Requests to hosts fail in the meantime.

#include "files/gdal_access.hpp"

#include <cpl_conv.h>
#include <cpl_http.h>
#include <cpl_vsi_virtual.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "files/absolute_path.hpp"
#include "files/library_settings.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Files that the GdalAccess objects of this thread admit, the innermost last.
thread_local std::vector<std::set<std::string>> admitted_here;

/// Returns GDAL's folder of tables; empty if there is none.
fs::path& tables() {
  static fs::path folder;
  return folder;
}

/// A guard around a file system of GDAL. It changes nothing for threads without a GdalAccess.
class GuardedFiles final : public VSIFilesystemHandler {
 public:
  /// `ordinary` means that names of this file system are those of files on disk.
  GuardedFiles(VSIFilesystemHandler& behind, bool ordinary) : behind_(behind), ordinary_(ordinary) {}

  VSIVirtualHandle* Open(const char* name, const char* access, bool tell, CSLConstList options) override {
    if (admitted_here.empty()) return behind_.Open(name, access, tell, options);
    const auto file = admitted(name);
    const bool reads = access[0] == 'r' && std::string_view(access).find('+') == std::string_view::npos;
    if (file && reads) return behind_.Open(file->c_str(), access, tell, options);
    errno = ENOENT;
    return nullptr;
  }
  int Stat(const char* name, VSIStatBufL* status, int flags) override {
    if (admitted_here.empty()) return behind_.Stat(name, status, flags);
    if (const auto file = admitted(name)) return behind_.Stat(file->c_str(), status, flags);
    errno = ENOENT;
    return -1;
  }
  // During a GdalAccess, GDAL cannot write or list folders.
  int Unlink(const char* name) override {
    return outside(-1, [&] { return behind_.Unlink(name); });
  }
  int* UnlinkBatch(CSLConstList names) override {
    return outside<int*>(nullptr, [&] { return behind_.UnlinkBatch(names); });
  }
  int Mkdir(const char* name, long mode) override {
    return outside(-1, [&] { return behind_.Mkdir(name, mode); });
  }
  int Rmdir(const char* name) override {
    return outside(-1, [&] { return behind_.Rmdir(name); });
  }
  int RmdirRecursive(const char* name) override {
    return outside(-1, [&] { return behind_.RmdirRecursive(name); });
  }
  char** ReadDirEx(const char* name, int most) override {
    return outside<char**>(nullptr, [&] { return behind_.ReadDirEx(name, most); });
  }
  char** SiblingFiles(const char* name) override {
    return outside<char**>(nullptr, [&] { return behind_.SiblingFiles(name); });
  }
  int Rename(const char* from, const char* to) override {
    return outside(-1, [&] { return behind_.Rename(from, to); });
  }
  VSIDIR* OpenDir(const char* name, int depth, const char* const* options) override {
    return outside<VSIDIR*>(nullptr, [&] { return behind_.OpenDir(name, depth, options); });
  }
  bool Sync(const char* from, const char* to, const char* const* options, GDALProgressFunc progress,
            void* data, char*** outputs) override {
    return outside(false, [&] { return behind_.Sync(from, to, options, progress, data, outputs); });
  }
  char** GetFileMetadata(const char* name, const char* domain, CSLConstList options) override {
    return outside<char**>(nullptr, [&] { return behind_.GetFileMetadata(name, domain, options); });
  }
  bool SetFileMetadata(const char* name, CSLConstList metadata, const char* domain,
                       CSLConstList options) override {
    return outside(false, [&] { return behind_.SetFileMetadata(name, metadata, domain, options); });
  }
  char* GetSignedURL(const char* name, CSLConstList options) override {
    return outside<char*>(nullptr, [&] { return behind_.GetSignedURL(name, options); });
  }
  const char* GetActualURL(const char* name) override {
    return outside<const char*>(nullptr, [&] { return behind_.GetActualURL(name); });
  }
  bool AbortPendingUploads(const char* name) override {
    return outside(true, [&] { return behind_.AbortPendingUploads(name); });
  }
  // These properties do not depend on admission.
  int IsCaseSensitive(const char* name) override { return behind_.IsCaseSensitive(name); }
  GIntBig GetDiskFreeSpace(const char* name) override { return behind_.GetDiskFreeSpace(name); }
  int SupportsSparseFiles(const char* name) override { return behind_.SupportsSparseFiles(name); }
  int HasOptimizedReadMultiRange(const char* name) override {
    return behind_.HasOptimizedReadMultiRange(name);
  }
  const char* GetOptions() override { return behind_.GetOptions(); }
  std::string GetStreamingFilename(const std::string& name) const override {
    return behind_.GetStreamingFilename(name);
  }
  bool IsLocal(const char* name) override { return behind_.IsLocal(name); }
  bool SupportsSequentialWrite(const char* name, bool temporary) override {
    return behind_.SupportsSequentialWrite(name, temporary);
  }
  bool SupportsRandomWrite(const char* name, bool temporary) override {
    return behind_.SupportsRandomWrite(name, temporary);
  }
  bool SupportsRead(const char* name) override { return behind_.SupportsRead(name); }

 private:
  template <class Result, class Ask>
  static Result outside(Result otherwise, const Ask& ask) {
    if (admitted_here.empty()) return ask();
    errno = EACCES;
    return otherwise;
  }

  /// Returns the file with this name if a GdalAccess of the thread admits it.
  std::optional<fs::path> admitted(const char* name) const {
    if (!ordinary_ || *name == '\0') return std::nullopt;
    const fs::path file = plain_name(name);
    for (const std::set<std::string>& files : admitted_here)
      if (files.contains(file.string())) return file;
    if (!tables().empty() && std::ranges::mismatch(tables(), file).in1 == tables().end()) return file;
    return std::nullopt;
  }

  VSIFilesystemHandler& behind_;
  bool ordinary_;
};

/// Installs the guards once, for all file systems of GDAL. The guards and the file systems behind them
/// exist as long as GDAL.
void put_guards() {
  register_gdal_drivers();  // the first call of GDAL creates its list of file systems
  if (const char* table = CPLFindFile("gdal", "gdalvrt.xsd"))
    tables() = absolute_path(table).lexically_normal().parent_path();
  char** prefixes = VSIGetFileSystemsPrefixes();
  for (char** prefix = prefixes; prefix != nullptr && *prefix != nullptr; ++prefix)
    if (std::string_view(*prefix) != "/vsimem/")  // memory of this process
      VSIFileManager::InstallHandler(*prefix, new GuardedFiles(*VSIFileManager::GetHandler(*prefix), false));
  CSLDestroy(prefixes);
  VSIFileManager::InstallHandler("", new GuardedFiles(*VSIFileManager::GetHandler("/"), true));
}

/// Replaces every request to a host and reports an error.
CPLHTTPResult* no_network(const char*, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc, void*,
                          void*) {
  auto* result = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  result->nStatus = 1;
  result->pszErrBuf = CPLStrdup("tubefoot does not read files over the network");
  return result;
}

}  // namespace

GdalAccess::GdalAccess(const std::vector<fs::path>& admitted) {
  static std::once_flag once;
  std::call_once(once, put_guards);
  keep_libraries_to_themselves();
  std::set<std::string>& names = admitted_here.emplace_back();
  for (const fs::path& file : admitted) names.insert(plain_name(file).string());
  CPLHTTPPushFetchCallback(no_network, nullptr);
}

GdalAccess::~GdalAccess() {
  CPLHTTPPopFetchCallback();
  admitted_here.pop_back();
}

void register_gdal_drivers() {
  static std::once_flag once;
  std::call_once(once, [] {
    GDALRegister_VRT();
    GDALRegister_GTiff();
    GDALRegister_PNG();
    GDALRegister_AAIGrid();
    GDALRegister_BAG();
    GDALRegister_netCDF();
    RegisterOGRShape();
    RegisterOGRGeoJSON();
    RegisterOGRGeoPackage();
  });
}

FixedGdalDate::FixedGdalDate() {
  CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "1970-01-01T00:00:00.000Z");
}
FixedGdalDate::~FixedGdalDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr); }

}  // namespace tubefoot
