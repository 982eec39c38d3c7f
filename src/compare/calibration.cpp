// SPDX-License-Identifier: GPL-3.0-or-later
// Prepares a candidate for comparison: averages frames, fits its energies to the reference, diagnoses it,
// and formats the results as text and JSON.
#include "compare/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/measures/noise_floor.hpp"
#include "files/input_error.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Estimate& estimate) { return {{"value", estimate.value}, {"error", estimate.error}}; }

Json json_of(const Overlap& overlap) {
  return {{"reference_bins", overlap.reference},
          {"candidate_bins", overlap.candidate},
          {"both_bins", overlap.both},
          {"iou", overlap.iou()}};
}

std::string overlap_line(const char* name, const Overlap& overlap) {
  return fmt::format(
      "  {:<24} {} bins in the reference, {} in the candidate ({:+.3g} %), overlap (IoU) {:.4f}\n", name,
      overlap.reference, overlap.candidate,
      overlap.reference > 0
          ? 100 * (static_cast<double>(overlap.candidate) / static_cast<double>(overlap.reference) - 1)
          : 0.0,
      overlap.iou());
}

}  // namespace

EchoPair echo_pair(const EchoPairs::Sensor& pair) {
  const SensorEchoes& reference = *pair.reference;
  return {{reference.pings, reference.beams, reference.samples},
          reference.energy,
          pair.candidate->energy,
          reference.energy_bound,
          reference.slant_range_m};
}

void average_frames(EchoContents& contents, std::size_t frames) {
  for (SensorEchoes& sensor : contents.sensors) {
    if (frames == 0 || sensor.pings % frames != 0)
      throw InputError({contents.file.string()},
                       fmt::format("sensor '{}' has {} pings, which is not a multiple of --frames {}: use a "
                                   "number that divides the number of pings",
                                   sensor.name, sensor.pings, frames));
    sensor.energy = mean_of_frames({sensor.pings, sensor.beams, sensor.samples}, sensor.energy, frames);
    sensor.energy_bound.clear();
    sensor.pings /= frames;
    if (frames > 1) sensor.ping_time_s.clear();
  }
}

std::vector<SensorFit> fit_candidate(EchoContents& candidate, const EchoPairs& pairs, FitTerms terms) {
  std::vector<SensorFit> fits;
  for (const EchoPairs::Sensor& pair : pairs.sensors) {
    stop_if_wanted();
    const EchoPair arrays = echo_pair(pair);
    const std::optional<EnergyFit> fit = fit_energies(arrays, terms);
    if (!fit)
      throw InputError({candidate.file.string()},
                       fmt::format("sensor '{}' has too few echoes where the reference has echoes, so --fit "
                                   "is not possible: leave out --fit, or draw both pictures with --png",
                                   pair.candidate->name));
    fits.push_back({pair.reference->name, *fit, echo_errors(arrays)});
    std::vector<double> fitted = fit->fitted(arrays);
    const auto sensor =
        std::ranges::find_if(candidate.sensors, [&](const SensorEchoes& s) { return &s == pair.candidate; });
    sensor->energy = std::move(fitted);
  }
  return fits;
}

std::vector<Diagnosis> diagnose(const EchoPairs& pairs, const EchoContents& as_given, const EchoPairs* ideal,
                                const std::vector<SceneLabels>& labels, const std::vector<SensorFit>& fits) {
  std::vector<Diagnosis> diagnoses;
  for (std::size_t k = 0; k < pairs.sensors.size(); ++k) {
    const EchoPairs::Sensor& pair = pairs.sensors[k];
    const auto given = std::ranges::find(as_given.sensors, pair.candidate->name, &SensorEchoes::name);
    DiagnosisInput input{echo_pair(pair), pair.reference->beam_azimuth_deg, given->energy, {}};
    if (ideal) input.ideal_j = ideal->sensors[k].candidate->energy;
    if (!labels.empty() && !labels[k].elevation_deg.empty()) input.labels = &labels[k];
    if (!fits.empty()) {
      input.fit = &fits[k].fit;
      input.l1_before_fit = fits[k].before.l1;
    }
    diagnoses.push_back(diagnose(input));
  }
  return diagnoses;
}

std::string fit_text(const SensorFit& sensor) {
  const auto& [name, fit, before] = sensor;
  std::string text;
  if (fit.terms.gain)
    text += fmt::format("  fitted gain              {:+.3f} +- {:.3f} dB{}\n", fit.gain_db.value,
                        fit.gain_db.error,
                        fit.terms.range ? fmt::format(" at {:.4g} m", fit.middle_range_m) : "");
  if (fit.terms.range)
    text += fmt::format("  fitted range power       r^{:.4f} +- {:.4f} relative to the reference\n",
                        fit.exponent.value, fit.exponent.error);
  if (fit.terms.offset)
    text += fmt::format("  fitted offset            {:.4g} +- {:.2g} in each bin\n", fit.offset_j.value,
                        fit.offset_j.error);
  text += fmt::format("  before the fit           L1 {:.3g}, RMS {:.3g} dB, energy ratio {:+.3g} dB\n",
                      before.l1, before.rms_db, 10 * std::log10(before.energy_ratio));
  return text;
}

