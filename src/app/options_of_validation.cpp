// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the commands that compare results or import those of other programs: import-scene, compare,
// import, chart, advise and suite.
#include <algorithm>
#include <optional>

#include "app/command_options.hpp"
#include "files/words.hpp"

namespace tubefoot {

void add_import_scene(CLI::App& app, CommandOptions& requested) {
  ImportSceneOptions& world = requested.import_scene;
  CLI::App* command =
      app.add_subcommand("import-scene",
                         "Convert the world of another engine, or a survey line of a multibeam, "
                         "to a scene file (docs/exchange-formats.md, docs/measured.md)");
  command
      ->add_option("WORLD", world.world,
                   "SDF file (.sdf, .world), Stonefish scenario (.scn) or Kongsberg survey line (.kmall)")
      ->required();
  command->add_option("-o,--output", world.output, "folder to write; a failed import leaves no folder")
      ->required()
      ->option_text("FOLDER");
  command
      ->add_option("--model-path", world.model_path,
                   "folder of models (model://NAME/...), searched before those of GZ_SIM_RESOURCE_PATH, "
                   "SDF_PATH and GAZEBO_MODEL_PATH. Files may come only from these folders and from the "
                   "folder of the world. The option may be repeated")
      ->allow_extra_args(false)
      ->option_text("FOLDER");
  command
      ->add_option("--unit-m", world.unit_m,
                   "length of one unit of mesh files that state none, such as OBJ and STL (default: 1)")
      ->check(CLI::Range(1e-9, 1e6))
      ->option_text("METRES");
  command
      ->add_option(
          "--seabed", world.kmall.seabed,
          "survey line: grid or plane, fitted to the soundings of the file, or a raster (default: grid)")
      ->option_text("SEABED");
  command
      ->add_option("--cell-m", world.kmall.cell_m,
                   "survey line: cell size of --seabed grid (default: 2.5 % of the depth)")
      ->check(CLI::Range(1e-3, 1e4))
      ->option_text("METRES");
  command
      ->add_option(
          "--receive-shading", world.kmall.receive_shading,
          "survey line: shading of the receiver, 0 (uniform) to 1 (Hann window), with the beam width of "
          "the file (default: 0)")
      ->check(CLI::Range(0.0, 1.0))
      ->option_text("S");
  command
      ->add_option("--material-table", world.kmall.material_table,
                   "survey line: table of grazing angles and backscattering strengths of the seabed")
      ->option_text("FILE");
  command->add_flag("--quiet", world.quiet, "do not list notes, such as parts that are left out");
  command->footer("Example:\n  tubefoot import-scene line.kmall -o out/line");
  command->callback([&requested] {
    requested.command = [&requested] { return import_scene_command(requested.import_scene); };
  });
}

void add_compare(CLI::App& app, CommandOptions& requested) {
  CompareOptions& compare = requested.compare;
  CLI::App* command =
      app.add_subcommand("compare", "Compare the echoes of two engines: errors, findings, pictures");
  command
      ->add_option("REFERENCE", compare.reference,
                   "echo file of the reference, or the folder of its run (docs/output-files.md)")
      ->required()
      ->transform(echoes_of_run());
  command
      ->add_option("CANDIDATE", compare.candidate,
                   "echo file of the engine under test, or the folder of its run")
      ->required()
      ->transform(echoes_of_run());
  command
      ->add_option(
          "--html", compare.html,
          "write a report into this file: findings (--diagnose), pictures, figures, commands and, with "
          "--scene, the attribution of the error")
      ->option_text("FILE");
  command
      ->add_option("--output-model", compare.output_model,
                   "convert the reference to the units of the candidate by the steps in this file "
                   "(docs/engine-validation.md)")
      ->option_text("FILE");
  command->add_option("--json", compare.json, "write all figures into this file; -: print them instead")
      ->option_text("FILE");
  command->add_option("--png", compare.png, "draw both pictures and their difference into this file")
      ->option_text("FILE");
  command->add_option("--sensor", compare.sensor, "compare this sensor only")->option_text("NAME");
  command
      ->add_option("--worst", compare.worst,
                   "number of range bins with the largest errors to list (default: 5)")
      ->check(CLI::Range(0, 1000000));
  command->add_flag("--any-scene", compare.any_scene, "compare even if the hashes of the scenes differ");
  command
      ->add_option(
          "--fit", compare.fit,
          "first fit one or more of: a gain, a power of range, an offset, for example gain,range,offset")
      ->option_text("LIST");
  command->add_flag("--geometry", compare.geometry,
                    "compare first returns, shadows and visible areas, independently of energies");
  command
      ->add_option("--threshold", compare.threshold,
                   "with --geometry: smallest energy of an echo of the candidate (default: its noise floor)")
      ->check(finite_number(0, false))
      ->needs("--geometry");
  command->add_flag("--diagnose", compare.diagnose,
                    "name the causes of errors with size and error bar: displacement, scale, mirrored axes, "
                    "spacing of beams, blur, range dependence, shadows, noise");
  command
      ->add_option(
          "--ideal", compare.ideal,
          "with --diagnose: state the error of a perfect engine with this sampling: 1x512 (columns x rays "
          "per beam) or points:512 (random points), both with --scene; or the echo file of such an engine")
      ->needs("--diagnose")
      ->transform(echoes_of_run())
      ->option_text("SAMPLING");
  CLI::Option* scene =
      command->add_option("--scene", compare.scene, "scene file of the reference")->option_text("FILE");
  command
      ->add_flag("--attribute", compare.attribute,
                 "attribute the error to objects, materials, kinds of range bins, ranges, beams and facets")
      ->needs(scene);
  command
      ->add_option(
          "--frames", compare.frames,
          "average groups of this number of candidate pings, which repeat the same ping (default: 1)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--within", compare.within_l1, "exit with status 3 if a relative L1 error is larger")
      ->check(finite_number(0, false));
  command
      ->add_option("--within-db", compare.within_db,
                   "exit with status 3 if an RMS error in dB over bins with an echo is larger")
      ->check(finite_number(0, false));
  add_scene_flags(*command, compare);
  command->footer(
      "Example:\n  tubefoot compare out/wellhead/echoes.nc out/wellhead-rays/echoes.nc --png out/rays.png");
  command->callback(
      [&requested] { requested.command = [&requested] { return compare_command(requested.compare); }; });
}

void add_import(CLI::App& app, CommandOptions& requested) {
  ImportOptions& import = requested.import;
  CLI::App* command =
      app.add_subcommand("import",
                         "Convert pictures of another engine, or a measured water column, to an echo file "
                         "(docs/engine-validation.md, docs/measured.md)");
  command
      ->add_option(
          "RESULT", import.results,
          "pictures, or folders of pictures: .npy, .npz, .csv, .png, .tif, .exr, .nc. Each picture "
          "is one ping, in the order of the file names. Or a Kongsberg water column: .kmwcd, with the "
          ".kmall of the same name beside it")
      ->required();
  command
      ->add_option("-o,--output", import.output,
                   "echo file to write (.nc); a folder next to it stores the original pictures")
      ->required()
      ->option_text("FILE");
  CLI::Option* like =
      command
          ->add_option("--like", import.like,
                       "echo file of the reference, or the folder of its run: beams, ranges, poses, energies")
          ->transform(echoes_of_run())
          ->option_text("FILE");
  CLI::Option* scene = command
                           ->add_option("--scene", import.scene,
                                        "scene file, instead of --like: tubefoot computes the reference")
                           ->excludes(like)
                           ->option_text("FILE");
  command->add_option("--sensor", import.sensor, "sensor of the reference, if it has several")
      ->option_text("NAME");
  command->add_option("--profile", import.profile, "conventions of this engine")
      ->check(CLI::IsMember(profile_names()));
  command
      ->add_option("--scale", import.scale,
                   "scale of the numbers: energy, amplitude, db, db:REFERENCE (energy at 0 dB) or 8bit")
      ->option_text("SCALE");
  command
      ->add_option("--order", import.order,
                   "range-first: each row is a range; beam-first: each row is a beam; two-sided: each row is "
                   "a ping of a sidescan, port on the left (default: from the shape of the picture)")
      ->check(CLI::IsMember({"range-first", "beam-first", "two-sided"}));
  // CLI11 sets an optional flag to false if it is absent, so an absent flag needs a callback to stay unset.
  const auto add_turn = [&](const char* flag, std::optional<bool>& turned, bool value, const char* words) {
    return command->add_flag_callback(
        flag, [&turned, value] { turned = value; }, words);
  };
  CLI::Option* beams =
      add_turn("--flip-beams", import.flip_beams, true, "beams are stored from starboard to port");
  add_turn("--no-flip-beams", import.flip_beams, false,
           "beams are stored from port to starboard, whatever the profile assumes")
      ->excludes(beams);
  CLI::Option* range =
      add_turn("--flip-range", import.flip_range, true, "ranges are stored from far to near");
  add_turn("--no-flip-range", import.flip_range, false,
           "ranges are stored from near to far, whatever the profile assumes")
      ->excludes(range);
  command
      ->add_option("--azimuths", import.azimuths,
                   "directions of beams within the sector of the reference: even (equiangular), tangent "
                   "(equidistant), tangent:3 (equidistant in each of 3 views side by side) or tangent:20deg "
                   "(in views of at most 20 degrees); FILE.csv (azimuth_deg), or FIRST:LAST in degrees "
                   "(default: those that the "
                   "file states, else those of the reference)")
      ->option_text("VALUE");
  command
      ->add_option(
          "--ranges", import.ranges,
          "ranges of samples: FIRST:LAST in m (default: those that the file states, else those of the "
          "reference)")
      ->option_text("FIRST:LAST");
  command->add_option("--range-origin", import.range_origin, "meaning of ranges: edges or centres of samples")
      ->check(CLI::IsMember({"edges", "centres"}));
  command
      ->add_option(
          "--cartesian", import.cartesian,
          "the picture is a fan in Cartesian pixels: COLUMN:ROW:METRES states its apex in pixels and the "
          "size of a pixel in m; fan: the fan fills the picture")
      ->option_text("VALUE");
  command
      ->add_option("--forward", import.forward,
                   "with --cartesian: direction in the picture that is ahead of the sonar (default: up)")
      ->check(CLI::IsMember({"up", "down", "left", "right"}))
      ->needs("--cartesian");
  command->add_flag("--resample", import.resample,
                    "average pictures that have other bins into the bins of the reference");
  command
      ->add_option("--variable", import.variable,
                   "array of the picture in an NPZ or netCDF file, or channel of an image")
      ->option_text("NAME");
  command->add_option("--range-variable", import.range_variable, "array with the ranges of the picture in m")
      ->option_text("NAME");
  command
      ->add_option("--azimuth-variable", import.azimuth_variable,
                   "array with the azimuths of the picture in radians")
      ->option_text("NAME");
  command
      ->add_option("--topic", import.topic,
                   "topic of the pictures in a ROS 2 recording (default: the only one with pictures)")
      ->option_text("NAME");
  command
      ->add_option(
          "--output-model", import.output_model,
          "output model of the engine: compare its pictures with the reference in the engine's units")
      ->option_text("FILE");
  command->add_flag("--strict", import.strict,
                    "reject settings that contradict the reference, instead of printing a warning");
  command->add_flag("--confined", import.confined,
                    "reject a scene that names files outside of its folder, even via links");
  command->footer(
      "Example:\n  tubefoot import frames/*.png --like out/reference/echoes.nc --profile stonefish -o "
      "candidate.nc");
  command->callback([&requested, like, scene] {
    const bool measured = std::ranges::any_of(requested.import.results, is_kmall_name);
    if (!measured && like->empty() && scene->empty())
      throw CLI::RequiredError("--like REFERENCE or --scene SCENE");
    requested.command = [&requested] { return import_command(requested.import); };
  });
}

void add_chart(CLI::App& app, CommandOptions& requested) {
  ChartOptions& chart = requested.chart;
  CLI::App* command = app.add_subcommand(
      "chart", "Run each engine with many settings and plot its error against its computing time");
  command->add_option("SCENE", chart.scenes, "scene files; the chart uses the first sensor of each")
      ->required();
  command->add_option("-o,--output", chart.output, "folder to write; a failed command leaves no folder")
      ->required()
      ->option_text("FOLDER");
  command
      ->add_option("--pings", chart.pings,
                   "pings A to B of each scene, both included, counted from 0 (default: the first)")
      ->option_text("A:B");
  command
      ->add_option("--repeats", chart.repeats, "runs per setting; the chart shows their median (default: 3)")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--seconds", chart.seconds_per_trial,
                   "leave out settings that need more than this number of seconds per run (default: 4)")
      ->check(finite_number(0, true));
  add_scene_flags(*command, chart);
  command->footer("Example:\n  tubefoot chart scenes/chart/*.toml -o out/chart");
  command->callback(
      [&requested] { requested.command = [&requested] { return chart_command(requested.chart); }; });
}

