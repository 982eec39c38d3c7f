// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "files/input_error.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "geometry/work/stop.hpp"
#include "run/console/interrupt.hpp"
#include "run/console/say.hpp"
#include "run/kept/build_identity.hpp"
#include "run/ranks/rank_link.hpp"

namespace tubefoot {
namespace {

constexpr int done = 0, failed = 1, wrong_input = 2;

/// CLI11's own range checks let NaN through, as it is neither too small nor too large.
CLI::Validator finite_number(double least, bool above) {
  return CLI::Validator(
      [least, above](std::string& text) -> std::string {
        double value = 0;
        const bool number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        if (number && (above ? value > least : value >= least)) return {};
        return fmt::format("'{}' is no number {} {:g}", text, above ? "above" : "of at least", least);
      },
      "NUMBER");
}

/// Of every command that reads a scene.
template <class Options>
void add_scene_flags(CLI::App& command, Options& options) {
  command.add_flag("--confined", options.confined,
                   "read nothing that lies outside of the scene file's folder, links followed");
  command.add_flag("--quiet", options.quiet, "print results and errors only");
}

void add_common(CLI::App& command, CommonOptions& options) {
  command.add_option("SCENE", options.scene, "scene file (docs/scene-file.md)")->required();
  command
      .add_option("--arithmetic", options.arithmetic,
                  "number type of the exact kernel; default: as the scene says")
      ->check(CLI::IsMember({"fixed", "filtered", "rational", "double"}));
  command
      .add_option("--threads", options.threads, "threads to use; default: as the scene says, else all cores")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(command, options);
}

/// Where a standard stream is closed, the first file that is opened would take its number, and its words.
void hold_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF && open("/dev/null", O_RDONLY) < 0) return;
}