std::string unitless_text(const UnitlessErrors& errors) {
  return fmt::format(
      "  L1 of normalised rows    {:.3g} over {} rows ({} have an echo in one file only)\n  rank correlation "
      "        {:.4f}\n",
      errors.row_l1, errors.rows, errors.rows_of_one_side, errors.rank_correlation);
}

std::string geometry_text(const EchoPairs::Sensor& pair, const GeometryErrors& errors) {
  std::string text = fmt::format("\n{}: geometry only\n", pair.reference->name);
  text += fmt::format("  echo threshold           {:.3g} in the reference, {:.3g} in the candidate\n",
                      errors.reference_threshold_j, errors.candidate_threshold_j);
  text += fmt::format(
      "  noise floor              {:.3g} +- {:.2g}, standard deviation {:.3g}, {:.3g} % above 0, in {} bins "
      "inside shadows\n",
      errors.floor.mean_j, errors.floor.mean_error_j, errors.floor.deviation_j,
      100 * errors.floor.share_positive, errors.floor.bins);
  const FirstReturnErrors& first = errors.first_return;
  if (first.in_both > 0)
    text += fmt::format(
        "  first return             mean {:+.3g} m, mean magnitude {:.3g} m ({:.3g} range bins), largest "
        "{:+} range bins at ping {}, beam {}\n",
        first.mean_m, first.mean_absolute_m, first.mean_absolute_samples, first.largest_samples,
        first.largest_at.ping, first.largest_at.beam);
  text += fmt::format(
      "  beams with a return      {} in both files, {} only in the reference, {} only in the candidate, {} "
      "in neither\n",
      first.in_both, first.only_in_reference, first.only_in_candidate, first.in_neither);
  return text + overlap_line("shadow", errors.shadow) + overlap_line("visible area", errors.visible);
}

Json fit_json(const SensorFit& sensor) {
  const auto& [name, fit, before] = sensor;
  Json json{{"sensor", name}, {"patches", fit.cells}, {"middle_range_m", fit.middle_range_m}};
  if (fit.terms.gain) json["gain_db"] = json_of(fit.gain_db);
  if (fit.terms.range) json["range_exponent"] = json_of(fit.exponent);
  if (fit.terms.offset) json["offset"] = json_of(fit.offset_j);
  json["before"] = {{"l1_error", before.l1},
                    {"rms_db_error", before.rms_db},
                    {"energy_ratio", before.energy_ratio},
                    {"energy_ratio_db", 10 * std::log10(before.energy_ratio)}};
  return json;
}

Json unitless_json(const UnitlessErrors& errors) {
  return {{"row_l1", errors.row_l1},
          {"rows", errors.rows},
          {"rows_of_one_side", errors.rows_of_one_side},
          {"rank_correlation", errors.rank_correlation}};
}

Json geometry_json(const GeometryErrors& errors) {
  const FirstReturnErrors& first = errors.first_return;
  return {{"reference_threshold", errors.reference_threshold_j},
          {"candidate_threshold", errors.candidate_threshold_j},
          {"noise_floor",
           {{"bins", errors.floor.bins},
            {"mean", json_of(Estimate{errors.floor.mean_j, errors.floor.mean_error_j})},
            {"deviation", errors.floor.deviation_j},
            {"share_positive", errors.floor.share_positive}}},
          {"first_return",
           {{"in_both", first.in_both},
            {"only_in_reference", first.only_in_reference},
            {"only_in_candidate", first.only_in_candidate},
            {"in_neither", first.in_neither},
            {"mean_m", first.mean_m},
            {"mean_absolute_m", first.mean_absolute_m},
            {"mean_absolute_samples", first.mean_absolute_samples},
            {"largest_m", first.largest_m},
            {"largest_samples", first.largest_samples}}},
          {"shadow", json_of(errors.shadow)},
          {"visible", json_of(errors.visible)}};
}

std::string wild_ratio_hint(const EchoErrors& errors) {
  const double ratio = errors.energy_ratio, db = 10 * std::log10(ratio);
  if (!std::isfinite(db) || (ratio <= 2 && ratio >= 0.5)) return {};
  return fmt::format(
      "the total energies differ by {:+.3g} dB: if the candidate has other units, use '--fit gain' or '--fit "
      "gain,range,offset'",
      db);
}

}  // namespace tubefoot
