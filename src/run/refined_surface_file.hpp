// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "engine/surface/surface_mesh.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// What a refined seabed is made from, as 64 hexadecimal digits: the scene's facets on the grid, [relief],
/// and the relief's heights at some thousands of places spread over the facets. The same however terrain is
/// read; by tiles, all of it is read once more, a row of tiles at a time.
std::string seabed_hash(const Scene& scene, double cell_m);

/// Writes a refined seabed as a binary PLY file for mesh tools: vertices in metres, faces with material,
/// component and the facet of the scene (`base_facet`) each is part of; the hash is a comment. Throws
/// std::runtime_error.
void write_refined_seabed(const std::filesystem::path& file, const RefinedMesh& seabed, const Scene& scene,
                          const SurfaceMesh& surface_mesh);

/// A file of write_refined_seabed(), to be read back, the same to the last bit. Thread-safe.
class RefinedSurfaceFile {
 public:
  /// Throws InputError at `place`: no such file, not written by write_refined_seabed(), cut short, or of
  /// another scene.
  RefinedSurfaceFile(std::filesystem::path file, const SourcePlace& place, const Scene& scene, double cell_m);

  /// The parts of some facets of the scene, by their numbers in all of it, increasing; those are the parents
  /// of the parts, too. Throws InputError for a damaged file.
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
