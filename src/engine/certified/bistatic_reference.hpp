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
  /// Tubes of an image are apertures, which are made of the visible parts of a mirror. For refracted rays,
  /// each wall may be displaced by at most this angle.
  std::array<double, 2> off_rad{};
};

/// Encloses the echo of a path whose two ends see the seabed at different apparent positions in stratified
/// water. It is the energy that refracted rays bring from the true facets. Points of a flattened facet are
/// points of the true facet, so the facets' own edges and textures are certain. The enclosures leave these
/// uncertainties:
///
/// (1) Each facet has an interval of factors. Half path lengths are uncertain within shift_m of a border
///     between samples.
/// (2) Directions of rays differ by at most turn_rad from the apparent directions, which changes beam
///     patterns.
/// (3) Next to a wall between tubes with different beams, it is uncertain which tube sees a point. The same
///     applies to the edges of apertures.
/// (4) Visibility is uncertain next to occluding edges, and where two facets are closer than their range
///     errors.
/// (5) Everything behind a facet without a proven ray is unknown.
///
/// `beams` and `model` are those of integrate_echo() for this path, and `ordinary` is its result. Throws the
/// errors of certify_refracted_echo() for one apex.
RefractedReference certify_refracted_echo(const BistaticSurface& seabed, const BistaticTubes& tubes,
                                          const VisibilityOptions& options, const ReceiveBeams& beams,
                                          const RangeSamples& samples, const EchoModel& model,
                                          const Echo& ordinary, double tolerance);

/// Function that flattens the facets that two ends share, in their order.
using Flattening = std::function<std::vector<BistaticFacet>(const SharedFootprints& shared)>;

/// Enclosed parts of a bistatic echo before summation.
struct BistaticParts {
  SharedFootprints shared;
  std::vector<BistaticFacet> bistatic;    ///< in the order of the facets of `shared`
  std::vector<BistaticEnclosure> facets;  ///< in the same order
  std::vector<char> is_proven;  ///< in the same order: the facet is proven, and both ends see it by one ray
  /// Bins of the certain parts by runs of proven facets, then bins of the conservative facets. From
  /// first_ambiguity[end] on, the list contains the bins of the ambiguities at this end.
  std::vector<BinIntervals> bins;
  std::size_t conservative = 0;  ///< index of the conservative facets' bins
  std::array<std::size_t, 2> first_ambiguity{};
};
/// Sums the bins in the order of the list.
BinIntervals added_up(std::span<const BinIntervals> parts);

/// Computes the parts of two neighbouring receivers (BistaticSurface::beside) that receive one beam from all
/// tubes. Ambiguities contain the larger of the energies that the two receivers receive from a point. They
/// therefore also bound the geometric mean of the energies. `ordinary` and `flatten` contain one element per
/// receiver.
std::array<BistaticParts, 2> bistatic_parts(const std::array<BistaticSurface, 2>& seabeds,
                                            const std::array<BistaticTubes, 2>& tubes,
                                            const VisibilityOptions& options, const RangeSamples& samples,
                                            const EchoModel& model, const std::array<Echo, 2>& ordinary,
                                            double tolerance, const std::array<Flattening, 2>& flatten);

}  // namespace tubefoot
