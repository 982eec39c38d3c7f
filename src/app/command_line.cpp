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

#include "app/asked.hpp"
#include "app/commands.hpp"
#include "app/library_versions.hpp"
#include "files/input_error.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "geometry/steps/stop.hpp"
#include "run/console/interrupt.hpp"
#include "run/console/say.hpp"
#include "run/kept/build_identity.hpp"
#include "run/ranks/rank_link.hpp"

namespace tubefoot {

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

namespace {

constexpr int done = 0, failed = 1, wrong_input = 2;

/// Where a standard stream is closed, the first file that is opened would take its number, and its words.
void hold_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF && open("/dev/null", O_RDONLY) < 0) return;
}

void add_check(CLI::App& app, Asked& asked) {
  CheckOptions& check = asked.check;
  CLI::App* command =
      app.add_subcommand("check", "Load everything a scene names and say what was understood");
  add_common(*command, check);
  command->add_option("--png", check.picture,
                      "draw the scene: plan and side views with bed, objects, tracks and where sensors look");
  command->footer("Example:\n  tubefoot check scenes/wellhead/scene.toml --png scene.png");
  command->callback([&asked] { asked.command = [&asked] { return check_command(asked.check); }; });
}

void add_audit(CLI::App& app, Asked& asked) {
  AuditOptions& audit = asked.audit;
  CLI::App* command = app.add_subcommand(
      "audit", "Prove the closure law, tube by tube, in rationals: visible pieces + open water = the tube");
  add_common(*command, audit);
  command->add_option("--sensor", audit.sensor, "only this sensor");
  command->add_option("--pings", audit.pings, "pings A:B, both included, counted from 0 (default: all)");
  command->footer("Example:\n  tubefoot audit scenes/wellhead/scene.toml --sensor camera --pings 0:2");
  command->callback([&asked] { asked.command = [&asked] { return audit_command(asked.audit); }; });
}

void add_footprints(CLI::App& app, Asked& asked) {
  FootprintOptions& footprints = asked.footprints;
  CLI::App* command =
      app.add_subcommand("footprints", "Write the visible polygons of some pings of a sensor");
  add_common(*command, footprints);
  command->add_option("--sensor", footprints.sensor, "the sensor; one")->required();
  command->add_option("--ping,--pings", footprints.pings,
                      "pings A:B, both included, counted from 0 (default: 0)");
  command->add_option("--beam,--beams", footprints.beams,
                      "beams A:B, both included, or several such between commas (default: all)");
  command
      ->add_option("-o,--output", footprints.output,
                   "file: .gpkg (GeoPackage), .geojson, .csv (WKT), .vtp (VTK, ParaView), .obj, .ply, .nc "
                   "(netCDF), .txt (exact corners); docs/footprints.md")
      ->required();
  command->add_option("--rationals", footprints.rationals,
                      "write the exact corners, as fractions, into this file as well");
  command->footer(
      "Example:\n  tubefoot footprints scenes/wellhead/scene.toml --sensor camera --ping 0 -o camera.gpkg\n"
      "  tubefoot footprints scenes/wellhead/scene.toml --sensor camera --beam 40:50 -o beams.vtp");
  command->callback([&asked] { asked.command = [&asked] { return footprints_command(asked.footprints); }; });
}

void add_coverage(CLI::App& app, Asked& asked) {
  CoverageOptions& coverage = asked.coverage;
  CLI::App* command = app.add_subcommand(
      "coverage", "Measure exactly what a survey's pings see of each facet: how often, or never");
  add_common(*command, coverage);
  command->add_option("--sensor", coverage.sensor, "only this sensor");
  command->add_option("--pings", coverage.pings,
                      "pings A:B of each sensor, both included, counted from 0 (default: all)");
  command
      ->add_option("-o,--output", coverage.output,
                   "file: .gpkg (GeoPackage: polygons and tables) or .csv (a row a facet); else a folder for "
                   "both and a picture")
      ->required();
  command
      ->add_option("--order", coverage.order,
                   "what paths of up to so many interactions see; 1: straight ways only; else [paths] says")
      ->check(CLI::Range(1, 8));
  command->add_option("--picture", coverage.picture, "also draw a plan of it into this PNG");
  command->footer("Example:\n  tubefoot coverage scenes/survey/scene.toml --pings 200:299 -o out/coverage");
  command->callback([&asked] { asked.command = [&asked] { return coverage_command(asked.coverage); }; });
}

