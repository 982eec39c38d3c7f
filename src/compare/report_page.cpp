// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a comparison as one HTML page without external files: findings, pictures, attribution tables, all
// figures, and the command that repeats the comparison.
#include "compare/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "files/json_text.hpp"
#include "files/shown.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* style = R"(
:root { --ground: #f4f5f6; --pane: #fff; --ink: #1b1e22; --faint: #5c646d; --line: #d3d8dd; --accent: #b3125a; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #15181b; --pane: #1d2124; --ink: #e8e9e7; --faint: #9aa3ab; --line: #343b41; --accent: #ff6ba9; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1100px; padding: 18px 16px 60px; background: var(--ground); color: var(--ink);
  font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 22px; margin: 0 0 2px; } h2 { font-size: 18px; margin: 30px 0 8px; } h3 { font-size: 15px; margin: 16px 0 6px; }
p { margin: 4px 0; } .faint { color: var(--faint); }
section, details { background: var(--pane); border: 1px solid var(--line); border-radius: 7px; padding: 12px 14px; margin: 10px 0; }
table { border-collapse: collapse; width: 100%; } .wide { overflow-x: auto; }
th { text-align: left; font-weight: 600; color: var(--faint); } td, th { padding: 4px 14px 4px 0; vertical-align: top; border-top: 1px solid var(--line); }
td.number { font-variant-numeric: tabular-nums; white-space: nowrap; } code, pre { font-family: "DejaVu Sans Mono", monospace; font-size: 13px; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; margin: 4px 0; } .fault { color: var(--accent); font-weight: 600; white-space: nowrap; }
.parts { margin: 0 0 18px; } .parts td:first-child { width: 26%; }
.bar { background: var(--accent); height: 10px; border-radius: 2px; min-width: 1px; } img { max-width: 100%; height: auto; display: block; }
)";

/// Formats a number for the page; a number that is not finite becomes a dash.
std::string number(const Json& value) {
  if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
  if (value.is_number()) return fmt::format("{:.4g}", value.get<double>());
  if (value.is_string()) return shown_markup(value.get<std::string>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  return "-";
}

std::string level(const Json& db) {
  return db.is_number() && std::isfinite(db.get<double>()) ? fmt::format("{:+.2f}", db.get<double>()) : "-";
}

/// In-memory JSON still contains infinities as numbers.
std::string finite(const Json& value) {
  return value.is_number() && std::isfinite(value.get<double>()) ? number(value) : "-";
}

std::string findings_of(const Json& sensor) {
  const Json &findings = sensor["diagnosis"]["findings"], &not_found = sensor["diagnosis"]["not_found"];
  std::string rows, limits;
  for (const Json& finding : findings) {
    const Json& share = finding["share"];
    rows += fmt::format(
        "<tr><td class=\"fault\">{}</td><td>{}</td><td class=\"number\">{} &plusmn; {} {}</td><td "
        "class=\"number\">{}</td><td>{}</td></tr>\n",
        number(finding["fault"]), number(finding["words"]), number(finding["size"]), number(finding["error"]),
        number(finding["unit"]), share.is_number() ? fmt::format("{:.0f} %", 100 * share.get<double>()) : "-",
        number(finding["look_for"]));
  }
  for (const Json& size : not_found)
    limits += fmt::format("{}{}{}{}", limits.empty() ? "" : "; ", number(size["fault"]),
                          finite(size["size"]) == "-"
                              ? ", for which the echoes are too few"
                              : fmt::format(" below {} {}", number(size["size"]), number(size["unit"])),
                          size["remark"] == "" ? "" : " (" + number(size["remark"]) + ")");
  if (!limits.empty()) limits = "<p class=\"faint\">Not found, and not resolved: " + limits + ".</p>\n";
  if (rows.empty()) return "<p>No mistake found.</p>\n" + limits;
  return "<div class=\"wide\"><table><tr><th>finding</th><th>description</th><th>size</th><th>of the "
         "error</th><th>what to look for</th></tr>\n" +
         rows + "</table></div>\n" + limits;
}

std::string shares_of(const Json& sensor) {
  const Json& l1 = sensor["diagnosis"]["l1"];
  static constexpr std::array<std::pair<const char*, const char*>, 5> names{
      {{"as_it_is", "without corrections"},
       {"after_gain", "after correction of gain and range dependence"},
       {"after_warp", "also after correction of displacement and blur"},
       {"left", "also without noise floor and false echoes (remaining error)"},
       {"ideal", "a perfect engine with the same sampling"}}};
  double most = 0;
  for (const auto& [key, name] : names)
    if (l1[key].is_number()) most = std::max(most, std::min(l1[key].get<double>(), 2.0));
  std::string rows;
  for (const auto& [key, name] : names) {
    if (!l1[key].is_number()) continue;
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{}</td><td style=\"width:45%\"><div class=\"bar\" "
        "style=\"width:{:.1f}%\"></div></td></tr>\n",
        name, number(l1[key]), most > 0 ? 100 * std::min(l1[key].get<double>() / most, 1.0) : 0.0);
  }
  return "<h3>Contributions to the relative L1 error</h3>\n<table>" + rows + "</table>\n";
}

