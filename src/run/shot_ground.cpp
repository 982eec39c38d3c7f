// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/shot_ground.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "files/memory_at_hand.hpp"
#include "run/refined_bed_file.hpp"
#include "run/refraction.hpp"
#include "run/shot.hpp"

namespace tubefoot {
namespace {

/// A facet of a refined bed with its share of vertices and tree takes some 60 bytes.
constexpr RefinementLimits most_offline{.facets = 100'000'000}, most_a_shot{.facets = 20'000'000};

bool has_relief(const Scene& scene) {
  return std::any_of(scene.relief.begin(), scene.relief.end(), [](const auto& r) { return r != nullptr; });
}

std::size_t facets_of(const Scene& scene) {
  std::size_t sum = 0;
  for (const ComponentReport& component : scene.report.components) sum += component.facets;
  return sum;
}

double cell_of(const Scene& scene) {
  const RefinementDescription& keys = scene.description.refinement;
  if (keys.cell_m) return *keys.cell_m;
  double finest = 0;
  for (const auto& field : scene.relief)
    if (field) finest = finest > 0 ? std::min(finest, field->finest_m()) : field->finest_m();
  return finest;
}

void check_cell(const Scene& scene, double cell_m) {
  const SourcePlace& place = scene.description.refinement.place;
  constexpr double least_units = 16;
  if (!(cell_m >= least_units * scene.grid.unit_m()))
    throw InputError(place, fmt::format("cells of {:.3g} m are too fine for a grid of {:.3g} m: 'cell_m' "
                                        "must be {:.3g} or more",
                                        cell_m, scene.grid.unit_m(), least_units * scene.grid.unit_m()));
  double longest2 = 0;
  for (const auto& f : scene.mesh.facets)
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 d = scene.grid.to_metres(scene.mesh.vertices[f[k]]) -
                           scene.grid.to_metres(scene.mesh.vertices[f[(k + 1) % 3]]);
      longest2 = std::max(longest2, glm::dot(d, d));
    }
  for (const TiledTerrain& terrain : scene.tiled)
    if (terrain.tiles) longest2 = std::max(longest2, std::pow(terrain.tiles->longest_edge_m(), 2));
  // Neighbours of different size take a few halvings more.
  const double finest = std::sqrt(longest2) / std::exp2(deepest_refinement - 4);
  if (cell_m < finest)
    throw InputError(place,
                     fmt::format("a facet with an edge of {:.6g} m cannot be refined to cells of {:.3g} "
                                 "m: give the terrain smaller facets, or a 'cell_m' of {:.3g} or more",
                                 std::sqrt(longest2), cell_m, finest));
}

}  // namespace

std::unique_ptr<Ground> relief_ground(const Scene& scene) {
  const RefinementDescription& keys = scene.description.refinement;
  if (!has_relief(scene))
    throw InputError(keys.place, keys.mode == "off"
                                     ? "[relief] says mode = \"off\": there is nothing to refine"
                                     : "no material of the scene has [[materials.relief]]: there is nothing "
                                       "to refine");
  const double cell_m = cell_of(scene);
  check_cell(scene, cell_m);
  return std::make_unique<Ground>(
      scene.mesh, scene.grid, scene.relief,
      GroundSettings{cell_m, keys.displace == "normal" ? Displacement::normal : Displacement::vertical,
                     keys.tolerance.value_or(GroundSettings().tolerance)});
}

RefinedMesh refined_bed(const Scene& scene, const Ground& ground) {
  const std::size_t count = ground.uniform_count();
  const auto too_many = [&] {
    return InputError(scene.description.refinement.place,
                      fmt::format("a bed in cells of {:.3g} m has {} facets, more than {}: use mode = "
                                  "\"online\", a larger 'cell_m' or a smaller terrain",
                                  ground.settings().cell_m, count, most_offline.facets));
  };
  if (count > most_offline.facets) throw too_many();
  require_memory(bytes_a_facet * static_cast<double>(count), scene.description.refinement.place,
                 fmt::format("a bed in cells of {:.3g} m and its {} facets", ground.settings().cell_m, count),
                 "use mode = \"online\", a larger 'cell_m' or a smaller terrain");
  try {
    return ground.everywhere(most_offline);
  } catch (const RefinementTooLarge&) {
    throw too_many();
  }
}

void lay_relief(Site& site) {
  Scene& scene = site.scene;
  if (!has_relief(scene)) return;
  const RefinementDescription& keys = scene.description.refinement;
  std::unique_ptr<Ground> ground = relief_ground(scene);
  site.relief.cell_m = ground->settings().cell_m;
  site.relief.base_facets = facets_of(scene);
  if (!site.is_tiled()) site.relief.uniform_facets = ground->uniform_count();
  site.relief.omitted = std::make_shared<const OmittedRelief>(ground->omitted());
  if (keys.mode == "online") {
    site.ground = std::move(ground);
    return;
  }
  RefinedMesh bed =
      keys.file ? read_refined_bed(*keys.file, keys.file_place, scene, *ground) : refined_bed(scene, *ground);
  ground.reset();
  scene.mesh = std::move(bed.mesh);
  site.relief.parent = std::move(bed.parent);
}

RefinedMesh relief_seen_by(const Shot& shot, std::span<const Look> looks, bool weights) {
  try {
    return shot.site().ground->seen_by(looks, {most_a_shot.facets, weights});
  } catch (const RefinementTooLarge&) {
    throw InputError(shot.scene().description.refinement.place,
                     fmt::format("{} looks at more than {} facets of its ground: use a larger 'cell_m' or "
                                 "'tolerance'",
                                 shot.name(), most_a_shot.facets));
  }
}

ShotGround ground_of(const Shot& shot, bool weights) {
  const Site& site = shot.site();
  if (site.scene.water->refracts()) return refracted_ground_of(shot, weights);
  if (!site.ground) return ShotGround(site);
  std::vector<TubeSet> tubes{shot.tubes()};
  if (shot.has_receiver_apart()) tubes.push_back(shot.receive_tubes(shot.first()));
  return ShotGround(site, relief_seen_by(shot, shot.looks(tubes), weights));
}

ShotGround ground_in_line_with(const Site& site, glm::dvec3 place_m) {
  if (!site.ground) return ShotGround(site);
  return ShotGround(site, site.ground->in_line_with(place_m));
}

}  // namespace tubefoot
