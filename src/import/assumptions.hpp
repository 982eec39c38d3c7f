// SPDX-License-Identifier: GPL-3.0-or-later
// Tests declared or assumed properties of a picture against the reference.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compare/measures/echo_errors.hpp"
#include "import/bin_axes.hpp"

namespace tubefoot {

/// One way to read the pictures. The first hypothesis is the assumed one.
struct Hypothesis {
  std::string name;    ///< "mirrored"
  std::string remedy;  ///< "--flip-beams"
  /// Returns energies on the bins of the reference, for its pings.
  std::function<std::vector<double>()> energies_of;
  std::string other_scale;  ///< for example "amplitude"; empty if no other scale is plausible
  std::function<std::vector<double>()> energies_of_other_scale;
};

struct Verdict {
  std::vector<std::string> found;      ///< confirmed properties, with figures
  std::vector<std::string> refuted;    ///< refuted properties, and what to declare instead
  std::vector<std::string> ambiguous;  ///< properties that the reference cannot decide
};

/// Returns the correlation of two pictures after as_seen(): rows have the same level, highlights are
/// compressed, and a blur of one bin is applied. Equal pictures have correlation 1.
double correlation(const EchoShape& shape, const BinAxes& axes, const std::vector<double>& truth_j,
                   const std::vector<double>& candidate_j);

/// Tests all hypotheses, and the best one also in its other scale. No reference in J refutes that scale: a
/// mean per bin differs from a sum as an energy differs from its root. Then it looks in the best picture
/// for displacements that other axes would explain. `declared` are the axes of the picture, to which the
/// remedies refer.
Verdict tested(const EchoShape& shape, const BinAxes& axes, const std::vector<double>& truth_j,
               const std::vector<Hypothesis>& hypotheses, const BinAxes& declared);

}  // namespace tubefoot
