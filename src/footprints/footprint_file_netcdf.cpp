// SPDX-License-Identifier: GPL-3.0-or-later
// Writes footprints as netCDF-4, after the CF conventions: polygons as geometries (section 7.5), and
// pieces, corners and occluders as contiguous ragged arrays (section 9.3.3).
#include <fmt/format.h>

#include "footprints/footprint_file.hpp"
#include "footprints/footprint_place.hpp"
#include "sensors/formats/netcdf_stream.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t chunk = 16384;

class Netcdf : public FootprintFile {
 public:
  Netcdf(const std::filesystem::path& file, const FootprintSource& source)
      : stream_(file), group_(stream_, stream_.id()) {
    group_.attribute("Conventions", "CF-1.8");
    group_.attribute("title", "Footprints of sensor '" + source.sensor + "'");
    group_.attribute("source", "tubefoot");
    const int footprint = group_.dimension("footprint", NC_UNLIMITED),
              piece = group_.dimension("piece", NC_UNLIMITED), node = group_.dimension("node", NC_UNLIMITED),
              occluder = group_.dimension("occluder_entry", NC_UNLIMITED);
    for (const FootprintColumn& column : footprint_columns()) {
      const nc_type type = std::holds_alternative<FootprintColumn::Reals>(column.values) ? NC_DOUBLE : NC_INT;
      columns_.push_back(
          group_.define({column.name, type, {footprint}, column.units, column.long_name}, chunk));
      group_.attribute(columns_.back(), "geometry", "polygons");
    }
    node_count_ = group_.define({"node_count", NC_INT, {footprint}, "1", "corners of a footprint"}, chunk);
    part_node_count_ =
        group_.define({"part_node_count", NC_INT, {piece}, "1", "corners of a convex piece"}, chunk);
    piece_count_ = group_.define({"piece_count", NC_INT, {footprint}, "1", "pieces of a footprint"}, chunk);
    occluder_count_ = group_.define(
        {"occluder_count", NC_INT, {footprint}, "1", "facets that hide parts of the facet in the tube"},
        chunk);
    group_.attribute(piece_count_, "sample_dimension", "piece");
    group_.attribute(occluder_count_, "sample_dimension", "occluder_entry");
    occluders_ = group_.define(
        {"occluder", NC_INT, {occluder}, "1", "facet that hides a part of the facet in the tube"}, chunk);
    const char* const axis[3] = {"X", "Y", "Z"};
    const char* const name[3] = {"node_east", "node_north", "node_up"};
    for (int k = 0; k < 3; ++k) {
      node_[k] = group_.define(
          {name[k], NC_DOUBLE, {node}, "m", std::string("corner, ") + (name[k] + 5) + " in the local frame"},
          chunk);
      group_.attribute(node_[k], "axis", axis[k]);
    }
    const int polygons = group_.define({"polygons", NC_INT, {}, nullptr, "convex pieces of the footprints"});
    group_.attribute(polygons, "geometry_type", "polygon");
    group_.attribute(polygons, "node_count", "node_count");
    group_.attribute(polygons, "part_node_count", "part_node_count");
    group_.attribute(polygons, "node_coordinates", "node_east node_north node_up");
    name_list("component", "components of the scene, by component_index", source.scene.report.components);
    name_list("material", "materials of the scene, by material_index", source.scene.description.materials);
    describe_frame(source.scene);
  }

  void add(const FootprintTable& table) override {
    if (table.rows() == 0) return;
    stream_.reserve(8 * (table.rows() * (columns_.size() + 3) + table.pieces() + table.occluders.size() +
                         3 * table.corners_m.size()) +
                    8 * chunk * (columns_.size() + 8));
    for (std::size_t c = 0; c < columns_.size(); ++c)
      std::visit([&](auto values) { put(columns_[c], rows_, table.*values); }, footprint_columns()[c].values);
    std::vector<std::uint32_t> nodes, pieces, part_nodes, occluders;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      nodes.push_back(static_cast<std::uint32_t>(table.first_corner[table.first_piece[row + 1]] -
                                                 table.first_corner[table.first_piece[row]]));
      pieces.push_back(table.pieces_of(row));
      occluders.push_back(static_cast<std::uint32_t>(table.occluders_of(row).size()));
    }
    for (std::size_t piece = 0; piece < table.pieces(); ++piece)
      part_nodes.push_back(static_cast<std::uint32_t>(table.corners_of(piece).size()));
    put(node_count_, rows_, nodes);
    put(piece_count_, rows_, pieces);
    put(occluder_count_, rows_, occluders);
    put(part_node_count_, all_pieces_, part_nodes);
    put(occluders_, all_occluders_, table.occluders);
    std::vector<double> values(table.corners_m.size());
    for (int k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < values.size(); ++c) values[c] = table.corners_m[c][k];
      put(node_[k], all_nodes_, values);
    }
    rows_ += table.rows();
    all_pieces_ += table.pieces();
    all_occluders_ += table.occluders.size();
    all_nodes_ += table.corners_m.size();
    stream_.flush();
  }

  void close() override { stream_.finish(); }

 private:
  void put(int variable, std::size_t start, const std::vector<std::uint32_t>& values) {
    const std::size_t count = values.size();
    stream_.check(nc_put_vara_uint(stream_.id(), variable, &start, &count, values.data()), "write columns");
  }
  void put(int variable, std::size_t start, const std::vector<double>& values) {
    const std::size_t count = values.size();
    stream_.check(nc_put_vara_double(stream_.id(), variable, &start, &count, values.data()), "write columns");
  }
  template <class Named>
  void name_list(const char* name, const char* long_name, const std::vector<Named>& list) {
    std::vector<std::string> texts;
    for (const Named& one : list) texts.push_back(one.name);
    group_.put_text(name, group_.dimension(name, texts.size()), long_name, texts);
  }
  /// States the frame of the corners. They stay in the local frame, because a distant origin would cost
  /// digits of a double.
  void describe_frame(const Scene& scene) const {
    group_.attribute("coordinates_are", "metres east, north and up of the origin of the scene");
    if (!scene.frame.is_georeferenced()) return;
    const LocalFrame::Map map = scene.frame.map();
    group_.attribute("map_crs_wkt", map.crs_wkt);
    group_.attribute(NC_GLOBAL, "map_easting_of_origin", NC_DOUBLE, {map.easting});
    group_.attribute(NC_GLOBAL, "map_northing_of_origin", NC_DOUBLE, {map.northing});
    group_.attribute(NC_GLOBAL, "map_metres_per_unit", NC_DOUBLE, {map.metres_per_unit});
    group_.attribute(NC_GLOBAL, "height_of_origin_m", NC_DOUBLE, {scene.frame.origin_height_m()});
  }

  NetcdfStream stream_;
  NetcdfGroup group_;
  std::vector<int> columns_;
  int node_count_ = 0, part_node_count_ = 0, piece_count_ = 0, occluder_count_ = 0, occluders_ = 0;
  int node_[3] = {};
  std::size_t rows_ = 0, all_pieces_ = 0, all_occluders_ = 0, all_nodes_ = 0;
};

}  // namespace

std::unique_ptr<FootprintFile> netcdf_footprint_file(const std::filesystem::path& file,
                                                     const FootprintSource& source) {
  return std::make_unique<Netcdf>(file, source);
}

}  // namespace tubefoot
