// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the visible polygons that a coverage counts (docs/notes/coverage.md). A straight path gives one
// CoverageLook per fan of the sensor, and each pair of mirror images gives further ones. A monostatic path
// needs one end, a bistatic path has two.

#include "footprints/coverage_looks.hpp"

#include <algorithm>
#include <utility>

#include "engine/echo/receiver_pair_echo.hpp"
#include "geometry/tubes/part_corner_weights.hpp"
#include "run/transmission_ends.hpp"
#include "run/transmission_images.hpp"

namespace tubefoot {
namespace {

std::shared_ptr<const SurfaceParts> parts_of(const FacetMesh& mesh, std::vector<FacetId> base,
                                             std::vector<PartWeights> weights, std::vector<FacetId> name) {
  const auto own = std::make_shared<const FacetMesh>(mesh);
  auto tree = std::make_shared<const SceneTree>(*own, SceneTree::HeightFieldSearch::ignored);
  return std::make_shared<const SurfaceParts>(
      SurfaceParts{own, std::move(tree), 0, std::move(base), std::move(weights), std::move(name)});
}

std::shared_ptr<const SurfaceParts> parts_of(const MovedFacets& moved) {
  return std::make_shared<const SurfaceParts>(
      SurfaceParts{moved.mesh(), moved.tree(), moved.first_moving(), {}, {}, {}});
}

/// Returns the surface mesh of an end as parts of the scene's facets; null if it is the scene's own mesh.
std::shared_ptr<const SurfaceParts> seabed_of(const TransmissionEnd& end) {
  if (end.moved != nullptr) return parts_of(*end.moved);
  if (end.refined == nullptr) return nullptr;
  std::vector<FacetId> name(end.refined->parent.size());
  for (FacetId f = 0; f < name.size(); ++f) name[f] = end.name_of(f);
  return parts_of(end.refined->mesh, end.refined->parent, end.refined->weights, std::move(name));
}

CoverageEnd seen_by(const TransmissionEnd& end, std::shared_ptr<const SurfaceParts> seabed,
                    const VisibilityOptions& options) {
  CoverageEnd result{end.tubes, look(*end.mesh, *end.tree, end.tubes, options), std::move(seabed)};
  for (TubeVisibility& seen : result.seen) seen.occluders = {};  // saves memory, because many looks are kept
  return result;
}

/// Splits a bistatic look into one look per fan, because no receiver records what one fan sends to another.
void add_by_fans(const CoverageLook& all, std::span<const std::uint32_t> fan_of_tx,
                 std::span<const std::uint32_t> fan_of_rx, std::vector<CoverageLook>& looks) {
  const auto of_fan = [](const CoverageEnd& end, std::span<const std::uint32_t> fans, std::uint32_t fan) {
    CoverageEnd own{tubes_of_fan(end.tubes, fans, fan), {}, end.seabed};
    for (std::size_t tube = 0; tube < fans.size(); ++tube)
      if (fans[tube] == fan) own.seen.push_back(end.seen[tube]);
    return own;
  };
  const std::uint32_t fans = fan_of_tx.empty() ? 0 : 1 + *std::ranges::max_element(fan_of_tx);
  for (std::uint32_t fan = 0; fan < fans; ++fan)
    looks.push_back({all.ping, of_fan(all.tx, fan_of_tx, fan), all.nearest, all.farthest, all.continues,
                     of_fan(*all.rx, fan_of_rx, fan)});
}

void add_straight(const Transmission& transmission, std::size_t sensor, std::uint32_t ping,
                  std::vector<CoverageLook>& looks) {
  const TransmissionEnds ends(transmission, sensor, true);
  const VisibilityOptions& options = transmission.request().visibility;
  const auto seabed = seabed_of(ends.tx());
  CoverageLook look{ping, seen_by(ends.tx(), seabed, options),
                    transmission.samples(sensor).first_m / transmission.scene().grid.unit_m(),
                    transmission.sensor(sensor).reach(transmission.scene().grid, transmission.number()),
                    transmission.sensor(sensor).first_sample(transmission.number()) > 0};
  if (!ends.are_two()) {
    looks.push_back(std::move(look));
    return;
  }
  look.rx = seen_by(ends.rx(), ends.apparent_pair() != nullptr ? seabed_of(ends.rx()) : seabed, options);
  const std::vector<std::uint32_t> fans = transmission.sensor(sensor).fan_of_tube(transmission.number());
  add_by_fans(look, fans, fans, looks);
}

/// Converts the surfaces in the views of images to parts of the scene's facets.
class ImageSeabeds {
 public:
  explicit ImageSeabeds(const TransmissionImages& of) : of_(of) {
    if (const RefinedMesh* own = of.surface_mesh().refined(); own != nullptr)
      whole_ = parts_of(own->mesh, own->parent, own->weights, {});
    else if (const MovedFacets* moved = of.surface_mesh().moved(); moved != nullptr)
      whole_ = parts_of(*moved);
  }
  CoverageEnd end_of(const Image& image) const {
    CoverageEnd end{image.windows, image.seen, whole_};
    const PathImages::Parts parts = of_.images().parts_seen_by(image);
    if (parts.of.empty()) return end;
    std::vector<FacetId> base = parts.of;
    std::vector<PartWeights> weights = parts.weights;
    if (const RefinedMesh* own = of_.surface_mesh().refined(); own != nullptr)
      for (FacetId f = 0; f < base.size(); ++f) {
        weights[f] = rounded_part_of_part(own->weights[base[f]], weights[f]);
        base[f] = own->parent[base[f]];
      }
    end.seabed = parts_of(*image.mesh, std::move(base), std::move(weights), parts.name);
    return end;
  }

