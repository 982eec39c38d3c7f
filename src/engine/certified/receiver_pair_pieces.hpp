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

// Encloses the mean product of a receiver pair's signals in stratified water, piece by piece. The two
// receivers and the transmitter see each facet at different apparent positions. Include this heavy header
// only in .cpp files.
namespace tubefoot {

/// Integrates products for one fan of a receiver pair. A facet has the same flattened plane for both
/// receivers (ReceiverPairFlattening), but each receiver has its own factor and ranges. The phase is that of
/// the flattened ranges, with the error of their difference (ReceiveRanges).
class ReceiverPairPieces {
 public:
  /// `model` contains only the patterns of this fan, if any. `target`: permitted half-width of the products
  /// by sample.
  ReceiverPairPieces(const EchoModel& model, double wavenumber_rad_m, std::span<const double> borders_m,
                     double step_m, std::vector<double> target, double tolerance);

  /// Products by sample. Beam 0 is the real part, beam 1 the imaginary part. `ambiguous.hi` may be added to
  /// or subtracted from either part.
  struct Products {
    BinIntervals sure, ambiguous;
  };
  struct By {
    const BistaticFacet& bistatic;
    const BistaticEnclosure& proven;
  };
  /// State of a facet that is proven for both receivers, for one thread.
  struct OnFacet {
    By upper, lower;
    std::uint16_t material;
    ShiftedSamples samples;
    std::unique_ptr<CertifiedPathIntegrator> integrator;
  };
  OnFacet on(FacetId facet, const By& upper, const By& lower) const;

  /// A piece of the common visibility of transmitter and receiver.
  struct Seen {
    std::span<const glm::dvec3> corners_m;
    glm::dvec3 receiver_m;
  };
  /// Adds the intersection of two pieces in the same transmit tube.
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