void add_strength(CLI::App& app, Asked& asked) {
  StrengthOptions& strength = asked.strength;
  CLI::App* command = app.add_subcommand(
      "strength",
      "Compute the target strength of a mesh over directions and frequencies (docs/smooth-surfaces.md)");
  command->add_option("MESH", strength.mesh, "mesh file, as scenes take them: .obj, .ply, .stl, .off, ...")
      ->required();
  command
      ->add_option("--frequency,--frequencies", strength.frequencies,
                   "FIRST:LAST:STEP or numbers between commas, in Hz, kHz or MHz: 38kHz,120kHz")
      ->required();
  command->add_option(
      "--azimuth,--azimuths", strength.azimuths,
      "of the sonar, FIRST:LAST:STEP or numbers, degrees from x towards y (default: 0:359:1)");
  command->add_option("--elevation,--elevations", strength.elevations,
                      "of the sonar, likewise, towards z (default: 0)");
  command->add_option("--sound-speed", strength.sound_speed, "of the water, m/s (default: 1500)")
      ->check(finite_number(0, true));
  command->add_option("--reflection", strength.reflection,
                      "of the surface: rigid, soft, a number from -1 to 1, or fluid:DENSITY:SPEED[:LOSS] "
                      "(default: rigid)");
  command->add_option("--roughness", strength.roughness_m, "standard deviation of its height, m (default: 0)")
      ->check(finite_number(0, false));
  CLI::Option* reference =
      command->add_flag("--reference", strength.reference,
                        "certify every length: a bound beside each, from balls (docs/smooth-surfaces.md)");
  command
      ->add_option("--tolerance", strength.tolerance,
                   "with --reference: the bound asked for, relative, 1e-12 to 0.1; wider ones are told "
                   "(default: 1e-3)")
      ->check(finite_number(0, true))
      ->needs(reference);
  command
      ->add_option("--unit", strength.unit_m, "metres of the mesh's unit (default: as the file says, else 1)")
      ->check(finite_number(0, true));
  command
      ->add_option("--up", strength.up, "the mesh's axis that becomes z (default: as the file says, else z)")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command
      ->add_option("-o,--output", strength.output,
                   "file: .csv, .nc (netCDF) or .png; else a folder for all three")
      ->required();
  command->add_option("--threads", strength.threads, "threads to use (default: all cores)")
      ->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", strength.quiet, "print results and errors only");
  command->footer("Example:\n  tubefoot strength mine.stl --unit 1e-3 --frequency 38kHz,120kHz -o out/mine");
  command->callback([&asked] { asked.command = [&asked] { return strength_command(asked.strength); }; });
}

void add_view(CLI::App& app, Asked& asked) {
  ViewOptions& view = asked.view;
  CLI::App* command = app.add_subcommand(
      "view", "Write a page that shows footprints in 3-D beside the picture they make (docs/viewer.md)");
  command->add_option("RESULT", view.scene, "folder that 'run' wrote, or a scene file")->required();
  command->add_option("-o,--output", view.output, "HTML file to write; needs no network")->required();
  command->add_option("--sensor", view.sensor, "the sensor (default: the scene's first)");
  command->add_option("--pings", view.pings,
                      "pings A:B, both included, counted from 0 (default: 0; of a sidescan or an echosounder "
                      "as many as a page shows well)");
  CLI::Option* candidate = command->add_option(
      "--candidate", view.candidate,
      "echo file of another engine: its picture, and how far it is from this one, beside the scene");
  command
      ->add_option("--reference", view.reference,
                   "with --candidate: echo file of the picture that it is held against (default: RESULT's)")
      ->needs(candidate);
  command->add_option("--scene", view.moved_scene, "where the scene of RESULT is, if it has moved");
  command
      ->add_option("--arithmetic", view.arithmetic,
                   "number type of the exact kernel; default: as the run or the scene says")
      ->check(CLI::IsMember({"fixed", "filtered", "rational", "double"}));
  command->add_option("--threads", view.threads, "threads to use; default: as the scene says, else all cores")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*command, view);
  command->footer("Example:\n  tubefoot view out/wellhead -o wellhead.html --sensor camera");
  command->callback([&asked] { asked.command = [&asked] { return view_command(asked.view); }; });
}

