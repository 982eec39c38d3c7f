// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/concurrent_vector.h>

#include <array>
#include <cstdint>
#include <deque>
#include <glm/vec2.hpp>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/arithmetic/long_integers.hpp"
#include "geometry/footprints/plane_lines.hpp"

// Stores the lines of one facet, each line once. Equal lines have equal numbers, so most degenerate cases
// need no arithmetic. This header is expensive to compile: include it only in .cpp files.
namespace tubefoot {

using LineId = std::uint32_t;

/// A line of a table with the half-plane on one of its sides.
struct DirectedLine {
  LineId line = 0;
  bool opposite = false;  ///< the half-plane where the value of the stored line is negative
  friend bool operator==(const DirectedLine&, const DirectedLine&) = default;
};

/// The intersection of two lines of a table. Their stored directions turn left from p to q.
struct LineCorner {
  LineId p = 0, q = 0;
  glm::dvec2 near{0};  ///< each coordinate is accurate to 4 units in the last place
};

/// A residue modulo the prime 2^61 - 1.
using Residue = std::uint64_t;
inline constexpr Residue residue_prime = (Residue{1} << 61) - 1;
Residue residue_of(const HugeInt& x);
Residue residue_product(Residue a, Residue b);
/// Returns the inverse of a residue above 0.
Residue residue_inverse(Residue a);
inline Residue residue_sum(Residue a, Residue b) {
  const Residue sum = a + b;
  return sum < residue_prime ? sum : sum - residue_prime;
}
inline Residue residue_difference(Residue a, Residue b) { return a < b ? a + residue_prime - b : a - b; }

class LineTable {
 public:
  struct Near {
    double a = 0, b = 0, c = 0;  ///< as in PlaneLine
  };

  /// Returns the number of a line, which may be stored already with other coefficients.
  DirectedLine keep(const PlaneLine& line);
  /// Adds the grid line u = `place` or v = `place`. Its half-plane has the larger coordinates. Thread-safe.
  LineId add_grid_line(bool across_v, std::int64_t place);

  const Near& near(LineId line) const { return lines_[line].near; }
  /// Residues of the coefficients a, b and c.
  const std::array<Residue, 3>& residues(LineId line) const { return lines_[line].residues; }
  PlaneLine exact(LineId line) const;
  std::array<Integer, 3> integers(LineId line) const;

  /// Returns 1 if the direction of p turns left into that of q, -1 if right, 0 if they are parallel.
  int turn(LineId p, LineId q) const;
  /// Returns the corner of two lines that are not parallel.
  LineCorner corner(LineId p, LineId q) const;
  /// Returns the corner at which one half-plane's border turns left into the other.
  LineCorner corner(DirectedLine arriving, DirectedLine leaving) const;
  /// Returns the side of a line on which a corner lies: 1, 0 or -1.
  int side(const LineCorner& corner, LineId line) const;
  /// Compares two corners on a line: negative if the first comes first in the direction of the line.
  int order(LineId line, const LineCorner& first, const LineCorner& second) const;

 private:
  struct Line {
    Near near;
    std::array<Residue, 3> residues{};
    const std::uint64_t* limbs = nullptr;
    std::array<std::uint8_t, 3> size{};
    std::array<bool, 3> negative{};
    LineId next = 0;  ///< next line of the same hash, plus 1
  };
  Line stored(const PlaneLine& line);
  HugeInt coefficient(const Line& line, std::size_t k) const;
  bool same(const Line& known, const PlaneLine& line, bool& opposite) const;
  int determinant(LineId p, LineId q, LineId r) const;

  tbb::concurrent_vector<Line> lines_;
  std::unordered_map<std::uint64_t, LineId> by_hash_;
  std::deque<std::vector<std::uint64_t>> limbs_;
  std::mutex adding_;
};

}  // namespace tubefoot