int obeyed(int argc, char** argv) {
  CLI::App app{"tubefoot: a sonar simulator that measures footprints instead of sampling them.", "tubefoot"};
  app.set_version_flag("--version", [] { return "tubefoot " TUBEFOOT_VERSION "\n" + build_in_words(); });
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer(
      "Exit status:\n  0  done\n  1  the run failed\n  2  the input or the command line is wrong\n"
      "  3  a comparison found more error than was allowed");
  std::function<int()> command;

  RunOptions run;
  CLI::App* run_app =
      app.add_subcommand("run", "Simulate all pings of a scene and write echoes, pictures and statistics");
  add_common(*run_app, run);
  run_app->add_option("-o,--output", run.output, "folder to write; made whole or not at all")->required();
  run_app->add_option("--engine", run.engine, "tube (exact) or ray (sampling)")
      ->check(CLI::IsMember({"tube", "ray"}));
  run_app
      ->add_option("--binning", run.binning,
                   "tube engine: cut footprints at the samples' borders (exact), or use their centroid's "
                   "energy, spread over their ranges or not")
      ->check(CLI::IsMember({"exact", "spread", "centroid"}));
  run_app->add_option("--sampling", run.sampling, "ray engine: stratified, regular, random or column")
      ->check(CLI::IsMember({"stratified", "regular", "random", "column"}));
  CLI::Option* rays = run_app->add_option("--rays", run.rays, "ray engine: rays per ping")
                          ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000'000}));
  run_app->add_option("--rays-per-beam", run.rays_per_beam, "ray engine: rays per beam instead")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000'000}))
      ->excludes(rays);
  run_app->add_option("--seed", run.seed, "ray engine: seed of the sampling")->check(CLI::NonNegativeNumber);
  run_app->add_flag("--reference", run.reference,
                    "tube engine: certify every energy and write energy_bound beside it");
  run_app->add_option("--tolerance", run.tolerance,
                      "error allowed, 0.1dB (RMS of lit bins), 1e-3 or 0.1% (relative L1): picks engine and "
                      "settings as 'advise' does; with --reference: the bound asked for (default: 1e-9)");
  run_app->add_flag(
      "--resume", run.resume,
      "go on with a run that was interrupted or killed, from '<output>.partial'; begin if there is "
      "none");
  run_app->footer("Example:\n  tubefoot run scenes/wellhead/scene.toml -o out/wellhead");
  run_app->callback([&] { command = [&] { return run_command(run); }; });

  CommonOptions check;
  CLI::App* check_app =
      app.add_subcommand("check", "Load everything a scene names and say what was understood");
  add_common(*check_app, check);
  check_app->footer("Example:\n  tubefoot check scenes/wellhead/scene.toml");
  check_app->callback([&] { command = [&] { return check_command(check); }; });

  AuditOptions audit;
  CLI::App* audit_app = app.add_subcommand(
      "audit", "Prove the closure law, tube by tube, in rationals: visible pieces + open water = the tube");
  add_common(*audit_app, audit);
  audit_app->add_option("--sensor", audit.sensor, "only this sensor");
  audit_app->add_option("--pings", audit.pings, "pings A:B, both included, counted from 0 (default: all)");
  audit_app->footer("Example:\n  tubefoot audit scenes/wellhead/scene.toml --sensor camera --pings 0:2");
  audit_app->callback([&] { command = [&] { return audit_command(audit); }; });

  FootprintOptions footprints;
  CLI::App* footprints_app =
      app.add_subcommand("footprints", "Write the visible polygons of some pings of a sensor");
  add_common(*footprints_app, footprints);
  footprints_app->add_option("--sensor", footprints.sensor, "the sensor; one")->required();
  footprints_app->add_option("--ping,--pings", footprints.pings,
                             "pings A:B, both included, counted from 0 (default: 0)");
  footprints_app->add_option("--beam,--beams", footprints.beams,
                             "beams A:B, both included, or several such between commas (default: all)");
  footprints_app
      ->add_option("-o,--output", footprints.output,
                   "file: .gpkg (GeoPackage), .geojson, .csv (WKT), .vtp (VTK, ParaView), .obj, .ply, .nc "
                   "(netCDF), .txt (exact corners); docs/footprints.md")
      ->required();
  footprints_app->add_option("--rationals", footprints.rationals,
                             "write the exact corners, as fractions, into this file as well");
  footprints_app->footer(
      "Example:\n  tubefoot footprints scenes/wellhead/scene.toml --sensor camera --ping 0 -o camera.gpkg\n"
      "  tubefoot footprints scenes/wellhead/scene.toml --sensor camera --beam 40:50 -o beams.vtp");
  footprints_app->callback([&] { command = [&] { return footprints_command(footprints); }; });

  CoverageOptions coverage;
  CLI::App* coverage_app = app.add_subcommand(
      "coverage", "Measure exactly what a survey's pings see of each facet: how often, or never");
  add_common(*coverage_app, coverage);
  coverage_app->add_option("--sensor", coverage.sensor, "only this sensor");
  coverage_app->add_option("--pings", coverage.pings,
                           "pings A:B of each sensor, both included, counted from 0 (default: all)");
  coverage_app
      ->add_option("-o,--output", coverage.output,
                   "file: .gpkg (GeoPackage: polygons and tables) or .csv (a row a facet); else a folder for "
                   "both and a picture")
      ->required();
  coverage_app->add_option("--picture", coverage.picture, "also draw a plan of it into this PNG");
  coverage_app->footer(
      "Example:\n  tubefoot coverage scenes/survey/scene.toml --pings 200:299 -o out/coverage");
  coverage_app->callback([&] { command = [&] { return coverage_command(coverage); }; });

  ViewOptions view;
  CLI::App* view_app = app.add_subcommand(
      "view", "Write a page that shows footprints in 3-D beside the picture they make (docs/viewer.md)");
  view_app->add_option("RESULT", view.scene, "folder that 'run' wrote, or a scene file")->required();
  view_app->add_option("-o,--output", view.output, "HTML file to write; needs no network")->required();
  view_app->add_option("--sensor", view.sensor, "the sensor (default: the scene's first)");
  view_app->add_option(
      "--pings", view.pings,
      "pings A:B, both included, counted from 0 (default: 0; of a sidescan or an echosounder "
      "as many as a page shows well)");
  view_app->add_option("--scene", view.moved_scene, "where the scene of RESULT is, if it has moved");
  view_app
      ->add_option("--arithmetic", view.arithmetic,
                   "number type of the exact kernel; default: as the run or the scene says")
      ->check(CLI::IsMember({"fixed", "filtered", "rational", "double"}));
  view_app
      ->add_option("--threads", view.threads, "threads to use; default: as the scene says, else all cores")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*view_app, view);
  view_app->footer("Example:\n  tubefoot view out/wellhead -o wellhead.html --sensor camera");
  view_app->callback([&] { command = [&] { return view_command(view); }; });

  RefineOptions refine;
  CLI::App* refine_app = app.add_subcommand(
      "refine", "Write the seabed with its relief in facets, for mesh tools and for mode = \"offline\"");
  refine_app->add_option("SCENE", refine.scene, "scene file (docs/scene-file.md)")->required();
  refine_app->add_option("-o,--output", refine.output, "PLY file to write")->required();
  refine_app->add_option("--threads", refine.threads, "number of threads (default: all cores)")
      ->check(CLI::Range(0, 1024));
  add_scene_flags(*refine_app, refine);
  refine_app->footer("Example:\n  tubefoot refine scenes/sand/ripples.toml -o ripples.ply");
  refine_app->callback([&] { command = [&] { return refine_command(refine); }; });

  CompareOptions compare;
  CLI::App* compare_app =
      app.add_subcommand("compare", "Measure how far one engine's echoes are from another's");
  compare_app->add_option("REFERENCE", compare.reference, "echo file taken for true (docs/echo-file.md)")
      ->required();
  compare_app->add_option("CANDIDATE", compare.candidate, "echo file of the engine in question")->required();
  compare_app->add_option("--json", compare.json, "write all figures into this file; -: print them instead");
  compare_app->add_option("--png", compare.png, "draw both and their difference into this file");
  compare_app->add_option("--sensor", compare.sensor, "only this sensor");
  compare_app->add_option("--worst", compare.worst, "number of worst bins to list (default: 5)")
      ->check(CLI::Range(0, 1000000));
  compare_app->add_flag("--any-scene", compare.any_scene, "compare although the scene hashes differ");
  compare_app->add_option("--within", compare.within_l1, "exit with 3 if a relative L1 error is larger")
      ->check(finite_number(0, false));
  compare_app
      ->add_option("--within-db", compare.within_db,
                   "exit with 3 if an RMS error of lit bins, in dB, is larger")
      ->check(finite_number(0, false));
  compare_app->footer(
      "Example:\n  tubefoot compare out/wellhead/echoes.nc out/wellhead-rays/echoes.nc --png out/rays.png");
  compare_app->callback([&] { command = [&] { return compare_command(compare); }; });

  ChartOptions chart;
  CLI::App* chart_app = app.add_subcommand(
      "chart", "Run every engine in many settings and draw its error against the time it takes");
  chart_app->add_option("SCENE", chart.scenes, "scene files: of each, the first pings of the first sensor")
      ->required();
  chart_app->add_option("-o,--output", chart.output, "folder to write; made whole or not at all")->required();
  chart_app->add_option("--pings", chart.pings, "pings of each scene (default: 1)")
      ->check(CLI::Range(1, 1000000));
  chart_app->add_option("--repeats", chart.repeats, "runs of each setting; the median counts (default: 3)")
      ->check(CLI::Range(1, 1000));
  chart_app
      ->add_option("--seconds", chart.seconds_per_trial,
                   "leave out settings that would take longer than this for one run (default: 4)")
      ->check(finite_number(0, true));
  add_scene_flags(*chart_app, chart);
  chart_app->footer("Example:\n  tubefoot chart scenes/chart/*.toml -o out/chart");
  chart_app->callback([&] { command = [&] { return chart_command(chart); }; });

  AdviseOptions advise;
  CLI::App* advise_app = app.add_subcommand(
      "advise", "Measure a few pings and name the cheapest engine and settings that hold a tolerance");
  advise_app->add_option("SCENE", advise.scene, "scene file (docs/scene-file.md)")->required();
  advise_app
      ->add_option("--tolerance", advise.tolerance,
                   "error allowed: 0.1dB (RMS of lit bins), 1e-3 or 0.1% (relative L1)")
      ->required();
  advise_app
      ->add_option("--pings", advise.pings,
                   "pings of each sensor to predict from, and as many others to measure (default: 8)")
      ->check(CLI::Range(2, 1000000));
  advise_app->add_option("--json", advise.json, "write all figures into this file; -: print them instead");
  add_scene_flags(*advise_app, advise);
  advise_app->footer("Example:\n  tubefoot advise scenes/wellhead/scene.toml --tolerance 0.5dB");
  advise_app->callback([&] { command = [&] { return advise_command(advise); }; });

  PresetsOptions presets;
  CLI::App* presets_app =
      app.add_subcommand("presets", "List the sonars that a scene's sensors can be, with their sources");
  presets_app->add_option("NAME", presets.name, "print this one's keys, as a scene file has them");
  presets_app->footer("Example:\n  tubefoot presets klein-3000-445");
  presets_app->callback([&] { command = [&] { return presets_command(presets); }; });

  const auto is_named = [&](const CLI::App* sub) { return argc > 1 && sub->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_named).empty()) {
    std::vector<std::string> names;
    for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
    const std::string last = names.back();
    names.pop_back();
    say("tubefoot: there is no command '{}': {} or {}\n", argv[1], fmt::join(names, ", "), last);
    return wrong_input;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Several ranks read the same command: one complains.
    if (argc > 1 && std::string_view(argv[1]) == "run" && is_later_rank()) return done;
    // --help and --version arrive as errors of code 0.
    std::ostringstream asked, complaint;
    const int code = app.exit(error, asked, complaint);
    tell("{}", asked.str());
    say("{}", complaint.str());
    return code == 0 ? done : wrong_input;
  }
  try {
    return command();
  } catch (const Interrupted&) {
    say("tubefoot: interrupted: nothing was written\n");
    return failed;
  } catch (const InputError& error) {
    say("{}\n", error.what());
    return wrong_input;
  } catch (const UsageError& error) {
    say("tubefoot: {}\n", shown(error.what()));
    return wrong_input;
  } catch (const std::bad_alloc&) {
    say("tubefoot: out of memory: use a window, a coarser decimation or a smaller scene\n");
    return failed;
  } catch (const std::exception& error) {
    // What is wrong with stdout is said once, at the end.
    if (std::ferror(stdout) == 0) say("tubefoot: {}\n", shown(error.what()));
    return failed;
  }
}

}  // namespace

int run_command_line(int argc, char** argv) {
  hold_closed_streams();
  take_signals();
  const int code = obeyed(argc, argv);
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  const std::string why = errno != 0 ? fmt::format(": {}", std::strerror(errno)) : "";
  say("tubefoot: cannot write to standard output{}\n", why);
  return code == done ? failed : code;
}

}  // namespace tubefoot
