// SPDX-License-Identifier: GPL-3.0-or-later
// Attributions as text for the terminal and as JSON. The level of a part is 10 log10 (C / R), with the sums
// of candidate energies C and reference energies R.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/attribution/attribution.hpp"
#include "files/shown.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;

double ratio(double part, double whole) { return whole > 0 ? part / whole : 0; }

/// Computes 10 log10 (C / R), which is not finite if C or R is 0.
double level_db(const ErrorSums& sums) {
  return 10 * std::log10((sums.energy + sums.difference) / sums.energy);
}

std::string table(const char* title, const std::vector<ErrorPart>& parts, const ErrorSums& whole,
                  std::size_t most) {
  std::string text = fmt::format("  {:<34} {:>12} {:>14} {:>8} {:>11} {:>9}\n", title, "of the error",
                                 "of the energy", "own L1", "level (dB)", "bins");
  for (const ErrorPart& part : std::span(parts).first(std::min(most, parts.size()))) {
    const double db = level_db(part.sums);
    text +=
        fmt::format("  {:<34} {:>10.1f} % {:>12.1f} % {:>8} {:>11} {:>9}\n", shown_line(part.name),
                    100 * ratio(part.sums.error, whole.error), 100 * ratio(part.sums.energy, whole.energy),
                    part.sums.energy > 0 ? fmt::format("{:.3g}", part.sums.error / part.sums.energy) : "-",
                    std::isfinite(db) ? fmt::format("{:+.2f}", db) : "-", part.bins);
  }
  return text;
}

Json json_of(const std::vector<ErrorPart>& parts, const ErrorSums& whole) {
  Json rows = Json::array();
  for (const ErrorPart& part : parts)
    rows.push_back({{"name", part.name},
                    {"share_of_error", ratio(part.sums.error, whole.error)},
                    {"share_of_energy", ratio(part.sums.energy, whole.energy)},
                    {"l1_error", part.sums.error / part.sums.energy},
                    {"level_db", level_db(part.sums)},
                    {"error_j", part.sums.error},
                    {"difference_j", part.sums.difference},
                    {"energy_j", part.sums.energy},
                    {"bins", part.bins}});
  return rows;
}

std::string name_at(const std::vector<std::string>& names, std::size_t number) {
  return number < names.size() ? names[number] : "nothing";
}

}  // namespace

std::string attribution_text(const std::string& sensor, const Attribution& a) {
  if (!(a.whole.error > 0)) return fmt::format("\n{}: no error to attribute\n", sensor);
  std::string text = fmt::format("\n{}: attribution of the error\n", sensor);
  for (const std::string& note : a.notes) text += fmt::format("  note: {}\n", note);
  constexpr std::size_t most_causes = 6, most_rows = 20;
  text += table("object and kind (largest)", a.causes, a.whole, most_causes);
  text += table("kind of bin", a.kinds, a.whole, most_rows);
  text += table("object", a.objects, a.whole, most_rows);
  text += table("material", a.materials, a.whole, most_rows);
  text += table("range", a.ranges, a.whole, most_rows);
  text += table("beams", a.beams, a.whole, most_rows);
  if (a.worst.empty()) return text;
  text += fmt::format("  worst bins {:>6} {:>6} {:>7} {:>14}  {:<12} facets\n", "ping", "beam", "sample",
                      "of difference", "kind");
  for (const WorstBin& bin : a.worst) {
    std::string facets;
    for (const FacetShare& facet : std::span(bin.facets).first(std::min<std::size_t>(bin.facets.size(), 3)))
      facets +=
          fmt::format("{}{} {} ({:.0f} %)", facets.empty() ? "" : ", ",
                      shown_line(name_at(a.object_names, facet.object)), facet.facet, 100 * facet.share);
    text += fmt::format("             {:>6} {:>6} {:>7} {:>12.3g} %  {:<12} {}\n", bin.place.ping,
                        bin.place.beam, bin.place.sample, 100 * bin.share_of_difference, name_of(bin.kind),
                        facets.empty() ? "-" : facets);
  }
  return text;
}

Json attribution_json(const Attribution& a) {
  Json json{{"notes", a.notes},
            {"causes", json_of(a.causes, a.whole)},
            {"kinds", json_of(a.kinds, a.whole)},
            {"objects", json_of(a.objects, a.whole)},
            {"materials", json_of(a.materials, a.whole)},
            {"ranges", json_of(a.ranges, a.whole)},
            {"beams", json_of(a.beams, a.whole)},
            {"worst_bins", Json::array()}};
  for (const WorstBin& bin : a.worst) {
    Json facets = Json::array();
    for (const FacetShare& facet : bin.facets)
      facets.push_back({{"object", name_at(a.object_names, facet.object)},
                        {"material", name_at(a.material_names, facet.material)},
                        {"facet", facet.facet},
                        {"share_of_energy", facet.share}});
    json["worst_bins"].push_back({{"ping", bin.place.ping},
                                  {"beam", bin.place.beam},
                                  {"sample", bin.place.sample},
                                  {"slant_range_m", bin.slant_range_m},
                                  {"reference_j", bin.reference_j},
                                  {"candidate_j", bin.candidate_j},
                                  {"share_of_difference", bin.share_of_difference},
                                  {"kind", std::string(name_of(bin.kind))},
                                  {"facets", facets}});
  }
  return json;
}

}  // namespace tubefoot
