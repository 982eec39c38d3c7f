// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/paths/image_pairs.hpp"
#include "engine/paths/path_echo.hpp"
#include "engine/visibility/bistatic_history.hpp"

// Computes the images of a transmission and their common visibility, for footprints, coverage and audits.
// Source: docs/notes/multiple-paths.md, "Images and apertures".
namespace tubefoot {

/// Images of the transmitter and of the receiver that take part in single scatterings of a transmission, and
/// the common visibility of pairs of them.
class PathImages {
 public:
  /// Uses the images of path_echo(): the apexes and their images in up to `settings.order` - 1 mirrors. All
  /// referenced arguments must outlive this object. Throws the exceptions of path_echo().
  PathImages(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
             const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
             const PathSettings& settings, double absorption_db_per_m, const PathWater* water = nullptr);
  ~PathImages();

  std::span<const Image> sent() const { return sent_; }
  /// The same images as sent() for a monostatic sonar.
  std::span<const Image> received() const { return one_place_ ? sent_ : received_; }
  bool one_place() const { return one_place_; }
  double grid_unit_m() const { return unit_m_; }
  /// Smallest energy factor of a path (PathSettings::least()).
  double least() const { return settings_.least(); }
  /// In a monostatic sonar each pair of images occurs once, because sound travels in both directions.
  std::vector<ImagePair> pairs() const;

  /// Mesh that contains the shared facets. In refracting water this is the cut mesh.
  const FacetMesh& seabed() const;
  bool is_cut() const { return refracted_ != nullptr; }
  /// Facet of the original mesh that contains a facet of seabed().
  FacetId uncut(FacetId facet) const { return refracted_ ? refracted_->uncut(facet) : facet; }
  /// Model and beams between two images, derived from those between the apexes. `model`, `beams` and this
  /// object must outlive the result.
  PairModel model(const Image& sent, const Image& received, const EchoModel& model,
                  const ReceiveBeams& beams) const {
    return PairModel(sent, received, this->sent().front().windows.apex, unit_m_, model, beams,
                     refracted_ ? &seabed() : nullptr);
  }
  /// Original facet, name and position of each facet that an image sees. Images that see the same part (in
  /// isovelocity water a part of the same facet) use the same name. Empty if the image sees the mesh itself.
  /// In refracting water the limits of the PathWater must request weights.
  struct Parts {
    std::vector<FacetId> of, name;
    std::vector<PartWeights> weights;
  };
  Parts parts_seen_by(const Image& image) const;
  FootprintSharer sharer(const Image& sent, const Image& received) const;
  /// Images in up to `settings.order` mirrors from which unscattered sound reaches the receiver. With
  /// `settings.direct` they include the transmitter of a bistatic sonar. If several images lie at one place,
  /// only the first is returned. Empty without `settings.arrivals`. For isovelocity water.
  std::vector<Image> arriving() const;
  /// Common visibility of two images, with the transmit leg to `sent` and the receive leg to `received`.
  BistaticHistory history(const Image& sent, const Image& received) const;

 private:
  const FacetMesh& mesh_;
  double unit_m_, absorption_db_per_m_;
  const PathSettings& settings_;
  bool one_place_;
  std::unique_ptr<RefractedImages> refracted_;
  std::unique_ptr<ImageFinder> finder_;
  std::vector<Image> sent_, received_;
};

}  // namespace tubefoot
