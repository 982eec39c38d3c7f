// SPDX-License-Identifier: GPL-3.0-or-later

// Writes a coverage as a GeoPackage and as CSV tables (docs/footprints.md). The GeoPackage holds the visible
// parts and shadows of facets as shapes, and tables of areas by facet and by number of pings.

#include "footprints/coverage_file.hpp"

#include <cpl_vsi.h>
#include <fmt/format.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <array>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "files/checked_file.hpp"
#include "files/csv_file.hpp"
#include "files/gdal_access.hpp"
#include "files/gdal_messages.hpp"
#include "footprints/plan_shape.hpp"

namespace tubefoot {
namespace {

std::string short_enough(const std::string& fraction) {
  return fraction.size() <= longest_fraction ? fraction : std::string();
}

AreaShare never(const FacetCoverage& coverage) {
  const AreaShare& first = coverage.by_pings.front();
  return first.pings == 0 ? first : AreaShare{0, 0, "0"};
}

constexpr std::array<const char*, 3> facet_fractions{"seen_exact", "never_exact", "shadow_exact"};

std::array<std::string, facet_fractions.size()> fractions_of(const CoveredFacet& facet) {
  return {short_enough(facet.coverage.seen.exact), short_enough(never(facet.coverage).exact),
          short_enough(facet.coverage.shadow.exact)};
}

}  // namespace

std::array<double, facet_reals.size()> reals_of(const CoveredFacet& facet) {
  const double seen = facet.coverage.seen.share, hidden = facet.coverage.shadow.share,
               unseen = never(facet.coverage).share, area = facet.area_m2;
  double mean = 0;
  for (const AreaShare& part : facet.coverage.by_pings) mean += part.pings * part.share;
  return {area, area * seen, area * unseen, area * hidden, seen, unseen, hidden, mean};
}

std::vector<glm::dvec3> CoveredFacet::polygon_m(std::size_t cell) const {
  const CoverageCell& c = coverage.cells[cell];
  return {corners_m.begin() + c.first, corners_m.begin() + c.first + c.count};
}

double CoveredFacet::cell_area_m2(std::size_t cell) const {
  const std::vector<glm::dvec3> p = polygon_m(cell);
  glm::dvec3 sum(0);
  for (std::size_t k = 1; k + 1 < p.size(); ++k) sum += glm::cross(p[k] - p[0], p[k + 1] - p[0]);
  return glm::length(sum) / 2;
}

struct CoverageFile::State {
  const Scene& scene;
  LocalFrame::Map map;
  FixedGdalDate date;
  GdalMessages messages;
  std::string memory_file;  ///< GDAL writes into this memory file, because some GDAL drivers do not notice a
                            ///< full disk
  GDALDataset* dataset = nullptr;
  OGRLayer *coverage = nullptr, *shadows = nullptr, *upright = nullptr, *facets = nullptr, *depths = nullptr;

