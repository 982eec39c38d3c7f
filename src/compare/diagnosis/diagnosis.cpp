// SPDX-License-Identifier: GPL-3.0-or-later
// Diagnosis of a candidate: corrects the gains of its pings, aligns the reference with it, and subtracts the
// noise floor. findings.hpp names the systematic errors.
#include "compare/diagnosis/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/diagnosis/coarse_search.hpp"
#include "compare/diagnosis/findings.hpp"

namespace tubefoot {
namespace {

constexpr double least_ping_gain_db = 0.3;

/// The selected pings of the input, as arrays of their own.
struct Excerpt {
  EchoShape shape;
  std::vector<std::size_t> pings;  ///< numbers in the input
  std::vector<double> reference, candidate;
  std::vector<double> ranges_m, azimuths_deg;
};

Excerpt excerpt_of(const DiagnosisInput& input, std::size_t most_bins) {
  const EchoShape& all = input.pair.shape;
  const std::vector<std::size_t> pings = diagnosed_pings(all, most_bins);
  Excerpt excerpt{{pings.size(), all.beams, all.samples}, pings, {}, {}, {}, {}};
  for (const std::size_t ping : pings) {
    const auto first = static_cast<std::ptrdiff_t>(ping * all.beams * all.samples),
               last = first + static_cast<std::ptrdiff_t>(all.beams * all.samples);
    excerpt.reference.insert(excerpt.reference.end(), input.pair.reference_j.begin() + first,
                             input.pair.reference_j.begin() + last);
    excerpt.candidate.insert(excerpt.candidate.end(), input.pair.candidate_j.begin() + first,
                             input.pair.candidate_j.begin() + last);
  }
  excerpt.ranges_m.assign(input.pair.slant_range_m.begin(), input.pair.slant_range_m.end());
  excerpt.azimuths_deg.assign(input.beam_azimuth_deg.begin(), input.beam_azimuth_deg.end());
  return excerpt;
}

/// Sets small energies of the prediction to 0. Interpolation causes such energies in shadows.
std::vector<double> without_traces(const EchoShape& shape, std::vector<double> predicted_j,
                                   const std::vector<double>& levels_j) {
  for (std::size_t k = 0; k < predicted_j.size(); ++k)
    if (predicted_j[k] < 1e-3 * levels_j[k % shape.samples]) predicted_j[k] = 0;
  return predicted_j;
}

class Doctor {
 public:
  Doctor(const DiagnosisInput& input, std::size_t most_bins)
      : input_(input),
        excerpt_(excerpt_of(input, most_bins)),
        fan_(excerpt_.shape, excerpt_.azimuths_deg, excerpt_.ranges_m),
        steps_(steps_of(input.as_given)),
        as_read_(excerpt_.candidate) {
    if (input.labels) labels_ = labels_of_excerpt();
  }

  Diagnosis done() {
    const EchoShape& shape = excerpt_.shape;
    const double total = input_total(excerpt_.reference);
    if (!(total > 0) || !(input_total(excerpt_.candidate) > 0)) {
      if (total > 0)
        result_.findings.push_back(
            {"silent", 0, 0, "", "the candidate has no energy, but the reference has echoes", 1.0});
      return result_;
    }
    Pictures pictures{fan_, excerpt_.reference, excerpt_.candidate, faintest_step_j(), 0};
    Warp start = coarse_warp(pictures);
    std::vector<double> truth = clean(fan_.warped(excerpt_.reference, start));
    if (correct_ping_gains(truth)) {
      pictures.candidate_j = excerpt_.candidate;
      start = coarse_warp(pictures);
      truth = clean(fan_.warped(excerpt_.reference, start));
    }
    const auto fit =
        fit_energies({shape, truth, excerpt_.candidate, {}, excerpt_.ranges_m}, {true, false, false});
    const double gain = fit ? std::pow(10, fit->gain_db.value / 10) : 1;
    take_off_floor(pictures, truth, gain);
    align_both_ways(pictures, start);
    if (result_.floor.mean_j > 0) {  // again, with the positions of the echoes from the alignment
      take_off_floor(pictures, clean(result_.alignment.predicted_j), 1);
      align_both_ways(pictures, result_.alignment.warp);
    }
    leave_out_missing_shadows(pictures);
    const std::vector<MaterialLevel> materials = correct_materials(pictures);
    const Residual residual = residual_of(pictures);
    find_errors({input_, fan_, excerpt_.reference, pictures.reference_j, as_read_, gains_, materials,
                 residual, steps_},
                result_);
    along_fan(pictures);
    return result_;
  }

