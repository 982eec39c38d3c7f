// SPDX-License-Identifier: GPL-3.0-or-later
// Diagnosis of a candidate: aligns the reference with it, subtracts the noise floor, and looks for
// systematic errors. These are geometric displacements, blur, gain, range dependence, noise, errors at
// shadows, and quantisation. It divides the relative L1 error into the parts that these errors explain.
#include "compare/diagnosis/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/diagnosis/coarse_search.hpp"
#include "compare/diagnosis/residuals.hpp"

namespace tubefoot {
namespace {

// A finding exceeds five standard errors and a least relevant size.
constexpr double error_bars = 5, least_level_db = 0.3, least_exponent = 0.1, least_edge = 0.25;
constexpr std::size_t least_wrongly_lit = 12;

/// The selected pings of the input, as arrays of their own.
struct Excerpt {
  EchoShape shape;
  std::vector<double> reference, candidate;
  std::vector<double> ranges_m, azimuths_deg;
};

Excerpt excerpt_of(const DiagnosisInput& input, std::size_t most_bins) {
  const EchoShape& all = input.pair.shape;
  const std::size_t bins = all.beams * all.samples;
  const std::size_t pings = std::clamp<std::size_t>(most_bins / std::max<std::size_t>(bins, 1), 1, all.pings);
  Excerpt excerpt{{pings, all.beams, all.samples}, {}, {}, {}, {}};
  for (std::size_t k = 0; k < pings; ++k) {
    const auto first = static_cast<std::ptrdiff_t>(k * all.pings / pings * bins),
               last = first + static_cast<std::ptrdiff_t>(bins);
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

double relative_l1(std::span<const double> a, std::span<const double> truth,
                   const std::vector<bool>& left_out = {}) {
  double off = 0, sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += truth[k];
    if (left_out.empty() || !left_out[k]) off += std::abs(a[k] - truth[k]);
  }
  return sum > 0 ? off / sum : 0;
}

bool sure(double value, double error, double least) {
  return std::abs(value) > std::max(least, error_bars * error);
}

class Doctor {
 public:
  Doctor(const DiagnosisInput& input, std::size_t most_bins)
      : input_(input),
        excerpt_(excerpt_of(input, most_bins)),
        fan_(excerpt_.shape, excerpt_.azimuths_deg, excerpt_.ranges_m),
        steps_(steps_of(input.as_given)) {}

  Diagnosis done() {
    const EchoShape& shape = excerpt_.shape;
    const double total = input_total(excerpt_.reference);
    if (!(total > 0) || !(input_total(excerpt_.candidate) > 0)) {
      if (total > 0) add("silent", 0, 0, "", "the candidate has no energy, but the reference has echoes");
      return result_;
    }
    Pictures pictures{fan_, excerpt_.reference, excerpt_.candidate, faintest_step_j(), 0};
    const Warp start = coarse_warp(pictures);
    const std::vector<double> truth = clean(fan_.warped(excerpt_.reference, start));
    const auto fit =
        fit_energies({shape, truth, excerpt_.candidate, {}, excerpt_.ranges_m}, {true, false, false});
    const double gain = fit ? std::pow(10, fit->gain_db.value / 10) : 1;
    take_off_floor(pictures, truth, gain);
    align_both_ways(pictures, start);
    if (result_.floor.mean_j > 0) {  // again, with the positions of the echoes from the alignment
      take_off_floor(pictures, clean(result_.alignment.predicted_j), 1);
      align_both_ways(pictures, result_.alignment.warp);
    }
    const Alignment& alignment = result_.alignment;

    const std::vector<double> levels = row_levels(shape, alignment.predicted_j);
    const std::vector<double> predicted = without_traces(shape, alignment.predicted_j, levels);
    Residual residual{fan_,
                      predicted,
                      pictures.candidate_j,
                      levels,
                      deep_shadow(shape, predicted, 1, 2),
                      {},
                      std::max(4 * result_.floor.deviation_j, 1.5 * step_j())};
    residual.row_counts = rows_that_count(predicted, levels, pictures.faintest_j);

    order();
    displacement();
    blur();
    energies();
    noise(levels);
    shadows(residual);
    edges(residual);
    steps();
    attribution(residual, predicted);
    along_fan(pictures);
    return result_;
  }

 private:
  static double input_total(const std::vector<double>& energy_j) {
    double total = 0;
    for (const double e : energy_j) total += e;
    return total;
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

  void add(const char* fault, double size, double error, const char* unit, std::string words) {
    result_.findings.push_back({fault, size, error, unit, std::move(words)});
  }
  double error_of(WarpTerm term) const { return result_.alignment.errors[static_cast<std::size_t>(term)]; }

  void order() {
    const BeamOrder order = result_.alignment.warp.order;
    if (order == BeamOrder::mirrored && excerpt_.shape.beams == 2) {
      add("swapped-ports", 1, 0, "", "the port and starboard beams are swapped");
      return;
    }
    if (order == BeamOrder::mirrored || order == BeamOrder::halves_mirrored)
      add("mirror", 1, 0, "", "the order of the beams is reversed, so the picture is mirrored");
    if (order == BeamOrder::halves_swapped || order == BeamOrder::halves_mirrored)
      add("swapped-ports", 1, 0, "", "the two halves of the fan are swapped");
  }

  void displacement() {
    const Warp& warp = result_.alignment.warp;
    if (warp.beams != 0)
      add("beam-shift", warp.beams, error_of(WarpTerm::beams), "beams",
          fmt::format("the picture is displaced by {:+.3f} +- {:.3f} beams ({:+.3f} degrees)", warp.beams,
                      error_of(WarpTerm::beams), warp.beams * fan_.beam_deg()));
    if (warp.samples != 0) {
      const double error = error_of(WarpTerm::samples);
      const bool half = std::abs(std::abs(warp.samples) - 0.5) < std::max(0.12, 3 * error);
      add(half ? "half-sample" : "sample-shift", warp.samples, error, "samples",
          fmt::format(
              "the picture is displaced by {:+.3f} +- {:.3f} range bins ({:+.4f} m) to larger ranges{}",
              warp.samples, error, warp.samples * fan_.sample_m(),
              half ? ", probably because edges of bins are used as centres" : ""));
    }
    // Reports the displacement relative to the position in the candidate. A displacement k there is a
    // stretch of the reference by k / (1 - k).
    const auto stretched = [](double k) { return k / (1 - k); };
    if (const double scale = stretched(warp.azimuth_scale); scale != 0)
      add("azimuth-scale", scale, error_of(WarpTerm::azimuth_scale), "of the angle",
          fmt::format("azimuths differ by {:+.2f} +- {:.2f} %: the opening angle differs", 100 * scale,
                      100 * error_of(WarpTerm::azimuth_scale)));
    if (const double scale = stretched(warp.range_scale); scale != 0)
      add("range-scale", scale, error_of(WarpTerm::range_scale), "of the range",
          fmt::format("ranges differ by {:+.3f} +- {:.3f} %: the sound speed or the range gate differs",
                      100 * scale, 100 * error_of(WarpTerm::range_scale)));
    if (warp.tangent != 0) {
      const double most = fan_.largest_of_tangent(warp.views);
      add("tangent-spacing", warp.tangent * most, error_of(WarpTerm::tangent) * most, "beams at most",
          fmt::format("beams are equidistant in the tangent of their angle (share {:.2f} +- {:.2f}) in {} "
                      "view{}: they are displaced by up to {:.3f} beams",
                      warp.tangent, error_of(WarpTerm::tangent), warp.views, warp.views > 1 ? "s" : "",
                      std::abs(warp.tangent) * most));
    }
  }

  void blur() {
    const Warp& warp = result_.alignment.warp;
    if (!(warp.beam_blur > 0) && !(warp.sample_blur > 0)) return;
    const double size = std::sqrt(std::max(warp.beam_blur, warp.sample_blur));
    const WarpTerm larger = warp.beam_blur > warp.sample_blur ? WarpTerm::beam_blur : WarpTerm::sample_blur;
    add("blur", size, error_of(larger) / (2 * size), "bins",
        fmt::format("the picture is blurred by a Gaussian of {:.2f} beams and {:.2f} range bins (standard "
                    "deviations)",
                    std::sqrt(std::max(warp.beam_blur, 0.0)), std::sqrt(std::max(warp.sample_blur, 0.0))));
  }

  void energies() {
    const EnergyFit& fit = result_.alignment.fit;
    if (sure(fit.exponent.value, fit.exponent.error, least_exponent))
      add("range-law", fit.exponent.value, fit.exponent.error, "power of range",
          fmt::format(
              "energies have a different range dependence: r^{:+.2f} +- {:.2f} relative to the reference",
              fit.exponent.value, fit.exponent.error));
    if (sure(fit.gain_db.value, fit.gain_db.error, least_level_db))
      add("level", fit.gain_db.value, fit.gain_db.error, "dB",
          fmt::format("energies differ by {:+.2f} +- {:.2f} dB at {:.3g} m", fit.gain_db.value,
                      fit.gain_db.error, fit.middle_range_m));
  }

  void noise(const std::vector<double>& levels) {
    const NoiseFloor& floor = result_.floor;
    double middle = 0, rows = 0;
    for (const double level : levels) middle += level, ++rows;
    middle /= rows;
    if (floor.bins < 30 || floor.share_positive < 0.15 ||
        !sure(floor.mean_j, floor.mean_error_j, 1e-4 * middle))
      return;
    const double db = 10 * std::log10(floor.mean_j / middle);
    add("noise", db, 4.343 * floor.mean_error_j / floor.mean_j, "dB re the mean echo",
        fmt::format(
            "there is a noise floor {:.1f} dB below the mean echo, in {:.0f} % of the bins in shadows", -db,
            100 * floor.share_positive));
  }

  void shadows(const Residual& residual) {
    lit_ = wrongly_lit(residual);
    const auto area = [&](const char* fault, std::size_t bins, std::size_t of, const char* words) {
      if (bins < least_wrongly_lit) return;
      add(fault, static_cast<double>(bins), std::sqrt(static_cast<double>(bins)), "bins",
          fmt::format("{}: {} bins have echoes, {:.0f} % of the bins in such shadows", words, bins,
                      100 * static_cast<double>(bins) / static_cast<double>(of)));
    };
    area("missing-shadow", lit_.behind_seen, lit_.shadows_of_seen,
         "shadows behind visible surfaces are missing");
    area("near-clipping", lit_.behind_unseen, lit_.shadows_of_unseen,
         "surfaces nearer than the first range bin cast no shadow");
    if (const auto range_m = near_returns_missing_to(residual))
      add("near-returns-missing", *range_m, fan_.sample_m() / 2, "m",
          fmt::format(
              "there are no echoes nearer than {:.3f} +- {:.3f} m, but the reference has nearer echoes",
              *range_m, fan_.sample_m() / 2));
  }

  void edges(const Residual& residual) {
    const Scallops found = scallops(residual);
    if (found.alikeness > 4.5 && sure(found.peak_to_peak, found.error / 2, 0.3))
      add("scalloped-edge", found.peak_to_peak, found.error, "samples",
          fmt::format("the near edge of the fan is scalloped by {:.2f} +- {:.2f} range bins from crest to "
                      "trough, similarly in adjacent beams",
                      found.peak_to_peak, found.error));
    result_.sides = shadow_sides(residual);
    result_.ends = shadow_ends(residual);
    const auto edge = [&](const char* fault, const EdgeOffsets& offsets, const char* unit,
                          const char* where) {
      if (offsets.edges >= 20 && sure(offsets.mean.value, offsets.mean.error, least_edge))
        add(fault, offsets.mean.value, offsets.mean.error, unit,
            fmt::format("shadows differ in size by {:+.2f} +- {:.2f} {} (spread of single edges {:.2f})",
                        offsets.mean.value, offsets.mean.error, where, offsets.spread));
    };
    if (lit_.behind_seen < least_wrongly_lit && lit_.behind_unseen < least_wrongly_lit) {
      edge("shadow-sides", result_.sides, "beams", "beams at each side");
      edge("shadow-ends", result_.ends, "samples", "range bins at each end");
    }
    result_.scatter = scatter(residual);
  }

  void steps() {
    if (steps_.levels > 0 && steps_.levels <= 256)
      add("8-bits", static_cast<double>(steps_.levels), 0, "levels",
          fmt::format("the picture has only {} different values{}{}", steps_.levels,
                      *steps_.scale ? ", in uniform steps of " : "", steps_.scale));
    else if (steps_.levels > 0)
      add("steps", static_cast<double>(steps_.levels), 0, "levels",
          fmt::format("the picture has only {} different values", steps_.levels));
    if (steps_.share_at_top > 0.002)
      add("clamped", 100 * steps_.share_at_top, 0, "% of the bins with an echo",
          fmt::format(
              "{:.2g} % of the bins with an echo have exactly the largest value, so the values are clamped",
              100 * steps_.share_at_top));
  }

  void attribution(const Residual& residual, const std::vector<double>& predicted) {
    const EchoShape& shape = excerpt_.shape;
    const EnergyFit& fit = result_.alignment.fit;
    result_.l1 = relative_l1(excerpt_.candidate, excerpt_.reference);
    const std::vector<double> fitted =
        fit.fitted({shape, excerpt_.reference, excerpt_.candidate, {}, excerpt_.ranges_m});
    result_.l1_after_gain = relative_l1(fitted, excerpt_.reference);
    // The prediction is in the unit of the candidate, so gain and range dependence apply to both sides.
    const std::vector<double> should = fit.fitted({shape, predicted, predicted, {}, excerpt_.ranges_m});
    result_.l1_after_warp = relative_l1(fitted, should);
    const std::vector<double> less_floor =
        fit.fitted({shape, predicted, residual.candidate_j, {}, excerpt_.ranges_m});
    result_.l1_left = relative_l1(less_floor, should, lit_.bins);
    if (!input_.ideal_j.empty()) result_.ideal_l1 = relative_l1(input_.ideal_j, input_.pair.reference_j);
    if (input_.ideal_j.empty()) return;
    const std::vector<double> levels =
        row_levels(input_.pair.shape, {input_.pair.reference_j.begin(), input_.pair.reference_j.end()});
    const Fan whole(input_.pair.shape, excerpt_.azimuths_deg, excerpt_.ranges_m);
    const std::vector<double> reference(input_.pair.reference_j.begin(), input_.pair.reference_j.end());
    const double of_ideal =
        scatter({whole, reference, input_.ideal_j, levels, {}, std::vector<bool>(levels.size(), true), 0});
    const double more = std::sqrt(std::max(0.0, result_.scatter * result_.scatter - of_ideal * of_ideal));
    if (result_.floor.deviation_j == 0 && more > 0.05 && more > 0.75 * of_ideal)
      add("speckle", more, 0.1 * of_ideal, "of the energy",
          fmt::format("the energies of single bins scatter by {:.0f} %, but those of a perfect engine with "
                      "the same sampling by {:.0f} %",
                      100 * result_.scatter, 100 * of_ideal));
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
  WronglyLit lit_;
  Diagnosis result_;
};

}  // namespace

bool Diagnosis::has(const std::string& fault) const {
  return std::ranges::any_of(findings, [&](const Finding& f) { return f.fault == fault; });
}

Diagnosis diagnose(const DiagnosisInput& input, std::size_t most_bins) {
  return Doctor(input, most_bins).done();
}

}  // namespace tubefoot
