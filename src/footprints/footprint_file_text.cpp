// SPDX-License-Identifier: GPL-3.0-or-later
// Writes footprints as CSV with shapes in well-known text (WKT), and as GeoJSON. GeoJSON has longitude and
// latitude (RFC 7946) if the scene is georeferenced.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "files/csv_file.hpp"
#include "files/streamed_file.hpp"
#include "footprints/footprint_file.hpp"
#include "footprints/footprint_place.hpp"
#include "footprints/plan_shape.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

std::string number(const FootprintTable& table, const FootprintColumn& column, std::size_t row) {
  return std::visit([&](auto values) { return fmt::format("{}", (table.*values)[row]); }, column.values);
}

/// Returns the items of a list as `one` writes them, separated by commas.
template <class List, class One>
std::string listed(const List& list, const One& one) {
  std::string text;
  for (const auto& item : list) {
    if (!text.empty()) text += ',';
    text += one(item);
  }
  return text;
}

/// Returns a shape as well-known text or in GeoJSON notation: nested lists in the brackets of that
/// notation.
std::string shape_text(const PlanShape& shape, const char* opened, const char* closed, const char* corner) {
  const auto in_brackets = [&](const std::string& inside) { return opened + inside + closed; };
  const auto line = [&](const PlanShape::Line& points) {
    return in_brackets(listed(
        points, [&](const glm::dvec3& p) { return fmt::format(fmt::runtime(corner), p.x, p.y, p.z); }));
  };
  return in_brackets(shape.is_upright() ? listed(shape.outlines, line)
                                        : listed(shape.polygons, [&](const auto& rings) {
                                            return in_brackets(listed(rings, line));
                                          }));
}

class Csv : public FootprintFile {
 public:
  Csv(const std::filesystem::path& file, const FootprintSource& source)
      : file_(file), source_(source), place_(source.scene) {
    std::string head = "WKT";
    for (const FootprintColumn& column : footprint_columns()) head += fmt::format(",{}", column.name);
    file_.append(head + ",component,material,pieces,occluders\n");
  }

  void add(const FootprintTable& table) override {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      stop_if_wanted();
      std::vector<glm::dvec3> on_map;
      for (const glm::dvec3& corner : table.corners_of_row(row)) on_map.push_back(place_(corner));
      const PlanShape shape = plan_shape(table.corners_of_row(row), on_map, table.pieces_in_row(row));
      std::string line = shape.is_upright() ? "\"MULTILINESTRING Z " : "\"MULTIPOLYGON Z ";
      line +=
          shape.is_upright() && shape.outlines.empty() ? "EMPTY" : shape_text(shape, "(", ")", "{} {} {}");
      line += '"';
      for (const FootprintColumn& column : footprint_columns()) line += ',' + number(table, column, row);
      line += fmt::format(",{},{},{},{}\n", csv_text(component_name(source_.scene, table, row)),
                          csv_text(material_name(source_.scene, table, row)), table.pieces_of(row),
                          occluder_list(table, row));
      file_.append(line);
    }
  }
  void close() override { file_.close(); }

 private:
  StreamedFile file_;
  FootprintSource source_;
  FootprintPlace place_;
};

class GeoJson : public FootprintFile {
 public:
  GeoJson(const std::filesystem::path& file, const FootprintSource& source)
      : file_(file), source_(source), on_earth_(source.scene.frame.is_georeferenced()) {
    std::string head = "{\"type\": \"FeatureCollection\",\n\"name\": \"footprints\",\n";
    if (!on_earth_) head += "\"crs\": null,\n";  // without it readers would take metres for degrees
    head += fmt::format("\"coordinates_are\": \"{}\",\n\"sensor\": {},\n\"features\": [",
                        on_earth_ ? "longitude and latitude in degrees on WGS 84, height in metres"
                                  : "metres east, north and up of the origin of the scene",
                        text(source.sensor));
    file_.append(head);
  }

  void add(const FootprintTable& table) override {
    std::vector<glm::dvec3> corners = table.corners_m;
    if (on_earth_) source_.scene.frame.to_lon_lat(corners, source_.scene.description.georeference->place);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      stop_if_wanted();
      std::string line = rows_++ == 0 ? "\n" : ",\n";
      line += R"({"type": "Feature", "properties": {)";
      for (const FootprintColumn& column : footprint_columns())
        line += fmt::format("\"{}\": {}, ", column.name, number(table, column, row));
      line += fmt::format(R"("component": {}, "material": {}, "pieces": {}, "occluders": "{}"}}, )",
                          text(component_name(source_.scene, table, row)),
                          text(material_name(source_.scene, table, row)), table.pieces_of(row),
                          occluder_list(table, row));
      const std::size_t first = table.first_corner[table.first_piece[row]];
      const PlanShape shape =
          plan_shape(table.corners_of_row(row),
                     std::span<const glm::dvec3>(corners).subspan(first, table.corners_of_row(row).size()),
                     table.pieces_in_row(row));
      line += fmt::format(R"("geometry": {{"type": "{}", "coordinates": )",
                          shape.is_upright() ? "MultiLineString" : "MultiPolygon");
      line += shape_text(shape, "[", "]", "[{},{},{}]");
      file_.append(line + "}}");
    }
  }
  void close() override {
    file_.append("\n]}\n");
    file_.close();
  }

 private:
  static std::string text(const std::string& words) {
    return nlohmann::json(words).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  StreamedFile file_;
  FootprintSource source_;
  bool on_earth_;
  std::size_t rows_ = 0;
};

}  // namespace

std::unique_ptr<FootprintFile> csv_file(const std::filesystem::path& file, const FootprintSource& source) {
  return std::make_unique<Csv>(file, source);
}

std::unique_ptr<FootprintFile> geojson_file(const std::filesystem::path& file,
                                            const FootprintSource& source) {
  return std::make_unique<GeoJson>(file, source);
}

}  // namespace tubefoot