 private:
  static double input_total(const std::vector<double>& energy_j) {
    double total = 0;
    for (const double e : energy_j) total += e;
    return total;
  }
  /// Divides the candidate by the gains of its pings, if they differ. Returns whether it did.
  bool correct_ping_gains(const std::vector<double>& truth) {
    gains_ = ping_gains(excerpt_.shape, truth, excerpt_.candidate);
    if (!(gains_.spread_db.value > std::max(least_ping_gain_db, 5 * gains_.spread_db.error))) {
      gains_ = {std::vector<double>(excerpt_.shape.pings, 1.0), {}};
      return false;
    }
    const std::size_t of_ping = excerpt_.shape.beams * excerpt_.shape.samples;
    for (std::size_t k = 0; k < excerpt_.candidate.size(); ++k)
      excerpt_.candidate[k] /= gains_.factor[k / of_ping];
    return true;
  }
  /// Returns the labels of the selected pings.
  SceneLabels labels_of_excerpt() const {
    const SceneLabels& all = *input_.labels;
    SceneLabels labels{{}, {}, {}, all.material_names, all.object_names};
    const std::size_t bins = excerpt_.shape.beams * excerpt_.shape.samples;
    const auto copy = [&](const auto& from, auto& to) {
      for (const std::size_t ping : from.empty() ? std::vector<std::size_t>{} : excerpt_.pings) {
        const auto first = from.begin() + static_cast<std::ptrdiff_t>(ping * bins);
        to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(bins));
      }
    };
    copy(all.elevation_deg, labels.elevation_deg);
    copy(all.material, labels.material);
    copy(all.near_caster, labels.near_caster);
    return labels;
  }
  /// Returns the labels at the places where the candidate shows the bins of the reference.
  SceneLabels warped(const SceneLabels& labels, const Warp& warp) const {
    SceneLabels result{{}, {}, {}, labels.material_names, labels.object_names};
    const auto move = [&](const auto& from, auto& to, auto none) {
      to.assign(from.size(), none);
      for (std::size_t k = 0; k < from.size(); ++k)
        if (const auto source = fan_.source_of(warp, k)) to[k] = from[*source];
    };
    move(labels.elevation_deg, result.elevation_deg, NAN);
    move(labels.material, result.material, SceneLabels::none);
    move(labels.near_caster, result.near_caster, SceneLabels::none);
    return result;
  }

  /// The difference between candidate and prediction after the present alignment. It refers to members that
  /// the next call replaces.
  Residual residual_of(const Pictures& pictures) {
    const Alignment& alignment = result_.alignment;
    const std::vector<double> levels = row_levels(excerpt_.shape, alignment.predicted_j);
    predicted_ = without_traces(excerpt_.shape, alignment.predicted_j, levels);
    level_curve_ = alignment.level_curve;
    for (std::size_t s = 0; s < level_curve_.size() && alignment.fit.exponent.value != 0; ++s)
      level_curve_[s] *=
          std::pow(excerpt_.ranges_m[s] / alignment.fit.middle_range_m, alignment.fit.exponent.value);
    Residual residual{fan_,
                      predicted_,
                      pictures.candidate_j,
                      levels,
                      deep_shadow(excerpt_.shape, predicted_, 1, 2),
                      rows_that_count(predicted_, levels, pictures.faintest_j),
                      std::max(4 * result_.floor.deviation_j, 1.5 * step_j()),
                      level_curve_,
                      nullptr};
    if (labels_) {
      seen_labels_ = warped(*labels_, alignment.warp);
      residual.labels = &seen_labels_;
    }
    return residual;
  }

  /// Aligns again without the shadows that the candidate lacks, since their borders are no evidence of its
  /// displacement and blur.
  void leave_out_missing_shadows(Pictures& pictures) {
    constexpr std::size_t beams = 3, samples = 5;  // from a wrongly insonified bin to beyond the border
    const std::vector<bool> wrong = wrongly_lit(residual_of(pictures)).bins;
    if (static_cast<std::size_t>(std::ranges::count(wrong, true)) < least_wrongly_lit) return;
    pictures.left_out =
        deep_shadow(excerpt_.shape, std::vector<double>(wrong.begin(), wrong.end()), beams, samples);
    pictures.left_out.flip();
    align_both_ways(pictures, result_.alignment.warp);
  }

