// SPDX-License-Identifier: GPL-3.0-or-later
// Footprints as CSV with WKT, and as GeoJSON.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/footprint_file.hpp"
#include "app/footprint_place.hpp"
#include "files/csv_file.hpp"
#include "files/streamed_file.hpp"
#include "geometry/stop.hpp"

namespace tubefoot {
namespace {

std::string number(const FootprintTable& table, const FootprintColumn& column, std::size_t row) {
  return std::visit([&](auto values) { return fmt::format("{}", (table.*values)[row]); }, column.values);
}

/// A piece's corners and the first again, each as `one` writes it.
template <class One>
std::string ring(std::span<const glm::dvec3> corners, const One& one) {
  std::string text;
  for (std::size_t k = 0; k <= corners.size(); ++k) {
    if (k > 0) text += ',';
    text += one(corners[k % corners.size()]);
  }
  return text;
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
      std::string line = "\"MULTIPOLYGON Z (";
      for (std::uint64_t piece = table.first_piece[row]; piece < table.first_piece[row + 1]; ++piece) {
        if (piece > table.first_piece[row]) line += ',';
        line += "((" +
                ring(table.corners_of(piece),
                     [&](const glm::dvec3& corner) {
                       const glm::dvec3 p = place_(corner);
                       return fmt::format("{} {} {}", p.x, p.y, p.z);
                     }) +
                "))";
      }
      line += ")\"";
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
    if (!on_earth_) head += "\"crs\": null,\n";  // without it readers take metres for degrees
    head += fmt::format("\"coordinates_are\": \"{}\",\n\"sensor\": {},\n\"features\": [",
                        on_earth_ ? "longitude and latitude in degrees on WGS 84, height in metres"
                                  : "metres east, north and up of the scene's own origin",
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
      line += R"("geometry": {"type": "MultiPolygon", "coordinates": [)";
      for (std::uint64_t piece = table.first_piece[row]; piece < table.first_piece[row + 1]; ++piece) {
        if (piece > table.first_piece[row]) line += ',';
        const auto own = std::span<const glm::dvec3>(corners).subspan(
            table.first_corner[piece], table.first_corner[piece + 1] - table.first_corner[piece]);
        line += "[[" +
                ring(own, [](const glm::dvec3& p) { return fmt::format("[{},{},{}]", p.x, p.y, p.z); }) +
                "]]";
      }
      file_.append(line + "]}}");
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
