// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "engine/surface/surface_mesh.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// Returns a hash of the inputs of a refined seabed, as 64 hexadecimal digits. It covers the scene's facets
/// on the grid, [relief], and the relief's heights at some thousands of places spread over the facets. The
/// hash does not depend on how the terrain is read. Terrain that is read by tiles is read once more for the
/// hash, one row of tiles at a time.
std::string seabed_hash(const Scene& scene, double cell_m);

/// Writes a refined seabed as a binary PLY file for mesh tools. Vertices are in metres. Each face has its
/// material, its component, and the facet of the scene (`base_facet`) that contains it. The hash is a
/// comment of the file. Throws std::runtime_error.
void write_refined_seabed(const std::filesystem::path& file, const RefinedMesh& seabed, const Scene& scene,
                          const SurfaceMesh& surface_mesh);

/// A file of write_refined_seabed(), which this class reads back without any change of a bit. Thread-safe.
class RefinedSurfaceFile {
 public:
  /// Throws InputError at `place` if the file is missing, is truncated, belongs to another scene, or was not
  /// written by write_refined_seabed().
  RefinedSurfaceFile(std::filesystem::path file, const SourcePlace& place, const Scene& scene, double cell_m);

  /// Returns the parts of some facets of the scene. `base` contains the facets' numbers in the whole scene
  /// in increasing order, and the parents of the parts have the same numbers. Throws InputError for a
  /// damaged file.
  RefinedMesh read(std::span<const FacetId> base) const;

 private:
  class Reader;
  InputError refused(const std::string& why) const;

  std::filesystem::path file_, scene_file_;
  SourcePlace place_;
  WorldGrid grid_;
  std::size_t materials_, components_;
  std::uint64_t vertices_ = 0, facets_ = 0, first_byte_ = 0;
};

}  // namespace tubefoot