void add_refine(CLI::App& app, Asked& asked) {
  RefineOptions& refine = asked.refine;
  CLI::App* command = app.add_subcommand(
      "refine", "Write the seabed with its relief in facets, for mesh tools and for mode = \"offline\"");
  command->add_option("SCENE", refine.scene, "scene file (docs/scene-file.md)")->required();
  command->add_option("-o,--output", refine.output, "PLY file to write")->required();
  command->add_option("--threads", refine.threads, "number of threads (default: all cores)")
      ->check(CLI::Range(0, 1024));
  add_scene_flags(*command, refine);
  command->footer("Example:\n  tubefoot refine scenes/sand/ripples.toml -o ripples.ply");
  command->callback([&asked] { asked.command = [&asked] { return refine_command(asked.refine); }; });
}

void add_export(CLI::App& app, Asked& asked) {
  ExportOptions& exported = asked.exported;
  CLI::App* command = app.add_subcommand(
      "export", "Write a scene for another engine: same triangles, same pose, same sonar (docs/exchange.md)");
  command->add_option("SCENE", exported.scene, "scene file (docs/scene-file.md)")->required();
  command->add_option("--threads", exported.threads, "threads to use; default: all cores")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*command, exported);
  command->add_option("--to", exported.to, "sdf (Gazebo), stonefish (.scn), gltf, obj or holoocean (JSON)")
      ->required()
      ->check(CLI::IsMember({"sdf", "stonefish", "gltf", "obj", "holoocean"}));
  command->add_option("-o,--output", exported.output, "folder to write; made whole or not at all")
      ->required();
  command->add_option("--ping", exported.ping, "the ping whose pose goes out, counted from 0 (default: 0)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--sensor", exported.sensor, "only this sensor (default: all)");
  command->footer("Example:\n  tubefoot export scenes/imaging/scene.toml --to stonefish -o out/imaging-scn");
  command->callback([&asked] { asked.command = [&asked] { return export_command(asked.exported); }; });
}

void add_import_scene(CLI::App& app, Asked& asked) {
  ImportSceneOptions& world = asked.import_scene;
  CLI::App* command = app.add_subcommand(
      "import-scene",
      "Make a scene file of another engine's world: geometry, poses and sonars (docs/exchange.md)");
  command->add_option("WORLD", world.world, "SDF file (.sdf, .world) or Stonefish scenario (.scn)")
      ->required();
  command->add_option("-o,--output", world.output, "folder to write; made whole or not at all")->required();
  command
      ->add_option("--model-path", world.model_path,
                   "folder that model://NAME/... is looked for in, and that files may come from besides the "
                   "world's own folder; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--quiet", world.quiet, "do not say what is left out");
  command->footer("Example:\n  tubefoot import-scene harbour.world --model-path models -o out/harbour");
  command->callback(
      [&asked] { asked.command = [&asked] { return import_scene_command(asked.import_scene); }; });
}

