// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/comparison.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/calibration.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;

double decibels(double ratio) { return 10 * std::log10(ratio); }

Json json_of(const EchoContents& contents) {
  const Provenance& provenance = contents.provenance;
  return {{"file", contents.file.string()},      {"title", provenance.title},
          {"scene_hash", provenance.scene_hash}, {"engine", provenance.engine},
          {"arithmetic", provenance.arithmetic}, {"version", provenance.version}};
}

Json json_of(const FirstReturnErrors& first) {
  Json json{{"in_both", first.in_both},
            {"only_in_reference", first.only_in_reference},
            {"only_in_candidate", first.only_in_candidate},
            {"in_neither", first.in_neither}};
  if (first.in_both == 0) return json;
  json["mean_m"] = first.mean_m;
  json["mean_absolute_m"] = first.mean_absolute_m;
  json["mean_absolute_samples"] = first.mean_absolute_samples;
  json["largest_m"] = first.largest_m;
  json["largest_samples"] = first.largest_samples;
  json["largest_ping"] = first.largest_at.ping;
  json["largest_beam"] = first.largest_at.beam;
  return json;
}

/// Figures that are not finite, as for a reference without energy, become null.
Json json_of(const SensorErrors& sensor) {
  const SensorEchoes& reference = *sensor.pair.reference;
  const EchoErrors& errors = sensor.errors;
  Json json{{"name", reference.name},
            {"pings", reference.pings},
            {"beams", reference.beams},
            {"samples", reference.samples},
            {"l1_error", errors.l1},
            {"rms_db_error", errors.rms_db},
            {"energy_ratio", errors.energy_ratio},
            {"energy_ratio_db", decibels(errors.energy_ratio)},
            {"reference_total_j", errors.reference_total_j},
            {"candidate_total_j", errors.candidate_total_j},
            {"lit_threshold_j", errors.lit_threshold_j},
            {"lit_bins", errors.lit_bins},
            {"shadow_bins", errors.shadow_bins},
            {"empty_where_lit", errors.empty_where_lit},
            {"lit_where_shadow", errors.lit_where_shadow},
            {"first_return", json_of(errors.first_return)},
            {"within_bound", nullptr},
            {"worst_bins", Json::array()}};
  if (const auto& bound = errors.within_bound)
    json["within_bound"] = {{"bound_l1", bound->bound_l1},
                            {"share_of_difference", bound->share_of_difference},
                            {"share_of_bins", bound->share_of_bins}};
  for (const BinError& bin : errors.worst)
    json["worst_bins"].push_back({{"ping", bin.place.ping},
                                  {"beam", bin.place.beam},
                                  {"sample", bin.place.sample},
                                  {"slant_range_m", bin.slant_range_m},
                                  {"reference_j", bin.reference_j},
                                  {"candidate_j", bin.candidate_j},
                                  {"error_db", bin.error_db},
                                  {"share_of_difference", bin.share_of_difference}});
  return json;
}

}  // namespace

std::vector<SensorErrors> errors_of(const EchoPairs& pairs, std::size_t worst) {
  std::vector<SensorErrors> sensors;
  for (const EchoPairs::Sensor& pair : pairs.sensors) {
    stop_if_wanted();
    sensors.push_back({pair, echo_errors(echo_pair(pair), worst)});
  }
  return sensors;
}

nlohmann::ordered_json comparison_json(const EchoContents& reference, const EchoContents& candidate,
                                       const EchoPairs& pairs, const std::vector<SensorErrors>& sensors) {
  Json all{{"reference", json_of(reference)}, {"candidate", json_of(candidate)}, {"notes", pairs.notes}};
  for (const SensorErrors& sensor : sensors) all["sensors"].push_back(json_of(sensor));
  return all;
}

}  // namespace tubefoot
