// SPDX-License-Identifier: GPL-3.0-or-later
// Error measures that need no common unit.
#pragma once

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

struct UnitlessErrors {
  /// Mean over rows of sum |C / sum C - R / sum R|, between 0 and 2. A row is one range sample of a ping
  /// over all beams. Only rows with echoes on both sides count. The measure does not depend on a gain of
  /// the row (a range dependence, a normalisation).
  double row_l1 = 0;
  std::size_t rows = 0, rows_of_one_side = 0;
  /// Spearman's rank correlation of C and R over the bins in which either is above 0. Equal energies share
  /// their rank. The measure does not depend on increasing functions of C (amplitude, dB, gamma). It is 0
  /// if it is undefined, that is, for fewer than two bins or for constant energies on one side.
  double rank_correlation = 0;
};

UnitlessErrors unitless_errors(const EchoPair& pair);

}  // namespace tubefoot
