// SPDX-License-Identifier: GPL-3.0-or-later
// Measures that need no common unit.
#pragma once

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

struct UnitlessErrors {
  /// A row is one range sample of a ping over all beams. Mean over the rows that have echo on both sides of
  /// sum |C / sum C - R / sum R|: 0 to 2. Any gain of the row (a law of range, a normalisation) drops out.
  double row_l1 = 0;
  std::size_t rows = 0, rows_of_one_side = 0;
  /// Spearman's correlation of the ranks of C and R over the bins where either is above 0, equal energies
  /// sharing their rank. Any increasing function of C (amplitude, dB, gamma) drops out. 0 where it is not
  /// defined: fewer than two bins, or one side of one value.
  double rank_correlation = 0;
};

UnitlessErrors unitless_errors(const EchoPair& pair);

}  // namespace tubefoot
