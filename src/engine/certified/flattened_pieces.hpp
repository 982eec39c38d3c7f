// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/certified/certified_driver.hpp"
#include "engine/certified/certified_path_energy.hpp"
#include "engine/certified/refracted_bins.hpp"

// Encloses the energies of facet pieces that two ends share and see at different apparent positions. For a
// receiver pair, it also encloses the mean product of the two signals. Include this heavy header only in .cpp
// files.
namespace tubefoot {

/// A flattened facet between two ends, with its proven bounds.
struct ProvenFacet {
  const BistaticFacet& bistatic;
  const BistaticEnclosure& proven;
};

/// Integrates the pieces of one facet, for one thread. The facet is proven for one receiver, or for both
/// receivers of a receiver pair. It has the same flattened plane for both (ReceiverPairFlattening), but each
/// receiver has its own factor and ranges. The phase is that of the flattened ranges, with the error of
/// their difference (ReceiveRanges).
class FlattenedPieces {
 public:
  /// The patterns of the request's model have the directions of the ends. All arguments must outlive this
  /// object.
  FlattenedPieces(const CertifiedRequest& request, FacetId facet, const ProvenFacet& one);
  /// The model contains only the patterns of the receiver pair's fan, if any. The targets are those of
  /// receiver_pair_targets().
  FlattenedPieces(const CertifiedRequest& request, FacetId facet, const ProvenFacet& upper,
                  const ProvenFacet& lower);

  /// Adds the energies of a piece that beams [first, second) receive, at least one.
  void add_energies(const ReceivedPiece& piece, std::uint32_t receive_tube,
                    std::pair<std::uint32_t, std::uint32_t> beams, BinIntervals& bins);

  /// Products by sample. Beam 0 is the real part, beam 1 the imaginary part. `ambiguous.hi` may be added to
  /// or subtracted from either part.
  struct Products {
    BinIntervals sure, ambiguous;
  };
  /// Adds the products of the intersection of two pieces in the same transmit tube.
  void add_products(double wavenumber_rad_m, const ReceivedPiece& upper, const ReceivedPiece& lower,
                    Products& found);

 private:
  FlattenedPieces(const CertifiedRequest& request, FacetId facet, const ProvenFacet& upper,
                  const ProvenFacet& lower, double shift_m);
  CertifiedPathEnergy energy_of(const ProvenFacet& facet) const;

  const CertifiedRequest& request_;
  ProvenFacet upper_, lower_;
  std::uint16_t material_;
  ShiftedSamples samples_;
  CertifiedPathIntegrator integrator_;
};

}  // namespace tubefoot
