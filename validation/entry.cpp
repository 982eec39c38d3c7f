// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/entry.hpp"

#include <algorithm>
#include <utility>

namespace tubefoot::atlas {
namespace {

Answer answer(const Case& scene, const CommonVisibility& truth, Arithmetic arithmetic, double tolerance = 0) {
  Answer a;
  a.visibility = look(scene, arithmetic, tolerance);
  a.error = error_of(a.visibility, truth);
  a.same_hash = a.visibility.hash == truth.hash;
  return a;
}

/// Selects the best tolerance of the sweep. The criteria are least error, then fewest tubes that do not
/// close, then least tolerance.
void tune(Entry& entry) {
  const CommonVisibility& truth = entry.rational.visibility;
  entry.sweep = sweep(entry.scene, truth);
  const double least = std::min_element(entry.sweep.begin(), entry.sweep.end(), [](auto& a, auto& b) {
                         return a.error < b.error;
                       })->error;
  bool first = true;
  for (auto it = entry.sweep.begin(); it != entry.sweep.end(); ++it) {
    if (it->error != least) continue;
    Answer tried = answer(entry.scene, truth, Arithmetic::plain_double, it->value);
    const bool closes = tried.visibility.unclosed == 0;
    if (first || tried.visibility.unclosed < entry.tuned.visibility.unclosed) {
      entry.tuned = std::move(tried);
      entry.tolerance = it->value;
      first = false;
    }
    if (!closes) continue;
    break;
  }
  entry.as_good_up_to = entry.tolerance;
  for (const Tolerance& t : entry.sweep)
    if (t.value > entry.as_good_up_to) {
      if (t.error != least) break;
      entry.as_good_up_to = t.value;
    }
}

}  // namespace

Entry evaluate(Case scene, std::uint32_t rays) {
  Entry entry;
  entry.scene = std::move(scene);
  entry.rational.visibility = look(entry.scene, Arithmetic::rational);
  entry.rational.same_hash = true;
  const CommonVisibility& truth = entry.rational.visibility;
  entry.fixed = answer(entry.scene, truth, Arithmetic::fixed);
  entry.filtered = answer(entry.scene, truth, Arithmetic::filtered);
  entry.plain = answer(entry.scene, truth, Arithmetic::plain_double);
  tune(entry);
  entry.sampling = sampling_error(truth, rays);
  entry.usual = shoot(entry.scene, truth, NaiveRays::Flags::usual, rays);
  entry.robust = shoot(entry.scene, truth, NaiveRays::Flags::robust, rays);
  return entry;
}

}  // namespace tubefoot::atlas
