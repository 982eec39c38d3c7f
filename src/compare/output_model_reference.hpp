// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "compare/echo_pairs.hpp"
#include "compare/output_models/output_model_file.hpp"

namespace tubefoot {

/// Puts what the output model makes of the reference's energies and bounds in their place, for the sensors of
/// `pairs`, which are of `reference`. Throws InputError where a step lacks solid angles, or where these are
/// not of the reference's pings, beams and samples.
void apply_output_model(const OutputModel& output_model, EchoContents& reference, const EchoPairs& pairs);

}  // namespace tubefoot
