// SPDX-License-Identifier: GPL-3.0-or-later
// Names the systematic errors of an aligned candidate. The share of an error is the part of the relative L1
// error that returns if this error alone is left uncorrected.
#include "compare/diagnosis/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

// A finding exceeds five standard errors and a least relevant size.
constexpr double error_bars = 5, least_level_db = 0.3, least_exponent = 0.1, least_edge = 0.25,
                 least_profile_db = 1, least_scallop = 0.3;
constexpr double least_share_of_shadow = 0.05, least_share_of_law = 0.02;

bool sure(double value, double error, double least) {
  return std::abs(value) > std::max(least, error_bars * error);
}

double relative_l1(std::span<const double> a, std::span<const double> reference,
                   const std::vector<bool>& left_out = {}) {
  double off = 0, sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += reference[k];
    if (left_out.empty() || !left_out[k]) off += std::abs(a[k] - reference[k]);
  }
  return sum > 0 ? off / sum : 0;
}

class Findings {
 public:
  Findings(const AlignedCandidate& aligned, Diagnosis& result)
      : in_(aligned),
        result_(result),
        alignment_(result.alignment),
        fan_(aligned.fan),
        r_(aligned.residual) {}

  void find() {
    measure_errors();
    level();
    pings();
    order();
    displacement();
    blur();
    noise();
    shadows();
    edges();
    steps();
    scatter_of_bins();
    materials();
    std::ranges::stable_sort(result_.findings, [](const Finding& a, const Finding& b) {
      const auto key = [](const Finding& f) {
        const bool of_fit = f.fault == "level" || f.fault == "range-law" || f.fault == "offset";
        return std::pair(of_fit ? 0 : f.share ? 1 : 2, -f.share.value_or(0));
      };
      return key(a) < key(b);
    });
  }

 private:
  void add(const char* fault, double size, double error, const char* unit, std::string words,
           std::optional<double> share = std::nullopt) {
    if (share) share = std::clamp(*share, 0.0, 1.0);
    result_.findings.push_back({fault, size, error, unit, std::move(words), share});
  }
  double error_of(WarpTerm term) const { return alignment_.errors[static_cast<std::size_t>(term)]; }

  std::vector<double> fitted(std::span<const double> energy_j) const {
    return alignment_.fit.fitted({fan_.shape(), in_.reference_j, energy_j, {}, fan_.ranges_m()});
  }
  /// The prediction under another warp, in the unit of the reference.
  std::vector<double> predicted(const Warp& warp, bool with_curve = true) const {
    std::vector<double> energy =
        fan_.warped({in_.model_reference_j.begin(), in_.model_reference_j.end()}, warp);
    for (std::size_t k = 0; with_curve && k < energy.size(); ++k)
      energy[k] *= alignment_.level_curve[k % fan_.shape().samples];
    return energy;
  }
  double l1_under(const Warp& warp, bool with_curve = true) const {
    return relative_l1(candidate_, predicted(warp, with_curve));
  }
  /// Share of an error whose absence lets the error grow from that of the whole model to `l1`.
  double share(double l1) const { return base_ > 0 ? (l1 - result_.l1_after_warp) / base_ : 0; }
  template <class Change>
  double share_of_warp(const Change& change) const {
    Warp warp = alignment_.warp;
    change(warp);
    return share(l1_under(warp));
  }

  void measure_errors() {
    std::vector<double> without_gains(in_.candidate_j.begin(), in_.candidate_j.end());
    const std::size_t of_ping = fan_.shape().beams * fan_.shape().samples;
    for (std::size_t k = 0; k < without_gains.size(); ++k) without_gains[k] /= in_.gains.factor[k / of_ping];
    candidate_ = fitted(without_gains);
    result_.l1 = relative_l1(in_.candidate_j, in_.reference_j);
    result_.l1_after_gain = relative_l1(fitted(in_.candidate_j), in_.reference_j);
    const auto of_gain = fit_energies({fan_.shape(), in_.reference_j, in_.candidate_j, {}, fan_.ranges_m()},
                                      {true, false, false});
    l1_after_gain_alone_ =
        of_gain ? relative_l1(
                      of_gain->fitted({fan_.shape(), in_.reference_j, in_.candidate_j, {}, fan_.ranges_m()}),
                      in_.reference_j)
                : result_.l1;
    result_.l1_after_warp = l1_under(alignment_.warp);
    base_ = result_.l1_after_gain;
    lit_ = wrongly_lit(r_);
    scallops_ = scallops(r_);
    result_.l1_left = relative_l1(fitted(r_.candidate_j), fitted(r_.predicted_j), lit_.bins);
    if (!in_.input.ideal_j.empty())
      result_.ideal_l1 = relative_l1(in_.input.ideal_j, in_.input.pair.reference_j);
  }

