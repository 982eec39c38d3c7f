// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/bistatic_reference.hpp"

namespace tubefoot {

/// Encloses what the two receivers of a fan's receiver pair receive through refracting water: rows as
/// certify_receiver_pair_echo() has them. Each receiver is an end of a path of its own, whose rays lead to
/// its true place; tubes look from the grid point next to it, in directions about it. So energies are those
/// of two paths, and the phase between them is that of the times along both arcs home.
///
/// `seabeds`, `tubes`: of one fan, with the upper and the lower receiver as their homes; `receiver_pair`: its
/// wavenumber. `law.patterns`: those of the fan alone. `ordinary`: energies of either path, to guide the
/// work. Throws as certify_refracted_echo().
RefractedReference certify_refracted_receiver_pair(const std::array<BistaticSurface, 2>& seabeds,
                                                   const std::array<BistaticTubes, 2>& tubes,
                                                   const VisibilityOptions& options,
                                                   const ReceiverBaseline& receiver_pair,
                                                   const RangeSamples& samples, const EchoModel& model,
                                                   const std::array<Echo, 2>& ordinary, double tolerance);

}  // namespace tubefoot
