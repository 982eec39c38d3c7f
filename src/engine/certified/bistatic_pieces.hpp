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

// Encloses the energies of facet pieces that two ends share and see at different apparent positions. Include
// this heavy header only in .cpp files.
namespace tubefoot {

/// Integrates the pieces of one path with its scattering models, its patterns in the directions of its ends,
/// its samples and its tolerance.
class BistaticPieces {
 public:
  /// `model` and `borders_m` must outlive this object. `target` contains the permitted half-width of each
  /// bin's enclosure.
  BistaticPieces(const EchoModel& model, std::span<const double> borders_m, double step_m,
                 std::vector<double> target, double tolerance);

  /// State of a proven facet for one thread.
  struct OnFacet {
    const BistaticFacet& bistatic;
    const BistaticEnclosure& proven;
    std::uint16_t material;
    ShiftedSamples samples;
    std::unique_ptr<CertifiedPathIntegrator> integrator;
  };
  OnFacet on(FacetId facet, const BistaticFacet& bistatic, const BistaticEnclosure& proven) const;
  /// Adds a piece that beams [first, second) receive. The corners are those that the transmitter sees
  /// (SharedFootprints).
  void add(OnFacet& on, std::span<const glm::dvec3> corners_m, glm::dvec3 receiver_m,
           std::uint32_t receive_tube, std::pair<std::uint32_t, std::uint32_t> beams,
           BinIntervals& bins) const;

  /// Returns an upper bound of the product of mirror losses and patterns in these directions.
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