  /// Measures the levels of the materials. If they differ, scales the reference accordingly and aligns it
  /// again, since wrong levels of objects hide their blur and their displacement. Otherwise returns nothing.
  std::vector<MaterialLevel> correct_materials(Pictures& pictures) {
    if (!labels_ || labels_->material.empty()) return {};
    Residual residual = residual_of(pictures);
    leave_out_missing_rows(residual);
    std::vector<MaterialLevel> found =
        material_levels(residual, seen_labels_.material, seen_labels_.material_names.size());
    if (!differ(found)) return {};
    for (std::size_t k = 0; k < pictures.reference_j.size(); ++k)
      if (const std::uint16_t m = labels_->material[k]; m < found.size())
        pictures.reference_j[k] *= std::pow(10, found[m].db.value / 10);
    align_both_ways(pictures, result_.alignment.warp);
    return found;
  }

  std::vector<double> clean(const std::vector<double>& predicted_j) const {
    return without_traces(excerpt_.shape, predicted_j, row_levels(excerpt_.shape, predicted_j));
  }
  /// Returns the smallest step of the candidate from 0 if its values are quantised, in the unit of the
  /// comparison. It is the least difference between two values, because the smallest value may be many
  /// steps (a uniform seabed). For uniform steps of amplitude, it is the energy of one step of amplitude.
  double step_j() const {
    if (steps_.levels == 0) return 0;
    const bool amplitude = std::string(steps_.scale) == "amplitude";
    std::set<double> values;
    for (const double e : excerpt_.candidate)
      if (e > 0) values.insert(amplitude ? std::sqrt(e) : e);
    if (values.empty()) return 0;
    double step = *values.begin();
    for (auto next = values.begin(), value = next++; next != values.end(); value = next++)
      // Ignores differences by rounding.
      if (*next - *value > 1e-6 * *next) step = std::min(step, *next - *value);
    return amplitude ? step * step : step;
  }
  /// Returns the energy of three steps of energy or of amplitude. Below it the quantisation is too coarse.
  double faintest_step_j() const { return (std::string(steps_.scale) == "amplitude" ? 9 : 3) * step_j(); }
  std::vector<bool> rows_that_count(const std::vector<double>& predicted, const std::vector<double>& levels,
                                    double faintest_j) const {
    const EchoShape& shape = excerpt_.shape;
    std::vector<std::size_t> lit(shape.samples);
    for (std::size_t k = 0; k < predicted.size(); ++k)
      lit[k % shape.samples] += predicted[k] > 0.1 * levels[k % shape.samples];
    std::vector<bool> counts(shape.samples);
    for (std::size_t s = 0; s < shape.samples; ++s)
      counts[s] = 10 * lit[s] >= shape.pings * shape.beams && levels[s] > faintest_j;
    return counts;
  }

  /// Estimates the noise floor in the deep shadow and subtracts it.
  ///
  /// The order of the beams determines the position of the shadow. Noise that is clipped at 0 (about half
  /// of the bins are 0) adds less to bins with an echo. Its mean is sigma (phi(x) - x (1 - Phi(x))), with x
  /// the echo divided by sigma.
  void take_off_floor(Pictures& pictures, const std::vector<double>& truth, double gain) {
    NoiseFloor& floor = result_.floor;
    floor = noise_floor(excerpt_.shape, excerpt_.candidate, deep_shadow(excerpt_.shape, truth, 2, 4));
    pictures.candidate_j = excerpt_.candidate;
    pictures.first_row = 0;
    if (!(floor.mean_j > 0)) return;
    pictures.faintest_j = std::max(faintest_step_j(), 3 * floor.deviation_j);
    const bool clipped = floor.share_positive > 0.3 && floor.share_positive < 0.7;
    const double sigma = floor.mean_j * std::sqrt(2 * M_PI);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const double x = gain * truth[k] / sigma;
      pictures.candidate_j[k] -=
          clipped ? sigma * (std::exp(-x * x / 2) / std::sqrt(2 * M_PI) - x * std::erfc(x / std::sqrt(2)) / 2)
                  : floor.mean_j;
    }
  }

