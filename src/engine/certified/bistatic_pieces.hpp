// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/certified/certified_path_integral.hpp"
#include "engine/certified/certified_texture.hpp"
#include "engine/certified/pattern_ambiguity.hpp"
#include "engine/certified/refracted_bins.hpp"

// What two ends share of facets that each sees elsewhere, enclosed piece by piece. Heavy: include only in
// .cpp files.
namespace tubefoot {

/// Of one path: its law, with patterns as its ends have them, samples and tolerance.
class BistaticPieces {
 public:
  /// `model` and `borders_m` outlive it; `target`: by bin, how wide its enclosure may be.
  BistaticPieces(const EchoModel& model, std::span<const double> borders_m, double step_m,
                 std::vector<double> target, double tolerance);

  /// A facet that was proven, for one thread.
  struct OnFacet {
    const BistaticFacet& bistatic;
    const BistaticEnclosure& proven;
    std::uint16_t material;
    ShiftedSamples samples;
    std::unique_ptr<CertifiedPathIntegrator> integrator;
  };
  OnFacet on(FacetId facet, const BistaticFacet& bistatic, const BistaticEnclosure& proven) const;
  /// A piece by its corners as the transmitter sees them (SharedFootprints), received in beams [first,
  /// second).
  void add(OnFacet& on, std::span<const glm::dvec3> corners_m, glm::dvec3 receiver_m,
           std::uint32_t receive_tube, std::pair<std::uint32_t, std::uint32_t> beams,
           BinIntervals& bins) const;

  /// No less than what mirrors and patterns leave of what goes out and comes home in these directions.
  double most_of(std::uint32_t transmit, std::uint32_t beam, const Towards& tx, const Towards& rx) const;

 private:
  const EchoModel& model_;
  std::span<const double> borders_;
  double step_m_, tolerance_;
  std::vector<double> target_;
  std::vector<std::shared_ptr<const CertifiedTexture>> textures_;
  Ball beta_;
};

}  // namespace tubefoot
