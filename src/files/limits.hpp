// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

// Upper limits for input. docs/limits.md lists them with their reasons, and a test keeps both lists equal.
// Input within these limits may still exceed the memory of a machine: memory_at_hand().
namespace tubefoot::limits {

inline constexpr std::size_t scene_file_bytes = std::size_t{8} << 20;
/// Length of a text in a scene file, of its title, and of a name, which may name files.
inline constexpr std::size_t text_bytes = std::size_t{1} << 16, title_bytes = 1000, name_bytes = 200;
/// Size of any file that a scene names. tubefoot hashes all its bytes first.
inline constexpr std::uintmax_t named_file_bytes = std::uintmax_t{64} << 30;
/// Length of a line of a text table.
inline constexpr std::size_t line_bytes = std::size_t{1} << 20;
/// Rows of a table of poses or sound speeds.
inline constexpr std::size_t table_rows = 10'000'000;
/// Cells of a terrain, or cells that are read of a raster.
inline constexpr double cells = 50e6;
/// Cells of a raster that is read by tiles. Each cell has two facets, whose numbers have 32 bits.
inline constexpr double tiled_cells = 2e9;
/// Facets of one primitive.
inline constexpr double primitive_facets = 20e6;
/// Number of vertices, corners and values of morph targets in addition to the bytes of a model. A model can
/// read or place its own parts repeatedly (instances of a mesh, primitives that share vertices).
inline constexpr std::uint64_t model_repeated = 5'000'000;
/// Nodes of a glTF model. Assimp takes about 20 us of processor time per node.
inline constexpr std::size_t gltf_nodes = 150'000;
/// Depth of the nodes of a model.
inline constexpr std::size_t model_depth = 1000;
/// Attribute names of a vector map, and pairs of consecutive names in a feature.
inline constexpr std::size_t map_attributes = 1000, map_attribute_pairs = 8000;
/// Size of a stored block of a raster. To read a row, whole blocks must be read.
inline constexpr std::int64_t block_bytes = std::int64_t{1} << 29;
/// Beams times range samples of one ping.
inline constexpr std::int64_t ping_cells = std::int64_t{1} << 26;
/// Pings of a sensor times transmissions per ping.
inline constexpr std::int64_t sensor_transmissions = 100'000'000;

}  // namespace tubefoot::limits
