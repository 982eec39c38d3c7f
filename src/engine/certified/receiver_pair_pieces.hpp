// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/certified/certified_path_integral.hpp"
#include "engine/certified/certified_texture.hpp"
#include "engine/certified/refracted_bins.hpp"

// The mean product of what two receivers receive of facets that they see elsewhere than the transmitter,
// enclosed piece by piece. Heavy: include only in .cpp files.
namespace tubefoot {

/// Of one fan of a receiver pair. On a facet that is laid out alike for both receivers
/// (ReceiverPairFlattening) each has its factor and its ranges; the phase is that of those laid out but for
/// their differences' (ReceiveRanges).
class ReceiverPairPieces {
 public:
  /// `model`: with the fan's patterns alone, if with any. `target`: by sample, how wide products may be.
  ReceiverPairPieces(const EchoModel& model, double wavenumber_rad_m, std::span<const double> borders_m,
                     double step_m, std::vector<double> target, double tolerance);

  /// By sample (beam 0), and of the second beam the imaginary part. `ambiguous.hi`: either part may have so
  /// much more or less besides.
  struct Products {
    BinIntervals sure, ambiguous;
  };
  struct By {
    const BistaticFacet& bistatic;
    const BistaticEnclosure& proven;
  };
  /// A facet that was proven for both, for one thread.
  struct OnFacet {
    By upper, lower;
    std::uint16_t material;
    ShiftedSamples samples;
    std::unique_ptr<CertifiedPathIntegrator> integrator;
  };
  OnFacet on(FacetId facet, const By& upper, const By& lower) const;

  /// A piece of the transmitter's and a receiver's common visibility.
  struct Seen {
    std::span<const glm::dvec3> corners_m;
    glm::dvec3 receiver_m;
  };
  /// What two pieces of the transmitter's same tube have in common.
  void add(OnFacet& on, const Seen& upper, const Seen& lower, Products& found) const;

 private:
  const EchoModel& model_;
  double wavenumber_;
  std::span<const double> borders_;
  double step_m_, tolerance_;
  std::vector<double> target_;
  std::vector<std::shared_ptr<const CertifiedTexture>> textures_;
  Ball beta_;
};

}  // namespace tubefoot