void add_advise(CLI::App& app, CommandOptions& requested) {
  AdviseOptions& advise = requested.advise;
  CLI::App* command = app.add_subcommand(
      "advise", "Find the fastest engine and settings within a tolerance, measured on a few pings");
  command->add_option("SCENE", advise.scene, "scene file (docs/scene-keys.md)")->required();
  command
      ->add_option("--tolerance", advise.tolerance,
                   "permitted error: 0.1dB (RMS over bins with an echo), 1e-3 or 0.1% (relative L1)")
      ->required()
      ->option_text("ERROR");
  command
      ->add_option("--pings", advise.pings,
                   "select trial pings from pings A to B of each sensor, both included, counted from 0 "
                   "(default: all)")
      ->option_text("A:B");
  command
      ->add_option("--trial-pings", advise.trial_pings,
                   "number of pings per sensor for the prediction; the same number of other pings is used "
                   "for the measurement (default: 8)")
      ->check(CLI::Range(2, 1000000));
  command
      ->add_option(
          "--threads", advise.threads,
          "number of threads for loading the scene (default: 'threads' of the scene, else all cores). "
          "Settings are always measured on one thread")
      ->check(CLI::Range(1, 4096));
  command->add_option("--json", advise.json, "write all figures into this file; -: print them instead")
      ->option_text("FILE");
  add_scene_flags(*command, advise);
  command->footer("Example:\n  tubefoot advise scenes/wellhead/scene.toml --tolerance 0.5dB");
  command->callback(
      [&requested] { requested.command = [&requested] { return advise_command(requested.advise); }; });
}

