// SPDX-License-Identifier: GPL-3.0-or-later
// Adds the moments of spans of directions from antiderivatives at the ends of the spans. The density of a
// span is a quadratic of the direction cosine (gain_panels.hpp).
#include <algorithm>

#include "engine/echo/antiderivatives.hpp"
#include "engine/echo/gain_panels.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t most_at_once = 24;

using Pair = double __attribute__((vector_size(16)));

constexpr Antiderivatives<GainPanels::terms> of;

/// Integral of x^i x^k over a part of a panel.
struct PartOfPanel {
  std::array<std::array<double, GainPanels::terms>, 4> of{};
  constexpr PartOfPanel(bool lower, bool upper) {
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < GainPanels::terms; ++i) {
        const double half = 1.0 / (i + k + 1);
        of[k][i] = (upper ? half : 0) + (lower ? ((i + k) % 2 == 0 ? half : -half) : 0);
      }
  }
};
constexpr PartOfPanel lower_half(true, false), upper_half(false, true), whole_panel(true, true);

/// Adds the integrals of a cubic about `origin`.
void add_part(const GainPanels::Panel& panel, const PartOfPanel& part, const EndLevels& level, double origin,
              double* row) {
  const double half = 1 / panel.per_half, half2 = half * half, away = panel.middle - origin;
  const double own0 = half * (level[0] + away * (level[1] + away * (level[2] + away * level[3]))),
               own1 = half2 * (level[1] + away * (2 * level[2] + 3 * away * level[3])),
               own2 = half2 * half * (level[2] + 3 * away * level[3]), own3 = half2 * half2 * level[3];
  for (int i = 0; i < GainPanels::terms; ++i)
    row[i] += own0 * part.of[0][i] + own1 * part.of[1][i] + own2 * part.of[2][i] + own3 * part.of[3][i];
}

}  // namespace

void DirectionMoments::hold(Held& held, double cosine) {
  held.number = gains_->find(cosine);
  held.panel = gains_->panel(held.number);
}

void DirectionMoments::add(std::span<const CosineSpan> spans, double origin) {
  for (std::size_t k = 0; k < spans.size();) {
    if (!begin_.holds(spans[k].begin)) hold(begin_, spans[k].begin);
    if (!end_.holds(spans[k].end)) hold(end_, spans[k].end);
    std::size_t count = 1;
    while (k + count < spans.size() && count < most_at_once && begin_.holds(spans[k + count].begin) &&
           end_.holds(spans[k + count].end))
      ++count;
    add_alike(spans.subspan(k, count), origin);
    k += count;
  }
}

/// Adds spans whose ends lie in the same two panels. Antiderivatives count from the panels' middles. The
/// contribution between the middles is added once for all of these spans.
void DirectionMoments::add_alike(std::span<const CosineSpan> spans, double origin) {
  const GainPanels::Panel &b = begin_.panel, &e = end_.panel;
  const Pair middle{b.middle, e.middle}, per_half{b.per_half, e.per_half},
      half = 1 / per_half, sign = Pair{-1, 1} * half, away = middle - origin;
  std::array<Pair, most_at_once> x, level0, level1, level2, power;
  const std::size_t count = spans.size();
  for (std::size_t k = 0; k < count; ++k) {
    const CosineSpan& span = spans[k];
    x[k] = (Pair{span.begin, span.end} - middle) * per_half;
    power[k] = x[k];
    level0[k] = (span.level[0] + away * (span.level[1] + away * span.level[2])) * sign;
    level1[k] = (span.level[1] + 2 * away * span.level[2]) * half * sign * x[k];
    level2[k] = span.level[2] * half * half * sign * (x[k] * x[k]);
  }
  std::array<Pair, GainPanels::terms> moment;
  for (int i = 0; i < GainPanels::terms; ++i) {
    Pair sum{};
    for (std::size_t k = 0; k < count; ++k) {
      sum += power[k] * (level0[k] + of.first[i] * level1[k] + of.second[i] * level2[k]);
      power[k] *= x[k];
    }
    moment[i] = sum * of.reciprocal[i];
  }
  double* row = row_of(begin_.number);
  if (begin_.number == end_.number) {
    for (int i = 0; i < GainPanels::terms; ++i) row[i] += moment[i][0] + moment[i][1];
    return;
  }
  for (int i = 0; i < GainPanels::terms; ++i) row[i] += moment[i][0];
  row = row_of(end_.number);
  for (int i = 0; i < GainPanels::terms; ++i) row[i] += moment[i][1];
  EndLevels level{};
  for (const CosineSpan& span : spans)
    for (std::size_t k = 0; k < span.level.size(); ++k) level[k] += span.level[k];
  const bool rising = b.middle < e.middle;
  const Held &low = rising ? begin_ : end_, &high = rising ? end_ : begin_;
  if (!rising)
    for (double& l : level) l = -l;
  add_part(low.panel, upper_half, level, origin, row_of(low.number));
  double from = low.panel.hi;
  for (std::uint32_t number; from < high.panel.lo; from = gains_->panel(number).hi) {
    number = gains_->find(from);
    add_part(gains_->panel(number), whole_panel, level, origin, row_of(number));
  }
  add_part(high.panel, lower_half, level, origin, row_of(high.number));
}

void DirectionMoments::add_across(std::uint32_t panel, double* row, const EndLevels& level,
                                  double origin) const {
  row += GainPanels::terms;
  const double away = gains_->panel(panel).hi - origin;
  row[0] += level[0] + away * (level[1] + away * (level[2] + away * level[3]));
  row[1] += level[1] + away * (2 * level[2] + 3 * away * level[3]);
  row[2] += level[2] + 3 * away * level[3];
  row[3] += level[3];
}

void DirectionMoments::cross_borders() {
  for (std::size_t k = 0, blocks = blocks_.size(); k < blocks * samples_of_block; ++k) {
    double* lower = block(k / samples_of_block) + k % samples_of_block * row_size;
    EndLevels level;
    std::copy_n(lower + GainPanels::terms, level.size(), level.begin());
    if (level == EndLevels{}) continue;
    std::fill_n(lower + GainPanels::terms, level.size(), 0.0);
    const Block at = blocks_[k / samples_of_block];
    const GainPanels::Panel panel = gains_->panel(at.panel);
    add_part(panel, upper_half, level, panel.hi, lower);
    const std::uint32_t upper = gains_->find(panel.hi);
    add_part(gains_->panel(upper), lower_half, level, panel.hi,
             row(at.block * samples_of_block + std::uint32_t(k % samples_of_block), upper));
  }
}

}  // namespace tubefoot