  /// Adds gain and range dependence, those removed before and those found now, and the level over elevation
  /// or range that remains.
  void level() {
    const LevelProfile over_range = level_over_range(plain_residual(true));
    const bool curved = sure(over_range.spread_db.value, over_range.spread_db.error, least_profile_db);
    const EnergyFit& fit = alignment_.fit;
    Estimate gain_db = fit.gain_db;
    bool vertical = false;
    if (const SceneLabels* labels = r_.labels; curved && labels && !labels->elevation_deg.empty()) {
      const LevelProfile over_elevation = level_over_elevation(plain_residual(false), labels->elevation_deg);
      // A curve over range fits as well on a flat seabed. The elevation is the simpler cause.
      vertical = over_elevation.at.size() > 1 && over_elevation.misfit < 2 * over_range.misfit &&
                 sure(over_elevation.spread_db.value, over_elevation.spread_db.error, least_profile_db);
      if (vertical) {
        add_profile("vertical-pattern", over_elevation, "elevation", "degrees");
        gain_db = {gain_db.value + over_elevation.largest_db,
                   std::hypot(gain_db.error, over_elevation.spread_db.error)};
      }
    }
    const EnergyFit* before = in_.input.fit;
    if (before && before->terms.gain)
      add("level", before->gain_db.value, before->gain_db.error, "dB",
          fmt::format("energies differ by {:+.2f} +- {:.2f} dB at {:.3g} m; --fit corrects this",
                      before->gain_db.value, before->gain_db.error, before->middle_range_m),
          fit_share());
    if (before && before->terms.range)
      add("range-law", before->exponent.value, before->exponent.error, "power of range",
          fmt::format("energies have a different range dependence: r^{:+.2f} +- {:.2f} relative to the "
                      "reference; --fit corrects this",
                      before->exponent.value, before->exponent.error),
          fit_share());
    const double share_of_law = law_share();
    if (!vertical && sure(fit.exponent.value, fit.exponent.error, least_exponent) &&
        share_of_law > least_share_of_law)
      add("range-law", fit.exponent.value, fit.exponent.error, "power of range",
          fmt::format(
              "energies have a different range dependence: r^{:+.2f} +- {:.2f} relative to the reference",
              fit.exponent.value, fit.exponent.error),
          share_of_law);
    // After --fit, the level at the largest value of a pattern follows from the pattern.
    const bool follows = vertical && before && before->terms.gain;
    if (!follows && sure(gain_db.value, gain_db.error, least_level_db))
      add("level", gain_db.value, gain_db.error, "dB",
          vertical
              ? fmt::format("energies differ by {:+.2f} +- {:.2f} dB where the vertical pattern is largest",
                            gain_db.value, gain_db.error)
              : fmt::format("energies differ by {:+.2f} +- {:.2f} dB at {:.3g} m", gain_db.value,
                            gain_db.error, fit.middle_range_m),
          result_.l1 > 0 ? 1 - l1_after_gain_alone_ / result_.l1 : 0);
    if (curved && !vertical) add_profile("range-curve", over_range, "range", "m");
  }
  /// Share of the error of the aligned candidate, without the level curve, that the power of range removes.
  double law_share() const {
    const EnergyFit& fit = alignment_.fit;
    std::vector<double> without_power = candidate_;
    for (std::size_t k = 0; k < without_power.size(); ++k)
      without_power[k] *=
          std::pow(fan_.range_m(k % fan_.shape().samples) / fit.middle_range_m, fit.exponent.value);
    const std::vector<double> plain = predicted(alignment_.warp, false);
    const double before = relative_l1(without_power, plain);
    return before > 0 ? 1 - relative_l1(candidate_, plain) / before : 0;
  }
  /// Share that --fit has removed.
  double fit_share() const {
    const double before = in_.input.l1_before_fit;
    return before > 0 ? 1 - result_.l1 / before : 0;
  }
  /// The residual without the level curve, which hides what this class looks for, and with or without the
  /// power of range.
  Residual plain_residual(bool with_power) {
    const EnergyFit& fit = alignment_.fit;
    plain_j_.assign(r_.predicted_j.begin(), r_.predicted_j.end());
    for (std::size_t k = 0; k < plain_j_.size(); ++k) {
      const std::size_t s = k % fan_.shape().samples;
      plain_j_[k] /= alignment_.level_curve[s];
      if (!with_power && fit.exponent.value != 0)
        plain_j_[k] /= std::pow(fan_.range_m(s) / fit.middle_range_m, fit.exponent.value);
    }
    Residual plain = r_;
    leave_out_missing_rows(plain);
    if (is_scalloped()) leave_out_edge(plain_j_);
    plain.predicted_j = plain_j_;
    return plain;
  }
  /// Removes the rows that a scalloped edge displaces. Their level is not that of a pattern.
  void leave_out_edge(std::vector<double>& predicted_j) const {
    const std::size_t samples = fan_.shape().samples,
                      rows = static_cast<std::size_t>(std::ceil(scallops_.depth.value)) + 1;
    for (std::size_t from = 0; from < predicted_j.size(); from += samples) {
      std::size_t s = 0;
      while (s < samples && !(predicted_j[from + s] > 0.1 * r_.levels_j[s])) ++s;
      for (std::size_t k = s; k < std::min(s + rows, samples); ++k) predicted_j[from + k] = 0;
    }
  }
  void add_profile(const char* fault, const LevelProfile& profile, const char* coordinate, const char* unit) {
    std::string list;
    for (std::size_t k = 0; k < profile.at.size(); ++k)
      list += fmt::format("{}{:+.1f} dB at {:.3g} {}", k > 0 ? ", " : "", profile.db[k], profile.at[k], unit);
    add(fault, profile.spread_db.value, profile.spread_db.error, "dB",
        fmt::format("the level of the candidate depends on {}: {}", coordinate, list),
        share(l1_under(alignment_.warp, false)));
  }

