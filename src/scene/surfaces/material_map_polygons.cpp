// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a material map from polygons of a vector file: one region per polygon, in the local frame. The
// order of regions decides where polygons overlap.

#include <fmt/ranges.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "files/gdal_input.hpp"
#include "files/words.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/surfaces/material_map_gdal.hpp"
#include "scene/surfaces/material_map_sources.hpp"

namespace tubefoot {
namespace {

OGRLayer& layer_of(GDALDataset& dataset, const PolygonMaterialMap& map, const SourcePlace& place) {
  std::vector<std::string> names;
  for (OGRLayer* layer : dataset.GetLayers()) names.emplace_back(layer->GetName());
  if (names.empty()) throw InputError(place, "has no layer of polygons");
  if (!map.layer && names.size() > 1)
    throw InputError(place, fmt::format("has several layers: set 'layer' to {}", one_of(names, '"')));
  const std::string& wanted = map.layer.value_or(names.front());
  OGRLayer* layer = dataset.GetLayerByName(wanted.c_str());
  if (layer == nullptr)
    throw InputError(place, fmt::format("has no layer \"{}\": expected {}", wanted, one_of(names, '"')));
  return *layer;
}

int attribute_of(OGRLayer& layer, const PolygonMaterialMap& map, const SourcePlace& place) {
  OGRFeatureDefn& fields = *layer.GetLayerDefn();
  const int index = fields.GetFieldIndex(map.attribute.c_str());
  if (index >= 0) return index;
  std::vector<std::string> names;
  for (int k = 0; k < fields.GetFieldCount(); ++k) names.emplace_back(fields.GetFieldDefn(k)->GetNameRef());
  const std::string_view meant = nearest(map.attribute, names);
  throw InputError(place, fmt::format("its polygons have no attribute \"{}\"{}", map.attribute,
                                      !meant.empty()  ? fmt::format(": did you mean \"{}\"?", meant)
                                      : names.empty() ? ": they have no attributes"
                                                      : ": expected " + one_of(names, '"')));
}

class PolygonReader {
 public:
  PolygonReader(const PolygonMaterialMap& map, const MaterialMapSetting& setting)
      : map_(map), setting_(setting), place_{map.file.string(), 0, 0} {}

  MaterialMap read() {
    const GdalInput input(map_.file, {FileFormat::geopackage, FileFormat::geojson, FileFormat::shapefile});
    const GdalMessages messages;
    OGRLayer& layer = layer_of(input.dataset(), map_, place_);
    const int attribute = attribute_of(layer, map_, place_);
    layer.ResetReading();
    while (const OGRFeatureUniquePtr feature{layer.GetNextFeature()}) {
      stop_if_wanted();
      add(*feature, attribute);
    }
    if (!messages.failures().empty())
      throw InputError(place_, "cannot be read to the end" + messages.in_brackets());
    if (!unknown_.empty())
      throw InputError(
          place_, fmt::format("has values of \"{}\" without a material: {}; add each of them to 'classes'",
                              map_.attribute, fmt::join(unknown_, ", ")));
    if (map_.coordinates == "crs")
      carry_map_points(
          points_, crs_text(layer.GetSpatialRef()), setting_.frame, place_,
          "set coordinates = \"local\" if the map's coordinates are in metres in the local frame");
    std::vector<MaterialBorder> borders;
    borders.reserve(edges_.size());
    const auto last = static_cast<std::uint32_t>(material_of_region_.size() - 1);
    const bool first_wins = map_.overlaps == "first";
    for (const Edge& edge : edges_)
      borders.push_back(
          {points_[edge.from], points_[edge.to], first_wins ? last - edge.region : edge.region});
    if (first_wins) std::ranges::reverse(material_of_region_);
    return {std::move(borders), std::move(material_of_region_), setting_.default_material};
  }

 private:
  struct Edge {
    std::uint32_t from, to, region;
  };

  void add(OGRFeature& feature, int attribute) {
    const std::string who = fmt::format("feature {}: ", feature.GetFID());
    OGRGeometry* geometry = feature.GetGeometryRef();
    if (geometry == nullptr || geometry->IsEmpty()) return;
    if (!feature.IsFieldSetAndNotNull(attribute))
      throw InputError(place_, fmt::format("{}has no value of \"{}\"", who, map_.attribute));
    const std::string value = feature.GetFieldAsString(attribute);
    std::string name = value;
    if (!map_.classes.empty()) {
      const auto found = std::ranges::find(map_.classes, value, &MaterialClass::value);
      if (found == map_.classes.end()) {
        if (unknown_.size() < 30) unknown_.insert('"' + value.substr(0, 100) + '"');
        return;
      }
      name = found->material;
    }
    material_of_region_.push_back(material_named(name, setting_.materials, place_, who));
    const std::unique_ptr<OGRGeometry> straight(geometry->getLinearGeometry());
    const OGRwkbGeometryType type = wkbFlatten(straight->getGeometryType());
    if (type == wkbPolygon) {
      add(*straight->toPolygon(), who);
    } else if (type == wkbMultiPolygon) {
      for (const OGRPolygon* polygon : *straight->toMultiPolygon()) add(*polygon, who);
    } else {
      throw InputError(place_,
                       fmt::format("{}is a {}, expected a polygon", who, geometry->getGeometryName()));
    }
  }

  void add(const OGRPolygon& polygon, const std::string& who) {
    for (const OGRLinearRing* ring : polygon) {
      const auto first = static_cast<std::uint32_t>(points_.size());
      const int corners = ring->getNumPoints();
      check_border_count(edges_.size() + static_cast<std::size_t>(corners), place_);
      for (int k = 0; k < corners; ++k) {
        if (!std::isfinite(ring->getX(k)) || !std::isfinite(ring->getY(k)))
          throw InputError(place_, who + "has a corner that is not finite");
        points_.emplace_back(ring->getX(k), ring->getY(k),
                             setting_.frame.origin_height_m() + (setting_.lo_m.z + setting_.hi_m.z) / 2);
      }
      const auto count = static_cast<std::uint32_t>(corners);
      const auto region = static_cast<std::uint32_t>(material_of_region_.size() - 1);
      for (std::uint32_t k = 0; k < count; ++k) {
        const std::uint32_t from = first + k, to = first + (k + 1) % count;
        if (glm::dvec2(points_[from]) != glm::dvec2(points_[to])) edges_.push_back({from, to, region});
      }
    }
  }

  const PolygonMaterialMap& map_;
  const MaterialMapSetting& setting_;
  SourcePlace place_;
  std::vector<glm::dvec3> points_;
  std::vector<Edge> edges_;
  std::vector<std::uint16_t> material_of_region_;
  std::set<std::string> unknown_;
};

}  // namespace

MaterialMap polygon_material_map(const PolygonMaterialMap& map, const MaterialMapSetting& setting) {
  return PolygonReader(map, setting).read();
}

}  // namespace tubefoot
