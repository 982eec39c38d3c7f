// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/entry.hpp"

#include <algorithm>
#include <utility>

namespace tubefoot::atlas {
namespace {

Answer answer(const Case& scene, const Sight& truth, Arithmetic arithmetic, double tolerance = 0) {
  Answer a;
  a.sight = look(scene, arithmetic, tolerance);
  a.error = error_of(a.sight, truth);
  a.same_hash = a.sight.hash == truth.hash;
  return a;
}

/// The best of the sweep: the least error, then the fewest tubes that do not close, then the least tolerance.
void tune(Entry& entry) {
  const Sight& truth = entry.rational.sight;
  entry.sweep = sweep(entry.scene, truth);
  const double least = std::min_element(entry.sweep.begin(), entry.sweep.end(), [](auto& a, auto& b) {
                         return a.error < b.error;
                       })->error;
  bool first = true;
  for (auto it = entry.sweep.begin(); it != entry.sweep.end(); ++it) {
    if (it->error != least) continue;
    Answer tried = answer(entry.scene, truth, Arithmetic::plain_double, it->value);
    const bool closes = tried.sight.unclosed == 0;
    if (first || tried.sight.unclosed < entry.tuned.sight.unclosed) {
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
  entry.rational.sight = look(entry.scene, Arithmetic::rational);
  entry.rational.same_hash = true;
  const Sight& truth = entry.rational.sight;
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
