// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/echo/gain_panels.hpp"
#include "engine/scattering/beam_pattern.hpp"

namespace tubefoot {

/// Two-way gains of the beams that receive a tube, in rows that are linear in the gains. Below
/// BeamPatterns::least a gain counts as 0. By default, there is one row per beam. With weights of bins, there
/// is one row, which is the sum of all beams. Without weights, many line arrays on one axis have rows of
/// powers of the cosine to this axis. Such rows exist for each panel of GainPanels that a polygon meets.
/// Their number does not depend on the number of beams, and RowSums converts their sums to beams.
class BeamGains {
 public:
  /// `patterns`: null for ideal beams, with the gain 1. `weights`: [beam][bin]; empty: none. `tolerance`:
  /// EchoModel::pattern_tolerance.
  /// Throws std::invalid_argument for patterns of other beams or tubes, and for a receiver pair.
  BeamGains(const BeamPatterns* patterns, const ReceiveBeams& beams, std::span<const double> weights,
            std::size_t bins, double tolerance);

  /// Selects the tube and the polygon of the following calls. `corners_m` are relative to the apex.
  void select(std::uint32_t tube, std::span<const glm::dvec3> corners_m);
  bool weighted() const { return !weights_.empty(); }
  /// Number of rows, and the beam of the first one.
  std::size_t rows() const {
    return weighted() ? 1 : panels_.empty() ? end_ - first_ : panels_.size() * std::size_t(GainPanels::terms);
  }
  std::uint32_t first_beam() const { return first_; }
  /// Returns whether all weights of a range of bins are 0.
  bool are_zero(std::size_t first_bin, std::size_t end_bin) const;
  void at(glm::dvec3 direction, std::size_t bin, std::span<double> gains);

  /// Directions with one cosine to an axis.
  struct Cone {
    glm::dvec3 axis{0};
    double cosine = 0;
  };
  /// Angle over which no gain grows by more than e^3 in the complex plane, and whether there are tables. The
  /// rows of the tables are kinks, unless they are more than most_kinks.
  struct Smooth {
    double angle_rad = 1;
    bool tables = false;
    std::vector<Cone> kinks{};
  };
  static constexpr std::size_t most_kinks = 64;
  const Smooth& smooth() const { return receiver_->smooth; }

 private:
  friend class RowSums;
  /// Beams [first, end) of a fan.
  struct Receiver {
    std::uint32_t first = 0, end = 0;
    Smooth smooth{};
    glm::dvec3 axis{0};                   ///< of all receive beams
    std::unique_ptr<GainPanels> gains{};  ///< functions of the cosine to this axis; null: of directions
    /// Polynomials of the weighted sum of all beams, by panel and bin.
    std::unordered_map<std::uint64_t, std::array<double, GainPanels::terms>> sums{};
  };
  Receiver& receiver_of(std::uint32_t fan);
  void add_common_axis(Receiver& receiver) const;
  void find_panels(std::span<const glm::dvec3> corners_m);
  double weighted_sum(double cosine, std::size_t bin);

  const BeamPatterns* patterns_;
  const ReceiveBeams& beams_;
  std::span<const double> weights_;
  std::size_t bins_;
  std::uint32_t first_ = 0, end_ = 0, fan_ = 0;
  double tolerance_;
  Receiver* receiver_ = nullptr;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, Receiver> known_;
  struct HeldPanel {
    std::uint32_t number = 0;
    GainPanels::Panel panel;
  };
  std::vector<HeldPanel> panels_;  ///< of the polygon, if rows are powers
  HeldPanel held_;
  const std::array<double, GainPanels::terms>* held_sum_ = nullptr;  ///< of held_ and held_bin_
  std::size_t held_bin_ = 0;
};

/// Sums of one quantity by beam and bin over polygons, whose rows are those of BeamGains.
class RowSums {
 public:
  /// `sums`: [beam][bin].
  RowSums(BeamGains& gains, std::span<double> sums) : gains_(gains), sums_(sums) {}
  /// The number of a row at bin k is at[k * stride].
  struct Row {
    double* at;
    std::size_t stride;
  };
  Row row(std::size_t number);
  /// Adds sums of powers to the beams.
  void finish();

 private:
  BeamGains& gains_;
  std::span<double> sums_;
  std::map<BeamGains::Receiver*, std::vector<std::vector<double>>> powers_;  ///< [panel][bin][power]
};

}  // namespace tubefoot