  void pings() {
    const Estimate& spread = in_.gains.spread_db;
    if (spread.value == 0) return;
    const std::vector<double> with_gains = fitted(in_.candidate_j);
    add("ping-gain", spread.value, spread.error, "dB",
        fmt::format("the gain changes from ping to ping, by up to {:.2f} +- {:.2f} dB", spread.value,
                    spread.error),
        share(relative_l1(with_gains, predicted(alignment_.warp))));
  }

  void order() {
    const BeamOrder order = alignment_.warp.order;
    const double part = share_of_warp([](Warp& w) { w.order = BeamOrder::as_is; });
    if (order == BeamOrder::mirrored && fan_.shape().beams == 2) {
      add("swapped-ports", 1, 0, "", "the port and starboard beams are swapped", part);
      return;
    }
    if (order == BeamOrder::mirrored || order == BeamOrder::halves_mirrored)
      add("mirror", 1, 0, "", "the order of the beams is reversed, so the picture is mirrored", part);
    if (order == BeamOrder::halves_swapped || order == BeamOrder::halves_mirrored)
      add("swapped-ports", 1, 0, "", "the two halves of the fan are swapped", part);
  }

  void displacement() {
    const Warp& warp = alignment_.warp;
    if (warp.beams != 0)
      add("beam-shift", warp.beams, error_of(WarpTerm::beams), "beams",
          fmt::format("the picture is displaced by {:+.3f} +- {:.3f} beams ({:+.3f} degrees)", warp.beams,
                      error_of(WarpTerm::beams), warp.beams * fan_.beam_deg()),
          share_of_warp([](Warp& w) { w.beams = 0; }));
    if (warp.samples != 0) {
      const double error = error_of(WarpTerm::samples);
      const bool half = std::abs(std::abs(warp.samples) - 0.5) < std::max(0.12, 3 * error);
      add(half ? "half-sample" : "sample-shift", warp.samples, error, "samples",
          fmt::format(
              "the picture is displaced by {:+.3f} +- {:.3f} range bins ({:+.4f} m) to larger ranges{}",
              warp.samples, error, warp.samples * fan_.sample_m(),
              half ? ", probably because edges of bins are used as centres" : ""),
          share_of_warp([](Warp& w) { w.samples = 0; }));
    }
    // Reports the displacement relative to the position in the candidate. A displacement k there is a
    // stretch of the reference by k / (1 - k).
    const auto stretched = [](double k) { return k / (1 - k); };
    if (const double scale = stretched(warp.azimuth_scale); scale != 0)
      add("azimuth-scale", scale, error_of(WarpTerm::azimuth_scale), "of the angle",
          fmt::format("azimuths differ by {:+.2f} +- {:.2f} %: the opening angle differs", 100 * scale,
                      100 * error_of(WarpTerm::azimuth_scale)),
          share_of_warp([](Warp& w) { w.azimuth_scale = 0; }));
    if (const double scale = stretched(warp.range_scale); scale != 0)
      add("range-scale", scale, error_of(WarpTerm::range_scale), "of the range",
          fmt::format("ranges differ by {:+.3f} +- {:.3f} %: the sound speed or the range gate differs",
                      100 * scale, 100 * error_of(WarpTerm::range_scale)),
          share_of_warp([](Warp& w) { w.range_scale = 0; }));
    if (warp.tangent != 0) {
      const double most = fan_.largest_of_tangent(warp.views);
      add("tangent-spacing", warp.tangent * most, error_of(WarpTerm::tangent) * most, "beams at most",
          fmt::format("beams are equidistant in the tangent of their angle (share {:.2f} +- {:.2f}) in {} "
                      "view{}: they are displaced by up to {:.3f} beams",
                      warp.tangent, error_of(WarpTerm::tangent), warp.views, warp.views > 1 ? "s" : "",
                      std::abs(warp.tangent) * most),
          share_of_warp([](Warp& w) { w.tangent = 0; }));
    }
    unresolved();
  }

