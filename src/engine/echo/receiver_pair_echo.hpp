// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"
#include "engine/surface/bistatic_facet.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

// Two receivers on a receiver pair: what each of them receives, and how much alike that is. docs/sensors.md
namespace tubefoot {

/// What a fan's transmission met that the two receivers on its receiver pair see. A path is transmit apex ->
/// facet -> receive apex.
struct ReceiverPairHistory {
  TubeSet transmit, upper, lower;       ///< of the fan
  SharedFootprints by_upper, by_lower;  ///< what the transmitter and either receiver see
  glm::dvec3 middle_m{0};               ///< of the receiver pair, relative to the transmit apex
  /// In refracting water with the transmitter elsewhere: by shared facet of either receiver, where else the
  /// receiver pair's middle sees it. Empty: facets are where the transmitter sees them.
  std::vector<BistaticFacet> bistatic_upper{}, bistatic_lower{};
  std::size_t pieces() const { return by_upper.pieces.size() + by_lower.pieces.size(); }
};

/// The tubes of one fan of a set.
TubeSet tubes_of_fan(const TubeSet& tubes, std::span<const std::uint32_t> fan_of_tube, std::uint32_t fan);
/// From one apex to another.
glm::dvec3 way_m(GridPoint from, GridPoint to, double grid_unit_m);
/// The same tubes half a baseline up the receiver pair (`end` 1) or down (-1), on the grid.
TubeSet moved_along(const TubeSet& tubes, const ReceiverBaseline& receiver_pair, double end,
                    double grid_unit_m);

/// Visibility from the transmitter and from both ends of the receiver pair, whose tubes look in the
/// directions of `receive`, the tubes of its middle: the transmitter's, unless that is elsewhere.
ReceiverPairHistory trace_receiver_pair(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                                        const VisibilityOptions& options, TubeSet transmit,
                                        const TubeSet& receive, const ReceiverBaseline& receiver_pair);

/// The same in refracting water with the transmitter elsewhere (as trace_bistatic()): both ends look at the
/// seabed as it appears from the receiver pair's middle.
ReceiverPairHistory trace_receiver_pair(const ApparentPair& pair, const WorldGrid& grid,
                                        const VisibilityOptions& options, TubeSet transmit,
                                        const TubeSet& receive, const ReceiverBaseline& receiver_pair,
                                        const ApparentMap& transmit_water, const ApparentMap& receive_water,
                                        double reference_absorption_db_per_m);

/// Covariances of a fan's two signals by sample: energies of the upper and of the lower receiver, and the
/// real and the imaginary part of the mean product of the upper one with the conjugate of the lower one.
struct ReceiverPairEcho {
  std::vector<double> upper_j, lower_j, cross_real_j, cross_imag_j;
};

/// Of scatterers that are independent of each other, two channels a and b have the covariance
///     R_ab = integral over what a and b both see, in sample k of a and of b, of
///            sqrt(e_a e_b) exp(i k (r_a - r_b)) dA,
/// with e_a the energy that an area element sends by way of receiver a (density.hpp;
/// energies are a = b). Sample k of a receiver holds the half paths (r_transmit + r_a) / 2 from first + k
/// step on, its own. `fan`, `beam`: which patterns of law.patterns are the fan's. Ranges and phases are those
/// from the receiver pair's true ends, which the grid may have moved by half a unit for the visibility. What
/// both receivers see is the intersection of the two exact shapes, in doubles. In refracting water facets are
/// the transmitter's apparent ones, or those of the receiver pair's middle where that is elsewhere; its axis
/// is then to be as much longer as sound there is slower than that by which ranges are measured.
ReceiverPairEcho integrate_receiver_pair_echo(const ReceiverPairHistory& history,
                                              const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                              std::uint32_t beam, const RangeSamples& samples,
                                              const EchoModel& model);

/// The same by way of mirrors: `history` is that of images, `receiver_pair` the image of the receiver pair,
/// and the legs of the two laws have the losses of their own receiver's mirrors. A chain of mirrors turns the
/// phases of both receivers alike, so that they cancel.
ReceiverPairEcho integrate_receiver_pair_echo(const ReceiverPairHistory& history,
                                              const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                              std::uint32_t beam, const RangeSamples& samples,
                                              const EchoModel& by_upper, const EchoModel& by_lower);
/// Of these the products alone (energies are 0).
ReceiverPairEcho integrate_receiver_pair_products(const ReceiverPairHistory& history,
                                                  const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                                  std::uint32_t beam, const RangeSamples& samples,
                                                  const EchoModel& by_upper, const EchoModel& by_lower);

}  // namespace tubefoot
