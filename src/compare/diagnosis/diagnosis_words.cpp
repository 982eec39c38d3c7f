// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/diagnosis/diagnosis_words.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
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

std::string look_for(const std::string& fault) {
  static const std::map<std::string, const char*> places{
      {"level", "unit, source level or gain; if pictures are normalised, there is no common unit"},
      {"range-law", "spreading loss, absorption and time-varying gain; a mean per bin has no spreading loss"},
      {"offset", "black level, or noise that is not centred at 0"},
      {"range-curve", "time-varying gain; with --scene the elevation is tested as the cause"},
      {"vertical-pattern", "vertical beam pattern or taper; add it to the reference or to the output model"},
      {"ping-gain", "normalisation of each picture by its own largest value"},
      {"mirror", "order of the beams; import with --flip-beams"},
      {"swapped-ports", "order of the two halves or sides in the file"},
      {"beam-shift", "direction of a beam: centre or edge; mounting angle"},
      {"half-sample", "range of a bin: centre or edge; rounding instead of truncation"},
      {"sample-shift", "start of the range gate; delay of the first sample"},
      {"azimuth-scale", "opening angle of the fan: between the outer axes or the outer edges"},
      {"range-scale", "sound speed; length of the range gate"},
      {"tangent-spacing", "columns of a plane image; import with --azimuths tangent or tangent:VIEWS"},
      {"blur", "smoothing filter, pulse length or beam width"},
      {"range-spread", "a pulse or beam whose width grows with range; interpolation from Cartesian pixels"},
      {"noise", "additive noise; average frames with --frames"},
      {"near-clipping", "near clipping plane: set it to a few centimetres, and cut off the ranges later"},
      {"missing-shadow", "visibility: rays that pass through objects, or objects without a back"},
      {"near-returns-missing", "blanking range or near clipping plane"},
      {"scalloped-edge", "lower side of a camera's view: a plane instead of a cone"},
      {"shadow-sides", "width of the samples of a beam; silhouettes that are rounded to whole columns"},
      {"shadow-ends", "height of objects; spacing of rays in elevation"},
      {"8-bits", "export the pictures as floating-point numbers"},
      {"steps", "number of samples per bin; integer counts"},
      {"clamped", "gain that is too large for the range of the values"},
      {"speckle", "random phases or multiplicative noise"},
      {"material-levels", "materials, which the engine may not read; means per bin without an output model"},
      {"silent", "range gate, pose and materials; an engine may have failed without a message"}};
  const auto found = places.find(fault);
  return found == places.end() ? "" : found->second;
}

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
    text += fmt::format("  {:<24} {}{}\n", finding.fault, finding.words,
                        finding.share ? fmt::format(" [{:.0f} % of the error]", 100 * *finding.share) : "");
  for (const ResolvableSize& size : diagnosis.not_found)
    text += fmt::format("  {} {:<12} {}{}\n",
                        std::isfinite(size.size) ? fmt::format("not found below {:.3g}", size.size)
                                                 : "too few echoes to find",
                        std::isfinite(size.size) ? size.unit : "", size.fault,
                        size.remark.empty() ? "" : "; " + size.remark);
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
            {"not_found", Json::array()},
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
                                {"words", finding.words},
                                {"share", finding.share ? Json(*finding.share) : Json()},
                                {"look_for", look_for(finding.fault)}});
  for (const ResolvableSize& size : diagnosis.not_found)
    json["not_found"].push_back(
        {{"fault", size.fault}, {"size", size.size}, {"unit", size.unit}, {"remark", size.remark}});
  for (const LocalShift& part : diagnosis.along_fan)
    json["along_fan"].push_back({{"first_beam", part.first_beam},
                                 {"last_beam", part.last_beam},
                                 {"beams", json_of(part.beams)},
                                 {"samples", json_of(part.samples)}});
  return json;
}

}  // namespace tubefoot
