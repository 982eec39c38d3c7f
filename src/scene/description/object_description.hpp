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

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

struct MeshFile {
  std::filesystem::path file;
  std::optional<std::string> up;         ///< the file's axis that is up: x | y | z; else what the file says
  std::optional<double> unit_m;          ///< metres in one of the file's units; else what the file says
  std::vector<MaterialClass> materials;  ///< by the names that the mesh gives to its faces
};
struct SpherePrimitive {
  double radius_m = 1;
};
struct CylinderPrimitive {
  double radius_m = 1, height_m = 1;
};  ///< along z, closed
struct ConePrimitive {
  double radius_m = 1, top_radius_m = 0, height_m = 1;
};  ///< along z, closed
struct BoxPrimitive {
  std::array<double, 3> size_m{1, 1, 1};
};

struct ObjectDescription {
  SourcePlace place;
  std::string name;
  std::string material;
  SourcePlace material_place;
  std::variant<MeshFile, SpherePrimitive, CylinderPrimitive, ConePrimitive, BoxPrimitive> kind;
  std::shared_ptr<const ComponentMesh> facets;  ///< given in memory, in place of `kind`; else null
  std::array<double, 3> position_m{0, 0, 0};    ///< of the primitive's centre / the file's origin
  std::optional<std::array<double, 2>> position_lat_lon_deg;  ///< instead of x and y of position_m
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
  std::array<double, 3> scale{1, 1, 1};
  /// Largest distance between a curved primitive and its facets; else as fine as sensors see
  /// (facet_fineness.hpp).
  std::optional<double> chord_error_m;
  /// Put the object's lowest point this far above the terrain below its position (position z is then
  /// ignored).
  std::optional<double> on_terrain_m;
};

}  // namespace tubefoot
