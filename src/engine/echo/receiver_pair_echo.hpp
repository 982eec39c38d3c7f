// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"
#include "engine/scattering/bistatic_facet.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

// Computes the energies of both receivers of a receiver pair and the mean product of their signals. Source:
// docs/notes/signals.md, "Receiver pairs".
namespace tubefoot {

/// Visibility of the transmission of a fan from the two receivers of its receiver pair. A path leads from
/// the transmit apex over a facet to the receive apex.
struct ReceiverPairHistory {
  TubeSet transmit, upper, lower;       ///< tubes of the fan
  SharedFootprints by_upper, by_lower;  ///< common visibility of the transmitter and each receiver
  glm::dvec3 middle_m{0};               ///< middle of the receiver pair, relative to the transmit apex
  /// For bistatic sonars in refracting water: apparent position of each shared facet from the receiver
  /// pair's middle. Empty: facets are at the apparent positions from the transmitter.
  std::vector<BistaticFacet> bistatic_upper{}, bistatic_lower{};
  std::size_t pieces() const { return by_upper.pieces.size() + by_lower.pieces.size(); }
};

/// A facet as each receiver shares it with the transmitter; null: not shared.
struct FacetOfReceivers {
  const SharedFacet *upper, *lower;
};
/// Facets that at least one receiver shares with the transmitter, in ascending order.
std::vector<FacetOfReceivers> facets_of_receivers(const SharedFootprints& by_upper,
                                                  const SharedFootprints& by_lower);

/// Tubes of one fan of a set.
TubeSet tubes_of_fan(const TubeSet& tubes, std::span<const std::uint32_t> fan_of_tube, std::uint32_t fan);
/// The same tubes, moved along the baseline by half of it up (`end` 1) or down (-1), on the grid.
TubeSet moved_along(const TubeSet& tubes, const ReceiverBaseline& receiver_pair, double end,
                    double grid_unit_m);

/// Computes the visibility from the transmitter and from both ends of the receiver pair. The tubes of the
/// ends have the directions of `receive`, the tubes of the middle. In a monostatic sonar these are the
/// transmitter's tubes. `corner_rests`: as SharedDetails::corner_rests.
ReceiverPairHistory trace_receiver_pair(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                                        const VisibilityOptions& options, TubeSet transmit,
                                        const TubeSet& receive, const ReceiverBaseline& receiver_pair,
                                        bool corner_rests = false);

/// The same for bistatic sonars in refracting water (as trace_bistatic()). Both ends see the apparent seabed
/// of the receiver pair's middle.
ReceiverPairHistory trace_receiver_pair(const ApparentPair& pair, const WorldGrid& grid,
                                        const VisibilityOptions& options, TubeSet transmit,
                                        const TubeSet& receive, const ReceiverBaseline& receiver_pair,
                                        const ApparentMap& transmit_water, const ApparentMap& receive_water,
                                        double reference_absorption_db_per_m);

/// Covariances of a fan's two signals per sample. They are the energies of both receivers and the mean
/// product (real and imaginary part). The product is that of the upper signal and the conjugate of the lower
/// one.
struct ReceiverPairEcho {
  std::vector<double> upper_j, lower_j, cross_real_j, cross_imag_j;
};

/// Computes covariances for independent scatterers. Two channels a and b have the covariance
///     R_ab = integral of sqrt(e_a e_b) exp(i k (r_a - r_b)) dA
/// over the surface that both a and b see, in sample k of a and of b. Here e_a is the energy of an area
/// element at receiver a (density.hpp), and the energies are R_aa. Sample k of a receiver contains its half
/// paths (r_transmit + r_a) / 2 from first + k step on. `fan`, `beam`: indices of the fan's patterns in
/// model.patterns. Ranges and phases refer to the true ends of the receiver pair. For the visibility the
/// grid may have moved them by half a unit. The common visibility of both receivers is the intersection of
/// two exact shapes, computed in doubles. In refracting water, facets are the apparent ones of the
/// transmitter, or in a bistatic sonar those of the receiver pair's middle. The baseline must then be
/// multiplied by the reference speed divided by the sound speed at the receivers.
ReceiverPairEcho integrate_receiver_pair_echo(const ReceiverPairHistory& history,
                                              const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                              std::uint32_t beam, const RangeSamples& samples,
                                              const EchoModel& model);

/// The same over mirrors: `history` is that of images, and `receiver_pair` the image of the receiver pair.
/// The legs of the two models contain the losses of their receiver's mirrors. A chain of mirrors shifts the
/// phases of both receivers equally, so the shift cancels.
ReceiverPairEcho integrate_receiver_pair_echo(const ReceiverPairHistory& history,
                                              const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                              std::uint32_t beam, const RangeSamples& samples,
                                              const EchoModel& by_upper, const EchoModel& by_lower);
/// Products only; the energies are 0.
ReceiverPairEcho integrate_receiver_pair_products(const ReceiverPairHistory& history,
                                                  const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                                  std::uint32_t beam, const RangeSamples& samples,
                                                  const EchoModel& by_upper, const EchoModel& by_lower);

}  // namespace tubefoot
