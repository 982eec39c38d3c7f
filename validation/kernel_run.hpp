// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <vector>

#include "geometry/visibility/closure.hpp"
#include "validation/case.hpp"
#include "validation/chart.hpp"

namespace tubefoot::atlas {

using Areas = std::map<FacetId, CGAL::Exact_rational>;

/// Visibility in one arithmetic. The names of its corners are evaluated in rationals, so that only
/// decisions can be wrong.
struct CommonVisibility {
  struct OfTube {
    std::vector<Chart::Polygon> polygons;
    Areas areas;
  };
  std::vector<OfTube> tubes;
  TopologyHash hash;
  std::size_t unclosed = 0;  ///< number of tubes that fail the audit
  std::size_t pieces = 0, facets = 0;
};

enum class Audit { no, yes };

/// Runs the kernel. plain_double computes in absolute coordinates if the case has an origin.
CommonVisibility look(const Case& scene, Arithmetic arithmetic, double tolerance = 0,
                      Audit audited = Audit::yes);

/// Sum over facets of |area found - exact area|, divided by the area of the tubes. It is exactly 0 only for
/// equal rationals.
double error_of(const CommonVisibility& found, const CommonVisibility& truth);

struct Tolerance {
  double value = 0, error = 0;
};
/// Errors for tolerances of powers of ten from 1e-17 to 1e-3.
std::vector<Tolerance> sweep(const Case& scene, const CommonVisibility& truth);

}  // namespace tubefoot::atlas
