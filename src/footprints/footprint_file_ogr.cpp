// SPDX-License-Identifier: GPL-3.0-or-later
// Writes footprints as a GeoPackage. The first layer has one multi-polygon per footprint, in the scene's
// map or in the local frame. A second layer has the outlines of footprints without plan area.
#include <fmt/format.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <array>

#include "files/checked_file.hpp"
#include "files/gdal_access.hpp"
#include "files/gdal_messages.hpp"
#include "footprints/footprint_file.hpp"
#include "footprints/footprint_place.hpp"
#include "footprints/plan_shape.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

class GeoPackage : public FootprintFile {
 public:
  GeoPackage(const std::filesystem::path& file, const FootprintSource& source)
      : file_(file), source_(source), place_(source.scene) {
    register_gdal_drivers();
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    require(driver != nullptr, "find the GDAL driver for");
    dataset_ = driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
    require(dataset_ != nullptr, "create");
    OGRSpatialReference crs;
    require(crs.SetFromUserInput(place_.is_map() ? place_.crs_wkt().c_str() : local_crs) == OGRERR_NONE,
            "describe the frame of");
    if (source.scene.frame.is_tangent()) crs.SetProjCS("tubefoot tangent plane");
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::string title = "DESCRIPTION=Footprints of sensor '" + source.sensor + "'. " + place_.said();
    std::array<const char*, 3> options{title.c_str(), "GEOMETRY_NAME=geom", nullptr};
    layer_ =
        dataset_->CreateLayer("footprints", &crs, wkbMultiPolygon25D, const_cast<char**>(options.data()));
    require(layer_ != nullptr, "create");
    for (const FootprintColumn& column : footprint_columns())
      field(layer_, column.name,
            std::holds_alternative<FootprintColumn::Reals>(column.values) ? OFTReal : OFTInteger64);
    for (const char* name : {"component", "material"}) field(layer_, name, OFTString);
    field(layer_, "pieces", OFTInteger64);
    field(layer_, "occluders", OFTString);
    const std::string upright_title =
        "DESCRIPTION=Outlines of footprints without plan area. " + place_.said();
    options[0] = upright_title.c_str();
    upright_ =
        dataset_->CreateLayer("upright", &crs, wkbMultiLineString25D, const_cast<char**>(options.data()));
    require(upright_ != nullptr, "create");
    for (const char* name : {"footprint", "ping", "transmission", "beam", "facet"})
      field(upright_, name, OFTInteger64);
    field(upright_, "component", OFTString);
    begin();
  }
  ~GeoPackage() override {
    if (dataset_ != nullptr) {
      dataset_->RollbackTransaction();
      GDALClose(dataset_);
    }
  }

  void add(const FootprintTable& table) override {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      stop_if_wanted();
      OGRFeature feature(layer_->GetLayerDefn());
      int f = 0;
      for (const FootprintColumn& column : footprint_columns()) {
        if (const auto* integers = std::get_if<FootprintColumn::Integers>(&column.values))
          feature.SetField(f++, static_cast<GIntBig>((table.**integers)[row]));
        else
          feature.SetField(f++, (table.*std::get<FootprintColumn::Reals>(column.values))[row]);
      }
      feature.SetField(f++, component_name(source_.scene, table, row).c_str());
      feature.SetField(f++, material_name(source_.scene, table, row).c_str());
      feature.SetField(f++, static_cast<GIntBig>(table.pieces_of(row)));
      feature.SetField(f++, occluder_list(table, row).c_str());
      const PlanShape shape = shape_of(table, row);
      feature.SetGeometry(shape.multi_polygon().get());
      require(layer_->CreateFeature(&feature) == OGRERR_NONE, "write to");
      if (shape.is_upright()) add_upright(table, row, feature.GetFID(), shape);
      ++rows_;
    }
    if (rows_ - committed_ < rows_a_transaction) return;
    commit();
    begin();
  }

  void close() override {
    commit();
    dataset_->FlushCache();
    GDALClose(dataset_);
    dataset_ = nullptr;
    require(messages_.failures().empty(), "finish");
    const std::unique_ptr<GDALDataset> written(
        GDALDataset::Open(file_.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
    require(written && written->GetLayerCount() == 2 &&
                written->GetLayer(0)->GetFeatureCount() == static_cast<GIntBig>(rows_) &&
                written->GetLayer(1)->GetFeatureCount() == static_cast<GIntBig>(upright_rows_),
            "finish");
  }

 private:
  static constexpr std::size_t rows_a_transaction = 100000;

  void require(bool good, const char* what) const {
    if (!good) throw write_error(file_, fmt::format("cannot {} the file{}", what, messages_.in_brackets()));
  }
  void field(OGRLayer* layer, const char* name, OGRFieldType type) const {
    OGRFieldDefn definition(name, type);
    require(layer->CreateField(&definition) == OGRERR_NONE, "add columns to");
  }
  void begin() { require(dataset_->StartTransaction() == OGRERR_NONE, "write to"); }
  void commit() {
    require(dataset_->CommitTransaction() == OGRERR_NONE, "write to");
    committed_ = rows_;
  }

  PlanShape shape_of(const FootprintTable& table, std::size_t row) const {
    std::vector<glm::dvec3> on_map;
    const std::span<const glm::dvec3> corners = table.corners_of_row(row);
    for (const glm::dvec3& corner : corners) on_map.push_back(place_(corner));
    return plan_shape(corners, on_map, table.pieces_in_row(row));
  }

  /// Repeats the row of the first layer with the outline, for a footprint without plan area.
  void add_upright(const FootprintTable& table, std::size_t row, GIntBig footprint, const PlanShape& shape) {
    OGRFeature feature(upright_->GetLayerDefn());
    int f = 0;
    feature.SetField(f++, footprint);
    for (const auto* values : {&table.ping, &table.transmission, &table.beam, &table.facet})
      feature.SetField(f++, static_cast<GIntBig>((*values)[row]));
    feature.SetField(f++, component_name(source_.scene, table, row).c_str());
    feature.SetGeometry(shape.multi_line().get());
    require(upright_->CreateFeature(&feature) == OGRERR_NONE, "write to");
    ++upright_rows_;
  }

  FixedGdalDate date_;
  std::filesystem::path file_;
  FootprintSource source_;
  FootprintPlace place_;
  GdalMessages messages_;
  GDALDataset* dataset_ = nullptr;
  OGRLayer *layer_ = nullptr, *upright_ = nullptr;
  std::size_t rows_ = 0, upright_rows_ = 0, committed_ = 0;
};

}  // namespace

std::unique_ptr<FootprintFile> geopackage_file(const std::filesystem::path& file,
                                               const FootprintSource& source) {
  return std::make_unique<GeoPackage>(file, source);
}

}  // namespace tubefoot
