// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// The files that a world may name, and where its names lead.
class WorldFiles {
 public:
  /// `world`: file. Files may come only from its folder and from the folders of `model_path`.
  WorldFiles(const std::filesystem::path& world, std::vector<std::filesystem::path> model_path);

  struct Place {
    std::optional<std::filesystem::path> file;  ///< empty if there is none that may be read
    std::string why;                            ///< reason, if there is none
  };
  /// Returns the regular file that a path or URI names. `beside`: folder of the file that names it. The
  /// schemes model:// and package:// refer to the folders of the model path, and file:// to a path. A model
  /// of Gazebo Fuel is found by its name in the model path, or in a copy of Gazebo's cache there.
  Place file(const std::string& uri, const std::filesystem::path& beside) const;
  /// Returns the SDF file of the model that a path or URI names. In the folder of a model, model.config
  /// names the file; without it, the file is model.sdf.
  Place model(const std::string& uri, const std::filesystem::path& beside);

 private:
  std::vector<std::filesystem::path> candidates(const std::string& uri, const std::filesystem::path& beside,
                                                std::string& why) const;
  bool is_allowed(const std::filesystem::path& file) const;
  Place chosen(const std::vector<std::filesystem::path>& found, const std::string& why,
               std::string_view kind) const;

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> model_path_;
  std::map<std::filesystem::path, std::filesystem::path> model_files_;  ///< by the folder of the model
};

/// Returns a URI without the white space around it.
std::string trimmed(std::string_view uri);

}  // namespace tubefoot