  /// Aligns twice if the candidate begins late. It may lack its near returns, or its echoes may be
  /// displaced. Keeps the alignment that explains the samples that both pictures have.
  void align_both_ways(Pictures& pictures, const Warp& start) {
    result_.alignment = align(pictures, start);
    const std::vector<double> levels = row_levels(excerpt_.shape, result_.alignment.predicted_j);
    const double noise_j = result_.floor.mean_j + 4 * result_.floor.deviation_j;
    const std::size_t first = first_row(excerpt_.candidate, levels, noise_j),
                      of_truth = first_row(result_.alignment.predicted_j, levels, noise_j);
    if (first < of_truth + 3) return;
    Pictures later = pictures;
    later.first_row = first + 2;
    const Alignment other = align(later, coarse_warp(later));
    const double of_first = misfit_under(later, result_.alignment.warp);
    const bool explains_all = result_.alignment.misfit < 1.15 * of_first;
    if (explains_all && other.misfit > 0.85 * of_first) return;
    result_.alignment = other;
    pictures = std::move(later);
  }
  /// Returns the first row in which at least three of ten beams have a significant echo.
  std::size_t first_row(const std::vector<double>& energy_j, const std::vector<double>& levels,
                        double noise_j) const {
    const EchoShape& shape = excerpt_.shape;
    for (std::size_t s = 0; s < shape.samples; ++s) {
      std::size_t lit = 0;
      for (std::size_t column = 0; column < shape.pings * shape.beams; ++column)
        lit += energy_j[column * shape.samples + s] > std::max(0.2 * levels[s], noise_j);
      if (10 * lit >= 3 * shape.pings * shape.beams) return s;
    }
    return 0;
  }

  /// Aligns parts of the fan separately, after the terms of the whole fan.
  void along_fan(const Pictures& pictures) {
    constexpr std::size_t parts = 6, least_beams = 8;
    const EchoShape& shape = excerpt_.shape;
    if (shape.beams < parts * least_beams) return;
    const std::vector<double>& predicted = result_.alignment.predicted_j;
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t first = part * shape.beams / parts, last = (part + 1) * shape.beams / parts;
      const EchoShape of_part{shape.pings, last - first, shape.samples};
      std::vector<double> truth, candidate;
      for (std::size_t ping = 0; ping < shape.pings; ++ping) {
        const auto from = static_cast<std::ptrdiff_t>((ping * shape.beams + first) * shape.samples),
                   to = static_cast<std::ptrdiff_t>((ping * shape.beams + last) * shape.samples);
        truth.insert(truth.end(), predicted.begin() + from, predicted.begin() + to);
        candidate.insert(candidate.end(), pictures.candidate_j.begin() + from,
                         pictures.candidate_j.begin() + to);
      }
      const std::vector<double> azimuths(excerpt_.azimuths_deg.begin() + static_cast<std::ptrdiff_t>(first),
                                         excerpt_.azimuths_deg.begin() + static_cast<std::ptrdiff_t>(last));
      if (!(input_total(truth) > 0) || !(input_total(candidate) > 0)) continue;
      const LocalEstimate local =
          local_shift({Fan(of_part, azimuths, excerpt_.ranges_m), truth, candidate, pictures.faintest_j});
      result_.along_fan.push_back({first, last - 1, local.beams, local.samples});
    }
  }

  const DiagnosisInput& input_;
  Excerpt excerpt_;
  Fan fan_;
  EvenSteps steps_;
  std::vector<double> as_read_;  // the candidate before the gains of its pings are corrected
  PingGains gains_;
  std::optional<SceneLabels> labels_;
  std::vector<double> predicted_, level_curve_;  // of the last residual
  SceneLabels seen_labels_;                      // at the positions of the bins of the last residual
  Diagnosis result_;
};

}  // namespace

bool Diagnosis::has(const std::string& fault) const {
  return std::ranges::any_of(findings, [&](const Finding& f) { return f.fault == fault; });
}

std::vector<std::size_t> diagnosed_pings(const EchoShape& shape, std::size_t most_bins) {
  const std::size_t bins = std::max<std::size_t>(shape.beams * shape.samples, 1),
                    count =
                        std::clamp<std::size_t>(most_bins / bins, 1, std::max<std::size_t>(shape.pings, 1));
  std::vector<std::size_t> pings;
  for (std::size_t k = 0; k < std::min(count, shape.pings); ++k) pings.push_back(k * shape.pings / count);
  return pings;
}

Diagnosis diagnose(const DiagnosisInput& input, std::size_t most_bins) {
  return Doctor(input, most_bins).done();
}

}  // namespace tubefoot