  /// Displacements that were not found, with the sizes that would have been found.
  void unresolved() {
    const auto size = [&](WarpTerm term) { return alignment_.resolvable[static_cast<std::size_t>(term)]; };
    const auto note = [&](WarpTerm term, const char* fault, double scale, const char* unit,
                          std::string remark = {}) {
      if (size(term) > 0) result_.not_found.push_back({fault, scale * size(term), unit, std::move(remark)});
    };
    note(WarpTerm::samples, "sample-shift", 1, "range bins");
    note(WarpTerm::range_scale, "range-scale", 100, "%");
    note(WarpTerm::beams, "beam-shift", 1, "beams");
    note(WarpTerm::azimuth_scale, "azimuth-scale", 100, "%");
    const int views = fan_.usual_views();
    note(WarpTerm::tangent, "tangent-spacing", 1, "beams",
         fmt::format("in {} view{} it displaces beams by up to {:.3f} beams", views, views > 1 ? "s" : "",
                     fan_.largest_of_tangent(views)));
  }

  void blur() {
    const Warp& warp = alignment_.warp;
    const auto deviation = [](double variance) { return std::sqrt(std::max(variance, 0.0)); };
    if (warp.beam_blur > 0 || warp.sample_blur > 0) {
      const double size = deviation(std::max(warp.beam_blur, warp.sample_blur));
      const WarpTerm larger = warp.beam_blur > warp.sample_blur ? WarpTerm::beam_blur : WarpTerm::sample_blur;
      add("blur", size, error_of(larger) / (2 * size), "bins",
          fmt::format("the picture is blurred by a Gaussian of {:.2f} beams and {:.2f} range bins (standard "
                      "deviations)",
                      deviation(warp.beam_blur), deviation(warp.sample_blur)),
          share_of_warp([](Warp& w) { w.beam_blur = w.sample_blur = 0; }));
    }
    if (warp.beam_growth > 0 || warp.sample_growth > 0) {
      const WarpTerm larger =
          warp.beam_growth > warp.sample_growth ? WarpTerm::beam_growth : WarpTerm::sample_growth;
      const double size = deviation(value_of(warp, larger));
      add("range-spread", size, error_of(larger) / (2 * size), "bins",
          fmt::format(
              "a blur grows in proportion to range, to {:.2f} beams and {:.2f} range bins at the last "
              "range bin (standard deviations)",
              deviation(warp.beam_growth), deviation(warp.sample_growth)),
          share_of_warp([](Warp& w) { w.beam_growth = w.sample_growth = 0; }));
    }
  }

