// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "compare/comparison.hpp"
#include "compare/comparison_picture.hpp"
#include "compare/echo_pairs.hpp"
#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "files/outlet.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "run/console/say.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr int within = 0, beyond = 3;

std::string made_by(const Provenance& provenance) {
  std::string words;
  for (const std::string& word : {provenance.engine, provenance.arithmetic, provenance.version})
    if (!word.empty()) words += (words.empty() ? "" : " ") + word;
  return words.empty() ? "does not say what computed it" : shown_line(words);
}

void print_first_return(const FirstReturnErrors& first) {
  if (first.in_both > 0) {
    tell("  first return             {:+.3g} m on average, {:.3g} m ({:.3g} samples) without sign\n",
         first.mean_m, first.mean_absolute_m, first.mean_absolute_samples);
    if (first.largest_samples != 0)
      tell("                           at worst {:+.3g} m ({:+} samples) at ping {}, beam {}\n",
           first.largest_m, first.largest_samples, first.largest_at.ping, first.largest_at.beam);
  }
  tell(
      "  beams with a return      {} on both sides, {} only in the reference, {} only in the candidate, "
      "{} on neither\n",
      first.in_both, first.only_in_reference, first.only_in_candidate, first.in_neither);
}

void print_sensor(const SensorErrors& sensor) {
  const SensorEchoes& reference = *sensor.pair.reference;
  const EchoErrors& errors = sensor.errors;
  tell("\n{}: {} pings x {} beams x {} samples\n", shown_line(reference.name), reference.pings,
       reference.beams, reference.samples);
  tell("  relative L1 error        {:.3g}\n", errors.l1);
  tell("  RMS error of lit bins    {:.3g} dB\n", errors.rms_db);
  tell("  total energy ratio       {:.6g} ({:+.3g} dB)\n", errors.energy_ratio,
       10 * std::log10(errors.energy_ratio));
  tell("  empty where lit          {} of {} lit bins (above {:.3g} J)\n", errors.empty_where_lit,
       errors.lit_bins, errors.lit_threshold_j);
  tell("  lit where shadow         {} of {} shadow bins\n", errors.lit_where_shadow, errors.shadow_bins);
  print_first_return(errors.first_return);
  if (const auto& bound = errors.within_bound)
    tell(
        "  the reference's bound    {:.3g} of its energy; explains {:.3g} % of the difference; holds "
        "{:.3g} % of the bins\n",
        bound->bound_l1, 100 * bound->share_of_difference, 100 * bound->share_of_bins);
  else
    tell("  the reference's bound    not known: the reference has no energy_bound\n");
  if (errors.worst.empty()) return;
  tell("  worst bins {:>6} {:>6} {:>7} {:>11} {:>13} {:>13} {:>11} {:>14}\n", "ping", "beam", "sample",
       "range (m)", "reference (J)", "candidate (J)", "error (dB)", "of difference");
  for (const BinError& bin : errors.worst)
    tell("             {:>6} {:>6} {:>7} {:>11.3f} {:>13.4g} {:>13.4g} {:>+11.3g} {:>12.3g} %\n",
         bin.place.ping, bin.place.beam, bin.place.sample, bin.slant_range_m, bin.reference_j,
         bin.candidate_j, bin.error_db, 100 * bin.share_of_difference);
}

/// The ping with the largest sum |C - R|.
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

void write_picture(const fs::path& file, const std::vector<SensorErrors>& sensors,
                   const EchoContents& reference, const EchoContents& candidate) {
  std::vector<ComparedEchoes> drawn;
  drawn.reserve(sensors.size());
  for (const auto& [pair, errors] : sensors)
    drawn.push_back({pair.reference, pair.candidate, errors.lit_threshold_j, worst_ping(pair)});
  const std::vector<std::string> subtitle{
      fmt::format("reference: {}, {}", reference.file.string(), made_by(reference.provenance)),
      fmt::format("candidate: {}, {}", candidate.file.string(), made_by(candidate.provenance))};
  const Canvas picture = draw_comparison(drawn, subtitle, label_font());
  picture.write_png(file, "tubefoot compare");
}

struct Outputs {
  std::optional<OutputFile> json, png;

  explicit Outputs(const CompareOptions& options) {
    const Inputs inputs{options.reference, options.candidate};
    const bool to_file = options.json && *options.json != "-";
    if (to_file) json.emplace(*options.json, inputs);
    if (options.png) png.emplace(*options.png, inputs);
    if (to_file && options.png && same_file(*options.json, *options.png))
      throw UsageError("--json and --png name the same file");
    if (options.png && options.png->extension() != ".png")
      throw UsageError(fmt::format("'{}': a picture is written as .png", options.png->string()));
  }
};

}  // namespace

int compare_command(const CompareOptions& options) {
  Outputs outputs(options);
  const EchoContents reference = read_echo_file(options.reference),
                     candidate = read_echo_file(options.candidate);
  const EchoPairs pairs = pair_echoes(reference, candidate, options.sensor, options.any_scene);
  const std::vector<SensorErrors> sensors = errors_of(pairs, options.worst);
  bool held = true;
  for (const auto& [pair, errors] : sensors) {
    if (options.within_l1) held = held && errors.l1 <= *options.within_l1;
    if (options.within_db) held = held && errors.rms_db <= *options.within_db;
  }

  if (options.png) {
    if (label_font().empty())
      say("warning: the picture has no labels: no font was found (on Debian, install "
          "fonts-dejavu-core)\n");
    write_picture(outputs.png->path(), sensors, reference, candidate);
    outputs.png->commit();
  }
  std::string json;
  if (options.json) {
    nlohmann::ordered_json all = comparison_json(reference, candidate, pairs, sensors);
    if (options.within_l1) all["within"]["l1_error"] = *options.within_l1;
    if (options.within_db) all["within"]["rms_db_error"] = *options.within_db;
    if (options.within_l1 || options.within_db) all["within"]["held"] = held;
    json = text_of(all) + "\n";
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
  for (const std::string& note : pairs.notes) tell("note       {}\n", shown_line(note));
  for (const SensorErrors& sensor : sensors) print_sensor(sensor);
  if (options.within_l1 || options.within_db)
    tell("\n{}\n", held ? "within the allowed error" : "BEYOND the allowed error");
  if (options.json) tell("wrote {}\n", *options.json);
  if (options.png) tell("wrote {}\n", options.png->string());
  return held ? within : beyond;
}

}  // namespace tubefoot
