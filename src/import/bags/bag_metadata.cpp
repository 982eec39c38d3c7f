// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/bags/bag_metadata.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <set>

#include "files/companions.hpp"
#include "files/input_registry.hpp"
#include "files/shown.hpp"
#include "geometry/steps/stop.hpp"
#include "import/bags/bag_limits.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

BagMetadata read(const YAML::Node& document, const SourcePlace& file, const fs::path& folder) {
  const auto fail = [&file](const YAML::Node& node, const std::string& what) {
    const YAML::Mark mark = node.Mark();
    throw InputError(mark.is_null() ? file : SourcePlace{file.file, mark.line + 1, mark.column + 1}, what);
  };
  const YAML::Node bag =
      document.IsMap() ? document["rosbag2_bagfile_information"] : YAML::Node(YAML::NodeType::Undefined);
  if (!bag.IsDefined() || !bag.IsMap())
    fail(document, "has no rosbag2_bagfile_information: it does not belong to a rosbag2 recording");
  const auto text = [&bag](const char* key) {
    const YAML::Node node = bag[key];
    return node.IsDefined() && node.IsScalar() ? node.Scalar() : std::string();
  };
  if (const std::string how = text("compression_format"); !how.empty() && how != "zstd")
    fail(bag["compression_format"],
         fmt::format("compression_format: tubefoot does not read '{}', expected zstd", shown_line(how)));
  const YAML::Node names = bag["relative_file_paths"];
  if (!names.IsDefined() || !names.IsSequence() || names.size() == 0)
    fail(bag, "has no relative_file_paths: run ros2 bag reindex to write them again");
  if (names.size() > limits::bag_files)
    fail(names, fmt::format("names more than {} files", limits::bag_files));
  BagMetadata metadata;
  std::set<fs::path> named;
  for (const YAML::Node& name : names) {
    stop_if_wanted();
    // Recordings from before 2020 put the name of the folder first. Only the file name counts, since the
    // files lie in this folder.
    const fs::path base = name.IsScalar() ? fs::path(name.Scalar()).filename() : fs::path();
    if (base.empty() || base == "." || base == "..")
      fail(name, "relative_file_paths: expected the name of a file");
    if (!named.insert(base).second)
      fail(name, fmt::format("relative_file_paths: '{}' is named twice", base.string()));
    if (const auto outside = place_outside(folder, folder / base))
      fail(name, fmt::format("relative_file_paths: '{}' is a link to '{}', outside of the folder: copy the "
                             "file into the folder",
                             base.string(), outside->string()));
    metadata.files.push_back(folder / base);
  }
  const std::string count = text("message_count");
  std::uint64_t messages = 0;
  if (const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), messages);
      error == std::errc{} && end == count.data() + count.size())
    metadata.messages = messages;
  return metadata;
}

}  // namespace

BagMetadata read_bag_metadata(const fs::path& folder) {
  const fs::path file = folder / "metadata.yaml";
  const SourcePlace place{file.string(), 0, 0};
  if (const auto outside = place_outside(folder, file))
    throw InputError(place,
                     fmt::format("is a link to '{}', outside of its folder: copy the file into the folder",
                                 outside->string()));
  const std::string text =
      read_whole(file, place, limits::metadata_bytes, "the metadata of a rosbag2 recording");
  try {
    return read(YAML::Load(text), place, folder);
  } catch (const YAML::Exception& error) {
    throw InputError(
        error.mark.is_null() ? place : SourcePlace{place.file, error.mark.line + 1, error.mark.column + 1},
        fmt::format("is not YAML: {}", shown_line(error.msg)));
  }
}

}  // namespace tubefoot
