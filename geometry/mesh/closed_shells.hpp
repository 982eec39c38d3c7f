// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Finds the facets of a component that form closed surfaces. A shell is a set of facets that are connected
/// by their edges. It is closed if each of its edges belongs to an even number of its facets, whatever their
/// orientation. Facets with the same three vertices count once. A body with inner walls has edges of three
/// facets; the class does not distinguish it from an open one.
///
/// Law N6 (closed): any line that meets no vertex and no edge of a closed shell crosses it an even number of
/// times.
class ClosedShells {
 public:
  ClosedShells(const FacetMesh& mesh, std::uint16_t component);

  /// Returns the number of closed shells.
  std::size_t count() const { return count_; }
  /// Returns the number of the closed shell to which a facet belongs, below count(). Returns nothing for a
  /// facet of an open shell, of another component, or one that repeats another facet.
  std::optional<std::uint32_t> shell_of(FacetId facet) const;

 private:
  std::vector<std::pair<FacetId, std::uint32_t>> shells_;  ///< sorted by facet
  std::size_t count_ = 0;
};

}  // namespace tubefoot
