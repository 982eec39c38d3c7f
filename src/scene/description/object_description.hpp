// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "files/input_error.hpp"
#include "scene/description/material_map_description.hpp"
#include "scene/description/scene_component.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

struct MeshFile {
  std::filesystem::path file;
  std::optional<std::string> up;         ///< up axis of the file: x | y | z; by default as the file states
  std::optional<double> unit_m;          ///< metres per unit of the file; by default as the file states
  std::vector<MaterialClass> materials;  ///< by the names of faces in the mesh
};
struct SpherePrimitive {
  double radius_m = 1;
};
struct CylinderPrimitive {
  double radius_m = 1, height_m = 1;
};  ///< axis along z, closed
struct ConePrimitive {
  double radius_m = 1, top_radius_m = 0, height_m = 1;
};  ///< axis along z, closed
struct BoxPrimitive {
  std::array<double, 3> size_m{1, 1, 1};
};

struct ObjectDescription {
  SourcePlace place;
  std::string name;
  std::string material;
  SourcePlace material_place;
  std::variant<MeshFile, SpherePrimitive, CylinderPrimitive, ConePrimitive, BoxPrimitive> kind;
  std::shared_ptr<const ComponentMesh> facets;  ///< given in memory instead of `kind`; otherwise null
  std::array<double, 3> position_m{0, 0, 0};    ///< of the primitive's centre or of the file's origin
  std::optional<std::array<double, 2>> position_lat_lon_deg;  ///< instead of x and y of position_m
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
  std::array<double, 3> scale{1, 1, 1};
  /// Largest distance between a curved primitive and its facets. The default is as fine as the sensors
  /// resolve (facet_fineness.hpp).
  std::optional<double> chord_error_m;
  /// Name of the trajectory on which the object moves; empty for an object at rest. Position and angles are
  /// then relative to the trajectory's carrier.
  std::string trajectory;
  SourcePlace trajectory_place;
  /// Height of the object's lowest point above the terrain below its position. The z of the position is
  /// then ignored.
  std::optional<double> on_terrain_m;
};

}  // namespace tubefoot
