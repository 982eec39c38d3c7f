// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/reference.hpp"
#include "engine/echo/receiver_pair_echo.hpp"

namespace tubefoot {

/// What the two receivers of a receiver pair receive (receiver_pair_echo.hpp), enclosed: rows upper, lower,
/// real and imaginary part of the cross product in place of beams. Bounds of the last two are held against
/// the geometric mean of both energies. `law.patterns`: those of the fan alone (patterns_of_fan()).
/// `ordinary` is integrate_receiver_pair_echo()'s and only guides the work.
CertifiedEcho certify_receiver_pair_echo(const FacetMesh& mesh, const ReceiverPairHistory& history,
                                         double grid_unit_m, const ReceiverBaseline& receiver_pair,
                                         const RangeSamples& samples, const EchoModel& model,
                                         const ReceiverPairEcho& ordinary, double tolerance);

/// The products alone, by way of mirrors (integrate_receiver_pair_products()): energies are the ordinary
/// ones, with bounds of 0.
CertifiedEcho certify_receiver_pair_products(const FacetMesh& mesh, const ReceiverPairHistory& history,
                                             double grid_unit_m, const ReceiverBaseline& receiver_pair,
                                             const RangeSamples& samples, const EchoModel& by_upper,
                                             const EchoModel& by_lower, const ReceiverPairEcho& ordinary,
                                             double tolerance);

/// What each bound is to be, by row, where the receivers have these energies.
std::vector<double> receiver_pair_targets(std::span<const double> upper_j, std::span<const double> lower_j,
                                          double tolerance);

/// The rows of such an echo.
Echo rows_of(const ReceiverPairEcho& echo);
/// Counts the bins of these rows whose bound is above what was asked for (as compare_with()).
void compare_receiver_pair_with(CertifiedEcho& certified, double tolerance);

}  // namespace tubefoot
