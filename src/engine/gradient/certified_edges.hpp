// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "geometry/integrals/certified_polygon.hpp"

namespace tubefoot {

/// Encloses the derivatives of the integral of f(r) = e^(-2 beta r) / r^6 over a polygon in balls. They are
/// those by the corners and by the distance. Edges are cut at enclosed crossings with the range circles. Each
/// part is integrated by a Gauss rule with its error bound (certified_rule.hpp). A place whose range bin is
/// not certain has an enclosure that contains 0 in each of the possible bins.
class CertifiedEdges {
 public:
  /// `borders_m`: increasing, one more than bins. `beta_per_m`: one-way absorption.
  CertifiedEdges(std::vector<double> borders_m, Ball beta_per_m)
      : borders_(std::move(borders_m)), beta_(std::move(beta_per_m)) {}

  /// The part of one edge in one range bin.
  struct Part {
    std::size_t bin = 0, edge = 0;            ///< edge k joins point k and point k + 1
    std::array<Ball, 2> by_first, by_second;  ///< derivatives by the points of the edge
    Ball by_distance;                         ///< at fixed density
  };
  using Take = std::function<void(const Part&)>;
  void add(const CertifiedPolygon& polygon, const Take& take);

 private:
  /// An edge a + t e for 0 <= t <= 1. With t0 the parameter of the point nearest to the apex, the squared
  /// range is nearest2 + length2 (t - t0)^2.
  struct Edge {
    std::size_t number;
    std::array<Ball, 2> first, along;
    Ball length2, turn;  ///< turn: first x along
    Ball t0, aside2, nearest2;
  };
  /// Integrals over t of f, t f and w. In the bin of the foot point w = (f(r) - f(D)) / (r^2 - D^2).
  /// Otherwise w = f / (r^2 - D^2).
  using Integrals = std::array<Ball, 3>;

  template <class N>
  std::array<N, 2> density_and_turn(const N& r2, const N& rho2, bool at_foot) const;
  template <class N>
  std::array<N, 2> on_edge(const Edge& edge, const N& t, bool at_foot) const;
  bool try_rule(const Edge& edge, const Ball& middle, const Ball& half, bool at_foot, Integrals& sum) const;
  Integrals integral(const Edge& edge, const Ball& from, const Ball& to, bool at_foot) const;
  void find_breaks(const Edge& edge);
  void add_edge(const Edge& edge, const Take& take);
  void take_part(const Edge& edge, std::size_t bin, const Integrals& integrals, const Take& take) const;
  /// Adds the angle of a part outside of the bin of the foot point to that bin.
  void take_angle(const Edge& edge, const Ball& from, const Ball& to, const Take& take) const;
  /// Encloses a part within `t` whose range bin is not certain.
  void take_doubtful(const Edge& edge, const Ball& t, const Take& take) const;
  std::size_t none() const { return borders_.size() - 1; }
  std::size_t bin_of(double range) const;

  std::vector<double> borders_;
  Ball beta_;
  Ball distance_, distance2_, at_foot_;  ///< D, D^2 and f(D)
  std::size_t foot_bin_ = 0;
  struct Break {
    Ball t;
    bool certain = true;
  };
  std::vector<Break> breaks_, sorted_;
};

}  // namespace tubefoot
