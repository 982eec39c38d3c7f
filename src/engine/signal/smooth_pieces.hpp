// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/path.hpp"
#include "engine/signal/visible_polygons.hpp"

// Patches cut so small that signals, but for a phase that all of them have, are smooth over each piece.
namespace tubefoot {

/// How fast what channels make of the seabed may change over it.
struct SignalExtent {
  std::vector<glm::dvec3> transmit_m, receive_m;  ///< all ends, local frame
  /// Of products of any two channels; else of single ones less the phase of the first ends.
  bool products = true;
  double wavenumber_rad_m = 0;  ///< of the carrier
  double band_rad_m = 0;        ///< by which ways count: 2 pi / sound speed times a bandwidth
  double pattern_rad = 0;       ///< sum over the factors, of both ways, of amplitude_wavenumber()
  /// Of ends that move: how far they get from the places above, and the transmitters' speed over what sound's
  /// is above it.
  double moved_m = 0, speed_share = 0;
};

/// The wavenumber over directions of a pattern's amplitude: it holds, or all but holds, nothing finer.
double amplitude_wavenumber(const Directivity& pattern);
/// The same of what mirrors leave of an amplitude.
double amplitude_wavenumber(const MirrorLoss& loss);

/// What cuts a patch: chunks small beside their range, and of each a lattice of rectangles along and across
/// the direction in which ways grow, as many as keep changes below a limit.
///
/// Law Y1 (bound): from the middle of a rectangle to any of its points, a phase k (L_a - L_b) changes by at
/// most change_u + change_v, and so does the phase of every frequency of the band.
class SmoothPieces {
 public:
  struct Chunk {
    std::vector<glm::dvec2> polygon;     ///< metres, in the frame's coordinates
    glm::dvec3 corner_m{0}, u{0}, v{0};  ///< of the lattice's first rectangle, and its axes, unit
    glm::dvec2 size_m{0};                ///< of a rectangle
    glm::dvec2 first{0};                 ///< that corner, in (u, v)
    int count_u = 1, count_v = 1;
    double change_u = 0, change_v = 0;

    /// Of a corner.
    glm::dvec3 at(glm::dvec2 p) const { return corner_m + (p.x - first.x) * u + (p.y - first.y) * v; }
    glm::dvec3 middle_m(int i, int j) const {
      return corner_m + (i + 0.5) * size_m.x * u + (j + 0.5) * size_m.y * v;
    }
  };

  /// `most_change`: radians along either axis.
  SmoothPieces(const SignalExtent& extent, double most_change);

  /// The chunks of a patch, polygons by (u, v) of their own axes.
  void cut(const VisiblePolygons& seen, const VisiblePolygon& patch, std::vector<Chunk>& chunks) const;
  /// What of a chunk lies in each of its rectangles. Calls take(i, j, polygon, whole): corners as in
  /// Chunk::polygon; `whole`: it is the rectangle.
  template <class Take>
  static void for_rectangles(const Chunk& chunk, const Take& take);

 private:
  struct OnPlane;
  void halve(const OnPlane& on, std::vector<glm::dvec2> polygon, std::vector<Chunk>& chunks, int depth) const;
  Chunk chunk_of(const OnPlane& on, std::vector<glm::dvec2> polygon) const;
  /// What moving ends add to rates of phase, in any direction.
  double moving_rate(double range_m) const;

  SignalExtent extent_;
  double most_change_;
};

/// The part of a convex polygon where sign * (p[axis] - level) >= 0.
std::vector<glm::dvec2> cut_at(std::span<const glm::dvec2> polygon, int axis, double level, double sign);
double area_of(std::span<const glm::dvec2> polygon);

template <class Take>
void SmoothPieces::for_rectangles(const Chunk& chunk, const Take& take) {
  for (int j = 0; j < chunk.count_v; ++j) {
    const double low = chunk.first.y + j * chunk.size_m.y, high = chunk.first.y + (j + 1) * chunk.size_m.y;
    std::vector<glm::dvec2> row = chunk.polygon;
    if (j > 0) row = cut_at(row, 1, low, 1);
    if (j + 1 < chunk.count_v) row = cut_at(row, 1, high, -1);
    if (row.size() < 3) continue;
    for (int i = 0; i < chunk.count_u; ++i) {
      std::vector<glm::dvec2> part = row;
      if (i > 0) part = cut_at(part, 0, chunk.first.x + i * chunk.size_m.x, 1);
      if (i + 1 < chunk.count_u) part = cut_at(part, 0, chunk.first.x + (i + 1) * chunk.size_m.x, -1);
      const double area = part.size() < 3 ? 0 : area_of(part);
      if (!(area > 0)) continue;
      take(i, j, std::span<const glm::dvec2>(part), area >= chunk.size_m.x * chunk.size_m.y * (1 - 1e-12));
    }
  }
}

}  // namespace tubefoot
