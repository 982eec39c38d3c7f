// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Which facets of a component make closed surfaces. A shell is facets that hang together by their edges; it
/// is closed where each of its edges belongs to an even number of them, however they are turned. Facets with
/// the same three vertices count once. A body with walls inside has edges of three facets: it is not told
/// from an open one.
/// Law N6 (closed): any line that meets no vertex and no edge of a closed shell crosses it an even number of
/// times.
class ClosedShells {
 public:
  ClosedShells(const FacetMesh& mesh, std::uint16_t component);

  /// How many there are.
  std::size_t count() const { return count_; }
  /// The number of the closed shell that a facet belongs to, below count(); nothing for one of an open shell,
  /// of another component, or that repeats another facet.
  std::optional<std::uint32_t> shell_of(FacetId facet) const;

 private:
  std::vector<std::pair<FacetId, std::uint32_t>> shells_;  ///< by facet
  std::size_t count_ = 0;
};

}  // namespace tubefoot
