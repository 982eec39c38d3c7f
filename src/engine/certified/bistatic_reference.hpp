// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "engine/certified/bistatic_enclosure.hpp"
#include "engine/certified/refracted_bins.hpp"
#include "engine/echo/echo.hpp"

namespace tubefoot {

/// Tubes of both ends of a path.
struct BistaticTubes {
  const TubeSet &tx, &rx;
  /// Of an image they are windows, made of what is seen of a mirror: no wall is farther than this from where
  /// curved rays have it.
  std::array<double, 2> off_rad{};
};

/// Encloses the echo of a path whose two ends see the seabed elsewhere, through refracting water: the energy
/// that curved rays bring from true facets. Places of what both see of a facet flattened are places of
/// the true facet; so facets' own edges and textures are certain, and what the enclosures leave open is
///
/// - a factor, from least to most, and half paths, within shift_m of a border between samples;
/// - beam patterns in the directions of rays, which are within turn_rad of those in which places are seen;
/// - which tube sees a place next to a wall between tubes that are not received alike, or whether a window
/// does;
///   whether one is seen beside the edge of what hides it, or where two facets are closer together than
///   ranges may be off;
/// - all that lies behind a facet without a proven ray.
///
/// `beams`, `model` as integrate_echo() has them for that path, `ordinary` what it makes of it. Throws as
/// certify_refracted_echo() of one apex.
RefractedReference certify_refracted_echo(const BistaticSurface& seabed, const BistaticTubes& tubes,
                                          const VisibilityOptions& options, const ReceiveBeams& beams,
                                          const RangeSamples& samples, const EchoModel& model,
                                          const Echo& ordinary, double tolerance);

/// The facets that two ends share, flattened, in their order.
using Flattening = std::function<std::vector<BistaticFacet>(const SharedFootprints& shared)>;

/// What is known of such an echo before it is added up.
struct BistaticParts {
  SharedFootprints shared;
  std::vector<BistaticFacet> bistatic;    ///< as its facets
  std::vector<BistaticEnclosure> facets;  ///< as these
  std::vector<char> is_proven;            ///< as these: the facet, and that both ends see it by one ray
  /// By runs of such facets what they surely have, a list of what loose facets may have, and from
  /// first_ambiguity[end] on of what that end is not certain of.
  std::vector<BinIntervals> bins;
  std::size_t conservative = 0;  ///< where that list of loose facets is
  std::array<std::size_t, 2> first_ambiguity{};
};
/// By bin, in the order of the list.
BinIntervals added_up(std::span<const BinIntervals> parts);

/// Of two receivers, each beside the other (BistaticSurface::beside), which receive one beam by all tubes:
/// what is in ambiguity holds the energies that both receive of a place, and so the root of their product.
/// `ordinary`, `flatten`: by receiver.
std::array<BistaticParts, 2> bistatic_parts(const std::array<BistaticSurface, 2>& seabeds,
                                            const std::array<BistaticTubes, 2>& tubes,
                                            const VisibilityOptions& options, const RangeSamples& samples,
                                            const EchoModel& model, const std::array<Echo, 2>& ordinary,
                                            double tolerance, const std::array<Flattening, 2>& flatten);

}  // namespace tubefoot