void add_suite(CLI::App& app, CommandOptions& requested) {
  SuiteOptions& suite = requested.suite;
  CLI::App* command = app.add_subcommand(
      "suite", "Write the benchmark suite: scenes that isolate causes of errors, with certified references");
  command->add_option("-o,--output", suite.output, "folder to write; a failed command leaves no folder")
      ->required()
      ->option_text("FOLDER");
  command
      ->add_option("--seed", suite.seed,
                   "write a validation set of the same classes, drawn with this text as seed (default: the "
                   "debug set)")
      ->option_text("SEED");
  command
      ->add_option(
          "--scenes", suite.scenes,
          "write these scenes only; separate names by commas (default: all; docs/reference-results.md)")
      ->option_text("LIST");
  command->add_option("--version", suite.version, "2 or 3: version of the suite (default: 3)")
      ->option_text("NUMBER");
  command->add_flag("--without-answers", suite.without_answers, "write scenes without references");
  command->add_option("--threads", suite.threads, "number of threads (default: all cores)")
      ->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", suite.quiet, "print results and errors only");
  command->footer(
      "Example:\n  tubefoot suite -o out/suite\n"
      "  tubefoot suite --seed 'what we agreed on' --without-answers -o out/to-hand-out");
  command->callback(
      [&requested] { requested.command = [&requested] { return suite_command(requested.suite); }; });
}

}  // namespace tubefoot
