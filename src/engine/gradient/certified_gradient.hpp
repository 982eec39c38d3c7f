// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"

namespace tubefoot {

/// Enclosures of derivatives: each one lies within `bound` of `value`. A bound may be infinite.
struct CertifiedDerivatives {
  std::vector<std::vector<double>> value, bound;  ///< [parameter][beam][sample]
};

/// Encloses the derivatives of echo_derivatives() in ball arithmetic (docs/notes/gradients.md, section 5).
/// The history must come from an exact arithmetic. All doubles of `model`, `samples` and `parameters` count
/// as exact numbers. The velocities of rotations follow from EchoParameter::turn. If the foot point of the
/// apex lies on a range border, a derivative may be one-sided. Its enclosure then contains both sides.
/// Throws std::invalid_argument as echo_derivatives() does. Patterns, textures and scattering models other
/// than Lambert's law are rejected too.
CertifiedDerivatives certified_derivatives(const FacetMesh& mesh, const History& history,
                                           const ReceiveBeams& beams, const RangeSamples& samples,
                                           const EchoModel& model, std::span<const EchoParameter> parameters);

}  // namespace tubefoot
