// SPDX-License-Identifier: GPL-3.0-or-later
// The near edge of a fan: displacements of the first return of each beam.
#pragma once

#include "compare/diagnosis/residuals.hpp"

namespace tubefoot {

/// Scallops of the near edge: equal arcs side by side.
struct Scallops {
  Estimate depth;         ///< from crest to trough, in samples; 0 without arcs
  int views = 0;          ///< number of arcs that explain the displacements; 0: none does
  double difference = 0;  ///< sum of |candidate - prediction| around the edge
  /// Standard error of the depth of arcs in as many views as usual; 0 if too few beams have an edge.
  double usual_error = 0;
};
Scallops scallops(const Residual& residual);

}  // namespace tubefoot
