// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

// The most that input is given, whatever it asks for. docs/limits.md has them with their reasons, and a test
// keeps the two in step. What stays below may still not fit a machine: memory_at_hand().
namespace tubefoot::limits {

inline constexpr std::size_t scene_file_bytes = std::size_t{8} << 20;
/// Of a text that a scene file holds, of its title, and of a name in it, which may name files.
inline constexpr std::size_t text_bytes = std::size_t{1} << 16, title_bytes = 1000, name_bytes = 200;
/// Of any file that a scene names: its bytes are hashed before anything else.
inline constexpr std::uintmax_t named_file_bytes = std::uintmax_t{64} << 30;
/// Of a line of a text table.
inline constexpr std::size_t line_bytes = std::size_t{1} << 20;
/// Of a table of poses or sound speeds.
inline constexpr std::size_t table_rows = 10'000'000;
/// Of a terrain, or read of a raster.
inline constexpr double cells = 50e6;
/// Of a raster that is read by tiles: two facets each have numbers of 32 bits.
inline constexpr double tiled_cells = 2e9;
/// Of one primitive.
inline constexpr double primitive_facets = 20e6;
/// Vertices, corners and values of morph targets that a model reads or places by naming what it holds again
/// (instances of a mesh, primitives of the same vertices): so many more than the model has bytes.
inline constexpr std::uint64_t model_repeated = 5'000'000;
/// Of a glTF model: Assimp takes about 20 us of processor time for each.
inline constexpr std::size_t gltf_nodes = 150'000;
/// Of the nodes of a model, one in another.
inline constexpr std::size_t model_depth = 1000;
/// Names of attributes of a vector map, and pairs of names that follow each other in a feature.
inline constexpr std::size_t map_attributes = 1000, map_attribute_pairs = 8000;
/// Of a raster as it is stored: any row takes whole blocks.
inline constexpr std::int64_t block_bytes = std::int64_t{1} << 29;
/// Beams times range samples of one ping.
inline constexpr std::int64_t ping_cells = std::int64_t{1} << 26;
/// Pings of a sensor, times the transmissions of each.
inline constexpr std::int64_t sensor_transmissions = 100'000'000;

}  // namespace tubefoot::limits
