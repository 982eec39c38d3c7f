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

namespace tubefoot {

/// Gains as piecewise polynomials of a direction cosine: several functions over the same panels, so that what
/// is summed up over one panel serves all of them. A panel is fitted when it is first asked for (Chebyshev
/// points) and halved until the last two coefficients of every function are below the tolerance, but not more
/// than a few times: a corner, as those of tables, is never met.
class GainPanels {
 public:
  static constexpr int terms = 12;
  /// Fills the value of each function at a cosine.
  using Evaluate = std::function<void(double cosine, std::span<double> values)>;

  struct Panel {
    double lo = 0, hi = 0;  ///< cosines, [lo, hi)
    double middle = 0, per_half = 0;
  };

  /// `width`: of the panels to begin with, in cosines; `tolerance`: absolute.
  GainPanels(std::size_t functions, Evaluate evaluate, double width, double tolerance);

  std::size_t functions() const { return functions_; }
  /// The panel that holds a cosine; one beyond +-1 by a rounding is held by the last.
  std::uint32_t find(double cosine);
  const Panel& panel(std::uint32_t k) const { return panels_[k]; }
  /// Function = sum of coefficients[i] x^i, x = (cosine - middle) per_half.
  const double* coefficients(std::uint32_t panel, std::size_t function) const {
    return coefficients_.data() + (panel * functions_ + function) * terms;
  }
  /// Of the first function.
  double value(double cosine);

 private:
  struct Base {
    std::uint32_t first = 0, count = 0;
  };
  void fit(double lo, double hi, int halvings);

  std::size_t functions_;
  Evaluate evaluate_;
  double per_width_ = 0, tolerance_ = 0;
  std::vector<Base> bases_;  // even parts of [-1, 1]; no panels until one is asked for
  std::vector<Panel> panels_;
  std::vector<double> coefficients_;
  std::vector<double> values_, chebyshev_;
  std::uint32_t last_ = 0;
};

/// A stretch of directions: what comes from each is a quadratic of its cosine.
struct CosineSpan {
  double begin, end;            ///< cosines, the end may be the smaller one
  std::array<double, 3> level;  ///< weight per cosine = sum of level[k] (cosine - origin)^k
};

/// What a receiver's beams receive as functions of one cosine, summed up before any beam is looked at: for
/// each range sample and panel the moments sum of weight x^i, i < terms. A direction costs `terms` products
/// however many beams there are.
class DirectionMoments {
 public:
  /// Moments of one panel in neighbouring samples, which a footprint meets one after the other.
  static constexpr std::uint32_t samples_of_block = 8;
  /// Of a row: after the moments the cubic, about the panel's upper border, whose integral across that border
  /// is still to be added.
  static constexpr std::size_t row_size = GainPanels::terms + std::tuple_size_v<EndLevels>;

  explicit DirectionMoments(std::shared_ptr<GainPanels> gains) : gains_(std::move(gains)) {}

  /// What follows belongs to this range sample.
  void begin(std::uint32_t sample) {
    if (sample == sample_) return;
    sample_ = sample;
    lo_ = std::numeric_limits<double>::infinity();
  }
  /// Weights of directions, best in the order of their cosines.
  void add(std::span<const double> cosines, std::span<const double> weights);
  /// The integrals over some spans, from begin to end, in closed form.
  void add(std::span<const CosineSpan> spans, double origin);
  /// Adds the integral of a cubic of the cosine from the middle of a panel to that of the next.
  void add_across(std::uint32_t panel, double* row, const EndLevels& level, double origin) const;
  const GainPanels::Panel& panel(std::uint32_t number) const { return gains_->panel(number); }
  std::uint32_t find(double cosine) { return gains_->find(cosine); }
  /// The row of a panel in a sample, to be added to. Rows stay where they are until clear(); those of the
  /// samples of a block follow each other.
  double* row(std::uint32_t sample, std::uint32_t panel) {
    begin(sample);
    return row_of(panel);
  }
  /// Adds to energy[(first_beam + function) * samples + sample].
  void finish(std::size_t first_beam, std::size_t samples, std::span<double> energy);
  /// Forgets all weights; gains stay known.
  void clear();

 private:
  static constexpr std::uint32_t blocks_of_chunk = 128;
  struct Block {
    std::uint32_t panel = 0, block = 0;
  };
  /// A panel that spans begin or end in, and its place among the cosines.
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
  std::array<Recent, 1024> recent_;  // by panel
  std::vector<Block> blocks_;
  std::vector<std::unique_ptr<double[]>>
      moments_;                       // of blocks_of_chunk blocks each: they stay where they are
  std::vector<std::uint32_t> slots_;  // hash of panel and block to its number + 1, open addressing
};

}  // namespace tubefoot