 private:
  const TransmissionImages& of_;
  std::shared_ptr<const SurfaceParts> whole_;  // null for the scene's own facets
};

void add_over_mirrors(const Transmission& transmission, std::size_t sensor, const PathSettings& settings,
                      std::uint32_t ping, std::vector<CoverageLook>& looks) {
  const TransmissionImages of(transmission, sensor, settings, PathEnds(transmission, sensor), false, true);
  const PathImages& images = of.images();
  const ImageSeabeds seabeds(of);
  const std::vector<std::uint32_t> fan_of_tube =
      transmission.sensor(sensor).fan_of_tube(transmission.number());
  const auto fans_of = [&](const Image& image) {
    std::vector<std::uint32_t> fans;
    for (const std::uint32_t tube : image.own_tube) fans.push_back(fan_of_tube[tube]);
    return fans;
  };
  std::vector<CoverageEnd> sent, received;
  for (const Image& image : images.sent()) sent.push_back(seabeds.end_of(image));
  if (!images.one_place())
    for (const Image& image : images.received()) received.push_back(seabeds.end_of(image));
  for (const auto& [i, j] : images.pairs()) {
    if (!is_order_wanted(transmission.scene(), images.sent()[i].mirrors + images.received()[j].mirrors + 1))
      continue;
    CoverageLook look{ping, sent[i],
                      transmission.samples(sensor).first_m / transmission.scene().grid.unit_m(),
                      transmission.sensor(sensor).reach(transmission.scene().grid, transmission.number()),
                      transmission.sensor(sensor).first_sample(transmission.number()) > 0};
    if (images.one_place() && i == j) {
      looks.push_back(std::move(look));
      continue;
    }
    look.rx = images.one_place() ? sent[j] : received[j];
    add_by_fans(look, fans_of(images.sent()[i]), fans_of(images.received()[j]), looks);
  }
}

}  // namespace

std::vector<CoverageLook> coverage_looks(const Transmission& transmission, std::size_t sensor,
                                         std::uint32_t ping) {
  std::vector<CoverageLook> looks;
  if (is_order_wanted(transmission.scene(), 1)) add_straight(transmission, sensor, ping, looks);
  if (const auto settings = path_settings(transmission, sensor); settings && settings->order > 1)
    add_over_mirrors(transmission, sensor, *settings, ping, looks);
  return looks;
}

}  // namespace tubefoot
