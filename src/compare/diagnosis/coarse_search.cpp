// SPDX-License-Identifier: GPL-3.0-or-later
// Coarse search for the warp. It tries orders of the beams, shifts and scales on blurred pictures whose
// rows are divided by their levels. Each accepted warp must reduce the misfit by a given factor.
#include "compare/diagnosis/coarse_search.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Tries warps on blurred pictures, each divided by its own row levels.
class CoarseSearch {
 public:
  explicit CoarseSearch(const Pictures& pictures)
      : fan_(pictures.fan),
        first_row_(pictures.first_row),
        reference_(coarse(pictures.reference_j)),
        candidate_(without_first_rows(coarse(pictures.candidate_j))) {}

  Warp found() {
    best_ = misfit(warp_);
    shift_around(warp_);
    for (const BeamOrder order :
         {BeamOrder::mirrored, BeamOrder::halves_swapped, BeamOrder::halves_mirrored}) {
      if (order != BeamOrder::mirrored && fan_.shape().beams < 4) continue;
      const Warp kept = warp_;
      const double before = best_;
      warp_ = {};
      warp_.order = order;
      best_ = misfit(warp_);
      shift_around(warp_);
      // Another order must be clearly better, because a scene may be almost symmetric.
      if (best_ < 0.9 * before) continue;
      warp_ = kept;
      best_ = before;
    }
    for (int round = 0; round < 2; ++round) {
      const double before = best_;
      scale_ranges();
      if (fan_.has_width()) scale_azimuths();
      if (best_ == before) break;
    }
    return warp_;
  }

 private:
  std::vector<double> coarse(const std::vector<double>& energy_j) const {
    constexpr double variance = 2;
    return fan_.blurred(as_seen(fan_.shape(), energy_j, row_levels(fan_.shape(), energy_j)),
                        fan_.has_width() ? variance : 0, variance);
  }
  std::vector<double> without_first_rows(std::vector<double> picture) const {
    for (std::size_t k = 0; k < picture.size(); ++k)
      if (k % fan_.shape().samples < first_row_) picture[k] = 0;
    return picture;
  }
  double misfit(const Warp& warp) const {
    return misfit_of(without_first_rows(fan_.warped(reference_, warp)), candidate_);
  }

  /// Accepts the warp if its misfit is below `must_be` times the best misfit.
  void attempt(const Warp& warp, double must_be) {
    const double value = misfit(warp);
    if (!(value < must_be * best_)) return;
    best_ = value;
    warp_ = warp;
  }

  void shift_around(const Warp& centre) {
    const int reach = fan_.has_width() ? 3 : 0;
    for (int b = -reach; b <= reach; ++b)
      for (int s = -5; s <= 5; ++s) {
        Warp warp = centre;
        warp.beams += 2 * b;
        warp.samples += 2 * s;
        attempt(warp, 0.98);
      }
    stop_if_wanted();
  }

  void scale_ranges() {
    const Warp centre = warp_;
    const std::size_t samples = fan_.shape().samples;
    const double far = fan_.range_m(samples - 1) / fan_.sample_m(),
                 middle = fan_.range_m(samples / 2) / fan_.sample_m(), step = std::max(2 / far, 0.002);
    for (double scale = -0.1; scale <= 0.1; scale += step) {
      Warp warp = centre;
      warp.range_scale += scale;
      attempt(warp, 0.96);
      // Also tries a scale about the middle of the range gate, which is a scale and a shift.
      for (int s = -4; s <= 4; ++s) {
        warp.samples = centre.samples - scale * middle + 2 * s;
        attempt(warp, 0.94);
      }
    }
    stop_if_wanted();
  }

  void scale_azimuths() {
    const Warp centre = warp_;
    const double edge = static_cast<double>(fan_.shape().beams) / 2, step = std::max(1.5 / edge, 0.01);
    const auto shifted = [&](const Warp& warp) {
      for (int b = -3; b <= 3; ++b) {
        Warp moved = warp;
        moved.beams += 1.5 * b;
        attempt(moved, 0.97);
      }
    };
    for (const int views : {1, 2, 3}) {
      if (fan_.largest_of_tangent(views) < 0.5) continue;
      Warp warp = centre;
      warp.views = views;
      warp.tangent = 1;
      shifted(warp);
    }
    for (double scale = -0.15; scale <= 0.15; scale += step) {
      Warp warp = centre;
      warp.azimuth_scale += scale;
      shifted(warp);
    }
    stop_if_wanted();
  }

  const Fan& fan_;
  std::size_t first_row_;
  std::vector<double> reference_, candidate_;
  Warp warp_;
  double best_ = 2;
};

}  // namespace

Warp coarse_warp(const Pictures& pictures) { return CoarseSearch(pictures).found(); }

std::vector<double> as_seen(const EchoShape& shape, const std::vector<double>& energy_j,
                            const std::vector<double>& levels_j) {
  std::vector<double> picture(energy_j.size());
  for (std::size_t k = 0; k < picture.size(); ++k) {
    const double x = energy_j[k] / levels_j[k % shape.samples] / 2;
    picture[k] = x < 1 ? x : 1 + std::log(x);
  }
  return picture;
}

double misfit_of(const std::vector<double>& a, const std::vector<double>& b) {
  double off = 0, sum = 1e-300;
  for (std::size_t k = 0; k < a.size(); ++k) {
    off += std::abs(a[k] - b[k]);
    sum += std::abs(a[k]) + std::abs(b[k]);
  }
  return off / sum;
}

}  // namespace tubefoot