  void noise() {
    const NoiseFloor& floor = result_.floor;
    double middle = 0, rows = 0;
    for (const double level : r_.levels_j) middle += level, ++rows;
    middle /= rows;
    if (floor.bins < 30 || floor.share_positive < 0.15 ||
        !sure(floor.mean_j, floor.mean_error_j, 1e-4 * middle))
      return;
    const double db = 10 * std::log10(floor.mean_j / middle);
    const double without_floor = relative_l1(fitted(r_.candidate_j), fitted(r_.predicted_j));
    add("noise", db, 4.343 * floor.mean_error_j / floor.mean_j, "dB re the mean echo",
        fmt::format(
            "there is a noise floor {:.1f} dB below the mean echo, in {:.0f} % of the bins in shadows", -db,
            100 * floor.share_positive),
        base_ > 0 ? (result_.l1_after_warp - without_floor) / base_ : 0);
  }

  /// Share of the bins that are set, or of the differences in them.
  template <class InGroup>
  double share_of_bins(const InGroup& in_group) const {
    const std::vector<double> c = fitted(r_.candidate_j), p = fitted(r_.predicted_j);
    double off = 0, total = 0;
    for (std::size_t k = 0; k < c.size(); ++k) {
      total += in_.reference_j[k];
      if (in_group(k)) off += std::abs(c[k] - p[k]);
    }
    return base_ > 0 && total > 0 ? off / total / base_ : 0;
  }

  void shadows() {
    // Both kinds of shadows share the error in the bins that have echoes.
    const double part = share_of_bins([&](std::size_t k) { return lit_.bins[k]; });
    const auto all_wrong = static_cast<std::size_t>(std::ranges::count(lit_.bins, true));
    const auto area = [&](const char* fault, const ShadowCount& count, const std::string& words) {
      if (count.wrong < least_wrongly_lit || double(count.wrong) < least_share_of_shadow * double(count.all))
        return;
      add(fault, static_cast<double>(count.wrong), std::sqrt(static_cast<double>(count.wrong)), "bins",
          fmt::format("{}: {} bins have echoes, {:.0f} % of these shadows", words, count.wrong,
                      100 * static_cast<double>(count.wrong) / static_cast<double>(count.all)),
          all_wrong > 0 ? part * static_cast<double>(count.wrong) / static_cast<double>(all_wrong) : 0);
    };
    area("missing-shadow", lit_.behind_seen, "shadows behind visible surfaces are missing");
    ShadowCount named;
    std::string names;
    for (std::size_t object = 0; object < lit_.of_object.size(); ++object) {
      const ShadowCount& count = lit_.of_object[object];
      // Echoes in a small part of a shadow may belong to another error.
      if (double(count.wrong) < least_share_of_shadow * double(count.all) || count.wrong < least_wrongly_lit)
        continue;
      names += (names.empty() ? "" : ", ") + r_.labels->object_names[object];
      named.wrong += count.wrong;
      named.all += count.all;
    }
    if (named.wrong > 0)
      area("near-clipping", named,
           fmt::format("{}, nearer than the first range bin, casts no shadow", names));
    else
      area("near-clipping", lit_.behind_unseen, "surfaces nearer than the first range bin cast no shadow");
    if (const auto range_m = near_returns_missing_to(r_))
      add("near-returns-missing", *range_m, fan_.sample_m() / 2, "m",
          fmt::format(
              "there are no echoes nearer than {:.3f} +- {:.3f} m, but the reference has nearer echoes",
              *range_m, fan_.sample_m() / 2),
          share_of_bins([&](std::size_t k) { return fan_.range_m(k % fan_.shape().samples) < *range_m; }));
  }

