// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "compare/echo_pairs.hpp"
#include "compare/output_models/output_model_file.hpp"

namespace tubefoot {

/// Returns whether a step needs solid angles: a mean or a count.
bool needs_solid_angles(const OutputModel& output_model);

/// Applies the output model to the energies and bounds of the reference, for the sensors of `pairs`, which
/// refer to `reference`. `own_angles` replaces the file `solid_angles`, and has its form with strength 1. The
/// samples of an engine thus determine its means. Throws InputError if a
/// step needs solid angles that are missing or have other pings, beams or samples.
void apply_output_model(const OutputModel& output_model, EchoContents& reference, const EchoPairs& pairs,
                        const std::optional<EchoContents>& own_angles = std::nullopt);

}  // namespace tubefoot
