// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "scene/description/scene_description.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {

/// A folder of its own for a test's scene file, removed at the end.
class SceneFolder {
 public:
  SceneFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tubefoot-scene-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~SceneFolder() { std::filesystem::remove_all(path_); }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::filesystem::path write(const std::string& name, std::string_view text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

  SceneDescription read(std::string_view scene) const { return read_scene_file(write("scene.toml", scene)); }

  /// The message of the InputError that the scene gives, without this folder's name; empty if it gives none.
  std::string error_of(std::string_view scene) const {
    try {
      read(scene);
    } catch (const InputError& error) {
      std::string message = error.what();
      const std::string prefix = path_.string() + "/";
      for (std::size_t at; (at = message.find(prefix)) != std::string::npos;)
        message.erase(at, prefix.size());
      return message;
    }
    return {};
  }

 private:
  std::filesystem::path path_;
};

/// The least that is a scene; lines are counted on in tests.
constexpr std::string_view smallest_scene = R"([[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 20
length_m = 30
[trajectory]
kind = "fixed"
[[sensors]]
name = "camera"
kind = "didson"
)";

/// The scene with its only occurrence of `from` replaced.
inline std::string replaced(std::string_view scene, std::string_view from, std::string_view to) {
  std::string text(scene);
  const std::size_t at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos) {
    throw std::logic_error("the scene must contain once: " + std::string(from));
  }
  return text.replace(at, from.size(), to);
}

}  // namespace tubefoot
