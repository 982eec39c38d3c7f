// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "app/command_options.hpp"
#include "files/words.hpp"

namespace tubefoot {

void add_import_scene(CLI::App& app, CommandOptions& requested) {
  ImportSceneOptions& world = requested.import_scene;
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
  command->callback([&requested] {
    requested.command = [&requested] { return import_scene_command(requested.import_scene); };
  });
}

void add_compare(CLI::App& app, CommandOptions& requested) {
  CompareOptions& compare = requested.compare;
  CLI::App* command = app.add_subcommand("compare", "Measure how far one engine's echoes are from another's");
  command
      ->add_option("REFERENCE", compare.reference,
                   "echo file of the reference, or the folder of its run (docs/echo-file.md)")
      ->required()
      ->transform(echoes_of_run());
  command
      ->add_option("CANDIDATE", compare.candidate,
                   "echo file of the engine under test, or the folder of its run")
      ->required()
      ->transform(echoes_of_run());
  command->add_option(
      "--html", compare.html,
      "write one page into this file: findings (--diagnose), with --scene whose the error is, pictures, "
      "figures, how to repeat it");
  command->add_option("--output-model", compare.output_model,
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
      ->needs("--diagnose")
      ->transform(echoes_of_run());
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
  command->callback(
      [&requested] { requested.command = [&requested] { return compare_command(requested.compare); }; });
}

void add_import(CLI::App& app, CommandOptions& requested) {
  ImportOptions& import = requested.import;
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
      command
          ->add_option("--like", import.like,
                       "echo file of the reference, or the folder of its run: beams, ranges, poses, energies")
          ->transform(echoes_of_run());
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
  command->add_option("--output-model", import.output_model,
                      "output model of the engine, to test against the reference in its units");
  command->add_flag("--strict", import.strict, "refuse what the truth refutes, instead of a warning");
  command->add_flag("--confined", import.confined,
                    "of a scene, read nothing that lies outside of its file's folder, links followed");
  command->footer(
      "Example:\n  tubefoot import frames/*.png --like out/reference/echoes.nc --profile stonefish -o "
      "candidate.nc");
  command->callback([&requested, like, scene] {
    if (like->empty() && scene->empty()) throw CLI::RequiredError("--like REFERENCE or --scene SCENE");
    requested.command = [&requested] { return import_command(requested.import); };
  });
}

void add_chart(CLI::App& app, CommandOptions& requested) {
  ChartOptions& chart = requested.chart;
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
  command->callback(
      [&requested] { requested.command = [&requested] { return chart_command(requested.chart); }; });
}

void add_advise(CLI::App& app, CommandOptions& requested) {
  AdviseOptions& advise = requested.advise;
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
  command->callback(
      [&requested] { requested.command = [&requested] { return advise_command(requested.advise); }; });
}

void add_suite(CLI::App& app, CommandOptions& requested) {
  SuiteOptions& suite = requested.suite;
  CLI::App* command = app.add_subcommand(
      "pack", "Write the reference pack: scenes that separate causes, and their answers with bounds");
  command->add_option("-o,--output", suite.output, "folder to write; made whole or not at all")->required();
  command->add_option("--seed", suite.seed,
                      "a validation set of the same classes, drawn by this word (default: the debug set)");
  command->add_option("--scenes", suite.scenes,
                      "only these, names between commas (default: all; docs/reference-pack.md)");
  command->add_flag("--without-answers", suite.without_answers, "scenes only, to be handed out");
  command->add_option("--threads", suite.threads, "threads to use (default: all cores)")
      ->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", suite.quiet, "print results and errors only");
  command->footer(
      "Example:\n  tubefoot pack -o out/pack\n"
      "  tubefoot pack --seed 'what we agreed on' --without-answers -o out/to-hand-out");
  command->callback(
      [&requested] { requested.command = [&requested] { return suite_command(requested.suite); }; });
}

}  // namespace tubefoot