  explicit State(const Scene& its_scene) : scene(its_scene), map(its_scene.frame.map()) {}
  ~State() {
    if (dataset) GDALClose(dataset);
    VSIUnlink(memory_file.c_str());
  }
  void require(bool good, const char* what) const {
    if (!good)
      throw std::runtime_error(fmt::format("cannot {} the coverage{}", what, messages.in_brackets()));
  }
  OGRLayer* layer(const char* name, const OGRSpatialReference* crs, OGRwkbGeometryType type) const {
    OGRLayer* made = dataset->CreateLayer(name, const_cast<OGRSpatialReference*>(crs), type,
                                          nullptr);  // as GDAL 3.6 requires
    require(made != nullptr, "create a layer of");
    return made;
  }
  void fields(OGRLayer* in, std::initializer_list<const char*> names, OGRFieldType type) const {
    for (const char* name : names) {
      OGRFieldDefn definition(name, type);
      require(in->CreateField(&definition) == OGRERR_NONE, "add columns to");
    }
  }
  void write(OGRLayer* to, OGRFeature& feature) const {
    require(to->CreateFeature(&feature) == OGRERR_NONE, "write");
  }
  void names(OGRFeature& feature, const CoveredFacet& facet) const {
    feature.SetField("facet", static_cast<GIntBig>(facet.coverage.facet));
    feature.SetField("component", scene.report.components[facet.component].name.c_str());
    feature.SetField("material", scene.description.materials[facet.material].name.c_str());
  }
  /// Returns the cells as one geometry and adds their areas to `area_m2`.
  PlanShape shape(const CoveredFacet& facet, const std::vector<std::size_t>& cells, double& area_m2) const {
    std::vector<Piece> pieces;
    std::vector<glm::dvec3> corners_m, on_map;  // of these cells alone
    for (const std::size_t cell : cells) {
      const auto [first, count] =
          std::pair(facet.coverage.cells[cell].first, facet.coverage.cells[cell].count);
      pieces.push_back({static_cast<std::uint32_t>(corners_m.size()), count});
      for (const glm::dvec3& p : std::span(facet.corners_m).subspan(first, count)) {
        corners_m.push_back(p);
        on_map.emplace_back(map.easting + p.x / map.metres_per_unit, map.northing + p.y / map.metres_per_unit,
                            scene.frame.origin_height_m() + p.z);
      }
      area_m2 += facet.cell_area_m2(cell);
    }
    return plan_shape(corners_m, on_map, pieces);
  }
  /// Writes a feature with its shape. A shape without plan area also gets a feature with the lines around
  /// it.
  void write_shape(OGRLayer* to, OGRFeature& feature, const PlanShape& shape) const {
    feature.SetGeometry(shape.multi_polygon().get());
    write(to, feature);
    if (!shape.is_upright()) return;
    OGRFeature lines(upright->GetLayerDefn());
    lines.SetField("layer", to->GetName());
    lines.SetField("feature", feature.GetFID());
    lines.SetField("facet", feature.GetFieldAsInteger64("facet"));
    for (const char* name : {"component", "material"}) lines.SetField(name, feature.GetFieldAsString(name));
    lines.SetGeometry(shape.multi_line().get());
    write(upright, lines);
  }
};

CoverageFile::CoverageFile(const Scene& scene) : state_(std::make_unique<State>(scene)) {
  register_gdal_drivers();
  State& s = *state_;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  s.require(driver != nullptr, "find the GeoPackage driver of GDAL for");
  s.memory_file = fmt::format("/vsimem/coverage-{}.gpkg", static_cast<const void*>(&s));
  s.dataset = driver->Create(s.memory_file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  s.require(s.dataset != nullptr, "create");
  OGRSpatialReference crs;
  s.require(
      crs.importFromWkt(scene.frame.is_georeferenced() ? s.map.crs_wkt.c_str() : local_crs) == OGRERR_NONE,
      "describe the reference system of");
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  s.coverage = s.layer("coverage", &crs, wkbMultiPolygon25D);
  s.shadows = s.layer("shadows", &crs, wkbMultiPolygon25D);
  s.upright = s.layer("upright", &crs, wkbMultiLineString25D);
  s.facets = s.layer("facets", nullptr, wkbNone);
  s.depths = s.layer("depths", nullptr, wkbNone);
  s.fields(s.upright, {"layer"}, OFTString);
  s.fields(s.upright, {"feature"}, OFTInteger64);
  for (OGRLayer* layer : {s.coverage, s.shadows, s.upright, s.facets}) {
    s.fields(layer, {"facet"}, OFTInteger64);
    s.fields(layer, {"component", "material"}, OFTString);
  }
  s.fields(s.coverage, {"pings"}, OFTInteger64);
  s.fields(s.coverage, {"area_m2"}, OFTReal);
  s.fields(s.shadows, {"in_sector"}, OFTInteger64);
  s.fields(s.shadows, {"first_sensor"}, OFTString);
  s.fields(s.shadows, {"first_ping", "occluder"}, OFTInteger64);
  s.fields(s.shadows, {"occluder_component"}, OFTString);
  s.fields(s.shadows, {"area_m2"}, OFTReal);
  s.fields(s.facets, {"most_pings"}, OFTInteger64);
  for (const char* name : facet_reals) s.fields(s.facets, {name}, OFTReal);
  for (const char* name : facet_fractions) s.fields(s.facets, {name}, OFTString);
  s.fields(s.depths, {"facet", "pings"}, OFTInteger64);
  s.fields(s.depths, {"area_m2", "share"}, OFTReal);
  s.fields(s.depths, {"share_exact"}, OFTString);
  s.dataset->StartTransaction();  // without a transaction SQLite commits every row
}

CoverageFile::~CoverageFile() = default;

void CoverageFile::add(const CoveredFacet& facet, std::span<const CountedPing> pings) {
  const State& s = *state_;
  const FacetCoverage& c = facet.coverage;
  std::map<std::uint32_t, std::vector<std::size_t>> seen;
  for (std::size_t k = 0; k < c.cells.size(); ++k) seen[c.cells[k].pings].push_back(k);
  for (const auto& [times, cells] : seen) {
    OGRFeature feature(s.coverage->GetLayerDefn());
    s.names(feature, facet);
    feature.SetField("pings", static_cast<GIntBig>(times));
    double area_m2 = 0;
    const PlanShape shape = s.shape(facet, cells, area_m2);
    feature.SetField("area_m2", area_m2);
    s.write_shape(s.coverage, feature, shape);
  }
  for (const ShadowPart& shadow : facet.shadows) {
    OGRFeature feature(s.shadows->GetLayerDefn());
    s.names(feature, facet);
    feature.SetField("in_sector", static_cast<GIntBig>(shadow.in_sector));
    feature.SetField("first_sensor", pings[shadow.first_ping].sensor.c_str());
    feature.SetField("first_ping", static_cast<GIntBig>(pings[shadow.first_ping].ping));
    if (shadow.occluder != no_facet) {
      feature.SetField("occluder", static_cast<GIntBig>(shadow.occluder));
      feature.SetField("occluder_component",
                       s.scene.report.components[shadow.occluder_component].name.c_str());
    }
    double area_m2 = 0;
    const PlanShape shape = s.shape(facet, shadow.cells, area_m2);
    feature.SetField("area_m2", area_m2);
    s.write_shape(s.shadows, feature, shape);
  }
  OGRFeature row(s.facets->GetLayerDefn());
  s.names(row, facet);
  row.SetField("most_pings", static_cast<GIntBig>(c.seen.pings));
  const auto reals = reals_of(facet);
  for (std::size_t k = 0; k < reals.size(); ++k) row.SetField(facet_reals[k], reals[k]);
  const auto fractions = fractions_of(facet);
  for (std::size_t k = 0; k < fractions.size(); ++k)
    if (!fractions[k].empty()) row.SetField(facet_fractions[k], fractions[k].c_str());
  s.write(s.facets, row);
  for (const AreaShare& part : c.by_pings) {
    OGRFeature depth(s.depths->GetLayerDefn());
    depth.SetField("facet", static_cast<GIntBig>(c.facet));
    depth.SetField("pings", static_cast<GIntBig>(part.pings));
    depth.SetField("area_m2", part.share * facet.area_m2);
    depth.SetField("share", part.share);
    if (const std::string exact = short_enough(part.exact); !exact.empty())
      depth.SetField("share_exact", exact.c_str());
    s.write(s.depths, depth);
  }
}

void CoverageFile::write(const std::filesystem::path& file) {
  State& s = *state_;
  s.dataset->CommitTransaction();
  s.dataset->FlushCache();
  GDALClose(s.dataset);
  s.dataset = nullptr;
  s.require(s.messages.failures().empty(), "finish");
  vsi_l_offset size = 0;
  const GByte* bytes = VSIGetMemFileBuffer(s.memory_file.c_str(), &size, FALSE);
  s.require(bytes != nullptr, "finish");
  write_file(file, {bytes, static_cast<std::size_t>(size)});
}

CoverageTables::CoverageTables(const Scene& scene) : scene_(scene) {
  facets_ = "facet,component,material,most_pings";
  for (const char* name : facet_reals) facets_ += fmt::format(",{}", name);
  for (const char* name : facet_fractions) facets_ += fmt::format(",{}", name);
  facets_ += "\n";
  depths_ = "facet,pings,area_m2,share,share_exact\n";
}

void CoverageTables::add(const CoveredFacet& facet) {
  const FacetId id = facet.coverage.facet;
  facets_ +=
      fmt::format("{},{},{},{}", id, csv_text(scene_.report.components[facet.component].name),
                  csv_text(scene_.description.materials[facet.material].name), facet.coverage.seen.pings);
  for (const double value : reals_of(facet)) facets_ += fmt::format(",{}", value);
  for (const std::string& fraction : fractions_of(facet)) facets_ += fmt::format(",{}", fraction);
  facets_ += "\n";
  for (const AreaShare& part : facet.coverage.by_pings)
    depths_ += fmt::format("{},{},{},{},{}\n", id, part.pings, part.share * facet.area_m2, part.share,
                           short_enough(part.exact));
}

}  // namespace tubefoot
