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
  if (offsets.edges == 0) return fmt::format("  {:<24} none to be measured\n", name);
  return fmt::format("  {:<24} larger by {:+.3f} +- {:.3f} {}, single ones spread by {:.3f} ({} of them)\n",
                     name, offsets.mean.value, offsets.mean.error, unit, offsets.spread, offsets.edges);
}

}  // namespace

std::vector<ErrorShare> error_shares(const Diagnosis& diagnosis) {
  std::vector<ErrorShare> shares{
      {diagnosis.l1, "as it is"},
      {diagnosis.l1_after_gain, "after gain and law of range"},
      {diagnosis.l1_after_warp, "after displacement and blur, too"},
      {diagnosis.l1_left, "without noise floor and what is wrongly lit: what is left"}};
  if (diagnosis.ideal_l1)
    shares.push_back({*diagnosis.ideal_l1,
                      diagnosis.l1_left <= 1.1 * *diagnosis.ideal_l1
                          ? "a perfect engine of the same sampling: no more is left"
                          : fmt::format("a perfect engine of the same sampling: {:.0f} % of what is left",
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
      fmt::format("  single bins scatter      by {:.3g} of their energy in even areas", diagnosis.scatter);
  if (diagnosis.scatter > 0)
    text +=
        fmt::format(", as of {:.3g} independent points a bin", 1 / (diagnosis.scatter * diagnosis.scatter));
  text += "\n" + edge_line("shadows' sides", diagnosis.sides, "beams") +
          edge_line("shadows' ends", diagnosis.ends, "samples");
  for (const LocalShift& part : diagnosis.along_fan)
    text += fmt::format(
        "  beams {:>5} to {:<5}       off by {:+.3f} +- {:.3f} beams, {:+.3f} +- {:.3f} samples "
        "beside the whole\n",
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
