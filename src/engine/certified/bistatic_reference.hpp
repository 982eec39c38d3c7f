// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

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

/// Encloses the signals of a fan's receiver pair in stratified water. The rows are those of
/// certify_receiver_pair_echo(). Each receiver is the end of its own path, and the rays of this path lead to
/// the receiver's true position. Its tubes start at the nearest grid point, with directions relative to the
/// receiver. The energies are those of two paths. The phase between the receivers follows from the travel
/// times along both receive legs.
///
/// `seabeds` and `tubes` belong to one fan, with the upper and the lower receiver as receive ends.
/// `receiver_pair` provides the wavenumber. The patterns of `model` are those of the fan alone. `ordinary`
/// contains the energies of both paths and only guides the work. Throws the errors of
/// certify_refracted_echo().
RefractedReference certify_refracted_receiver_pair(const std::array<BistaticSurface, 2>& seabeds,
                                                   const std::array<BistaticTubes, 2>& tubes,
                                                   const VisibilityOptions& options,
                                                   const ReceiverBaseline& receiver_pair,
                                                   const RangeSamples& samples, const EchoModel& model,
                                                   const std::array<Echo, 2>& ordinary, double tolerance);

}  // namespace tubefoot
