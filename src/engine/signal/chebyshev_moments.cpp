// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/chebyshev_moments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

// Accumulates moments of scatterers in Chebyshev polynomials over the rectangles of a chunk, and converts
// the moments to amplitudes at the nodes. Source: docs/notes/signals.md, "Element signals".

namespace tubefoot {

ChebyshevNodes::ChebyshevNodes(double tolerance) {
  if (!(tolerance >= 1e-12 && tolerance <= 0.1))
    throw std::invalid_argument(fmt::format("the tolerance must be from 1e-12 to 0.1, not {}", tolerance));
  // With n nodes the remainder is at most change^n / (2^(n-1) n!).
  double factorial = 1;
  for (int n = 1; n <= most; ++n) {
    factorial *= n;
    change_[std::size_t(n)] = 2 * std::pow(tolerance * factorial / 2, 1.0 / n);
  }
}

int ChebyshevNodes::nodes_for(double change_rad) const {
  int n = 1;
  while (n < most && change_[std::size_t(n)] < change_rad) ++n;
  return n;
}

void ChebyshevMoments::Axis::set(int nodes) {
  if (count == nodes) return;
  count = nodes;
  for (int a = 0; a < nodes; ++a) {
    const double angle = std::numbers::pi * (a + 0.5) / nodes;
    node[std::size_t(a)] = std::cos(angle);
    for (int k = 0; k < nodes; ++k)
      weight[std::size_t(a * nodes + k)] = (k == 0 ? 1.0 : 2.0) / nodes * std::cos(k * angle);
  }
}

bool ChebyshevMoments::begin(const SmoothPieces::Chunk& chunk, glm::dvec3 tx_m, glm::dvec3 rx_m,
                             const SignalExtent& extent, double shortest_m, double longest_m) {
  const glm::dvec3 half_u = chunk.count_u * chunk.size_m.x / 2 * chunk.u,
                   half_v = chunk.count_v * chunk.size_m.y / 2 * chunk.v,
                   middle = chunk.corner_m + half_u + half_v;
  double apart = 0;  // largest distance of ends from their middle, summed over both legs
  for (const auto* ends : {&extent.transmit_m, &extent.receive_m}) {
    double most = 0;
    for (const glm::dvec3& end : *ends) most = std::max(most, glm::distance(end, (*ends)[0]));
    apart += most;
  }
  const double motion = glm::distance(middle, tx_m) + glm::distance(middle, rx_m),
               spare = 2 * glm::length(half_u + half_v) + apart + 2 * extent.moved_m;
  if (motion + spare < shortest_m || motion - spare > longest_m) return false;
  chunk_ = &chunk;
  u_.set(nodes_.nodes_for(chunk.change_u));
  v_.set(nodes_.nodes_for(chunk.change_v));
  return true;
}

void ChebyshevMoments::clear() {
  const auto rectangles = std::size_t(chunk_->count_u) * std::size_t(chunk_->count_v);
  moment_.assign(rectangles * std::size_t(u_.count * v_.count), 0);
  any_.assign(rectangles, 0);
}

void ChebyshevMoments::add(glm::dvec3 place_m, std::complex<double> amplitude) {
  const glm::dvec3 motion = place_m - chunk_->corner_m;
  const double s = glm::dot(motion, chunk_->u) / chunk_->size_m.x,
               t = glm::dot(motion, chunk_->v) / chunk_->size_m.y;
  const int i = std::clamp(int(s), 0, chunk_->count_u - 1), j = std::clamp(int(t), 0, chunk_->count_v - 1);
  const double u = 2 * (s - i) - 1, v = 2 * (t - j) - 1;
  std::array<double, ChebyshevNodes::most> by_u, by_v;
  const auto polynomials = [](double x, int count, std::array<double, ChebyshevNodes::most>& value) {
    value[0] = 1;
    if (count > 1) value[1] = x;
    for (std::size_t k = 2; k < std::size_t(count); ++k) value[k] = 2 * x * value[k - 1] - value[k - 2];
  };
  polynomials(u, u_.count, by_u);
  polynomials(v, v_.count, by_v);
  const std::size_t rectangle = std::size_t(j) * std::size_t(chunk_->count_u) + std::size_t(i);
  any_[rectangle] = 1;
  auto* moment = reinterpret_cast<double*>(&moment_[rectangle * std::size_t(u_.count * v_.count)]);
  const double re = amplitude.real(), im = amplitude.imag();
  for (std::size_t b = 0; b < std::size_t(v_.count); ++b) {
    const double x = re * by_v[b], y = im * by_v[b];
    for (std::size_t a = 0; a < std::size_t(u_.count); ++a) {
      *moment++ += x * by_u[a];
      *moment++ += y * by_u[a];
    }
  }
}

bool ChebyshevMoments::to_nodes(int i, int j) {
  const std::size_t rectangle = std::size_t(j) * std::size_t(chunk_->count_u) + std::size_t(i);
  if (any_[rectangle] == 0) return false;
  const auto nu = std::size_t(u_.count), nv = std::size_t(v_.count);
  const std::complex<double>* moment = &moment_[rectangle * nu * nv];
  std::array<std::complex<double>, ChebyshevNodes::most * ChebyshevNodes::most> by_u;
  for (std::size_t m = 0; m < nv; ++m)
    for (std::size_t a = 0; a < nu; ++a) {
      std::complex<double> sum = 0;
      for (std::size_t k = 0; k < nu; ++k) sum += u_.weight[a * nu + k] * moment[m * nu + k];
      by_u[m * nu + a] = sum;
    }
  for (std::size_t b = 0; b < nv; ++b)
    for (std::size_t a = 0; a < nu; ++a) {
      std::complex<double> sum = 0;
      for (std::size_t m = 0; m < nv; ++m) sum += v_.weight[b * nv + m] * by_u[m * nu + a];
      told_[b * nu + a] = sum;
    }
  return true;
}

}  // namespace tubefoot