  void edges() {
    const Scallops& found = scallops_;
    if (is_scalloped())
      add("scalloped-edge", found.depth.value, found.depth.error, "samples",
          fmt::format("the near edge of the fan is scalloped by {:.2f} +- {:.2f} range bins from crest to "
                      "trough, in {} equal arc{}",
                      found.depth.value, found.depth.error, found.views, found.views > 1 ? "s" : ""),
          base_ > 0 ? found.difference / total(r_.predicted_j) / base_ : 0);
    else if (found.usual_error > 0)
      result_.not_found.push_back(
          {"scalloped-edge", std::max(least_scallop, error_bars * found.usual_error), "range bins", ""});
    result_.sides = shadow_sides(r_);
    result_.ends = shadow_ends(r_);
    const auto edge = [&](const char* fault, const EdgeOffsets& offsets, const char* unit,
                          const char* where) {
      if (offsets.edges >= 20 && sure(offsets.mean.value, offsets.mean.error, least_edge))
        add(fault, offsets.mean.value, offsets.mean.error, unit,
            fmt::format("shadows differ in size by {:+.2f} +- {:.2f} {} (spread of single edges {:.2f})",
                        offsets.mean.value, offsets.mean.error, where, offsets.spread));
    };
    if (lit_.behind_seen.wrong < least_wrongly_lit && lit_.behind_unseen.wrong < least_wrongly_lit) {
      edge("shadow-sides", result_.sides, "beams", "beams at each side");
      edge("shadow-ends", result_.ends, "samples", "range bins at each end");
    }
    result_.scatter = scatter(r_);
  }
  bool is_scalloped() const {
    return scallops_.views > 0 && sure(scallops_.depth.value, scallops_.depth.error, least_scallop);
  }
  static double total(std::span<const double> energy_j) {
    double sum = 0;
    for (const double e : energy_j) sum += e;
    return sum;
  }

  void steps() {
    const EvenSteps& steps = in_.steps;
    if (steps.levels > 0 && steps.levels <= 256)
      add("8-bits", static_cast<double>(steps.levels), 0, "levels",
          fmt::format("the picture has only {} different values{}{}", steps.levels,
                      *steps.scale ? ", in uniform steps of " : "", steps.scale));
    else if (steps.levels > 0)
      add("steps", static_cast<double>(steps.levels), 0, "levels",
          fmt::format("the picture has only {} different values", steps.levels));
    if (steps.share_at_top > 0.002)
      add("clamped", 100 * steps.share_at_top, 0, "% of the bins with an echo",
          fmt::format(
              "{:.2g} % of the bins with an echo have exactly the largest value, so the values are clamped",
              100 * steps.share_at_top));
  }

  /// Compares the scatter of single bins with that of a perfect engine of the same sampling.
  void scatter_of_bins() {
    const DiagnosisInput& input = in_.input;
    if (input.ideal_j.empty()) return;
    const std::vector<double> reference(input.pair.reference_j.begin(), input.pair.reference_j.end()),
        levels = row_levels(input.pair.shape, reference);
    const Fan whole(input.pair.shape, {input.beam_azimuth_deg.begin(), input.beam_azimuth_deg.end()},
                    fan_.ranges_m());
    const double of_ideal =
        scatter({whole, reference, input.ideal_j, levels, {}, std::vector<bool>(levels.size(), true), 0});
    const double more = std::sqrt(std::max(0.0, result_.scatter * result_.scatter - of_ideal * of_ideal));
    if (result_.floor.deviation_j == 0 && more > 0.05 && more > 0.75 * of_ideal)
      add("speckle", more, 0.1 * of_ideal, "of the energy",
          fmt::format("the energies of single bins scatter by {:.0f} %, but those of a perfect engine with "
                      "the same sampling by {:.0f} %",
                      100 * result_.scatter, 100 * of_ideal));
  }

  void materials() {
    if (in_.materials.empty()) return;
    const Estimate spread = spread_db(in_.materials);
    std::string list;
    for (std::size_t m = 0; m < in_.materials.size(); ++m)
      if (in_.materials[m].bins > 0)
        list += fmt::format("{}{} {:+.1f} dB", list.empty() ? "" : ", ", r_.labels->material_names[m],
                            in_.materials[m].db.value);
    std::vector<double> plain =
        fan_.warped({in_.reference_j.begin(), in_.reference_j.end()}, alignment_.warp);
    for (std::size_t k = 0; k < plain.size(); ++k)
      plain[k] *= alignment_.level_curve[k % fan_.shape().samples];
    add("material-levels", spread.value, spread.error, "dB",
        fmt::format("materials have other levels relative to each other than in the reference: {}", list),
        share(relative_l1(candidate_, plain)));
  }

  const AlignedCandidate& in_;
  Diagnosis& result_;
  const Alignment& alignment_;
  const Fan& fan_;
  const Residual& r_;
  std::vector<double> candidate_, plain_j_;  // in the unit of the reference
  double l1_after_gain_alone_ = 0;
  double base_ = 0;  // the error to which shares refer
  WronglyLit lit_;
  Scallops scallops_;
};

}  // namespace

void find_errors(const AlignedCandidate& aligned, Diagnosis& result) { Findings(aligned, result).find(); }

}  // namespace tubefoot
