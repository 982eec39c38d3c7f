// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exchange/exchanged_scene.hpp"
#include "exchange/toml_text.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// A mesh of the world, as it is written to the folder of a scene.
struct ImportedMesh {
  std::filesystem::path file;  ///< for example "hull.obj"
  ComponentMesh mesh;
};

struct ImportedObject {
  std::string name, material;
  std::string shape;  ///< shape of a scene file: mesh, sphere, cylinder, cone or box
  /// Further keys of the shape, and their values as TOML.
  std::vector<std::pair<std::string, std::string>> keys;
  std::optional<std::size_t> mesh;  ///< index of the mesh, for shape mesh
  std::array<double, 3> scale{1, 1, 1};
  Placement placed;  ///< placement of the axes of the object, in the axes of tubefoot
};

struct ImportedSensor {
  std::string name;
  /// `kind` and other keys of a scene file, and their values as TOML.
  std::vector<std::pair<std::string, std::string>> keys;
  Placement own;  ///< in the axes of tubefoot
};

/// The parts of the world of another engine that form a scene.
struct ImportedScene {
  std::filesystem::path world;
  std::string title;
  std::optional<double> sound_speed_m_s, absorption_db_per_km;
  std::vector<ExchangedMaterial> materials;
  std::vector<ImportedMesh> meshes;
  std::vector<ImportedObject> objects;
  std::vector<ImportedSensor> sensors;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> noticed;           ///< omissions and assumptions, one line each
};

/// Reads an SDF world (.sdf, .world; the root element decides) or a Stonefish scenario. `model_path`:
/// folders of model:// and package://, from which files may come in addition to the folder of the world.
/// `unit_m`: unit of meshes that state none. Throws InputError with line and column for other files and for
/// a world without geometry.
ImportedScene read_world(const std::filesystem::path& world,
                         const std::vector<std::filesystem::path>& model_path,
                         std::optional<double> unit_m = {});

/// Writes scene.toml and its meshes into an existing folder. Places the example sonar of a scene without
/// sonars, and sonars that lie on a facet. Adds remarks on them, and on sonars inside objects, to the scene.
/// Throws InputError for an invalid scene, and std::runtime_error on a write error.
void write_imported_scene(ImportedScene& scene, const std::filesystem::path& folder);
/// Returns the contents of scene.toml.
std::string scene_text(const ImportedScene& scene);

}  // namespace tubefoot
