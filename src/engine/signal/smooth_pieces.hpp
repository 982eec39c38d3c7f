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

// Cuts visible polygons into pieces over which the signals of all channels, except for a common phase
// factor, are smooth. A rectangle limits the phase change of k (L_a - L_b) along each axis. Source:
// docs/notes/signals.md, "Pulses".
namespace tubefoot {

/// Rate of amplitudes r^-4 with sines of grazing angles, in rad per relative change of range.
constexpr double amplitude_rad = 8;

/// Bounds of the rates at which the channels' responses change over the seabed.
struct SignalExtent {
  std::vector<glm::dvec3> transmit_m, receive_m;  ///< all ends, local frame
  /// True: for products of two channels. False: for single channels, relative to the phase of the first
  /// ends.
  bool products = true;
  double wavenumber_rad_m = 0;  ///< wavenumber of the carrier
  double band_rad_m = 0;        ///< rate of path lengths: 2 pi / sound speed times a bandwidth
  double pattern_rad = 0;       ///< sum of amplitude_wavenumber() over the factors of both legs
  /// Moving ends: largest distance from the positions above, and the transmitters' speed divided by the
  /// sound speed minus this speed.
  double moved_m = 0, speed_share = 0;
};

/// Highest angular wavenumber of a pattern's amplitude, up to negligible parts.
double amplitude_wavenumber(const Directivity& pattern);
/// The same for the amplitude factor of mirrors.
double amplitude_wavenumber(const MirrorLoss& loss);

/// Cuts a polygon into chunks that are small relative to their range. Each chunk has a lattice of rectangles
/// along and across the direction in which path lengths increase. The number of rectangles keeps the changes
/// of phase below a limit.
///
/// Law Y1 (bound): let p be a point of a rectangle. From the middle of the rectangle to p, a phase k (L_a -
/// L_b) changes by at most change_u + change_v. The same holds for the phase of every frequency of the band.
class SmoothPieces {
 public:
  struct Chunk {
    std::vector<glm::dvec2> polygon;     ///< in m, in the frame's coordinates
    glm::dvec3 corner_m{0}, u{0}, v{0};  ///< corner of the lattice's first rectangle; unit vectors of its
                                         ///< axes
    glm::dvec2 size_m{0};                ///< size of a rectangle
    glm::dvec2 first{0};                 ///< the same corner in (u, v)
    int count_u = 1, count_v = 1;
    double change_u = 0, change_v = 0;

    /// Position of a point in (u, v).
    glm::dvec3 at(glm::dvec2 p) const { return corner_m + (p.x - first.x) * u + (p.y - first.y) * v; }
    glm::dvec3 middle_m(int i, int j) const {
      return corner_m + (i + 0.5) * size_m.x * u + (j + 0.5) * size_m.y * v;
    }
  };

  /// `most_change`: largest change in rad along either axis.
  SmoothPieces(const SignalExtent& extent, double most_change);

  /// Appends the chunks of a polygon, each in (u, v) of its own axes.
  void cut(const VisiblePolygons& seen, const VisiblePolygon& patch, std::vector<Chunk>& chunks) const;
  /// Intersects a chunk with each of its rectangles. Calls take(i, j, polygon, whole) with corners as in
  /// Chunk::polygon. `whole`: the polygon is the full rectangle.
  template <class Take>
  static void for_rectangles(const Chunk& chunk, const Take& take);

 private:
  struct OnPlane;
  void halve(const OnPlane& on, std::vector<glm::dvec2> polygon, std::vector<Chunk>& chunks, int depth) const;
  Chunk chunk_of(const OnPlane& on, std::vector<glm::dvec2> polygon) const;
  /// Contribution of moving ends to rates of phase, in any direction.
  double moving_rate(double range_m) const;

  SignalExtent extent_;
  double most_change_;
};

/// Part of a convex polygon with sign * (p[axis] - level) >= 0.
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
