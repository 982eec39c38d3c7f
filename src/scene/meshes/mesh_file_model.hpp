// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "files/file_format.hpp"
#include "scene/meshes/mesh_file_polygons.hpp"

namespace tubefoot {

/// The axes and units that a model states.
struct DeclaredAxes {
  std::optional<std::string> up;
  std::optional<double> unit_m;
  std::optional<double> default_unit_m{};  ///< that of the format, if the model may omit its unit and does
};

/// A model of another program: all its meshes, placed by their nodes, in its own axes and units.
struct Model {
  UncheckedPolygons polygons;
  DeclaredAxes declared;
};

/// Reads COLLADA, glTF, 3DS or FBX with Assimp in a separate process (mesh_file_apart.hpp). Textures,
/// lights, cameras and animations are not read. Throws InputError.
Model read_model(const std::filesystem::path& file, FileFormat format);

/// Returns the axes and units in COLLADA's `asset`. Missing or invalid values are left out. Without a unit,
/// the default is 1 m (COLLADA 1.4.1 and 1.5, element `unit`).
DeclaredAxes collada_axes(std::string_view content);

/// The bytes of a model's files, by the names that the model uses.
using ModelBytes = std::map<std::string, std::string>;

/// Loads Assimp. Call it before a separate process, which may not open files, calls assimp_model().
void load_assimp();
/// Reads a model with Assimp and returns it as bytes for model_from(). Call it in a separate process,
/// because it may crash. Throws std::exception.
std::string assimp_model(const ModelBytes& bytes, const std::string& name, FileFormat format);
/// Returns the model from its bytes. Throws std::runtime_error for invalid bytes.
Model model_from(const std::string& bytes);

}  // namespace tubefoot
