// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "compare/echo_pairs.hpp"
#include "compare/output_models/output_model_file.hpp"

namespace tubefoot {

/// Applies the output model to the energies and bounds of the reference, for the sensors of `pairs`, which
/// refer to `reference`. Throws InputError if a step needs solid angles that are missing or have other
/// pings, beams or samples.
void apply_output_model(const OutputModel& output_model, EchoContents& reference, const EchoPairs& pairs);

}  // namespace tubefoot
