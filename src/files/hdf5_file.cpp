// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <mutex>
#include <set>
#include <string>

#include "files/inlet.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Closes what HDF5 opened.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// HDF5 prints its errors to stderr unless told not to, thread by thread.
class Silence {
 public:
  Silence() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

struct Finding {
  std::string what;  ///< empty: nothing
};

herr_t look_at_link(hid_t, const char* name, const H5L_info_t* link, void* data) {
  if (link->type == H5L_TYPE_HARD || link->type == H5L_TYPE_SOFT) return 0;
  static_cast<Finding*>(data)->what =
      fmt::format("has '{}', a link {}", name,
                  link->type == H5L_TYPE_EXTERNAL ? "into another file" : "of a kind that is not known");
  return 1;
}

herr_t look_at_object(hid_t file, const char* name, const H5O_info_t* object, void* data) {
  if (object->type != H5O_TYPE_DATASET) return 0;
  auto& finding = *static_cast<Finding*>(data);
  const Handle dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  const Handle plan(dataset < 0 ? -1 : H5Dget_create_plist(dataset), H5Pclose);
  if (plan < 0) return -1;
  if (H5Pget_external_count(plan) != 0)
    finding.what = fmt::format("keeps the values of '{}' in other files (external storage)", name);
  else if (H5Pget_layout(plan) == H5D_VIRTUAL)
    finding.what = fmt::format("takes the values of '{}' from other files (a virtual dataset)", name);
  return finding.what.empty() ? 0 : 1;
}

std::string references_of(const fs::path& path) {
  const Silence silence;
  // Compression that HDF5 does not have itself would be loaded from wherever an environment variable points
  // to.
  H5PLset_loading_state(0);
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file < 0) return "cannot be read as netCDF-4 or BAG (HDF5): it is cut off or damaged";
  Finding finding;
  if (H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_link, &finding) < 0 ||
      (finding.what.empty() &&
       H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_object, &finding, H5O_INFO_BASIC) < 0))
    return "is damaged: its list of contents cannot be read";
  if (!finding.what.empty())
    finding.what += ": copy it into one file (h5repack, ncks, or nccopy) where those files are";
  return finding.what;
}

}  // namespace

void refuse_hdf5_references(const fs::path& file) {
  const auto state = state_of(file);
  if (!state) return;  // opening it says why
  static std::mutex mutex;
  static std::set<FileState> passed;
  const std::lock_guard lock(mutex);
  if (passed.contains(*state)) return;
  if (const std::string what = references_of(file); !what.empty())
    throw InputError({file.string(), 0, 0}, what);
  passed.insert(*state);
}

}  // namespace tubefoot