void add_compare(CLI::App& app, Asked& asked) {
  CompareOptions& compare = asked.compare;
  CLI::App* command = app.add_subcommand("compare", "Measure how far one engine's echoes are from another's");
  command->add_option("REFERENCE", compare.reference, "echo file taken for true (docs/echo-file.md)")
      ->required();
  command->add_option("CANDIDATE", compare.candidate, "echo file of the engine in question")->required();
  command->add_option(
      "--html", compare.html,
      "write one page into this file: findings (--diagnose), with --scene whose the error is, pictures, "
      "figures, how to repeat it");
  command->add_option("--recipe", compare.recipe,
                      "put the reference into the candidate's own measure by the steps of this file "
                      "(docs/recipes.md)");
  command->add_option("--json", compare.json, "write all figures into this file; -: print them instead");
  command->add_option("--png", compare.png, "draw both and their difference into this file");
  command->add_option("--sensor", compare.sensor, "only this sensor");
  command->add_option("--worst", compare.worst, "number of worst bins to list (default: 5)")
      ->check(CLI::Range(0, 1000000));
  command->add_flag("--any-scene", compare.any_scene, "compare although the scene hashes differ");
  command->add_option(
      "--fit", compare.fit,
      "compare after fitting gain, range (a power of it) and offset (a floor), or some of them: "
      "gain,range,offset");
  command->add_flag(
      "--geometry", compare.geometry,
      "compare what is seen and where, whatever its energy: first returns, shadows, visible area");
  command
      ->add_option("--threshold", compare.threshold,
                   "with --geometry: the candidate is lit above this (default: above its noise floor)")
      ->check(finite_number(0, false))
      ->needs("--geometry");
  command->add_flag(
      "--diagnose", compare.diagnose,
      "say what is wrong: shifts, scales, mirror, spacing, blur, law of range, shadows, noise, each "
      "with its size and error bar");
  command
      ->add_option(
          "--ideal", compare.ideal,
          "with --diagnose: what of the error a perfect engine of this sampling would have: 1x512 (columns x "
          "rays of each beam) or points:512 (at random), with --scene; or an echo file of one")
      ->needs("--diagnose");
  CLI::Option* scene =
      command->add_option("--scene", compare.scene, "the scene that the reference was computed of");
  command
      ->add_flag("--attribute", compare.attribute,
                 "say whose the error is: by object, material, kind of bin, range and beam, and which facets "
                 "are behind the worst bins")
      ->needs(scene);
  command
      ->add_option("--frames", compare.frames,
                   "average as many of the candidate's pings, which are frames of one (default: 1)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--within", compare.within_l1, "exit with 3 if a relative L1 error is larger")
      ->check(finite_number(0, false));
  command
      ->add_option("--within-db", compare.within_db,
                   "exit with 3 if an RMS error of lit bins, in dB, is larger")
      ->check(finite_number(0, false));
  add_scene_flags(*command, compare);
  command->footer(
      "Example:\n  tubefoot compare out/wellhead/echoes.nc out/wellhead-rays/echoes.nc --png out/rays.png");
  command->callback([&asked] { asked.command = [&asked] { return compare_command(asked.compare); }; });
}

