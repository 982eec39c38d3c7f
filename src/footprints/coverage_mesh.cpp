// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the covered facets as VTK's XML PolyData ("VTK File Formats", XML, arrays in ASCII) and as binary
// glTF 2.0 (one buffer in the file). Corners are not shared, because values belong to facets.
#include "footprints/coverage_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <iterator>
#include <limits>
#include <string>

#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF's buffers are little-endian");

/// Returns a colour between dark blue (never seen) and pale yellow (`most` pings), linear in the logarithm.
std::array<float, 3> mesh_colour(double pings, double most) {
  constexpr std::array<std::array<float, 3>, 4> stops{
      {{0.16f, 0.25f, 0.55f}, {0.10f, 0.55f, 0.58f}, {0.45f, 0.77f, 0.40f}, {0.98f, 0.93f, 0.55f}}};
  const double at = most > 0 ? 3 * std::log1p(pings) / std::log1p(most) : 0;
  const auto k = std::min<std::size_t>(static_cast<std::size_t>(at), 2);
  const auto part = static_cast<float>(at - static_cast<double>(k));
  std::array<float, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = stops[k][c] + part * (stops[k + 1][c] - stops[k][c]);
  return colour;
}

/// Returns texts as VTK writes strings in ASCII: the codes of the letters, and a 0 after each text.
template <class Named>
std::string coded_names(const char* name, const std::vector<Named>& list) {
  std::string text =
      fmt::format(R"(<Array type="String" Name="{}" NumberOfTuples="{}" format="ascii">)", name, list.size());
  for (const Named& one : list) {
    for (const unsigned char c : one.name) text += fmt::format(" {}", static_cast<int>(c));
    text += " 0";
  }
  return text + "</Array>\n";
}

}  // namespace

void CoverageMesh::add(const CoveredFacet& facet) {
  rows_.push_back({facet.vertices_m, facet.coverage.facet, facet.component, facet.material,
                   facet.coverage.seen.pings, reals_of(facet)});
}

void CoverageMesh::write_vtp(const std::filesystem::path& file) const {
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- tubefoot coverage: metres east, north and up of the origin of the "
      "scene -->\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n{}{}</FieldData>\n<Piece NumberOfPoints=\"{}\" "
      "NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n<Points>\n",
      coded_names("component_names", scene_.report.components),
      coded_names("material_names", scene_.description.materials), 3 * rows_.size(), rows_.size());
  const auto array = [&](const char* type, const char* name, int components, const auto& add) {
    text += fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="ascii">)", type,
                        name, components);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      stop_if_wanted();
      add(k, rows_[k]);
    }
    text += "</DataArray>\n";
  };
  const auto out = std::back_inserter(text);
  array("Float64", "Points", 3, [&](std::size_t, const Row& row) {
    for (const glm::dvec3& p : row.corners_m) fmt::format_to(out, " {} {} {}", p.x, p.y, p.z);
  });
  text += "</Points>\n<Polys>\n";
  array("Int64", "connectivity", 1,
        [&](std::size_t k, const Row&) { fmt::format_to(out, " {} {} {}", 3 * k, 3 * k + 1, 3 * k + 2); });
  array("Int64", "offsets", 1, [&](std::size_t k, const Row&) { fmt::format_to(out, " {}", 3 * k + 3); });
  text += "</Polys>\n<CellData>\n";
  const auto whole = [&](const char* name, std::uint32_t Row::*value) {
    array("UInt32", name, 1, [&](std::size_t, const Row& row) { fmt::format_to(out, " {}", row.*value); });
  };
  array("UInt32", "facet", 1, [&](std::size_t, const Row& row) { fmt::format_to(out, " {}", row.facet); });
  whole("component", &Row::component);
  whole("material", &Row::material);
  whole("most_pings", &Row::most_pings);
  for (std::size_t c = 0; c < facet_reals.size(); ++c)
    array("Float64", facet_reals[c], 1,
          [&](std::size_t, const Row& row) { fmt::format_to(out, " {}", row.reals[c]); });
  text += "</CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  write_file(file, std::string_view(text));
}

glm::dvec3 CoverageMesh::centre_m() const {
  glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
  for (const Row& row : rows_)
    for (const glm::dvec3& p : row.corners_m) lo = glm::min(lo, p), hi = glm::max(hi, p);
  return rows_.empty() ? glm::dvec3(0) : glm::round((lo + hi) / 2.0);
}

