// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "engine/signal/smooth_pieces.hpp"

namespace tubefoot {

/// Number of Chebyshev nodes that interpolate e^{i change x} on -1 .. 1 within a tolerance.
class ChebyshevNodes {
 public:
  static constexpr int most = 12;
  /// `tolerance`: largest error.
  explicit ChebyshevNodes(double tolerance);
  /// Largest change that `most` nodes resolve.
  double most_change() const { return change_[most]; }
  int nodes_for(double change_rad) const;

 private:
  std::array<double, most + 1> change_{};
};

/// Replaces the scatterers of a chunk by equivalent ones at the nodes of its rectangles. For a function f
/// that polynomials interpolate well, sum_m l_m(x) f(x_m),
///     sum_j z_j f(x_j) = sum_m f(x_m) sum_j z_j l_m(x_j).
/// The inner sums do not depend on f. They are accumulated as moments of Chebyshev polynomials.
class ChebyshevMoments {
 public:
  explicit ChebyshevMoments(const ChebyshevNodes& nodes) : nodes_(nodes) {}

  /// Selects a chunk. Returns false if no path over the chunk to any ends of the extent has a length between
  /// the given ones.
  bool begin(const SmoothPieces::Chunk& chunk, glm::dvec3 tx_m, glm::dvec3 rx_m, const SignalExtent& extent,
             double shortest_m, double longest_m);
  /// Number of nodes of the selected chunk.
  double nodes() const {
    return double(chunk_->count_u) * double(chunk_->count_v) * double(u_.count * v_.count);
  }
  /// Sets the moments of the selected chunk to 0.
  void clear();
  /// Adds a scatterer on the plane of the chunk. Call clear() first.
  void add(glm::dvec3 place_m, std::complex<double> amplitude);
  /// Calls take(place, amplitude) for the nodes of all rectangles that contain scatterers.
  template <class Take>
  void tell(const Take& take) {
    for (int j = 0; j < chunk_->count_v; ++j)
      for (int i = 0; i < chunk_->count_u; ++i) {
        if (!to_nodes(i, j)) continue;
        for (int b = 0; b < v_.count; ++b)
          for (int a = 0; a < u_.count; ++a) take(node_m(i, j, a, b), told_[std::size_t(b * u_.count + a)]);
      }
  }

 private:
  /// Chebyshev nodes of the first kind, and the weights that convert moments to amplitudes at the nodes.
  struct Axis {
    int count = 0;
    std::array<double, ChebyshevNodes::most> node{};
    std::array<double, ChebyshevNodes::most * ChebyshevNodes::most> weight{};  // [node][moment]
    void set(int nodes);
  };
  bool to_nodes(int i, int j);
  glm::dvec3 node_m(int i, int j, int a, int b) const {
    return chunk_->middle_m(i, j) + u_.node[std::size_t(a)] * chunk_->size_m.x / 2 * chunk_->u +
           v_.node[std::size_t(b)] * chunk_->size_m.y / 2 * chunk_->v;
  }

  const ChebyshevNodes& nodes_;
  const SmoothPieces::Chunk* chunk_ = nullptr;
  Axis u_, v_;
  std::vector<std::complex<double>> moment_;  // [rectangle][v][u]
  std::vector<char> any_;                     // per rectangle: has scatterers
  std::array<std::complex<double>, ChebyshevNodes::most * ChebyshevNodes::most> told_{};
};

}  // namespace tubefoot
