// SPDX-License-Identifier: GPL-3.0-or-later
// tubefoot_advise_study PAGE SCENE...: requests advice for each scene and writes a page. The page compares
// the advice with measurements on pings that the advice did not use.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "run/settings.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "unseen.hpp"

namespace tubefoot {
namespace {

constexpr const char* tolerances[] = {"3dB", "1dB", "0.5dB", "0.1dB", "0.1", "1e-2", "1e-3"};
constexpr std::size_t unseen_pings = 8;
constexpr double allowed_ratio = 1.5;

struct Tally {
  int advices = 0, hold = 0, near = 0;
  double worst = 0;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// Measures all settings that advice may select, up to the work of exact cuts, which always satisfy the
/// tolerance.
std::vector<Measured> all_measured(UnseenPings& unseen) {
  constexpr int repeats = 3;
  constexpr double most_rays = 1e6;
  std::vector<Measured> all;
  for (const Binning binning : {Binning::exact, Binning::spread, Binning::centroid})
    all.push_back({tube_setting(binning), unseen.run(tube_setting(binning), repeats)});
  const double exact_seconds = all.front().trial.work.processor_seconds;
  for (const RaySampling sampling : {RaySampling::stratified, RaySampling::sobol, RaySampling::adaptive,
                                     RaySampling::regular, RaySampling::column})
    for (Measured& m : fine_ladder(unseen, sampling, repeats, exact_seconds, most_rays))
      all.push_back(std::move(m));
  return all;
}

std::string name(const EngineSetting& s) { return s.engine + ", " + s.setting; }

/// Measures the seconds of two settings alternately, because the speed of the machine drifts.
std::pair<double, double> seconds_in_turns(UnseenPings& unseen, const EngineSetting& a,
                                           const EngineSetting& b) {
  constexpr int rounds = 7;
  std::vector<double> first, second;
  for (int k = 0; k < rounds; ++k) {
    first.push_back(unseen.run(a, 1).work.processor_seconds);
    second.push_back(unseen.run(b, 1).work.processor_seconds);
  }
  return {median(first), median(second)};
}

std::string study(const std::filesystem::path& file, Tally& tally) {
  const SceneDescription scene = read_scene_file(file);
  AdviceOptions options;
  options.quiet = true;
  std::unique_ptr<UnseenPings> unseen;
  std::vector<Measured> measured;
  std::string rows;
  for (const char* text : tolerances) {
    const Tolerance tolerance = parse_tolerance(text);
    const Advice advice = advise(scene, tolerance, options);
    if (!unseen) {
      unseen = std::make_unique<UnseenPings>(scene, advice.sensors, unseen_pings);
      measured = all_measured(*unseen);
    }
    const Measured* least = nullptr;
    for (const Measured& m : measured)
      if (error_of(m.trial, tolerance.measure) <= tolerance.value &&
          (!least || m.trial.work.processor_seconds < least->trial.work.processor_seconds))
        least = &m;
    const EngineSetting& advised = advice.best().setting;
    const double error = error_of(unseen->run(advised, 1), tolerance.measure);
    const bool same = name(advised) == name(least->setting);
    const auto [ours, cheapest] = seconds_in_turns(*unseen, advised, least->setting);
    const double ratio = same ? 1 : ours / cheapest;
    ++tally.advices;
    tally.hold += error <= tolerance.value;
    tally.near += ratio <= allowed_ratio;
    tally.worst = std::max(tally.worst, ratio);
    rows += fmt::format(
        "| {} | {} | {} | {} | {} | {:.3g} | {} | {} | {:.3g} | {:.2f} |\n",
        file.stem() == "scene" ? file.parent_path().filename().string() : file.stem().string(), text,
        name(advised), error_text(tolerance.measure, advice.best().predicted_error),
        error_text(tolerance.measure, error) + (error <= tolerance.value ? "" : " **over**"), 1e3 * ours,
        name(least->setting), error_text(tolerance.measure, error_of(least->trial, tolerance.measure)),
        1e3 * cheapest, ratio);
  }
  return rows;
}

int run(const std::filesystem::path& page, const std::vector<std::filesystem::path>& scenes) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  std::string rows;
  std::vector<std::string> left_out;
  Tally tally;
  for (const auto& scene : scenes) {
    try {
      rows += study(scene, tally);
    } catch (const std::exception& error) {  // the data is not in the repository
      left_out.push_back(fmt::format("- omitted: {}", error.what()));
      fmt::print(stderr, "{}\n", left_out.back());
    }
    fmt::print(stderr, "{}: {} of {} recommendations hold, {} are within {} times\n", scene.string(),
               tally.hold, tally.advices, tally.near, allowed_ratio);
  }
  std::ofstream out(page);
  out << fmt::format(
      "# Accuracy of recommendations\n\n`make advise-study` writes this page. It runs `tubefoot advise` with "
      "its defaults, and then the recommended\nsetting on at most {} other pings of each sensor. A sensor "
      "without other pings uses {} other positions and\ndirections nearby. *Cheapest* is the setting with "
      "the fewest seconds on these pings that satisfies the\ntolerance: tubes with their three binnings, and "
      "stratified, sobol, adaptive, regular and column rays in\nsteps of 1.25 up to the cost of exact cuts. "
      "This choice uses the results, so chance can favour it. Seconds are\nprocessor time of one thread, "
      "measured alternately.\n\n**{} of {} recommendations hold; {} take at most {} times as long as the "
      "cheapest setting; the worst ratio is {:.2f}.**\n{}{}{}\n| scene | tolerance | recommended | predicted "
      "| measured | ms per ping | cheapest | its error | ms per ping | ratio "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n{}",
      unseen_pings, UnseenPings::moved_places, tally.hold, tally.advices, tally.near, allowed_ratio,
      tally.worst, left_out.empty() ? "" : "\n", fmt::join(left_out, "\n"), left_out.empty() ? "" : "\n",
      rows);
  if (!out.flush()) {
    fmt::print(stderr, "cannot write {}\n", page.string());
    return 1;
  }
  fmt::print("wrote {}\n", page.string());
  return 0;
}

}  // namespace
}  // namespace tubefoot

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: tubefoot_advise_study PAGE SCENE...\n");
    return 2;
  }
  return tubefoot::run(argv[1], {argv + 2, argv + argc});
}