void add_import(CLI::App& app, Asked& asked) {
  ImportOptions& import = asked.import;
  CLI::App* command = app.add_subcommand(
      "import", "Turn another engine's pictures into an echo file that 'compare' reads (docs/import.md)");
  command
      ->add_option(
          "RESULT", import.results,
          "pictures, or folders of them: .npy, .npz, .csv, .png, .tif, .exr, .nc; in the order of their "
          "names a ping each")
      ->required();
  command->add_option("-o,--output", import.output, "echo file to write (.nc); originals go beside it")
      ->required();
  CLI::Option* like =
      command->add_option("--like", import.like,
                          "echo file of the reference: beams, ranges and poses, and the truth to test with");
  CLI::Option* scene =
      command->add_option("--scene", import.scene, "scene file instead: the reference is run for it")
          ->excludes(like);
  command->add_option("--sensor", import.sensor, "the reference's sensor, where it has several");
  command
      ->add_option("--profile", import.profile,
                   "what an engine writes is assumed: " + one_of(profile_names(), '\''))
      ->check(CLI::IsMember(profile_names()));
  command->add_option(
      "--scale", import.scale,
      "what the numbers are: energy, amplitude, db, db:REFERENCE (the energy of 0 dB) or 8bit");
  command
      ->add_option(
          "--order", import.order,
          "range-first: a row is a range; beam-first: a row is a beam; two-sided: a row is a ping of a "
          "sidescan, port left (default: as the shape tells)")
      ->check(CLI::IsMember({"range-first", "beam-first", "two-sided"}));
  // An optional flag of CLI11 is false where it is not given, which is not unset.
  const auto add_turn = [&](const char* flag, std::optional<bool>& turned, bool value, const char* words) {
    return command->add_flag_callback(
        flag, [&turned, value] { turned = value; }, words);
  };
  CLI::Option* beams = add_turn("--flip-beams", import.flip_beams, true, "beams go from starboard to port");
  add_turn("--no-flip-beams", import.flip_beams, false, "they do not, whatever the profile assumes")
      ->excludes(beams);
  CLI::Option* range = add_turn("--flip-range", import.flip_range, true, "ranges go from far to near");
  add_turn("--no-flip-range", import.flip_range, false, "they do not, whatever the profile assumes")
      ->excludes(range);
  command->add_option(
      "--azimuths", import.azimuths,
      "where beams are: even or tangent over the reference's opening, FILE.csv (azimuth_deg), or "
      "FIRST:LAST in degrees (default: as the file says, else the reference's)");
  command->add_option("--ranges", import.ranges,
                      "where samples are: FIRST:LAST in m (default: as the file says, else the reference's)");
  command
      ->add_option("--range-origin", import.range_origin,
                   "whether ranges, declared or the file's, are of the samples' edges or centres")
      ->check(CLI::IsMember({"edges", "centres"}));
  command->add_option(
      "--cartesian", import.cartesian,
      "the picture is a fan in even pixels: COLUMN:ROW:METRES, its apex in pixels and metres a pixel, "
      "or fan: it fills the picture");
  command->add_option("--forward", import.forward, "with --cartesian: where ahead is (default: up)")
      ->check(CLI::IsMember({"up", "down", "left", "right"}))
      ->needs("--cartesian");
  command->add_flag("--resample", import.resample,
                    "bring pictures of other bins onto the reference's, by means");
  command->add_option("--variable", import.variable,
                      "the picture among the arrays of an NPZ or netCDF file, or the channel of an image");
  command->add_option("--range-variable", import.range_variable, "and that of its ranges, in metres");
  command->add_option("--azimuth-variable", import.azimuth_variable, "and that of its azimuths, in radians");
  command->add_option("--topic", import.topic,
                      "of a recording of ROS 2, the topic of the pictures (default: the only one with any)");
  command->add_option("--recipe", import.recipe, "test against the truth in the engine's own measure");
  command->add_flag("--strict", import.strict, "refuse what the truth refutes, instead of a warning");
  command->add_flag("--confined", import.confined,
                    "of a scene, read nothing that lies outside of its file's folder, links followed");
  command->footer(
      "Example:\n  tubefoot import frames/*.png --like out/reference/echoes.nc --profile stonefish -o "
      "candidate.nc");
  command->callback([&asked, like, scene] {
    if (like->empty() && scene->empty()) throw CLI::RequiredError("--like REFERENCE or --scene SCENE");
    asked.command = [&asked] { return import_command(asked.import); };
  });
}

void add_chart(CLI::App& app, Asked& asked) {
  ChartOptions& chart = asked.chart;
  CLI::App* command = app.add_subcommand(
      "chart", "Run every engine in many settings and draw its error against the time it takes");
  command->add_option("SCENE", chart.scenes, "scene files: of each, the first pings of the first sensor")
      ->required();
  command->add_option("-o,--output", chart.output, "folder to write; made whole or not at all")->required();
  command->add_option("--pings", chart.pings, "pings of each scene (default: 1)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--repeats", chart.repeats, "runs of each setting; the median counts (default: 3)")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--seconds", chart.seconds_per_trial,
                   "leave out settings that would take longer than this for one run (default: 4)")
      ->check(finite_number(0, true));
  add_scene_flags(*command, chart);
  command->footer("Example:\n  tubefoot chart scenes/chart/*.toml -o out/chart");
  command->callback([&asked] { asked.command = [&asked] { return chart_command(asked.chart); }; });
}

void add_advise(CLI::App& app, Asked& asked) {
  AdviseOptions& advise = asked.advise;
  CLI::App* command = app.add_subcommand(
      "advise", "Measure a few pings and name the cheapest engine and settings that hold a tolerance");
  command->add_option("SCENE", advise.scene, "scene file (docs/scene-file.md)")->required();
  command
      ->add_option("--tolerance", advise.tolerance,
                   "error allowed: 0.1dB (RMS of lit bins), 1e-3 or 0.1% (relative L1)")
      ->required();
  command
      ->add_option("--pings", advise.pings,
                   "pings of each sensor to predict from, and as many others to measure (default: 8)")
      ->check(CLI::Range(2, 1000000));
  command->add_option("--json", advise.json, "write all figures into this file; -: print them instead");
  add_scene_flags(*command, advise);
  command->footer("Example:\n  tubefoot advise scenes/wellhead/scene.toml --tolerance 0.5dB");
  command->callback([&asked] { asked.command = [&asked] { return advise_command(asked.advise); }; });
}

