// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/reference.hpp"
#include "engine/echo/receiver_pair_echo.hpp"

namespace tubefoot {

/// Encloses the signals of a receiver pair (receiver_pair_echo.hpp). In place of beams, the rows are upper
/// energy, lower energy, real part and imaginary part of the cross product. Bounds of the last two rows are
/// compared with the geometric mean of both energies. The patterns of `model` are those of the fan alone
/// (patterns_of_fan()). `ordinary` is the result of integrate_receiver_pair_echo() and only guides the work.
CertifiedEcho certify_receiver_pair_echo(const FacetMesh& mesh, const ReceiverPairHistory& history,
                                         double grid_unit_m, const ReceiverBaseline& receiver_pair,
                                         const RangeSamples& samples, const EchoModel& model,
                                         const ReceiverPairEcho& ordinary, double tolerance);

/// Encloses only the products over mirrors (integrate_receiver_pair_products()). Energies are the ordinary
/// ones, with bounds of 0.
CertifiedEcho certify_receiver_pair_products(const FacetMesh& mesh, const ReceiverPairHistory& history,
                                             double grid_unit_m, const ReceiverBaseline& receiver_pair,
                                             const RangeSamples& samples, const EchoModel& by_upper,
                                             const EchoModel& by_lower, const ReceiverPairEcho& ordinary,
                                             double tolerance);

/// Returns the required bounds by row, for these energies of the receivers.
std::vector<double> receiver_pair_targets(std::span<const double> upper_j, std::span<const double> lower_j,
                                          double tolerance);

/// The same for the rows of an echo.
std::vector<double> receiver_pair_row_targets(const Echo& rows, double tolerance);

/// Returns the rows of such an echo.
Echo rows_of(const ReceiverPairEcho& echo);
/// Counts the bins of these rows whose bound exceeds the requested one, as compare_with() does.
void compare_receiver_pair_with(CertifiedEcho& certified, double tolerance);

}  // namespace tubefoot
