// SPDX-License-Identifier: GPL-3.0-or-later
// The command `compare`. It compares the echoes of two files bin by bin. Options fit gain and range
// dependence, apply an output model, diagnose systematic errors and attribute errors to objects. One option
// computes the sampling error of a perfect engine. The command prints the results and writes JSON, PNG or
// HTML (docs/compared-figures.md).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "compare/attribution/attribution.hpp"
#include "compare/attribution/bin_labels.hpp"
#include "compare/attribution/perfect_engine.hpp"
#include "compare/calibration.hpp"
#include "compare/comparison.hpp"
#include "compare/comparison_picture.hpp"
#include "compare/diagnosis/diagnosis_words.hpp"
#include "compare/echo_pairs.hpp"
#include "compare/output_model_reference.hpp"
#include "compare/report_page.hpp"
#include "files/atomic_output.hpp"
#include "files/checked_file.hpp"
#include "files/file_hash.hpp"
#include "files/input_registry.hpp"
#include "files/json_text.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr int within = 0, beyond = 3;

std::string made_by(const Provenance& provenance) {
  std::string words;
  for (const std::string& word : {provenance.engine, provenance.arithmetic, provenance.version})
    if (!word.empty()) words += (words.empty() ? "" : " ") + word;
  return words.empty() ? "unknown engine" : shown_line(words);
}

void print_first_return(const FirstReturnErrors& first) {
  if (first.in_both > 0) {
    tell("  first return             mean {:+.3g} m, mean magnitude {:.3g} m ({:.3g} range bins)\n",
         first.mean_m, first.mean_absolute_m, first.mean_absolute_samples);
    if (first.largest_samples != 0)
      tell("                           largest {:+.3g} m ({:+} range bins) at ping {}, beam {}\n",
           first.largest_m, first.largest_samples, first.largest_at.ping, first.largest_at.beam);
  }
  tell(
      "  beams with a return      {} in both files, {} only in the reference, {} only in the candidate, {} "
      "in neither\n",
      first.in_both, first.only_in_reference, first.only_in_candidate, first.in_neither);
}

void print_sensor(const SensorErrors& sensor, const SensorFit* fit) {
  const SensorEchoes& reference = *sensor.pair.reference;
  const EchoErrors& errors = sensor.errors;
  tell("\n{}: {} pings x {} beams x {} range bins\n", shown_line(reference.name), reference.pings,
       reference.beams, reference.samples);
  if (fit) tell("{}", fit_text(*fit));
  tell("  relative L1 error        {:.3g}\n", errors.l1);
  tell("  RMS error of echo bins   {:.3g} dB\n", errors.rms_db);
  tell("  total energy ratio       {:.6g} ({:+.3g} dB)\n", errors.energy_ratio,
       10 * std::log10(errors.energy_ratio));
  tell("  missing echoes           {} of {} echo bins (above {:.3g} J/m2)\n", errors.empty_where_lit,
       errors.lit_bins, errors.lit_threshold_j);
  tell("  echoes in shadows        {} of {} shadow bins\n", errors.lit_where_shadow, errors.shadow_bins);
  if (fit) tell("{}", unitless_text(unitless_errors(echo_pair(sensor.pair))));
  print_first_return(errors.first_return);
  if (const auto& bound = errors.within_bound)
    tell(
        "  bound of the reference   {:.3g} of its energy; explains {:.3g} % of the difference; contains "
        "{:.3g} % of the bins\n",
        bound->bound_l1, 100 * bound->share_of_difference, 100 * bound->share_of_bins);
  else
    tell("  bound of the reference   unknown, because the reference has no energy_bound\n");
  if (errors.worst.empty()) return;
  tell("  worst bins {:>6} {:>6} {:>7} {:>11} {:>13} {:>13} {:>11} {:>14}\n", "ping", "beam", "sample",
       "range (m)", "ref. (J/m2)", "cand. (J/m2)", "error (dB)", "of difference");
  for (const BinError& bin : errors.worst)
    tell("             {:>6} {:>6} {:>7} {:>11.3f} {:>13.4g} {:>13.4g} {:>+11.3g} {:>12.3g} %\n",
         bin.place.ping, bin.place.beam, bin.place.sample, bin.slant_range_m, bin.reference_j,
         bin.candidate_j, bin.error_db, 100 * bin.share_of_difference);
}