std::string ideal_of(const Json& sensor) {
  if (!sensor.contains("ideal")) return {};
  const Json& ideal = sensor["ideal"];
  const Json& forecast = ideal["forecast"];
  const double explained = ideal["explains"].get<double>();
  return fmt::format(
      "<p><b>A perfect engine with {}</b> would have L1 {}; the candidate has {}: sampling explains "
      "{}.</p>\n",
      number(ideal["sampling"]),
      forecast.is_null() ? number(ideal["l1_error"])
                         : number(forecast["l1_error"]) + " &plusmn; " + number(forecast["l1_deviation"]),
      number(sensor["l1_error"]),
      explained < 1 ? fmt::format("{:.0f} % of the error", 100 * explained) : "the whole error");
}

std::string percent(const Json& share) { return fmt::format("{:.1f} %", 100 * share.get<double>()); }

/// Draws a bar for the share of each row in the error.
std::string parts_of(const Json& rows, const char* title, std::size_t most) {
  std::string text = fmt::format(
      "<table class=\"parts\"><tr><th>{}</th><th colspan=\"2\">of the error</th><th>of the "
      "energy</th><th>own "
      "L1</th><th>level, dB</th><th>bins</th></tr>\n",
      title);
  for (std::size_t k = 0; k < std::min(most, rows.size()); ++k) {
    const Json& row = rows[k];
    text += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{}</td><td style=\"width:30%\"><div class=\"bar\" "
        "style=\"width:{:.1f}%\"></div></td><td class=\"number\">{}</td><td class=\"number\">{}</td><td "
        "class=\"number\">{}</td><td class=\"number\">{}</td></tr>\n",
        number(row["name"]), percent(row["share_of_error"]), 100 * row["share_of_error"].get<double>(),
        percent(row["share_of_energy"]), finite(row["l1_error"]), level(row["level_db"]),
        number(row["bins"]));
  }
  return text + "</table>\n";
}

std::string attribution_of(const Json& sensor) {
  if (!sensor.contains("attribution")) return {};
  const Json& all = sensor["attribution"];
  std::string text = "<section><h3>" + number(sensor["name"]) + "</h3>\n<div class=\"wide\">";
  for (const Json& note : all["notes"]) text += "<p class=\"faint\">" + number(note) + "</p>\n";
  constexpr std::size_t causes = 8, rows = 40;
  text += parts_of(all["causes"], "object and kind of bin", causes) +
          parts_of(all["kinds"], "kind of bin", rows) + parts_of(all["objects"], "object", rows) +
          parts_of(all["materials"], "material", rows) + parts_of(all["ranges"], "range", rows) +
          parts_of(all["beams"], "beams", rows);
  if (!all["worst_bins"].empty()) {
    text +=
        "<h3>Worst bins and their facets</h3><table><tr><th>ping, beam, bin</th><th>range, m</th><th>of the "
        "error</th><th>kind</th><th>facets</th></tr>\n";
    for (const Json& bin : all["worst_bins"]) {
      std::string facets;
      for (const Json& facet : bin["facets"])
        facets += fmt::format("{}{} {} ({})", facets.empty() ? "" : ", ", number(facet["object"]),
                              number(facet["facet"]), percent(facet["share_of_energy"]));
      text += fmt::format(
          "<tr><td class=\"number\">{}, {}, {}</td><td class=\"number\">{}</td><td "
          "class=\"number\">{}</td><td>{}</td><td>{}</td></tr>\n",
          number(bin["ping"]), number(bin["beam"]), number(bin["sample"]), number(bin["slant_range_m"]),
          percent(bin["share_of_difference"]), number(bin["kind"]), facets.empty() ? "-" : facets);
    }
    text += "</table>";
  }
  return text + "</div></section>\n";
}

