// SPDX-License-Identifier: GPL-3.0-or-later
// Names the systematic errors of an aligned candidate, with sizes, standard errors and shares.
#pragma once

#include "compare/diagnosis/diagnosis.hpp"
#include "compare/diagnosis/level_differences.hpp"
#include "compare/diagnosis/near_edge.hpp"
#include "compare/diagnosis/residuals.hpp"

namespace tubefoot {

/// A candidate after alignment. The spans and references must outlive the call of find_errors().
struct AlignedCandidate {
  const DiagnosisInput& input;
  const Fan& fan;
  std::span<const double> reference_j;          ///< of the selected pings
  std::span<const double> model_reference_j;    ///< with the levels of the materials of the candidate
  std::span<const double> candidate_j;          ///< without any correction
  const PingGains& gains;                       ///< of the selected pings
  const std::vector<MaterialLevel>& materials;  ///< empty if they do not differ
  const Residual& residual;                     ///< after all corrections
  EvenSteps steps;
};

/// Adds the findings, the sizes that were not resolved, and the error measures to `result`, whose alignment
/// and noise floor are set.
void find_errors(const AlignedCandidate& aligned, Diagnosis& result);

}  // namespace tubefoot