/// Returns the ping with the largest sum |C - R|.
std::size_t worst_ping(const EchoPairs::Sensor& pair) {
  const std::size_t bins = pair.reference->beams * pair.reference->samples;
  std::size_t worst = 0;
  double largest_j = -1;
  for (std::size_t ping = 0; ping < pair.reference->pings; ++ping) {
    double difference_j = 0;
    for (std::size_t bin = ping * bins; bin < (ping + 1) * bins; ++bin)
      difference_j += std::abs(pair.candidate->energy[bin] - pair.reference->energy[bin]);
    if (difference_j <= largest_j) continue;
    largest_j = difference_j;
    worst = ping;
  }
  return worst;
}

Canvas picture_of(const std::vector<SensorErrors>& sensors, const EchoContents& reference,
                  const EchoContents& candidate) {
  if (label_font().empty())
    say("warning: the picture has no labels, because no font was found: on Debian, install "
        "fonts-dejavu-core\n");
  std::vector<ComparedEchoes> drawn;
  drawn.reserve(sensors.size());
  for (const auto& [pair, errors] : sensors)
    drawn.push_back({pair.reference, pair.candidate, errors.lit_threshold_j, worst_ping(pair)});
  const std::vector<std::string> subtitle{
      fmt::format("reference: {}, {}", reference.file.string(), made_by(reference.provenance)),
      fmt::format("candidate: {}, {}", candidate.file.string(), made_by(candidate.provenance))};
  return draw_comparison(drawn, subtitle, label_font());
}

/// Formats the hash and the name of a file from which a page was made: "SHA-256  file".
std::string hash_line(const fs::path& file) { return fmt::format("{}  {}", sha256_of(file), file.string()); }

/// Returns the echo file of a perfect engine, if the option names a file and not a sampling.
std::optional<fs::path> ideal_file(const CompareOptions& options) {
  if (!options.ideal || beam_sampling(*options.ideal)) return std::nullopt;
  return *options.ideal;
}

/// Returns a command that makes the same comparison again.
std::string command_of(const CompareOptions& options) {
  std::string command =
      fmt::format("tubefoot compare {} {}", options.reference.string(), options.candidate.string());
  if (options.sensor) command += " --sensor " + *options.sensor;
  if (options.any_scene) command += " --any-scene";
  if (options.frames > 1) command += fmt::format(" --frames {}", options.frames);
  if (options.output_model) command += " --output-model " + options.output_model->string();
  if (!options.fit.empty()) command += " --fit " + options.fit;
  if (options.geometry) command += " --geometry";
  if (options.threshold) command += fmt::format(" --threshold {}", *options.threshold);
  if (options.ideal) command += " --diagnose --ideal " + *options.ideal;
  if (options.scene) command += " --scene " + options.scene->string();
  return command + " --html " + options.html->string();
}

std::string page_of(const CompareOptions& options, const nlohmann::ordered_json& figures,
                    const Canvas& picture, const std::vector<Diagnosis>& diagnoses) {
  std::vector<std::string> files{hash_line(options.reference), hash_line(options.candidate)};
  for (const auto& file : {ideal_file(options), options.output_model, options.scene})
    if (file) files.push_back(hash_line(*file));
  std::string caption =
      "Reference, candidate and their ratio in dB: red where the candidate is stronger, blue where it is "
      "weaker.";
  for (const Diagnosis& diagnosis : diagnoses)
    if (diagnosis.has("level") || diagnosis.has("range-law")) {
      caption +=
          " Gain and range dependence are not corrected; --fit gain,range shows the remaining difference.";
      break;
    }
  return report_page({figures, picture.screen_png("tubefoot compare"), caption, files, command_of(options)});
}

struct Outputs {
  std::optional<OutputFile> json, png, html;

