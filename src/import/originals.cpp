// SPDX-License-Identifier: GPL-3.0-or-later
// Copies imported files into a folder of originals, each under the hash of its bytes. Reads such a folder
// back and checks the hashes.
#include "import/originals.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "files/checked_file.hpp"
#include "files/companions.hpp"
#include "files/csv_file.hpp"
#include "files/file_hash.hpp"
#include "files/input_error.hpp"
#include "files/input_registry.hpp"
#include "files/shown.hpp"
#include "files/staging.hpp"
#include "files/streamed_file.hpp"
#include "geometry/steps/stop.hpp"
#include "import/bags/bag_metadata.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t hash_digits = 64;
constexpr std::string_view of_azimuths = "# --azimuths:";

fs::path beside(fs::path echo_file) { return echo_file.replace_extension(".originals"); }

/// Returns a name with the original extension, which identifies the format; .db3.zstd keeps both
/// extensions.
std::string kept_name(const std::string& sha256, const fs::path& file) {
  const std::string ending = file.extension().string();
  return sha256 + (ending == ".zstd" ? file.stem().extension().string() : "") + ending;
}

bool begins_with_hash(std::string_view line) {
  return line.size() > hash_digits + 2 && line.substr(hash_digits, 2) == "  " &&
         line.substr(0, hash_digits).find_first_not_of("0123456789abcdef") == line.npos;
}

/// Throws InputError unless the file has this hash.
void require_hash(const fs::path& file, const SourcePlace& listed, const std::string& sha256) {
  InputFile input(file, listed);
  Sha256 hash;
  input.for_each_piece([&](std::string_view piece) {
    stop_if_wanted();
    hash.update(piece);
  });
  if (hash.hex_digest() != sha256)
    throw InputError({file.string()}, "has changed: its bytes do not match the hash in its name");
}

}  // namespace

OriginalsFolder::OriginalsFolder(const fs::path& echo_file, const Inputs& inputs)
    : path_(beside(echo_file)), folder_(path_, inputs) {}

std::vector<Original> OriginalsFolder::keep(const std::vector<fs::path>& pictures,
                                            const std::optional<fs::path>& azimuths) {
  std::vector<Original> kept;
  std::string list;
  const auto keep_one = [&](const fs::path& file, const std::string& name) {
    stop_if_wanted();
    Sha256 hash;
    const fs::path under_way = folder_.staging() / "under way";
    InputFile input(file);
    StreamedFile copy(under_way);
    input.for_each_piece([&](std::string_view piece) {
      hash.update(piece);
      copy.append(piece);
    });
    copy.close();
    kept.push_back({name, hash.hex_digest()});
    rename_file(under_way, folder_.staging() / kept_name(kept.back().sha256, file));
    list += fmt::format("{}  {}\n", kept.back().sha256, name);
  };
  for (const fs::path& file : pictures) {
    if (!fs::is_directory(file)) {
      keep_one(file, file.filename().string());
      continue;
    }
    std::vector<fs::path> parts = read_bag_metadata(file).files;  // other files of the folder are ignored
    parts.insert(parts.begin(), file / "metadata.yaml");
    const fs::path folder = file.has_filename() ? file.filename() : file.parent_path().filename();
    for (const fs::path& part : parts) keep_one(part, (folder / part.filename()).string());
  }
  if (azimuths) {
    list += fmt::format("{}\n", of_azimuths);
    keep_one(*azimuths, azimuths->filename().string());
  }
  write_file(folder_.staging() / "list.txt", list);
  return kept;
}

std::optional<std::vector<fs::path>> listed_originals(const fs::path& folder) {
  const fs::path list = folder / "list.txt";
  std::error_code error;
  if (!fs::is_regular_file(list, error) || place_outside(folder, list)) return std::nullopt;
  InputFile input(list);
  std::vector<fs::path> pictures;
  std::string line;
  bool pictures_follow = true;
  for (SourcePlace place{list.string(), 1, 0}; next_line(input.stream(), line, place); ++place.line) {
    if (place.line == 1 && !begins_with_hash(line)) return std::nullopt;  // a list of another kind
    if (line == of_azimuths) {
      pictures_follow = false;
      continue;
    }
    if (!begins_with_hash(line)) throw InputError(place, "expected a SHA-256, two spaces and a name");
    if (!pictures_follow) continue;
    const std::string sha256 = line.substr(0, hash_digits);
    const fs::path name = line.substr(hash_digits + 2);
    if (name.has_parent_path())
      throw InputError(place, fmt::format("'{}' belongs to a recording that is a folder: copy its files into "
                                          "one folder under their names, and import that folder",
                                          shown_line(name.string())));
    const fs::path file = folder / kept_name(sha256, name);
    if (const auto outside = place_outside(folder, file))
      throw InputError(place,
                       fmt::format("is a link to '{}', outside of the folder: copy the file into the folder",
                                   outside->string()));
    require_hash(file, place, sha256);
    pictures.push_back(file);
  }
  return pictures;
}

}  // namespace tubefoot
