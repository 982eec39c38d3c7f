// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/footprint_file.hpp"

#include <cpl_vsi.h>
#include <fmt/format.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <array>

#include "app/output_folder.hpp"
#include "app/usage_error.hpp"
#include "scene/raster_messages.hpp"

namespace tubefoot {
namespace {

struct Format {
  const char *ending, *driver;
};
constexpr std::array<Format, 3> formats{{{".gpkg", "GPKG"}, {".geojson", "GeoJSON"}, {".csv", "CSV"}}};

const char* driver_for(const std::filesystem::path& file) {
  for (const Format& format : formats)
    if (file.extension() == format.ending) return format.driver;
  throw UsageError(
      fmt::format("'{}': the ending chooses the format: .gpkg, .geojson or .csv", file.string()));
}

/// East and north in metres about the scene's own origin; heights are metres above it.
constexpr const char* local_crs =
    R"wkt(ENGCRS["tubefoot local east-north",EDATUM["scene origin"],CS[Cartesian,2],)wkt"
    R"wkt(AXIS["east (E)",east,ORDER[1],LENGTHUNIT["metre",1]],)wkt"
    R"wkt(AXIS["north (N)",north,ORDER[2],LENGTHUNIT["metre",1]]])wkt";

constexpr double degrees = 57.29577951308232;

}  // namespace

struct FootprintFile::State {
  std::filesystem::path file;
  std::string memory_file;  ///< GDAL's drivers write here: some of them do not notice a full disk
  GdalMessages messages;
  GDALDataset* dataset = nullptr;
  OGRLayer* layer = nullptr;
  bool with_relief = false;

  ~State() {
    if (dataset) GDALClose(dataset);
    VSIUnlink(memory_file.c_str());
  }
  void require(bool good, const char* what) const {
    if (!good)
      throw std::runtime_error(fmt::format("cannot {} '{}'{}", what, file.string(), messages.in_brackets()));
  }
  void field(const char* name, OGRFieldType type) const {
    OGRFieldDefn definition(name, type);
    require(layer->CreateField(&definition) == OGRERR_NONE, "add columns to");
  }
};

FootprintFile::FootprintFile(const std::filesystem::path& file, bool with_relief)
    : state_(std::make_unique<State>()) {
  const char* driver_name = driver_for(file);
  GDALAllRegister();
  State& s = *state_;
  s.file = file;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
  s.require(driver != nullptr, "find the GDAL driver for");
  s.memory_file =
      fmt::format("/vsimem/footprints-{}{}", static_cast<const void*>(&s), file.extension().string());
  s.dataset = driver->Create(s.memory_file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  s.require(s.dataset != nullptr, "create");
  std::array<const char*, 2> options{driver_name == std::string("CSV") ? "GEOMETRY=AS_WKT" : nullptr,
                                     nullptr};
  OGRSpatialReference local;
  s.require(local.importFromWkt(local_crs) == OGRERR_NONE, "describe the frame of");
  s.layer =
      s.dataset->CreateLayer("footprints", &local, wkbMultiPolygon25D, const_cast<char**>(options.data()));
  s.require(s.layer != nullptr, "create");
  for (const char* name : {"ping", "beam", "tube", "facet"}) s.field(name, OFTInteger64);
  s.with_relief = with_relief;
  if (with_relief) s.field("base_facet", OFTInteger64);
  for (const char* name : {"component", "material"}) s.field(name, OFTString);
  for (const char* name : {"area_m2", "solid_angle_sr", "grazing_deg", "slant_range_min_m",
                           "slant_range_max_m", "centroid_east_m", "centroid_north_m", "centroid_up_m"})
    s.field(name, OFTReal);
  s.field("pieces", OFTInteger64);
  s.field("occluders", OFTString);
  s.dataset->StartTransaction();  // a GeoPackage without one commits every row; other formats refuse, which
                                  // is fine
}

FootprintFile::~FootprintFile() = default;

void FootprintFile::add(const Scene& scene, const ShotGround& ground, const History& history,
                        const std::vector<std::uint32_t>& beam_of_tube, std::size_t ping) {
  const State& s = *state_;
  const FootprintSet& set = history.footprints;
  const glm::dvec3 apex = scene.grid.to_metres(history.tubes.apex);
  for (const Footprint& footprint : set.footprints) {
    const auto true_place = [&](glm::dvec3 seen_m) {
      const ApparentGround* apparent = ground.apparent();
      return apparent == nullptr ? seen_m : apparent->true_place(footprint.facet, seen_m, scene.grid);
    };
    const double area_ratio =
        ground.apparent() == nullptr ? 1 : ground.apparent()->area_ratio(footprint.facet, scene.grid);
    OGRMultiPolygon shape;
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece& piece = set.pieces[footprint.first_piece + p];
      auto* ring = new OGRLinearRing;  // owned by the polygon below
      for (std::uint32_t c = 0; c <= piece.count; ++c) {
        const glm::dvec3 corner = true_place(apex + set.corners_m[piece.first + c % piece.count]);
        ring->addPoint(corner.x, corner.y, corner.z);
      }
      auto* polygon = new OGRPolygon;  // owned by the shape
      polygon->addRingDirectly(ring);
      shape.addGeometryDirectly(polygon);
    }
    std::string occluders;
    for (std::uint32_t k = 0; k < footprint.occluder_count; ++k)
      occluders += fmt::format("{}{}", k == 0 ? "" : " ", set.occluders[footprint.first_occluder + k]);
    const glm::dvec3 centroid = true_place(apex + footprint.centroid_m);

    OGRFeature feature(s.layer->GetLayerDefn());
    int f = 0;
    feature.SetField(f++, static_cast<GIntBig>(ping));
    feature.SetField(f++, static_cast<GIntBig>(beam_of_tube[footprint.tube]));
    feature.SetField(f++, static_cast<GIntBig>(footprint.tube));
    feature.SetField(f++, static_cast<GIntBig>(footprint.facet));
    if (s.with_relief) feature.SetField(f++, static_cast<GIntBig>(ground.base_facet(footprint.facet)));
    feature.SetField(f++, scene.report.components[ground.mesh().component[footprint.facet]].name.c_str());
    feature.SetField(f++, scene.description.materials[ground.mesh().material[footprint.facet]].name.c_str());
    for (const double value :
         {area_ratio * footprint.area_m2, footprint.solid_angle_sr, footprint.grazing_angle_rad * degrees,
          footprint.slant_range_min_m, footprint.slant_range_max_m, centroid.x, centroid.y, centroid.z})
      feature.SetField(f++, value);
    feature.SetField(f++, static_cast<GIntBig>(footprint.piece_count));
    feature.SetField(f++, occluders.c_str());
    feature.SetGeometry(&shape);
    s.require(s.layer->CreateFeature(&feature) == OGRERR_NONE, "write to");
  }
}

void FootprintFile::close() {
  State& s = *state_;
  s.dataset->CommitTransaction();
  s.dataset->FlushCache();
  GDALClose(s.dataset);
  s.dataset = nullptr;
  s.require(s.messages.failures().empty(), "finish");
  vsi_l_offset size = 0;
  const GByte* bytes = VSIGetMemFileBuffer(s.memory_file.c_str(), &size, FALSE);
  s.require(bytes != nullptr, "finish");
  write_file(s.file, {reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size)});
}

}  // namespace tubefoot
