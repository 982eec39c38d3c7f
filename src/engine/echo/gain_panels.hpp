// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/echo/edge_lanes.hpp"

// Approximates beam gains by piecewise polynomials of a direction cosine and accumulates moments of
// directions. The echo of each beam is a product of moments and coefficients: sum of weight * x^i, i <
// terms, per range sample and panel.

namespace tubefoot {

/// Gains as piecewise polynomials of a direction cosine. Several functions use the same panels, so that sums
/// over one panel serve all of them. A panel is fitted at its first use (Chebyshev points). It is halved
/// until the last two coefficients of every function are below the tolerance, but only a few times. At a
/// kink, as in tables, the tolerance is not reached.
class GainPanels {
 public:
  static constexpr int terms = 12;
  /// Computes the value of each function at a cosine.
  using Evaluate = std::function<void(double cosine, std::span<double> values)>;

  struct Panel {
    double lo = 0, hi = 0;  ///< cosines, [lo, hi)
    double middle = 0, per_half = 0;
  };

  /// `width`: initial width of panels in cosines. `tolerance`: absolute.
  GainPanels(std::size_t functions, Evaluate evaluate, double width, double tolerance);

  std::size_t functions() const { return functions_; }
  /// Panel that contains a cosine. The last panel also contains a cosine that exceeds +-1 by rounding.
  std::uint32_t find(double cosine);
  const Panel& panel(std::uint32_t k) const { return panels_[k]; }
  /// Function = sum of coefficients[i] x^i with x = (cosine - middle) per_half.
  const double* coefficients(std::uint32_t panel, std::size_t function) const {
    return coefficients_.data() + (panel * functions_ + function) * terms;
  }
  /// Value of the first function.
  double value(double cosine);

 private:
  struct Base {
    std::uint32_t first = 0, count = 0;
  };
  void fit(double lo, double hi, int halvings);

  std::size_t functions_;
  Evaluate evaluate_;
  double per_width_ = 0, tolerance_ = 0;
  std::vector<Base> bases_;  // equal parts of [-1, 1], fitted at first use
  std::vector<Panel> panels_;
  std::vector<double> coefficients_;
  std::vector<double> values_, chebyshev_;
  std::uint32_t last_ = 0;
};

/// Interval of directions whose density is a quadratic of their cosine.
struct CosineSpan {
  double begin, end;            ///< cosines; `end` may be smaller than `begin`
  std::array<double, 3> level;  ///< weight per cosine = sum of level[k] (cosine - origin)^k
};

/// Sums over directions for beams that are functions of the same cosine, before any beam is evaluated. Each
/// range sample and panel has the moments sum of weight x^i, i < terms. The cost of a direction is `terms`
/// products for any number of beams.
class DirectionMoments {
 public:
  /// Number of neighbouring samples in a block of one panel. A footprint needs them one after the other.
  static constexpr std::uint32_t samples_of_block = 8;
  /// Length of a row: the moments, and a cubic about the panel's upper border, whose integral across this
  /// border is still to be added.
  static constexpr std::size_t row_size = GainPanels::terms + std::tuple_size_v<EndLevels>;

  explicit DirectionMoments(std::shared_ptr<GainPanels> gains) : gains_(std::move(gains)) {}

  /// Selects the range sample of the following calls.
  void begin(std::uint32_t sample) {
    if (sample == sample_) return;
    sample_ = sample;
    lo_ = std::numeric_limits<double>::infinity();
  }
  /// Adds weights of directions. Ascending or descending cosines are fastest.
  void add(std::span<const double> cosines, std::span<const double> weights);
  /// Adds the integrals over spans, from begin to end, in closed form.
  void add(std::span<const CosineSpan> spans, double origin);
  /// Adds the integral of a cubic of the cosine from the middle of a panel to that of the next one.
  void add_across(std::uint32_t panel, double* row, const EndLevels& level, double origin) const;
  const GainPanels::Panel& panel(std::uint32_t number) const { return gains_->panel(number); }
  std::uint32_t find(double cosine) { return gains_->find(cosine); }
  /// Row of a panel in a sample, to which values may be added. Rows do not move before clear(). The rows of
  /// the samples of a block are contiguous.
  double* row(std::uint32_t sample, std::uint32_t panel) {
    begin(sample);
    return row_of(panel);
  }
  /// Adds the energies to energy[(first_beam + function) * samples + sample].
  void finish(std::size_t first_beam, std::size_t samples, std::span<double> energy);
  /// Removes all weights and keeps the fitted gains.
  void clear();

 private:
  static constexpr std::uint32_t blocks_of_chunk = 128;
  struct Block {
    std::uint32_t panel = 0, block = 0;
  };
  /// Panel that contains the begin or end of spans.
  struct Held {
    std::uint32_t number = std::numeric_limits<std::uint32_t>::max();
    GainPanels::Panel panel;
    bool holds(double cosine) const { return cosine >= panel.lo && cosine < panel.hi; }
  };
  void hold(Held& held, double cosine);
  void add_alike(std::span<const CosineSpan> spans, double origin);
  void select(double cosine);
  double* row_of(std::uint32_t panel);
  double* block(std::size_t number) const {
    return moments_[number / blocks_of_chunk].get() +
           number % blocks_of_chunk * (samples_of_block * row_size);
  }
  void grow();
  void cross_borders();

  std::shared_ptr<GainPanels> gains_;
  std::uint32_t sample_ = std::numeric_limits<std::uint32_t>::max();
  double lo_ = std::numeric_limits<double>::infinity(), hi_ = 0, middle_ = 0, per_half_ = 0;
  double* row_ = nullptr;
  Held begin_, end_;
  struct Recent {
    std::uint32_t panel = std::numeric_limits<std::uint32_t>::max(), block = 0, number = 0;
  };
  std::array<Recent, 1024> recent_;  // per panel
  std::vector<Block> blocks_;
  std::vector<std::unique_ptr<double[]>> moments_;  // chunks of blocks_of_chunk blocks, which do not move
  std::vector<std::uint32_t> slots_;  // hash of panel and block to its index + 1, open addressing
};

}  // namespace tubefoot
