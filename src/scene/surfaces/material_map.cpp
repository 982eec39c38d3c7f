// SPDX-License-Identifier: GPL-3.0-or-later

// Assigns materials to facets: it divides facets along the borders of a map and finds the region of each
// part. Ray crossing (even-odd rule) finds the region, with borders sorted into strips.

#include "scene/surfaces/material_map.hpp"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <stdexcept>

#include "files/words.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/surfaces/material_map_sources.hpp"

namespace tubefoot {

MaterialMap::MaterialMap(std::vector<MaterialBorder> borders, std::vector<std::uint16_t> material_of_region,
                         std::uint16_t default_material)
    : borders_(std::move(borders)),
      material_of_region_(std::move(material_of_region)),
      default_material_(default_material) {
  if (borders_.empty()) return;
  lo_y_ = std::numeric_limits<double>::infinity(), hi_y_ = -lo_y_;
  for (const MaterialBorder& border : borders_) {
    lo_y_ = std::min({lo_y_, border.a.y, border.b.y});
    hi_y_ = std::max({hi_y_, border.a.y, border.b.y});
  }
  constexpr std::size_t most_entries = 100'000'000;
  const auto rows_of = [this](const MaterialBorder& border) {
    return std::pair(row(std::min(border.a.y, border.b.y)), row(std::max(border.a.y, border.b.y)));
  };
  for (std::size_t rows = std::min<std::size_t>(borders_.size(), 4096);; rows /= 2) {
    first_.assign(rows + 1, 0);
    std::size_t entries = 0;
    for (const MaterialBorder& border : borders_) {
      const auto [from, to] = rows_of(border);
      entries += to - from + 1;
    }
    if (entries <= most_entries || rows == 1) break;
  }
  for (const MaterialBorder& border : borders_) {
    const auto [from, to] = rows_of(border);
    for (std::size_t r = from; r <= to; ++r) ++first_[r + 1];
  }
  for (std::size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
  list_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t k = 0; k < borders_.size(); ++k) {
    const auto [from, to] = rows_of(borders_[k]);
    for (std::size_t r = from; r <= to; ++r) list_[next[r]++] = k;
  }
}

std::size_t MaterialMap::row(double y) const {
  const std::size_t rows = first_.size() - 1;
  if (!(hi_y_ > lo_y_)) return 0;
  const double part = (y - lo_y_) / (hi_y_ - lo_y_) * static_cast<double>(rows);
  // The order of min and max matters: if the extent of the borders exceeds the range of a double, `part` is
  // NaN.
  return static_cast<std::size_t>(std::min(std::max(0.0, part), static_cast<double>(rows - 1)));
}

std::uint16_t MaterialMap::at(glm::dvec2 place_m) const {
  if (borders_.empty() || !(place_m.y >= lo_y_ && place_m.y <= hi_y_)) return default_material_;
  thread_local std::vector<std::uint32_t> crossed;  // regions, once per crossing
  crossed.clear();
  const std::size_t r = row(place_m.y);
  for (std::uint32_t k = first_[r]; k < first_[r + 1]; ++k) {
    const MaterialBorder& border = borders_[list_[k]];
    const glm::dvec2 &a = border.a, &b = border.b;
    const bool upwards = b.y > place_m.y;
    if ((a.y > place_m.y) == upwards) continue;
    // The ray leads east. It crosses the border if the position lies to the west of the border.
    const double side = (b.x - a.x) * (place_m.y - a.y) - (b.y - a.y) * (place_m.x - a.x);
    if ((side > 0) != upwards) continue;
    crossed.push_back(border.region);
    if (border.other_region != MaterialBorder::none) crossed.push_back(border.other_region);
  }
  std::sort(crossed.begin(), crossed.end(), std::greater<>());
  for (std::size_t i = 0; i < crossed.size();) {
    std::size_t end = i;
    while (end < crossed.size() && crossed[end] == crossed[i]) ++end;
    if ((end - i) % 2 == 1) return material_of_region_[crossed[i]];
    i = end;
  }
  return default_material_;
}

std::uint16_t material_named(const std::string& name, const std::vector<MaterialDescription>& materials,
                             const SourcePlace& place, const std::string& who) {
  const auto found = std::ranges::find(materials, name, &MaterialDescription::name);
  if (found != materials.end()) return static_cast<std::uint16_t>(found - materials.begin());
  std::vector<std::string> names;
  for (const MaterialDescription& material : materials) names.push_back(material.name);
  const std::string_view meant = nearest(name, names);
  throw InputError(place, fmt::format("{}there is no material named \"{}\": {}", who, name.substr(0, 200),
                                      meant.empty() ? "expected " + one_of(names, '"')
                                                    : fmt::format("did you mean \"{}\"?", meant)));
}

void check_border_count(std::size_t borders, const SourcePlace& place) {
  if (borders > most_material_borders)
    throw InputError(
        place,
        fmt::format(
            "the material map has more than {} border segments: simplify the map, or cut it to the terrain",
            most_material_borders));
}

namespace {

MaterialMap make_map(const MaterialMapDescription& map, const MaterialMapSetting& setting) {
  if (const auto* patches = std::get_if<PatchMaterialMap>(&map.kind))
    return patch_material_map(*patches, setting);
  try {
    if (const auto* raster = std::get_if<RasterMaterialMap>(&map.kind))
      return raster_material_map(*raster, setting);
    return polygon_material_map(std::get<PolygonMaterialMap>(map.kind), setting);
  } catch (const InputError& error) {
    throw InputError(map.place, error.what());  // reports both places
  }
}

}  // namespace

TerrainMap::TerrainMap(const TerrainDescription& terrain, const std::vector<MaterialDescription>& materials,
                       const LocalFrame& frame, glm::dvec3 lo_m, glm::dvec3 hi_m)
    : place_(terrain.material_map->place),
      map_(make_map(*terrain.material_map,
                    {materials, material_named(terrain.material, materials, terrain.material_place, ""), lo_m,
                     hi_m, frame, place_})) {
  constexpr double reach_m = 1e9;
  for (const MaterialBorder& border : map_.borders())
    for (const glm::dvec2& p : {border.a, border.b})
      if (!(std::abs(p.x) <= reach_m && std::abs(p.y) <= reach_m))
        throw InputError(place_, fmt::format("the map's border at ({:.6g}, {:.6g}) m is too far from this "
                                             "scene: check the map's coordinate reference system",
                                             p.x, p.y));
  segments_.reserve(map_.borders().size());
  // Neighbouring regions share borders, of which one copy is enough.
  const auto key = [](const PlanSegment& s) { return std::array{s.a.x, s.a.y, s.b.x, s.b.y}; };
  for (const MaterialBorder& border : map_.borders()) {
    const bool forwards = std::pair(border.a.x, border.a.y) < std::pair(border.b.x, border.b.y);
    segments_.push_back({forwards ? border.a : border.b, forwards ? border.b : border.a});
  }
  std::ranges::sort(segments_, {}, key);
  const auto same = [&key](const PlanSegment& s, const PlanSegment& t) { return key(s) == key(t); };
  segments_.erase(std::unique(segments_.begin(), segments_.end(), same), segments_.end());
}

std::vector<std::uint32_t> TerrainMap::apply(ComponentMesh& mesh) const {
  try {
    PlanCut cut = cut_in_plan(mesh.points_m, mesh.triangles, segments_);
    mesh.triangles = std::move(cut.triangles);
    mesh.materials.resize(mesh.triangles.size());
    tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t k) {
      stop_if_wanted();
      const auto& [a, b, c] = mesh.triangles[k];
      mesh.materials[k] = map_.at((mesh.points_m[a] + mesh.points_m[b] + mesh.points_m[c]) / 3.0);
    });
    return std::move(cut.facet);
  } catch (const std::domain_error& error) {
    throw InputError(place_, error.what());
  } catch (const std::length_error& error) {
    throw InputError(place_, error.what());
  }
}

std::size_t apply_material_map(ComponentMesh& mesh, const TerrainDescription& terrain,
                               const std::vector<MaterialDescription>& materials, const LocalFrame& frame) {
  if (!terrain.material_map || mesh.triangles.empty()) return 0;
  glm::dvec3 lo = mesh.points_m.front(), hi = lo;
  for (const glm::dvec3& p : mesh.points_m) lo = glm::min(lo, p), hi = glm::max(hi, p);
  const std::vector<std::uint32_t> facet = TerrainMap(terrain, materials, frame, lo, hi).apply(mesh);
  std::size_t cut = 0;  // number of facets with a second part
  for (std::size_t k = 1; k < facet.size(); ++k)
    cut += facet[k] == facet[k - 1] && (k == 1 || facet[k - 2] != facet[k]);
  return cut;
}

}  // namespace tubefoot
