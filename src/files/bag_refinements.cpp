// SPDX-License-Identifier: GPL-3.0-or-later

// Reads the tables varres_metadata and varres_refinements of a BAG of variable resolution with HDF5 and
// checks them against each other. It also finds the finest resolution at which each cell has a node.
// (Format Specification Document of BAG 2.0, "Variable Resolution")

#include "files/bag_refinements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <set>
#include <span>

#include "files/advised_command.hpp"
#include "files/hdf5_handle.hpp"
#include "files/input_error.hpp"
#include "files/library_settings.hpp"
#include "files/limits.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

constexpr float no_height = 1e6f;
// GDAL takes the highest of the nodes in a cell unless VALUE_POPULATION=MEAN is set.
constexpr const char* resampled = "gdal_translate -oo MODE=RESAMPLED_GRID -oo VALUE_POPULATION=MEAN";
const std::string coarser = std::string(resampled) + " -oo RESX=METRES -oo RESY=METRES";
constexpr const char* metadata = "/BAG_root/varres_metadata";
constexpr const char* refinements = "/BAG_root/varres_refinements";

/// The members of a row of varres_metadata that tubefoot reads.
struct Entry {
  std::uint32_t index, columns, rows;
  float step_x, step_y, first_x, first_y;
};

/// A two-dimensional table of records in the file.
class Table {
 public:
  Table(hid_t file, const char* name, const SourcePlace& place)
      : place_(place), name_(name), set_(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose) {
    if (set_ < 0) fail("is missing");
    const Hdf5Handle space(H5Dget_space(set_), H5Sclose), type(H5Dget_type(set_), H5Tclose),
        plan(H5Dget_create_plist(set_), H5Pclose);
    if (H5Sget_simple_extent_ndims(space) != 2 || H5Tget_class(type) != H5T_COMPOUND)
      fail("is not a two-dimensional table");
    H5Sget_simple_extent_dims(space, extent_.data(), nullptr);
    if (static_cast<double>(extent_[0]) * static_cast<double>(extent_[1]) > limits::cells)
      fail(fmt::format(
          "has {} x {} entries, more than {:.3g}: convert the file to a single, coarser resolution with {}",
          extent_[0], extent_[1], limits::cells, advised_command(coarser, place_.file)));
    // HDF5 holds at least one whole chunk in memory, even if the chunk has few bytes in the file.
    std::array<hsize_t, 2> chunk{1, 1};
    if (H5Pget_layout(plan) == H5D_CHUNKED && H5Pget_chunk(plan, 2, chunk.data()) == 2 &&
        static_cast<double>(chunk[0]) * static_cast<double>(chunk[1]) *
                static_cast<double>(H5Tget_size(type)) >
            static_cast<double>(limits::block_bytes))
      fail(fmt::format("is stored in chunks of more than {} MB", limits::block_bytes >> 20));
  }
  std::size_t rows() const { return static_cast<std::size_t>(extent_[0]); }
  std::size_t columns() const { return static_cast<std::size_t>(extent_[1]); }
  /// Reads the members of the records that `type` names.
  template <class T>
  std::vector<T> read(const Hdf5Handle& type) const {
    const Hdf5Handle stored(H5Dget_type(set_), H5Tclose);
    for (unsigned i = 0; i < static_cast<unsigned>(H5Tget_nmembers(type)); ++i) {
      char* const name = H5Tget_member_name(type, i);
      const std::string member = name;
      H5free_memory(name);
      // HDF5 would leave the member's value unset.
      if (H5Tget_member_index(stored, member.c_str()) < 0)
        fail(fmt::format("has records without '{}'", member));
    }
    std::vector<T> values(rows() * columns());
    stop_if_wanted();
    if (!values.empty() && H5Dread(set_, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      fail("cannot be read: the file is cut off, or its records have other members");
    return values;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(place_, fmt::format("its table '{}' {}", name_, what));
  }

 private:
  SourcePlace place_;
  const char* name_;
  Hdf5Handle set_;
  std::array<hsize_t, 2> extent_{};
};

std::vector<Entry> read_entries(const Table& table) {
  const Hdf5Handle type(H5Tcreate(H5T_COMPOUND, sizeof(Entry)), H5Tclose);
  const auto take = [&](const char* name, std::size_t offset, hid_t kind) {
    H5Tinsert(type, name, offset, kind);
  };
  take("index", offsetof(Entry, index), H5T_NATIVE_UINT32);
  take("dimensions_x", offsetof(Entry, columns), H5T_NATIVE_UINT32);
  take("dimensions_y", offsetof(Entry, rows), H5T_NATIVE_UINT32);
  take("resolution_x", offsetof(Entry, step_x), H5T_NATIVE_FLOAT);
  take("resolution_y", offsetof(Entry, step_y), H5T_NATIVE_FLOAT);
  take("sw_corner_x", offsetof(Entry, first_x), H5T_NATIVE_FLOAT);
  take("sw_corner_y", offsetof(Entry, first_y), H5T_NATIVE_FLOAT);
  return table.read<Entry>(type);
}

std::vector<float> read_heights(const Table& table) {
  const Hdf5Handle type(H5Tcreate(H5T_COMPOUND, sizeof(float)), H5Tclose);
  H5Tinsert(type, "depth", 0, H5T_NATIVE_FLOAT);
  std::vector<float> heights = table.read<float>(type);
  for (float& height : heights)
    if (height == no_height || !std::isfinite(height)) height = std::numeric_limits<float>::quiet_NaN();
  return heights;
}

/// The nodes of a supergrid along one side of its cell.
struct NodeRow {
  double first, step;
  std::uint32_t count;
  auto operator<=>(const NodeRow&) const = default;
};

/// Returns whether each of `parts` equal parts of the side has a node that rounding does not move to
/// another part.
bool fills(const NodeRow& row, double side, std::uint32_t parts) {
  constexpr double margin = 1e-3;
  std::uint32_t filled = 0;  // number of filled parts, counted from the first
  for (std::uint32_t k = 0; k < row.count && filled < parts; ++k) {
    const double at = (row.first + k * row.step) / side * parts;
    if (at > filled + 1 - margin) return false;
    if (at >= filled + margin) ++filled;
  }
  return filled == parts;
}

/// Returns the largest number of parts of a side that all rows fill. It returns 0 if not even one part is
/// filled, or if a hostile file makes the search too long.
std::uint32_t most_parts(const std::set<NodeRow>& rows, double side) {
  if (rows.empty()) return 0;
  constexpr double most_nodes = 1e8;
  double nodes = 0;
  for (auto parts = std::ranges::min_element(rows, {}, &NodeRow::count)->count; parts > 0; --parts) {
    const bool all = std::ranges::all_of(rows, [&](const NodeRow& row) {
      return (nodes += row.count) <= most_nodes && fills(row, side, parts);
    });
    if (all) return parts;
    if (nodes > most_nodes) return 0;
  }
  return 0;
}

}  // namespace

std::string advised_resampling(const std::filesystem::path& file, double cell_x, double cell_y) {
  std::set<NodeRow> along_x, along_y;
  try {
    const Hdf5Silence silence;
    keep_libraries_to_themselves();
    const Hdf5Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (opened < 0) return advised_command(coarser, file);
    for (const Entry& e : read_entries(Table(opened, metadata, {file.string(), 0, 0}))) {
      if (e.columns == 0 || e.rows == 0) continue;
      for (const float number : {e.first_x, e.step_x, e.first_y, e.step_y})
        if (!std::isfinite(number)) return advised_command(coarser, file);
      along_x.insert({e.first_x, e.step_x, e.columns});
      along_y.insert({e.first_y, e.step_y, e.rows});
    }
  } catch (const InputError&) {
    return advised_command(coarser, file);
  }
  const std::uint32_t columns = most_parts(along_x, cell_x), rows = most_parts(along_y, cell_y);
  if (columns == 0 || rows == 0) return advised_command(coarser, file);
  return advised_command(
      fmt::format("{} -oo RESX={} -oo RESY={}", resampled, cell_x / columns, cell_y / rows), file);
}

bool has_bag_refinements(const std::filesystem::path& path) {
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  return file >= 0 && H5Lexists(file, "/BAG_root", H5P_DEFAULT) > 0 &&
         H5Lexists(file, metadata, H5P_DEFAULT) > 0;
}

BagRefinements read_bag_refinements(const std::filesystem::path& path) {
  const SourcePlace place{path.string(), 0, 0};
  const Hdf5Silence silence;
  keep_libraries_to_themselves();
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file < 0) throw InputError(place, "cannot be read as BAG (HDF5): it is cut off or damaged");
  const Table cells(file, metadata, place), nodes(file, refinements, place);
  BagRefinements read;
  read.columns = cells.columns();
  read.rows = cells.rows();
  read.heights = read_heights(nodes);
  double nodes_met = 0;
  for (const Entry& e : read_entries(cells)) {
    const std::size_t cell = read.supergrids.size();
    const auto fail = [&](const std::string& what) {
      cells.fail(fmt::format("{} at row {}, column {} (counted from 0, from the south-west)", what,
                             cell / read.columns, cell % read.columns));
    };
    if (e.columns == 0 || e.rows == 0) {
      read.supergrids.emplace_back();
      continue;
    }
    const double count = static_cast<double>(e.columns) * e.rows;
    if ((nodes_met += count) > limits::cells)
      fail(
          fmt::format("declares more than {:.3g} nodes: convert the file to a single, coarser resolution "
                      "with {}; the number exceeds the limit",
                      limits::cells, advised_command(coarser, path)));
    if (e.index + count > static_cast<double>(read.heights.size()))
      fail(fmt::format("declares {} x {} nodes from number {} of only {} nodes", e.columns, e.rows, e.index,
                       read.heights.size()));
    if (!(e.step_x > 0) || !(e.step_y > 0) || !(e.first_x >= 0) || !(e.first_y >= 0) ||
        !std::isfinite(e.step_x) || !std::isfinite(e.step_y) || !std::isfinite(e.first_x) ||
        !std::isfinite(e.first_y))
      fail(
          fmt::format("declares an invalid node spacing of {:g} x {:g} or an invalid first node ({:g}, {:g})",
                      e.step_x, e.step_y, e.first_x, e.first_y));
    read.supergrids.push_back({e.columns, e.rows, e.step_x, e.step_y, e.first_x, e.first_y, e.index});
  }
  return read;
}

}  // namespace tubefoot
