// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/certified/bistatic_reference.hpp"

namespace tubefoot {

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
