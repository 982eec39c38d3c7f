// SPDX-License-Identifier: GPL-3.0-or-later

// Checks the polygons of a mesh file, divides them into triangles, removes points without a face, and
// counts conspicuous faces in warnings.

#include "scene/meshes/mesh_file_polygons.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <span>

#include "files/input_error.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/meshes/polygon_cutter.hpp"

namespace tubefoot {
namespace {

using Corners = std::span<const std::uint32_t>;

class Cutting {
 public:
  Cutting(UncheckedPolygons polygons, const std::string& file) : polygons_(std::move(polygons)), file_(file) {
    mesh_.names = std::move(polygons_.names);
    mesh_.warnings = std::move(polygons_.warnings);
  }

  NamedMesh cut() {
    std::size_t begin = 0;
    for (face_ = 0; face_ < polygons_.end.size(); ++face_) {
      stop_if_wanted();
      add(Corners(polygons_.corners.data() + begin, polygons_.end[face_] - begin));
      begin = polygons_.end[face_];
    }
    if (mesh_.triangles.empty()) throw InputError({file_, 0, 0}, what_is_missing());
    mesh_.points_m = std::move(polygons_.points);
    drop_unused_points(mesh_);
    if (too_few_ > 0) warn(fmt::format("{} faces have fewer than three corners and are left out", too_few_));
    if (uneven_ > 0)
      warn(
          fmt::format("{} polygons are not flat and are cut into triangles; {} deviates most from its plane, "
                      "by {:.3g} units of the file",
                      uneven_, name_of(most_uneven_), farthest_));
    return std::move(mesh_);
  }

 private:
  void warn(const std::string& what) { mesh_.warnings.push_back(file_ + ": " + what); }

  SourcePlace place() const { return {file_, polygons_.line.empty() ? 0 : polygons_.line[face_], 0}; }
  std::string name_of(std::size_t face) const {
    return polygons_.line.empty() ? fmt::format("face {} (counted from 0)", face)
                                  : fmt::format("the face of line {}", polygons_.line[face]);
  }
  std::string name() const { return polygons_.line.empty() ? name_of(face_) : "the face"; }

  void add(Corners polygon) {
    for (const std::uint32_t index : polygon)
      if (index >= polygons_.points.size())
        throw InputError(
            place(),
            fmt::format(
                "{} refers to vertex {}, which is out of range: the file holds {} vertices, counted from {}",
                name(), std::uint64_t{index} + polygons_.first_index, polygons_.points.size(),
                polygons_.first_index));
    if (polygon.size() < 3) {
      ++too_few_;
      return;
    }
    if (cutter_.cut(polygons_.points, polygon, mesh_.triangles) == PolygonCutter::Result::crossed)
      throw InputError(place(), fmt::format("{} of {} corners crosses or overlaps itself and does not bound "
                                            "a surface: repair or triangulate it in the modelling program",
                                            name(), polygon.size()));
    if (!polygons_.names_of.empty()) mesh_.names_of.resize(mesh_.triangles.size(), polygons_.names_of[face_]);
    const double off = unevenness(polygons_.points, polygon);
    if (off > 0) ++uneven_;
    if (off > farthest_) {
      farthest_ = off;
      most_uneven_ = face_;
    }
  }

  std::string what_is_missing() const {
    if (too_few_ > 0)
      return fmt::format("holds no facets, only {} points or lines: export the model as a surface", too_few_);
    if (polygons_.points.empty()) return "holds no facets, expected a surface mesh: export it with its faces";
    return fmt::format(
        "holds {} points and no facets: it is a point cloud, but the scene needs surfaces. Convert it to a "
        "surface (CloudCompare, MeshLab), or to a grid of heights (gdal_grid) for a [[terrain]] of kind = "
        "\"raster\"",
        polygons_.points.size());
  }

  UncheckedPolygons polygons_;
  const std::string& file_;
  NamedMesh mesh_;
  PolygonCutter cutter_;
  std::size_t face_ = 0, too_few_ = 0, uneven_ = 0, most_uneven_ = 0;
  double farthest_ = 0;
};

}  // namespace

NamedMesh triangulate(UncheckedPolygons polygons, const std::string& file) {
  return Cutting(std::move(polygons), file).cut();
}

}  // namespace tubefoot
