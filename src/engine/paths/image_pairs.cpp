// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/image_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Facets of the whole mesh that an image sees, each once.
std::vector<FacetId> facets_seen(const Image& image) {
  std::vector<FacetId> facets;
  for (const TubeVisibility& seen : image.seen)
    for (const NamedPiece& piece : seen.pieces)
      facets.push_back(image.origin.empty() ? piece.facet : image.origin[piece.facet]);
  std::sort(facets.begin(), facets.end());
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  return facets;
}

/// Pairs (facet, image that sees this facet), sorted.
std::vector<std::pair<FacetId, std::size_t>> who_sees(std::span<const Image> images) {
  std::vector<std::pair<FacetId, std::size_t>> who;
  for (std::size_t i = 0; i < images.size(); ++i)
    for (const FacetId facet : facets_seen(images[i])) who.emplace_back(facet, i);
  std::sort(who.begin(), who.end());
  return who;
}

std::vector<std::uint32_t> of_windows(const Image& image, std::span<const std::uint32_t> of_tube) {
  std::vector<std::uint32_t> values;
  if (of_tube.empty()) return values;
  for (const std::uint32_t tube : image.own_tube) values.push_back(of_tube[tube]);
  return values;
}

}  // namespace

PairModel::PairModel(const Image& sent, const Image& received, GridPoint true_apex, double grid_unit_m,
                     const EchoModel& of_apexes, const ReceiveBeams& all, const FacetMesh* seabed)
    : model(of_apexes),
      beam(of_windows(received, all.of_tube)),
      from(of_windows(sent, all.fan_of_transmit_tube)),
      to(of_windows(received, all.fan_of_receive_tube)),
      beams{all.count, beam, from, to} {
  if (seabed != nullptr) model.material = seabed->material;
  model.path.rx = received.leg;
  model.path.tx = sent.leg;
  const GridPoint apex = sent.windows.apex;
  model.path.tx.apex_m = of_apexes.path.tx.apex_m + displacement_m(true_apex, apex, grid_unit_m);
  if (of_apexes.patterns == nullptr) return;
  patterns = *of_apexes.patterns;
  patterns.fan_of_tube = of_windows(received, of_apexes.patterns->fan_of_tube);
  patterns.beams_of_tube.clear();
  for (const std::uint32_t tube : received.own_tube)
    patterns.beams_of_tube.push_back(of_apexes.patterns->beams_of_tube[tube]);
  model.patterns = &patterns;
}

std::vector<ImagePair> pairs_of_images(std::span<const Image> sent, std::span<const Image> received,
                                       bool one_place, int order, double least, std::size_t most) {
  std::vector<ImagePair> pairs;
  const auto who = who_sees(received);
  std::vector<std::size_t> same, last(received.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    stop_if_wanted();
    same.clear();
    for (const FacetId facet : facets_seen(sent[i]))
      for (auto at = std::lower_bound(who.begin(), who.end(), std::pair(facet, one_place ? i : 0));
           at != who.end() && at->first == facet; ++at)
        if (std::exchange(last[at->second], i) != i) same.push_back(at->second);
    std::sort(same.begin(), same.end());
    for (const std::size_t j : same) {
      const std::uint32_t mirrors = sent[i].mirrors + received[j].mirrors;
      if (mirrors > 0 && int(mirrors) < order && sent[i].largest * received[j].largest > least)
        pairs.push_back({i, j});
    }
    if (pairs.size() > most)
      throw std::length_error(
          fmt::format("there are more than {} pairs of images that see the same facets: use fewer and larger "
                      "mirror facets, a lower order, or an earlier cut-off",
                      most));
  }
  return pairs;
}

}  // namespace tubefoot
