// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/paths/image_pairs.hpp"
#include "engine/paths/path_echo.hpp"
#include "engine/visibility/bistatic_history.hpp"

// What paths over mirrors see, for who tells it or proves it. docs/paths.md
namespace tubefoot {

/// The images between which a transmission is scattered once, of its transmitter and of its receiver, and
/// what pairs of them see together.
class PathImages {
 public:
  /// As path_echo() has them: between apexes and images in up to `settings.order` - 1 mirrors. What is
  /// referred to must outlive it. Throws as path_echo().
  PathImages(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
             const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
             const PathSettings& settings, double absorption_db_per_m, const PathWater* water = nullptr);
  ~PathImages();

  std::span<const Image> sent() const { return sent_; }
  /// The very same for a sonar in one place.
  std::span<const Image> received() const { return one_place_ ? sent_ : received_; }
  bool one_place() const { return one_place_; }
  double grid_unit_m() const { return unit_m_; }
  /// The least part of the energy that paths leave (PathSettings::least()).
  double least() const { return settings_.least(); }
  /// Of one place each two images are a pair once: sound goes both ways.
  std::vector<ImagePair> pairs() const;

  /// The facets that shared ones are of: the mesh, or in refracting water what it was cut into.
  const FacetMesh& seabed() const;
  bool is_cut() const { return refracted_ != nullptr; }
  /// By facet of that: the one of the mesh that it is, or is a part of.
  FacetId uncut(FacetId facet) const { return refracted_ ? refracted_->uncut(facet) : facet; }
  /// Of what `model` and `beams` are between the apexes; they and this outlive it.
  PairModel model(const Image& sent, const Image& received, const EchoModel& model,
                  const ReceiveBeams& beams) const {
    return PairModel(sent, received, this->sent().front().windows.apex, unit_m_, model, beams,
                     refracted_ ? &seabed() : nullptr);
  }
  /// Facets that an image sees as parts of those of the mesh: of which, where they lie on it, and what all
  /// images that see the same (in isovelocity water, a part of the same) call it. Empty where it sees the
  /// mesh itself. In refracting water of a PathWater whose limits want weights.
  struct Parts {
    std::vector<FacetId> of, name;
    std::vector<PartWeights> weights;
  };
  Parts parts_seen_by(const Image& image) const;
  FootprintSharer sharer(const Image& sent, const Image& received) const;
  /// Images in up to `settings.order` mirrors from which what is sent comes to the receiver without
  /// scattering, and with `settings.direct` the transmitter that a separate receiver receives; of two at one
  /// place the first. None without `settings.arrivals`. In isovelocity water.
  std::vector<Image> arriving() const;
  /// What both see, over the transmit leg to the one and home from the other.
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
