// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/path_images.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "geometry/tubes/part_corner_weights.hpp"
#include "geometry/tubes/window_tubes.hpp"

// Computes the images of a transmission with up to order - 1 mirrors and the footprints that pairs of them
// share. In refracting water RefractedImages finds the images, otherwise ImageFinder. Source:
// docs/notes/multiple-paths.md, "Images and apertures".

namespace tubefoot {

PathImages::PathImages(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                       const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                       const PathSettings& settings, double absorption_db_per_m, const PathWater* water)
    : mesh_(mesh),
      unit_m_(grid_unit_m),
      absorption_db_per_m_(absorption_db_per_m),
      settings_(settings),
      one_place_(transmit == receive) {
  const int most_mirrors = settings.order - 1;
  if (water != nullptr) {
    std::vector<TubeSet> ends{std::move(transmit)};
    if (!one_place_) ends.push_back(std::move(receive));
    refracted_ = std::make_unique<RefractedImages>(mesh, tree, options, settings.mirrors, settings.least(),
                                                   settings.most_images, absorption_db_per_m, *water,
                                                   std::move(ends), settings.order);
    sent_ = refracted_->images_of(0);
    if (!one_place_) received_ = refracted_->images_of(1);
    return;
  }
  finder_ = std::make_unique<ImageFinder>(mesh, tree, options, settings.mirrors, settings.least(),
                                          settings.most_images);
  sent_ = finder_->images_of(std::move(transmit), most_mirrors);
  if (!one_place_) received_ = finder_->images_of(std::move(receive), most_mirrors);
}

PathImages::~PathImages() = default;

std::vector<ImagePair> PathImages::pairs() const {
  return pairs_of_images(sent(), received(), one_place_, settings_.order, settings_.least(),
                         100 * settings_.most_images);
}

const FacetMesh& PathImages::seabed() const { return refracted_ ? refracted_->seabed() : mesh_; }

PathImages::Parts PathImages::parts_seen_by(const Image& image) const {
  Parts parts;
  if (image.mesh == &mesh_) return parts;
  parts.name.assign(image.origin.begin(), image.origin.end());
  if (refracted_) {
    for (const FacetId facet : parts.name) parts.of.push_back(refracted_->uncut(facet));
    parts.weights = refracted_->weights(image);
    return parts;
  }
  parts.of = parts.name;
  // The scene of the image was clipped in the same way.
  std::vector<FacetId> cut = parts.of;
  cut.erase(std::unique(cut.begin(), cut.end()), cut.end());
  std::vector<std::array<PartCorner, 3>> corners;
  in_front_of(*image.last, mesh_, cut, &corners);
  for (const auto& corner : corners) parts.weights.push_back(weights_of(corner, all_of_it));
  return parts;
}

FootprintSharer PathImages::sharer(const Image& sent, const Image& received) const {
  if (refracted_) return FootprintSharer(sent.look(), received.look(), unit_m_);
  return FootprintSharer(mesh_, sent.look(), received.look(), unit_m_);
}

std::vector<Image> PathImages::arriving() const {
  std::vector<Image> arriving;
  if (!settings_.arrivals || refracted_) return arriving;
  const TubeSet& receive = received().front().windows;
  const auto any_holds = [](const TubeSet& tubes, GridPoint along, double slack_rad) {
    for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube)
      if (holds(tubes, tube, along, slack_rad)) return true;
    return false;
  };
  std::set<GridPoint> from;
  for (Image& image : finder_->images_of(sent_.front().windows, settings_.order, {{receive.apex}})) {
    if (image.mirrors == 0 && (one_place_ || !settings_.direct)) continue;
    const GridPoint apex = image.windows.apex, along = receive.apex - apex;
    if (along == GridPoint{} || from.contains(apex) || !any_holds(image.windows, along, window_border_rad) ||
        !any_holds(receive, GridPoint{} - along, 0) || !reaches(image, receive.apex))
      continue;
    from.insert(apex);
    arriving.push_back(std::move(image));
  }
  return arriving;
}

BistaticHistory PathImages::history(const Image& sent, const Image& received) const {
  BistaticHistory history{sent.windows, received.windows, unit_m_, {}};
  history.shared = &sent == &received && !refracted_ ? shared_with_itself(mesh_, sent.look(), unit_m_)
                                                     : sharer(sent, received).all();
  if (refracted_)
    history.bistatic =
        bistatic_facets(history.shared, refracted_->seabed(), refracted_->end_of(sent),
                        refracted_->end_of(received), refracted_->grid(), absorption_db_per_m_);
  return history;
}

}  // namespace tubefoot