  Outputs(const CompareOptions& options, Inputs inputs) {
    inputs.insert(inputs.end(), {options.reference, options.candidate});
    for (const auto& file : {ideal_file(options), options.output_model})
      if (file) inputs.push_back(*file);
    const bool to_file = options.json && *options.json != "-";
    if (to_file) json.emplace(*options.json, inputs);
    if (options.png) png.emplace(*options.png, inputs);
    if (options.html) html.emplace(*options.html, inputs);
    if (to_file && options.png && same_file(*options.json, *options.png))
      throw UsageError("--json and --png name the same file: choose different names");
    if (options.html && ((to_file && same_file(*options.json, *options.html)) ||
                         (options.png && same_file(*options.png, *options.html))))
      throw UsageError("--html and --json or --png name the same file: choose different names");
    if (options.png && options.png->extension() != ".png")
      throw UsageError(fmt::format("'{}': the name of a picture must end in .png", options.png->string()));
  }
};

}  // namespace

int compare_command(const CompareOptions& options) {
  const std::optional<BeamSampling> sampling = options.ideal ? beam_sampling(*options.ideal) : std::nullopt;
  if (sampling && !options.scene)
    throw UsageError(
        fmt::format("--ideal {} needs the scene of the reference: add --scene FILE", *options.ideal));
  std::optional<SceneDescription> description;
  if (options.scene) description = described({*options.scene, {}, {}, options.confined, options.quiet});
  Outputs outputs(options, description ? inputs_of(*description) : Inputs{});
  const FitTerms terms = options.fit.empty() ? FitTerms{} : fit_terms(options.fit);
  const std::optional<OutputModel> output_model =
      options.output_model ? std::optional(read_output_model(*options.output_model)) : std::nullopt;
  const bool diagnosed = options.diagnose || options.html;
  EchoContents reference = read_echo_file(options.reference);
  EchoContents candidate = read_echo_file(options.candidate);
  EchoContents as_given;
  if (diagnosed) as_given = candidate;
  if (options.frames > 1) average_frames(candidate, options.frames);
  EchoPairs pairs = pair_echoes(reference, candidate, options.sensor, options.any_scene);
  const ThreadLimit limit(description ? description->run.threads : 0);
  std::optional<SceneAtHand> scene;
  if (description) scene.emplace(*description, reference, options.any_scene, pairs.notes);
  std::optional<EchoContents> ideal, ideal_angles;
  std::vector<std::optional<PointsForecast>> forecasts;
  if (sampling) {
    PerfectEchoes perfect = perfect_echoes(*scene, reference, *sampling, options.sensor,
                                           output_model && needs_solid_angles(*output_model), options.quiet);
    ideal = std::move(perfect.energies);
    ideal_angles = std::move(perfect.solid_angles);
    for (const EchoPairs::Sensor& pair : pairs.sensors)
      forecasts.push_back(output_model ? std::nullopt : points_forecast(*scene, *pair.reference, *sampling));
  } else if (options.ideal) {
    ideal = read_echo_file(*options.ideal);
    forecasts.resize(pairs.sensors.size());
  }
  if (output_model) apply_output_model(*output_model, reference, pairs);
  std::vector<GeometryErrors> geometries;  // computed from the candidate as given, before any fit
  for (const EchoPairs::Sensor& pair : pairs.sensors)
    if (options.geometry) geometries.push_back(geometry_errors(echo_pair(pair), options.threshold));
  std::vector<SensorFit> fits;
  if (terms.any()) fits = fit_candidate(candidate, pairs, terms);
  const std::vector<SensorErrors> sensors = errors_of(pairs, options.worst);
  std::vector<SceneLabels> labels;
  if (scene && diagnosed)
    for (const EchoPairs::Sensor& pair : pairs.sensors) {
      const SensorEchoes& echoes = *pair.reference;
      const std::vector<std::size_t> pings = diagnosed_pings({echoes.pings, echoes.beams, echoes.samples});
      labels.push_back(bin_labels(
          *scene, echoes, [&](std::size_t ping) { return std::ranges::binary_search(pings, ping); },
          options.quiet));
    }
  std::vector<Diagnosis> diagnoses;
  std::vector<IdealShare> shares;
  if (ideal) {
    if (output_model)
      apply_output_model(*output_model, *ideal, pair_echoes(*ideal, *ideal, options.sensor, true),
                         ideal_angles);
    const EchoPairs of_ideal = pair_echoes(reference, *ideal, options.sensor, options.any_scene);
    diagnoses = diagnose(pairs, as_given, &of_ideal, labels, fits);
    const std::vector<SensorErrors> errors = errors_of(of_ideal, 0);
    for (std::size_t k = 0; k < sensors.size(); ++k)
      shares.push_back({sampling ? sampling->words() : "the sampling of " + *options.ideal,
                        errors[k].errors.l1, errors[k].errors.rms_db, sensors[k].errors.l1, forecasts[k]});
  } else if (diagnosed) {
    diagnoses = diagnose(pairs, as_given, nullptr, labels, fits);
  }
  std::vector<Attribution> attributions;
  if (scene && (options.attribute || options.html))
    for (const EchoPairs::Sensor& pair : pairs.sensors)
      attributions.push_back(
          attribute(*scene, *pair.reference, echo_pair(pair), options.worst, options.quiet));
  for (const SensorErrors& sensor : sensors)
    if (const std::string hint = wild_ratio_hint(sensor.errors); !terms.gain && !hint.empty())
      pairs.notes.push_back(fmt::format("{}: {}", sensor.pair.reference->name, hint));
  bool held = true;
  for (const auto& [pair, errors] : sensors) {
    if (options.within_l1) held = held && errors.l1 <= *options.within_l1;
    if (options.within_db) held = held && errors.rms_db <= *options.within_db;
  }

  std::string json;
  if (options.json || options.html) {
    nlohmann::ordered_json all = comparison_json(reference, candidate, pairs, sensors);
    if (output_model)
      all["recipe"] = {{"file", options.output_model->string()}, {"title", output_model->title}};
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      auto& sensor = all["sensors"][k];
      if (!fits.empty()) {
        sensor["fit"] = fit_json(fits[k]);
        sensor["unitless"] = unitless_json(unitless_errors(echo_pair(pairs.sensors[k])));
      }
      if (!geometries.empty()) sensor["geometry"] = geometry_json(geometries[k]);
      if (!diagnoses.empty()) sensor["diagnosis"] = diagnosis_json(diagnoses[k]);
      if (!shares.empty()) sensor["ideal"] = ideal_json(shares[k]);
      if (!attributions.empty()) sensor["attribution"] = attribution_json(attributions[k]);
    }
    if (options.within_l1) all["within"]["l1_error"] = *options.within_l1;
    if (options.within_db) all["within"]["rms_db_error"] = *options.within_db;
    if (options.within_l1 || options.within_db) all["within"]["held"] = held;
    json = text_of(all) + "\n";
    if (options.html) {
      write_file(outputs.html->path(),
                 page_of(options, all, picture_of(sensors, reference, candidate), diagnoses));
      outputs.html->commit();
    }
  }
  if (options.png) {
    picture_of(sensors, reference, candidate).write_png(outputs.png->path(), "tubefoot compare");
    outputs.png->commit();
  }
  if (options.json == "-") {
    tell("{}", json);
    return held ? within : beyond;
  }
  if (options.json) {
    write_file(outputs.json->path(), json);
    outputs.json->commit();
  }

  tell("reference  {} ({})\ncandidate  {} ({})\n", reference.file.string(), made_by(reference.provenance),
       candidate.file.string(), made_by(candidate.provenance));
  if (output_model)
    tell("model      {}{}\n", options.output_model->string(),
         output_model->title.empty() ? "" : ": " + shown_line(output_model->title));
  for (const std::string& note : pairs.notes) tell("note       {}\n", shown_line(note));
  for (std::size_t k = 0; k < diagnoses.size(); ++k) {
    tell("{}", diagnosis_text(shown_line(pairs.sensors[k].reference->name), diagnoses[k]));
    if (!shares.empty()) tell("{}", ideal_text(shares[k]));
  }
  for (std::size_t k = 0; k < attributions.size(); ++k)
    tell("{}", attribution_text(shown_line(pairs.sensors[k].reference->name), attributions[k]));
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    print_sensor(sensors[k], fits.empty() ? nullptr : &fits[k]);
    if (!geometries.empty()) tell("{}", geometry_text(pairs.sensors[k], geometries[k]));
  }
  if (options.within_l1 || options.within_db)
    tell("\n{}\n", held ? "within the allowed error" : "ABOVE the allowed error");
  if (options.json) tell("wrote {}\n", *options.json);
  if (options.png) tell("wrote {}\n", options.png->string());
  if (options.html) tell("wrote {}\n", options.html->string());
  return held ? within : beyond;
}

}  // namespace tubefoot
