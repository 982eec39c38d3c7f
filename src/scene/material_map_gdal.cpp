// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/material_map_gdal.hpp"

#include <fmt/core.h>

#include "scene/raster_messages.hpp"
#include "scene/raster_netcdf_size.hpp"

namespace tubefoot {

GDALDatasetUniquePtr open_material_map(const SourcePlace& place, unsigned flags, const char* const* drivers,
                                       const char* expected) {
  GDALAllRegister();
  const GdalMessages messages;
  refuse_short_netcdf(place);
  GDALDatasetUniquePtr dataset(
      GDALDataset::Open(place.file.c_str(), flags | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers));
  if (dataset == nullptr)
    throw InputError(place, fmt::format("cannot be read as {}: it is empty, cut off, corrupt or of another "
                                        "format{}",
                                        expected, messages.in_brackets()));
  return dataset;
}

std::string crs_text(const OGRSpatialReference* crs) {
  if (crs == nullptr || crs->IsEmpty() || crs->IsLocal()) return {};
  char* text = nullptr;
  crs->exportToWkt(&text);
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  return wkt;
}

void carry_map_points(std::span<glm::dvec3> points, const std::string& crs, const LocalFrame& frame,
                      const SourcePlace& place, const char* way_out) {
  if (frame.is_georeferenced() == crs.empty())
    throw InputError(place, fmt::format("has {} coordinate reference system, but the scene's frame is{} "
                                        "georeferenced: {}",
                                        crs.empty() ? "no" : "a", crs.empty() ? "" : " not", way_out));
  if (!crs.empty()) frame.carry(points, crs, place);
}

}  // namespace tubefoot
