// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the assumptions about imported pictures against the reference. It correlates the reference with the
// pictures read in each possible way, and looks for displacements that other axes would explain.
#include "import/assumptions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "compare/diagnosis/coarse_search.hpp"
#include "compare/diagnosis/diagnosis.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

// Thresholds for another way of reading. It must leave less than 0.8 of the correlation that the assumed way
// lacks. Its correlation must be larger by 0.03, and above 0.3.
constexpr double clearly_less = 0.8, clearly_more = 0.03, hardly_alike = 0.3;
constexpr std::size_t most_others = 4;

double pearson(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n,
               mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += (a[k] - mean_a) * (b[k] - mean_b);
    aa += (a[k] - mean_a) * (a[k] - mean_a);
    bb += (b[k] - mean_b) * (b[k] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

/// Returns whether one correlation exceeds the other by so much that the other way of reading is refuted.
bool better(double than, double other) {
  return 1 - than < clearly_less * (1 - other) && than > other + clearly_more && than > hardly_alike;
}

bool silent(const std::vector<double>& energies) {
  return std::ranges::none_of(energies, [](double e) { return e > 0; });
}

/// Adds the meaning of displacements for the declared axes.
void add_displacements(const Diagnosis& diagnosis, const BinAxes& declared, Verdict& verdict) {
  const Bins& samples = declared.samples;
  const double step_m = (samples.edges.back() - samples.edges.front()) / static_cast<double>(samples.count());
  for (const Finding& finding : diagnosis.findings) {
    std::string remedy;
    if (finding.fault == "half-sample" || finding.fault == "sample-shift")
      remedy = fmt::format("; --ranges {:.8g}:{:.8g} (edges) corrects this",
                           samples.edges.front() - finding.size * step_m,
                           samples.edges.back() - finding.size * step_m);
    else if (finding.fault == "tangent-spacing")
      remedy = finding.size > 0
                   ? fmt::format("; --azimuths tangent:{} corrects this", diagnosis.alignment.warp.views)
                   : "; --azimuths even corrects this";
    else if (finding.fault != "beam-shift" && finding.fault != "azimuth-scale" &&
             finding.fault != "range-scale" && finding.fault != "swapped-ports")
      continue;
    verdict.refuted.push_back(finding.words + remedy);
  }
}

}  // namespace

double correlation(const EchoShape& shape, const BinAxes& axes, const std::vector<double>& truth_j,
                   const std::vector<double>& candidate_j) {
  const Fan fan(shape, axes.beams.centres, axes.samples.centres);
  const auto seen = [&](const std::vector<double>& energies) {
    constexpr double variance = 1;
    return fan.blurred(as_seen(shape, energies, row_levels(shape, energies)), fan.has_width() ? variance : 0,
                       variance);
  };
  return pearson(seen(truth_j), seen(candidate_j));
}

Verdict tested(const EchoShape& shape, const BinAxes& axes, const std::vector<double>& truth_j,
               const std::vector<Hypothesis>& hypotheses, const BinAxes& declared) {
  Verdict verdict;
  if (silent(truth_j)) {
    verdict.found.emplace_back("nothing was tested: the reference has no echoes in these pings");
    return verdict;
  }
  struct Tried {
    const Hypothesis* of;
    std::vector<double> energies;
    double correlation;
  };
  std::vector<Tried> tried;
  for (const Hypothesis& hypothesis : hypotheses) {
    stop_if_wanted();
    std::vector<double> energies = hypothesis.energies_of();
    if (energies.empty()) continue;
    const double alike = correlation(shape, axes, truth_j, energies);
    tried.push_back({&hypothesis, std::move(energies), alike});
  }
  if (tried.empty() || silent(tried.front().energies)) {
    verdict.refuted.emplace_back("the pictures have no echoes where the reference has some");
    return verdict;
  }
  const Tried &assumed = tried.front(), &best = *std::ranges::max_element(tried, {}, &Tried::correlation);
  const bool refuted = better(best.correlation, assumed.correlation);
  const Tried& taken = refuted ? best : assumed;
  if (refuted)
    verdict.refuted.push_back(
        fmt::format("{}: corr {:.2f}, compared with {:.2f} for the assumed interpretation; use {}",
                    best.of->name, best.correlation, assumed.correlation, best.of->remedy));
  else
    verdict.found.push_back(fmt::format("{}{}: corr {:.2f}", assumed.of->name,
                                        assumed.correlation > hardly_alike ? " holds" : "",
                                        assumed.correlation));
  std::vector<std::string> others;
  for (const Tried& other : tried)
    if (&other != &best && &other != &assumed && others.size() < most_others)
      others.push_back(fmt::format("{} {:.2f}", other.of->name, other.correlation));
  if (!others.empty())
    verdict.found.push_back(fmt::format("corr of other interpretations: {}", fmt::join(others, ", ")));
  std::vector<double> otherwise;
  bool scale_ambiguous = false;
  if (!taken.of->other_scale.empty()) otherwise = taken.of->energies_of_other_scale();
  if (!otherwise.empty()) {
    const double alike = correlation(shape, axes, truth_j, otherwise);
    scale_ambiguous = better(alike, taken.correlation);
    if (scale_ambiguous)
      verdict.ambiguous.push_back(
          fmt::format("with --scale {} the pictures agree better with the reference: corr {:.2f} instead of "
                      "{:.2f}. The same happens if the numbers are means per bin. In that case, keep the "
                      "scale and compare with --output-model",
                      taken.of->other_scale, alike, taken.correlation));
    else
      verdict.found.push_back(fmt::format("corr with --scale {}: {:.2f}", taken.of->other_scale, alike));
  }
  if (best.correlation < hardly_alike) {
    verdict.refuted.push_back(
        fmt::format("no interpretation of the pictures resembles the reference (corr {:.2f} at best): is it "
                    "the same scene, sensor, pose and ping?",
                    best.correlation));
    return verdict;
  }
  // If the other scale fits about as well, displacements are measured in the scale whose picture is closer
  // to the reference.
  const std::vector<double>& looked_at = scale_ambiguous ? otherwise : taken.energies;
  add_displacements(
      diagnose({{shape, truth_j, looked_at, {}, axes.samples.centres}, axes.beams.centres, looked_at, {}}),
      declared, verdict);
  return verdict;
}

}  // namespace tubefoot
