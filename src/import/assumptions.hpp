// SPDX-License-Identifier: GPL-3.0-or-later
// What was declared or assumed of a picture, held against the truth.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compare/measures/echo_errors.hpp"
#include "import/bin_axes.hpp"

namespace tubefoot {

/// One way to read the pictures; the first is the assumed one.
struct Hypothesis {
  std::string name;                                  ///< "mirrored"
  std::string remedy;                                ///< "--flip-beams"
  std::function<std::vector<double>()> energies_of;  ///< on the truth's bins, of its pings
  std::string other_scale;                           ///< "amplitude"; empty: none is as near
  std::function<std::vector<double>()> energies_of_other_scale;
};

struct Verdict {
  std::vector<std::string> found;      ///< what holds, with figures
  std::vector<std::string> refuted;    ///< what does not, and what to declare instead
  std::vector<std::string> ambiguous;  ///< what the truth cannot decide
};

/// How alike two pictures are as the eye sees them: rows at one level, highlights compressed, blurred by a
/// bin; 1 where they are equal.
double correlation(const EchoShape& shape, const BinAxes& axes, const std::vector<double>& truth_j,
                   const std::vector<double>& candidate_j);

/// Tries all hypotheses, the best one by its other scale, too, which no truth in J refutes: a mean per bin
/// differs from a sum as an energy does from its root. Then looks at the best one for displacements that
/// other axes would explain. `declared` are the picture's axes, which the remedies are words for.
Verdict tested(const EchoShape& shape, const BinAxes& axes, const std::vector<double>& truth_j,
               const std::vector<Hypothesis>& hypotheses, const BinAxes& declared);

}  // namespace tubefoot
