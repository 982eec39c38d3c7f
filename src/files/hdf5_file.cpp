// SPDX-License-Identifier: GPL-3.0-or-later

// Visits all links, datasets and attributes of an HDF5 file and rejects references to other files. It
// limits the number of links and attributes, the depth of groups and the size of texts.

#include "files/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <set>
#include <string>

#include "files/grid_words.hpp"
#include "files/hdf5_handle.hpp"
#include "files/input_registry.hpp"
#include "files/library_settings.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

using Handle = Hdf5Handle;

constexpr std::size_t most_links = 10'000;
constexpr int deepest = 32;
/// Largest size of texts and attribute values, which describe data but do not hold them.
constexpr double most_text_bytes = 64 << 20;

struct Finding {
  std::string what;  ///< the problem; empty if there is none
  std::size_t links = 0, attributes = 0;
  double file_bytes = 0;
};

herr_t look_at_link(hid_t, const char* name, const H5L_info_t* link, void* data) {
  auto& finding = *static_cast<Finding*>(data);
  if (++finding.links > most_links)
    finding.what = fmt::format("has more than {} groups and variables", most_links);
  else if (std::count(name, name + std::strlen(name), '/') >= deepest)
    finding.what = fmt::format("nests groups more than {} levels deep", deepest);
  else if (link->type == H5L_TYPE_EXTERNAL)
    finding.what = fmt::format("has '{}', a link into another file", name);
  else if (link->type != H5L_TYPE_HARD && link->type != H5L_TYPE_SOFT)
    finding.what = fmt::format("has '{}', a link of an unknown kind", name);
  return finding.what.empty() ? 0 : 1;
}

double count_of(hid_t space) {
  const hssize_t count = space < 0 ? 0 : H5Sget_simple_extent_npoints(space);
  return count < 0 ? 0 : static_cast<double>(count);
}

/// Checks an attribute. A reader of an attribute reads all of it, and many texts may share one stored text.
herr_t look_at_attribute(hid_t object, const char* name, const H5A_info_t*, void* data) {
  auto& finding = *static_cast<Finding*>(data);
  if (++finding.attributes > most_links) {
    finding.what = fmt::format("has more than {} attributes", most_links);
    return 1;
  }
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (attribute < 0) return -1;
  const Handle space(H5Aget_space(attribute), H5Sclose), type(H5Aget_type(attribute), H5Tclose);
  const double count = count_of(space);
  const bool varies = type >= 0 && H5Tis_variable_str(type) > 0;
  const double bytes = count * (varies ? finding.file_bytes : static_cast<double>(H5Tget_size(type)));
  if ((varies && count > 16 && bytes > most_text_bytes) || (!varies && bytes > most_text_bytes))
    finding.what =
        fmt::format("has an attribute '{}' with {:.0f} values, more than a description needs", name, count);
  return finding.what.empty() ? 0 : 1;
}

herr_t look_at_object(hid_t file, const char* name, const H5O_info_t* object, void* data) {
  auto& finding = *static_cast<Finding*>(data);
  if (object->type == H5O_TYPE_GROUP && object->rc > 1) {
    finding.what = fmt::format("holds the group '{}' under several names", name);
    return 1;
  }
  const Handle opened(H5Oopen(file, name, H5P_DEFAULT), H5Oclose);
  if (opened < 0) return -1;
  hsize_t first = 0;
  if (H5Aiterate2(opened, H5_INDEX_NAME, H5_ITER_NATIVE, &first, look_at_attribute, data) < 0) return -1;
  if (!finding.what.empty()) return 1;
  if (object->type != H5O_TYPE_DATASET) return 0;
  const Handle plan(H5Dget_create_plist(opened), H5Pclose);
  if (plan < 0) return -1;
  if (H5Pget_external_count(plan) != 0) {
    finding.what = fmt::format("keeps the values of '{}' in other files (external storage)", name);
  } else if (H5Pget_layout(plan) == H5D_VIRTUAL) {
    finding.what = fmt::format("takes the values of '{}' from other files (a virtual dataset)", name);
  } else {
    const Handle space(H5Dget_space(opened), H5Sclose), type(H5Dget_type(opened), H5Tclose);
    if (type >= 0 && H5Tget_class(type) == H5T_STRING &&
        count_of(space) * static_cast<double>(H5Tget_size(type)) > most_text_bytes)
      finding.what = fmt::format("has '{}', a text larger than {:.0f} MB", name, most_text_bytes / 1048576);
    else if (type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) {
      // Fixed-length texts may be compressed, so that the bytes of the file do not show the keyword.
      std::string text(static_cast<std::size_t>(count_of(space)) * H5Tget_size(type), '\0');
      GridWords words;
      if (!text.empty() && H5Dread(opened, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0)
        words.feed(text);
      if (!words.met().empty())
        finding.what = fmt::format("refers to correction files in '{}' ('{}')", name, words.met());
    }
  }
  return finding.what.empty() ? 0 : 1;
}

std::string references_of(const fs::path& path) {
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file < 0) return "cannot be read as netCDF-4 or BAG (HDF5): it is cut off or damaged";
  Finding finding;
  std::error_code ignored;
  finding.file_bytes = static_cast<double>(fs::file_size(path, ignored));
  if (H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_link, &finding) < 0 ||
      (finding.what.empty() &&
       H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_object, &finding, H5O_INFO_BASIC) < 0))
    return "is damaged: its list of contents cannot be read";
  if (!finding.what.empty()) finding.what += ": write the heights or energies into one plain file";
  return finding.what;
}

}  // namespace

void refuse_hdf5_references(const fs::path& file) {
  const auto state = state_of(file);
  if (!state) return;  // the attempt to open the file reports the reason
  static std::mutex mutex;
  static std::set<FileState> passed;
  const std::lock_guard lock(mutex);
  if (passed.contains(*state)) return;
  if (const std::string what = references_of(file); !what.empty())
    throw InputError({file.string(), 0, 0}, what);
  passed.insert(*state);
}

}  // namespace tubefoot
