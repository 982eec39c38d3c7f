// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/gain_panels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

// Fits gains in panels at Chebyshev points, converts the coefficients to powers, and multiplies them by the
// moments of directions (gain_panels.hpp).

namespace tubefoot {
namespace {

constexpr int most_halvings = 3;
constexpr double beyond = 4;  // larger than every cosine

using Pair = double __attribute__((vector_size(16)));

struct ChebyshevTables {
  static constexpr int terms = GainPanels::terms;
  std::array<double, terms> x{};
  std::array<std::array<double, terms>, terms> cosine{};    // T_k(x_j), times 2 / terms (1 / terms for k = 0)
  std::array<std::array<double, terms>, terms> monomial{};  // T_k = sum of monomial[k][i] x^i
  ChebyshevTables() {
    for (int j = 0; j < terms; ++j) {
      const double angle = std::numbers::pi * (j + 0.5) / terms;
      x[j] = std::cos(angle);
      for (int k = 0; k < terms; ++k) cosine[k][j] = std::cos(k * angle) * (k == 0 ? 1 : 2) / terms;
    }
    monomial[0][0] = 1;
    monomial[1][1] = 1;
    for (int k = 2; k < terms; ++k)
      for (int i = 0; i < terms; ++i)
        monomial[k][i] = (i > 0 ? 2 * monomial[k - 1][i - 1] : 0.0) - monomial[k - 2][i];
  }
};

const ChebyshevTables& tables() {
  static const ChebyshevTables made;
  return made;
}

std::size_t hash(std::uint32_t panel, std::uint32_t sample) {
  std::uint64_t h = (std::uint64_t(panel) << 32 | sample) * 0x9e3779b97f4a7c15u;
  return h ^ (h >> 29);
}

}  // namespace

GainPanels::GainPanels(std::size_t functions, Evaluate evaluate, double width, double tolerance)
    : functions_(functions), evaluate_(std::move(evaluate)), tolerance_(tolerance) {
  bases_.resize(std::size_t(std::clamp(std::ceil(2 / width), 8.0, 65536.0)));
  per_width_ = double(bases_.size()) / 2;
}

std::uint32_t GainPanels::find(double cosine) {
  auto k = std::size_t(std::clamp((cosine + 1) * per_width_, 0.0, double(bases_.size()) - 1));
  // Corrects a panel that rounding chose on the wrong side of a border.
  const auto border = [&](std::size_t at) { return -1 + double(at) / per_width_; };
  if (k + 1 < bases_.size() && cosine >= border(k + 1))
    ++k;
  else if (k > 0 && cosine < border(k))
    --k;
  Base& base = bases_[k];
  if (base.count == 0) {
    base.first = std::uint32_t(panels_.size());
    fit(-1 + double(k) / per_width_, -1 + double(k + 1) / per_width_, 0);
    base.count = std::uint32_t(panels_.size()) - base.first;
    if (k == 0) panels_[base.first].lo = -beyond;
    if (k + 1 == bases_.size()) panels_.back().hi = beyond;
  }
  std::uint32_t first = base.first, count = base.count;
  while (count > 1) {
    const std::uint32_t half = count / 2;
    if (cosine >= panels_[first + half].lo) first += half;
    count -= half;
  }
  return first;
}

void GainPanels::fit(double lo, double hi, int halvings) {
  const ChebyshevTables& t = tables();
  const double half = (hi - lo) / 2, middle = lo + half;
  std::vector<double>& values = values_;
  values.resize(functions_ * terms);
  for (int j = 0; j < terms; ++j)
    evaluate_(middle + half * t.x[j], std::span(values).subspan(j * functions_, functions_));
  chebyshev_.assign(functions_ * terms, 0);
  double tail = 0;
  for (std::size_t f = 0; f < functions_; ++f) {
    double* c = chebyshev_.data() + f * terms;
    for (int k = 0; k < terms; ++k)
      for (int j = 0; j < terms; ++j) c[k] += values[j * functions_ + f] * t.cosine[k][j];
    tail = std::max(tail, std::abs(c[terms - 1]) + std::abs(c[terms - 2]));
  }
  if (tail > tolerance_ && halvings < most_halvings) {
    fit(lo, middle, halvings + 1);
    fit(middle, hi, halvings + 1);
    return;
  }
  panels_.push_back({lo, hi, middle, 1 / half});
  for (std::size_t f = 0; f < functions_; ++f) {
    std::array<double, terms> power{};
    for (int k = 0; k < terms; ++k)
      for (int i = 0; i <= k; ++i) power[i] += chebyshev_[f * terms + k] * t.monomial[k][i];
    coefficients_.insert(coefficients_.end(), power.begin(), power.end());
  }
}

double GainPanels::value(double cosine) {
  if (panels_.empty() || !(cosine >= panels_[last_].lo && cosine < panels_[last_].hi)) last_ = find(cosine);
  const Panel& p = panels_[last_];
  const double x = (cosine - p.middle) * p.per_half, x2 = x * x;
  const double* c = coefficients(last_, 0);
  double even = c[terms - 2], odd = c[terms - 1];
  for (int i = terms - 4; i >= 0; i -= 2) {
    even = even * x2 + c[i];
    odd = odd * x2 + c[i + 1];
  }
  return even + x * odd;
}

void DirectionMoments::add(std::span<const double> cosines, std::span<const double> weights) {
  for (std::size_t k = 0; k < cosines.size();) {
    if (!(cosines[k] >= lo_ && cosines[k] < hi_)) select(cosines[k]);
    static_assert(GainPanels::terms == 12);
    Pair s0{}, s1{}, s2{}, s3{}, s4{}, s5{};  // separate variables stay in registers
    do {
      const double x = (cosines[k] - middle_) * per_half_, x2 = x * x, weight = weights[k];
      const Pair p0{weight, weight * x}, step{x2, x2}, p1 = p0 * step, p2 = p1 * step, p3 = p2 * step,
                                                       p4 = p3 * step, p5 = p4 * step;
      s0 += p0;
      s1 += p1;
      s2 += p2;
      s3 += p3;
      s4 += p4;
      s5 += p5;
      ++k;
    } while (k < cosines.size() && cosines[k] >= lo_ && cosines[k] < hi_);
    int i = 0;
    for (const Pair& s : {s0, s1, s2, s3, s4, s5}) {
      row_[i++] += s[0];
      row_[i++] += s[1];
    }
  }
}

void DirectionMoments::select(double cosine) {
  const std::uint32_t k = gains_->find(cosine);
  const GainPanels::Panel& panel = gains_->panel(k);
  lo_ = panel.lo;
  hi_ = panel.hi;
  middle_ = panel.middle;
  per_half_ = panel.per_half;
  row_ = row_of(k);
}

double* DirectionMoments::row_of(std::uint32_t k) {
  const std::uint32_t block = sample_ / samples_of_block;
  const auto row_in = [&](std::uint32_t number) {
    return this->block(number) + sample_ % samples_of_block * row_size;
  };
  Recent& recent = recent_[k % recent_.size()];
  if (recent.panel == k && recent.block == block) return row_in(recent.number);
  if (2 * (blocks_.size() + 1) > slots_.size()) grow();
  std::size_t slot = hash(k, block) & (slots_.size() - 1);
  while (slots_[slot] != 0 &&
         (blocks_[slots_[slot] - 1].panel != k || blocks_[slots_[slot] - 1].block != block))
    slot = (slot + 1) & (slots_.size() - 1);
  if (slots_[slot] == 0) {
    blocks_.push_back({k, block});
    if (blocks_.size() > moments_.size() * blocks_of_chunk)
      moments_.push_back(std::make_unique<double[]>(blocks_of_chunk * samples_of_block * row_size));
    slots_[slot] = std::uint32_t(blocks_.size());
  }
  recent = {k, block, slots_[slot] - 1};
  return row_in(recent.number);
}

void DirectionMoments::grow() {
  slots_.assign(std::max<std::size_t>(2 * slots_.size(), 4096), 0);
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    std::size_t slot = hash(blocks_[k].panel, blocks_[k].block) & (slots_.size() - 1);
    while (slots_[slot] != 0) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = std::uint32_t(k + 1);
  }
}

void DirectionMoments::clear() {
  if (blocks_.empty()) return;
  for (std::size_t k = 0; k < blocks_.size(); ++k) std::fill_n(block(k), samples_of_block * row_size, 0.0);
  blocks_.clear();
  std::fill(slots_.begin(), slots_.end(), 0u);
  recent_.fill({});
  sample_ = std::numeric_limits<std::uint32_t>::max();
  lo_ = std::numeric_limits<double>::infinity();
}

void DirectionMoments::finish(std::size_t first_beam, std::size_t samples, std::span<double> energy) {
  cross_borders();
  for (std::size_t number = 0; number < blocks_.size(); ++number) {
    const std::size_t first = blocks_[number].block * std::size_t(samples_of_block);
    add_received(block(number), row_size, std::min<std::size_t>(samples_of_block, samples - first),
                 gains_->coefficients(blocks_[number].panel, 0), gains_->functions(), samples,
                 energy.data() + first_beam * samples + first);
  }
}

}  // namespace tubefoot