void CoverageMesh::write_glb(const std::filesystem::path& file) const {
  using Json = nlohmann::ordered_json;
  constexpr int floats = 5126, vertex_target = 34962;
  const auto theirs = [](glm::dvec3 p) { return glm::dvec3(p.x, p.z, -p.y); };
  const glm::dvec3 centre = centre_m();
  std::string bytes;
  Json views = Json::array(), accessors = Json::array(), attributes = Json::object();
  /// Adds an attribute of `components` floats per corner.
  const auto attribute = [&](const std::string& name, std::size_t components, const auto& value) {
    const std::size_t first = bytes.size();
    std::vector<float> least(components, std::numeric_limits<float>::infinity()), most(components);
    for (float& x : most) x = -std::numeric_limits<float>::infinity();
    for (const Row& row : rows_) {
      stop_if_wanted();
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto values = value(row, corner);
        for (std::size_t c = 0; c < components; ++c) {
          least[c] = std::min(least[c], values[c]);
          most[c] = std::max(most[c], values[c]);
        }
        bytes.append(reinterpret_cast<const char*>(values.data()), components * sizeof(float));
      }
    }
    views.push_back({{"buffer", 0},
                     {"byteOffset", first},
                     {"byteLength", bytes.size() - first},
                     {"target", vertex_target}});
    attributes[name] = accessors.size();
    accessors.push_back({{"bufferView", views.size() - 1},
                         {"componentType", floats},
                         {"count", 3 * rows_.size()},
                         {"type", components == 3 ? "VEC3" : "SCALAR"},
                         {"min", least},
                         {"max", most}});
  };
  Json root;
  root["asset"] = {{"version", "2.0"}, {"generator", "tubefoot"}};
  root["scene"] = 0;
  Json nodes = Json::array();
  if (!rows_.empty()) {
    attribute("POSITION", 3, [&](const Row& row, std::size_t corner) {
      const glm::dvec3 p = theirs(row.corners_m[corner] - centre);
      return std::array{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    });
    constexpr std::size_t mean_pings = facet_reals.size() - 1;
    double most = 0;
    for (const Row& row : rows_) most = std::max(most, row.reals[mean_pings]);
    attribute("COLOR_0", 3,
              [&](const Row& row, std::size_t) { return mesh_colour(row.reals[mean_pings], most); });
    attribute("_MOST_PINGS", 1,
              [](const Row& row, std::size_t) { return std::array{static_cast<float>(row.most_pings)}; });
    for (std::size_t c = 0; c < facet_reals.size(); ++c) {
      std::string name = "_";
      for (const char* letter = facet_reals[c]; *letter != 0; ++letter)
        name += *letter >= 'a' && *letter <= 'z' ? static_cast<char>(*letter - 'a' + 'A') : *letter;
      attribute(name, 1,
                [c](const Row& row, std::size_t) { return std::array{static_cast<float>(row.reals[c])}; });
    }
    root["materials"] =
        Json::array({{{"name", "coverage"},
                      {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                      {"doubleSided", true}}});
    root["meshes"] =
        Json::array({{{"name", "coverage"},
                      {"primitives", Json::array({{{"attributes", attributes}, {"material", 0}}})}}});
    const glm::dvec3 place = theirs(centre);
    root["nodes"] = Json::array(
        {{{"name", "coverage"}, {"mesh", 0}, {"translation", {place.x, place.y, place.z + 0.0}}}});
    root["accessors"] = accessors;
    root["bufferViews"] = views;
    root["buffers"] = Json::array({{{"byteLength", bytes.size()}}});
    nodes.push_back(0);
  }
  Json scene{{"name", "coverage"}};
  if (!nodes.empty()) scene["nodes"] = nodes;
  root["scenes"] = Json::array({scene});
  std::string json = text_of(root);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out;
  const auto word = [&](std::uint32_t value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const std::size_t length = 12 + 8 + json.size() + (bytes.empty() ? 0 : 8 + bytes.size());
  if (length > std::numeric_limits<std::uint32_t>::max())
    throw write_error(file, "binary glTF has at most 4 GiB: write fewer facets, or use .vtp");
  word(0x46546c67);  // "glTF"
  word(2);
  word(static_cast<std::uint32_t>(length));
  word(static_cast<std::uint32_t>(json.size()));
  word(0x4e4f534a);  // "JSON"
  out += json;
  if (!bytes.empty()) {
    word(static_cast<std::uint32_t>(bytes.size()));
    word(0x004e4942);  // "BIN"
    out += bytes;
  }
  write_file(file, std::string_view(out));
}

}  // namespace tubefoot