/// Adds every figure below a JSON value, with its path.
void add_rows(const Json& value, const std::string& path, std::string& rows) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      if (key != "findings" && key != "not_found" && key != "attribution")
        add_rows(inner, path.empty() ? key : path + "." + key, rows);
  } else if (value.is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) add_rows(value[k], fmt::format("{}[{}]", path, k), rows);
  } else {
    rows += fmt::format("<tr><td><code>{}</code></td><td class=\"number\">{}</td></tr>\n", shown_markup(path),
                        number(value));
  }
}

std::string figures_of(const Json& sensor) {
  static constexpr std::array<std::pair<const char*, const char*>, 6> main{
      {{"l1_error", "relative L1 error"},
       {"rms_db_error", "RMS error of echo bins, dB"},
       {"energy_ratio_db", "total energy ratio, dB"},
       {"empty_where_lit", "missing echoes, bins"},
       {"lit_where_shadow", "echoes in shadows, bins"},
       {"lit_bins", "echo bins"}}};
  std::string rows, all;
  for (const auto& [key, name] : main)
    rows += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td></tr>\n", name, number(sensor[key]));
  add_rows(sensor, "", all);
  return "<table>" + rows + "</table>\n<details><summary>All figures</summary><div class=\"wide\"><table>" +
         all + "</table></div></details>\n";
}

}  // namespace

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - k);
    unsigned group = static_cast<unsigned>(bytes[k]) << 16;
    if (left > 1) group |= static_cast<unsigned>(bytes[k + 1]) << 8;
    if (left > 2) group |= bytes[k + 2];
    for (std::size_t d = 0; d < 4; ++d) text += d <= left ? digits[group >> (18 - 6 * d) & 63] : '=';
  }
  return text;
}

std::string report_page(const ReportContents& contents) {
  const Json& figures = contents.figures;
  std::string body;
  for (const Json& sensor : figures["sensors"])
    body += fmt::format("<section><h3>{}: {} pings x {} beams x {} range bins</h3>\n{}{}</section>\n",
                        number(sensor["name"]), number(sensor["pings"]), number(sensor["beams"]),
                        number(sensor["samples"]), findings_of(sensor), ideal_of(sensor) + shares_of(sensor));
  std::string notes;
  for (const Json& note : figures["notes"]) notes += "<p class=\"faint\">Note: " + number(note) + "</p>\n";
  std::string tables;
  for (const Json& sensor : figures["sensors"])
    tables += "<section><h3>" + number(sensor["name"]) + "</h3>\n" + figures_of(sensor) + "</section>\n";
  std::string whose;
  for (const Json& sensor : figures["sensors"]) whose += attribution_of(sensor);
  if (!whose.empty()) whose = "<h2>Attribution of the error</h2>\n" + whose;
  std::string files;
  for (const std::string& line : contents.files) files += shown_markup(line) + "\n";
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>tubefoot "
      "compare</title><style>{}</style></head><body>\n<h1>Comparison of {}</h1>\n<p class=\"faint\">with the "
      "reference {}</p>\n{}<h2>Findings</h2>\n{}<h2>Pictures</h2>\n<section><img alt=\"reference, candidate "
      "and their ratio\" src=\"data:image/png;base64,{}\"><p "
      "class=\"faint\">{}</p></section>\n{}<h2>Figures</h2>\n{}<h2>Command of this "
      "comparison</h2>\n<section><pre>{}</pre><pre class=\"faint\">{}</pre><p "
      "class=\"faint\">docs/compared-figures.md defines every finding and "
      "figure.</p></section>\n</body></html>\n",
      style, number(figures["candidate"]["file"]), number(figures["reference"]["file"]), notes, body,
      base64(contents.png), shown_markup(contents.caption), whose, tables, shown_markup(contents.command),
      files);
}

}  // namespace tubefoot
