// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "files/file_format.hpp"
#include "scene/meshes/mesh_file_polygons.hpp"

namespace tubefoot {

/// What a model says of its axes and units.
struct DeclaredAxes {
  std::optional<std::string> up;
  std::optional<double> unit_m;
};

/// A model of another program: all its meshes, put where their nodes are, in its own axes and units.
struct Model {
  UncheckedPolygons polygons;
  DeclaredAxes declared;
};

/// Reads COLLADA, glTF, 3DS or FBX through Assimp, in a process of its own (mesh_file_apart.hpp). Textures,
/// lights, cameras and animations are not read. Throws InputError.
Model read_model(const std::filesystem::path& file, FileFormat format);

/// What COLLADA says in its `asset`; a value that is not said, or is nonsense, is left out.
DeclaredAxes collada_axes(std::string_view content);

/// The bytes that a model is read from, by the names by which it asks for them.
using ModelBytes = std::map<std::string, std::string>;

/// Assimp's side: what a model holds, as bytes that model_from() reads. To be called where it may crash.
/// Throws std::exception.
std::string assimp_model(const ModelBytes& bytes, const std::string& name, FileFormat format);
/// Throws std::runtime_error for bytes that are none.
Model model_from(const std::string& bytes);

/// Of the Assimp at hand: "5.2.5".
std::string assimp_version();

}  // namespace tubefoot
