// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exchange/exchanged_scene.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// A mesh that the world names, read, as it goes into a scene's folder.
struct ImportedMesh {
  std::filesystem::path file;  ///< "hull.obj"
  ComponentMesh mesh;
};

struct ImportedObject {
  std::string name, material;
  std::string shape;  ///< of a scene file: mesh, sphere, cylinder, cone or box
  /// What goes with the shape: key, and value as TOML.
  std::vector<std::pair<std::string, std::string>> keys;
  std::optional<std::size_t> mesh;  ///< of `shape` mesh
  std::array<double, 3> scale{1, 1, 1};
  Placement placed;  ///< in our axes, of the object's own ones, whatever they are
};

struct ImportedSensor {
  std::string name;
  /// `kind` and the others of a scene file: key, and value as TOML.
  std::vector<std::pair<std::string, std::string>> keys;
  Placement own;  ///< in our axes
};

/// What of another engine's world is a scene.
struct ImportedScene {
  std::filesystem::path world;
  std::string title;
  std::optional<double> sound_speed_m_s, absorption_db_per_km;
  std::vector<ExchangedMaterial> materials;
  std::vector<ImportedMesh> meshes;
  std::vector<ImportedObject> objects;
  std::vector<ImportedSensor> sensors;
  std::vector<std::filesystem::path> inputs;  ///< that were read
  std::vector<std::string> noticed;           ///< what was left out or assumed, a line each
};

/// Reads an SDF world (.sdf, .world: its root says) or a Stonefish scenario. `model_path`: folders of
/// model:// and package://, which files may come from besides the world's own. Throws InputError with line
/// and column for what is no such world, and for one without any geometry.
ImportedScene read_world(const std::filesystem::path& world,
                         const std::vector<std::filesystem::path>& model_path);

/// Writes scene.toml and its meshes into a folder that is there. Throws InputError for what makes no scene,
/// std::runtime_error where the disk refuses.
void write_imported_scene(const ImportedScene& scene, const std::filesystem::path& folder);
/// That scene.toml.
std::string scene_text(const ImportedScene& scene);

}  // namespace tubefoot
