// SPDX-License-Identifier: GPL-3.0-or-later
// Reads files of other engines. The first bytes determine the format: NPY, NPZ, PNG, TIFF, OpenEXR, netCDF,
// a ROS 2 recording, or a matrix as text. Files of a folder are ordered by name, with numbers in names by
// size.
#include "import/foreign_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "files/companions.hpp"
#include "files/file_format.hpp"
#include "files/input_registry.hpp"
#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "files/usage_error.hpp"
#include "import/bags/bag.hpp"
#include "import/frames/csv_frames.hpp"
#include "import/frames/netcdf_frames.hpp"
#include "import/frames/npy_file.hpp"
#include "import/frames/picture_frames.hpp"
#include "import/originals.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

/// Compares names with numbers by size: "frame-9" comes before "frame-10". All other characters compare by
/// byte.
bool comes_before(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (digit(a[i]) && digit(b[k])) {
      const auto end_of = [&](const std::string& text, std::size_t at) {
        while (at < text.size() && digit(text[at])) ++at;
        return at;
      };
      const auto number = [](const std::string& text, std::size_t at, std::size_t end) {
        while (at + 1 < end && text[at] == '0') ++at;
        return text.substr(at, end - at);
      };
      const std::size_t end_a = end_of(a, i), end_b = end_of(b, k);
      const std::string of_a = number(a, i, end_a), of_b = number(b, k, end_b);
      if (of_a.size() != of_b.size()) return of_a.size() < of_b.size();
      if (of_a != of_b) return of_a < of_b;
      i = end_a, k = end_b;
    } else {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i, ++k;
    }
  }
  return a.size() - i < b.size() - k;
}

/// A file and the name that determines its position.
struct Placed {
  fs::path file;
  std::string by;
};

/// Options that apply to a kind of file.
struct Kind {
  const char* name;
  bool variable, axes, topic;
};

void refuse_idle(const ReadOptions& options, const Kind& kind, const fs::path& file) {
  const WantedArrays& arrays = options.arrays;
  const std::pair<const char*, bool> idle[] = {
      {"--variable", !kind.variable && !arrays.variable.empty()},
      {"--range-variable", !kind.axes && !arrays.range_variable.empty()},
      {"--azimuth-variable", !kind.axes && !arrays.azimuth_variable.empty()},
      {"--topic", !kind.topic && !options.topic.empty()}};
  for (const auto& [option, given] : idle)
    if (given)
      throw UsageError(fmt::format("{} does not apply to '{}', which is {}: omit the option", option,
                                   file.string(), kind.name));
}

}  // namespace

std::vector<fs::path> files_in_order(const std::vector<fs::path>& results) {
  std::vector<Placed> placed;
  for (const fs::path& result : results) {
    std::error_code error;
    if (!fs::is_directory(result, error) || is_bag(result)) {
      placed.push_back({result, result.string()});
      continue;
    }
    const std::size_t before = placed.size();
    if (const auto originals = listed_originals(result)) {
      for (const fs::path& file : *originals) placed.push_back({file, result.string()});
    } else {
      for (const auto& entry : fs::directory_iterator(result, error)) {
        if (!entry.is_regular_file(error) || entry.path().filename().string().starts_with('.')) continue;
        if (const auto outside = place_outside(result, entry.path()))
          throw InputError({entry.path().string()},
                           fmt::format("is a link to '{}', outside of its folder: copy the file into the "
                                       "folder, or name the file directly",
                                       outside->string()));
        placed.push_back({entry.path(), entry.path().string()});
      }
    }
    if (placed.size() == before) throw InputError({result.string()}, "is a folder without files");
  }
  std::ranges::stable_sort(placed, comes_before, &Placed::by);
  std::vector<fs::path> files;
  for (Placed& one : placed) files.push_back(std::move(one.file));
  return files;
}

ForeignData read_foreign_file(const fs::path& file, const ReadOptions& options) {
  if (is_bag(file)) {
    refuse_idle(options, {"a recording or message of ROS 2", false, false, true}, file);
    return read_bag(file, options.topic.empty() ? std::nullopt : std::optional(options.topic));
  }
  const SourcePlace place{file.string()};
  InputFile input(file, place, "a file of pictures");
  const std::string head = input.head(8);
  const bool npy = head.starts_with("\x93NUMPY"),
             npz = head.starts_with("PK\3\4"sv) || head.starts_with("PK\5\6"sv),
             picture = !picture_format(head).empty();
  if (npz || npy || picture) {
    refuse_idle(options,
                npz   ? Kind{"an NPZ file", true, true, false}
                : npy ? Kind{"an NPY file", false, false, false}
                      : Kind{"a picture", true, false, false},
                file);
    require_memory(static_cast<double>(input.size()), place, "its bytes", "write fewer pictures per file");
    const std::string bytes = read_whole(file, place, limits::named_file_bytes, "a file of pictures");
    if (npz) return frames_of(read_npz(bytes, place), options.arrays, place);
    if (npy) return frames_of(read_npy(bytes, place), nullptr, nullptr, options.arrays.points, place);
    return read_picture(file, bytes, options.arrays.variable);
  }
  const FileFormat format = format_of(file);
  if (format == FileFormat::netcdf4 || format == FileFormat::netcdf_classic) {
    refuse_idle(options, {"a netCDF file", true, true, false}, file);
    return read_netcdf_frames(file, options.arrays);
  }
  refuse_idle(options, {"a table in text", false, false, false}, file);
  return read_matrix(file);
}

}  // namespace tubefoot