void add_presets(CLI::App& app, Asked& asked) {
  PresetsOptions& presets = asked.presets;
  CLI::App* command =
      app.add_subcommand("presets", "List the sonars that a scene's sensors can be, with their sources");
  command->add_option("NAME", presets.name, "print this one's keys, as a scene file has them");
  command->footer("Example:\n  tubefoot presets klein-3000-445");
  command->callback([&asked] { asked.command = [&asked] { return presets_command(asked.presets); }; });
}

void add_pack(CLI::App& app, Asked& asked) {
  PackOptions& pack = asked.pack;
  CLI::App* command = app.add_subcommand(
      "pack", "Write the reference pack: scenes that separate causes, and their answers with bounds");
  command->add_option("-o,--output", pack.output, "folder to write; made whole or not at all")->required();
  command->add_option("--seed", pack.seed,
                      "a validation set of the same classes, drawn by this word (default: the debug set)");
  command->add_option("--scenes", pack.scenes,
                      "only these, names between commas (default: all; docs/reference-pack.md)");
  command->add_flag("--without-answers", pack.without_answers, "scenes only, to be handed out");
  command->add_option("--threads", pack.threads, "threads to use (default: all cores)")
      ->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", pack.quiet, "print results and errors only");
  command->footer(
      "Example:\n  tubefoot pack -o out/pack\n"
      "  tubefoot pack --seed 'what we agreed on' --without-answers -o out/to-hand-out");
  command->callback([&asked] { asked.command = [&asked] { return pack_command(asked.pack); }; });
}

/// Says so, where the first word is no command.
bool refused_first_word(const CLI::App& app, int argc, char** argv) {
  const auto is_named = [&](const CLI::App* sub) { return argc > 1 && sub->get_name() == argv[1]; };
  if (argc < 2 || argv[1][0] == '-' || !app.get_subcommands(is_named).empty()) return false;
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  const std::string last = names.back();
  names.pop_back();
  say("tubefoot: there is no command '{}': {} or {}\n", argv[1], fmt::join(names, ", "), last);
  return true;
}

/// Calls the command; what it throws becomes a message and an exit code.
int called(const std::function<int()>& command) {
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

/// What libraries set up before main() they do not all look at: OpenImageIO's table of names, 8 MB, may have
/// holes in which it crashes later. Where as much can still be had, it has none. Throws std::bad_alloc.
void require_memory_of_libraries() { ::operator delete(::operator new (std::size_t{16} << 20)); }

int obeyed(int argc, char** argv) {
  CLI::App app{"tubefoot: a sonar simulator that measures footprints instead of sampling them.", "tubefoot"};
  app.set_version_flag(
      "--version", [] { return "tubefoot " TUBEFOOT_VERSION "\n" + build_in_words() + library_versions(); });
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer(
      "Exit status:\n  0  done\n  1  the run failed\n  2  the input or the command line is wrong\n"
      "  3  a comparison found more error than was allowed");
  Asked asked;
  for (const auto add : {add_run, add_join, add_check, add_audit, add_footprints, add_coverage, add_strength,
                         add_view, add_refine, add_export, add_import_scene, add_compare, add_import,
                         add_chart, add_advise, add_presets, add_pack})
    add(app, asked);
  if (refused_first_word(app, argc, argv)) return wrong_input;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Several ranks read the same command: one complains.
    if (argc > 1 && std::string_view(argv[1]) == "run" && is_later_rank()) return done;
    // --help and --version arrive as errors of code 0.
    std::ostringstream answer, complaint;
    const int code = app.exit(error, answer, complaint);
    tell("{}", answer.str());
    say("{}", complaint.str());
    return code == 0 ? done : wrong_input;
  }
  return called(asked.command);
}

}  // namespace

int run_command_line(int argc, char** argv) {
  hold_closed_streams();
  take_signals();
  const int code = called([&] {
    require_memory_of_libraries();
    return obeyed(argc, argv);
  });
  errno = tell_error;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  const std::string why = errno != 0 ? fmt::format(": {}", std::strerror(errno)) : "";
  say("tubefoot: cannot write to standard output{}\n", why);
  return code == done ? failed : code;
}

}  // namespace tubefoot
