// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "engine/ground/ground.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// What a refined bed is made from, as 64 hexadecimal digits: the scene's facets on the grid, [relief], and
/// the relief's heights at some thousands of places spread over the facets.
std::string bed_hash(const Scene& scene, const Ground& ground);

/// Writes a refined bed as a binary PLY file for mesh tools: vertices in metres, faces with material,
/// component and the facet of the scene (`base_facet`) each is part of; the hash is a comment. Throws
/// std::runtime_error.
void write_refined_bed(const std::filesystem::path& file, const RefinedMesh& bed, const Scene& scene,
                       const Ground& ground);

/// Reads it back, the same to the last bit. Throws InputError at `place`: no such file, not written by
/// write_refined_bed(), cut short, or of another scene.
RefinedMesh read_refined_bed(const std::filesystem::path& file, const SourcePlace& place, const Scene& scene,
                             const Ground& ground);

}  // namespace tubefoot
