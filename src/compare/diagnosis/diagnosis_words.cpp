// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/diagnosis/diagnosis_words.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Estimate& estimate) { return {{"value", estimate.value}, {"error", estimate.error}}; }

Json json_of(const EdgeOffsets& offsets) {
  return {{"edges", offsets.edges}, {"mean", json_of(offsets.mean)}, {"spread", offsets.spread}};
}

std::string edge_line(const char* name, const EdgeOffsets& offsets, const char* unit) {
  if (offsets.edges == 0) return fmt::format("  {:<24} no edges to measure\n", name);
  return fmt::format(
      "  {:<24} size differs by {:+.3f} +- {:.3f} {}, spread of single edges {:.3f} ({} edges)\n", name,
      offsets.mean.value, offsets.mean.error, unit, offsets.spread, offsets.edges);
}

}  // namespace

std::vector<ErrorShare> error_shares(const Diagnosis& diagnosis) {
  std::vector<ErrorShare> shares{
      {diagnosis.l1, "without corrections"},
      {diagnosis.l1_after_gain, "after correction of gain and range dependence"},
      {diagnosis.l1_after_warp, "also after correction of displacement and blur"},
      {diagnosis.l1_left, "also without noise floor and false echoes (remaining error)"}};
  if (diagnosis.ideal_l1)
    shares.push_back(
        {*diagnosis.ideal_l1,
         diagnosis.l1_left <= 1.1 * *diagnosis.ideal_l1
             ? "a perfect engine with the same sampling, which explains the remaining error"
             : fmt::format("a perfect engine with the same sampling, {:.0f} % of the remaining error",
                           100 * *diagnosis.ideal_l1 / diagnosis.l1_left)});
  return shares;
}

std::string diagnosis_text(const std::string& sensor, const Diagnosis& diagnosis) {
  std::string text = fmt::format(
      "\n{}: {}\n", sensor,
      diagnosis.findings.empty()
          ? "no mistake found"
          : fmt::format("{} finding{}", diagnosis.findings.size(), diagnosis.findings.size() > 1 ? "s" : ""));
  for (const Finding& finding : diagnosis.findings)
    text += fmt::format("  {:<24} {}\n", finding.fault, finding.words);
  text += "  relative L1 error\n";
  for (const ErrorShare& share : error_shares(diagnosis))
    text += fmt::format("  {:>24.4g} {}\n", share.l1, share.words);
  text +=
      fmt::format("  scatter of single bins   {:.3g} of their energy in uniform areas", diagnosis.scatter);
  if (diagnosis.scatter > 0)
    text += fmt::format(", as with {:.3g} independent points per bin",
                        1 / (diagnosis.scatter * diagnosis.scatter));
  text += "\n" + edge_line("sides of shadows", diagnosis.sides, "beams") +
          edge_line("ends of shadows", diagnosis.ends, "range bins");
  for (const LocalShift& part : diagnosis.along_fan)
    text += fmt::format(
        "  beams {:>5} to {:<5}       displaced by {:+.3f} +- {:.3f} beams, {:+.3f} +- {:.3f} range bins "
        "relative to the fan\n",
        part.first_beam, part.last_beam, part.beams.value, part.beams.error, part.samples.value,
        part.samples.error);
  return text;
}

Json diagnosis_json(const Diagnosis& diagnosis) {
  Json json{{"findings", Json::array()},
            {"l1",
             {{"as_it_is", diagnosis.l1},
              {"after_gain", diagnosis.l1_after_gain},
              {"after_warp", diagnosis.l1_after_warp},
              {"left", diagnosis.l1_left},
              {"ideal", nullptr}}},
            {"scatter", diagnosis.scatter},
            {"misfit_before", diagnosis.alignment.misfit_before},
            {"misfit", diagnosis.alignment.misfit},
            {"shadow_sides", json_of(diagnosis.sides)},
            {"shadow_ends", json_of(diagnosis.ends)},
            {"along_fan", Json::array()}};
  if (diagnosis.ideal_l1) json["l1"]["ideal"] = *diagnosis.ideal_l1;
  for (const Finding& finding : diagnosis.findings)
    json["findings"].push_back({{"fault", finding.fault},
                                {"size", finding.size},
                                {"error", finding.error},
                                {"unit", finding.unit},
                                {"words", finding.words}});
  for (const LocalShift& part : diagnosis.along_fan)
    json["along_fan"].push_back({{"first_beam", part.first_beam},
                                 {"last_beam", part.last_beam},
                                 {"beams", json_of(part.beams)},
                                 {"samples", json_of(part.samples)}});
  return json;
}

}  // namespace tubefoot
