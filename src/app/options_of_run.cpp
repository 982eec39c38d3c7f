// SPDX-License-Identifier: GPL-3.0-or-later
// The options of the commands that write a result folder: run and join.
#include <cstdint>
#include <string>

#include "app/command_options.hpp"

namespace tubefoot {
namespace {

constexpr const char *what = "What to compute", *how = "How to compute it", *written = "What to write",
                     *where = "Where to write";

/// Options that select the files of a run.
void add_files(CLI::App& command, RunOptions& run) {
  command
      .add_option_function<std::string>(
          "--pictures",
          [&run](const std::string& word) {
            using Which = PictureSettings::Which;
            run.pictures.which = word == "none" ? Which::none : word == "all" ? Which::all : Which::sequence;
          },
          "pictures to draw. sequence: pictures that show several pings. all: also pictures of each ping, "
          "where the sonar has such pictures. Default: 'pictures' of the scene, else all")
      ->check(CLI::IsMember({"none", "sequence", "all"}))
      ->group(written);
  command
      .add_flag("--animate", run.pictures.animated,
                "also write the pings of cameras and imaging sonars as an animated GIF")
      ->group(written);
  command
      .add_option("--picture-bits", run.pictures.bits, "bits per colour channel of PNG files (default: 8)")
      ->check(CLI::IsMember({8, 16}))
      ->group(written);
  command
      .add_option(
          "--without", run.without,
          "do not write these files, separated by commas: sonar.nc omits this product of all sensors, "
          "fan-sonar.nc that of the sensor 'fan' (docs/output-files.md)")
      ->option_text("FILE,...")
      ->group(written);
}

}  // namespace

void add_run(CLI::App& app, CommandOptions& requested) {
  RunOptions& run = requested.run;
  CLI::App* command =
      app.add_subcommand("run", "Simulate the pings of a scene and write echoes, pictures and statistics");
  command->add_option("--sensor", run.selection.sensor, "compute this sensor only")
      ->option_text("NAME")
      ->group(what);
  command
      ->add_option("--pings", run.selection.pings,
                   "compute pings A to B of each sensor, both included, counted from 0 (default: all)")
      ->option_text("A:B")
      ->group(what);
  command
      ->add_option(
          "--beams", run.selection.beams,
          "write the echoes of beams A to B, both included. Separate several ranges by commas (default: all)")
      ->option_text("A:B")
      ->group(what);
  command
      ->add_flag("--reference", run.reference,
                 "certify each energy: the file then also contains energy_bound (tube engine)")
      ->group(what);
  command
      ->add_flag("--labels", run.labels,
                 "also compute the shares of objects and materials in each range bin, its label, mean height "
                 "and mean range (docs/output-files.md)")
      ->group(what);
  command
      ->add_option("--label-level", run.label_level_db,
                   "with --labels: label a range bin by contributions within this many dB of the two-way "
                   "peak of the beam pattern (default: 20)")
      ->option_text("DB")
      ->group(what);
  command
      ->add_option(
          "--gradient", run.gradient,
          "also compute the derivatives of energies, and of the signals of smooth materials, by these "
          "parameters, separated by commas. 'help' lists the parameters of the scene (docs/gradients.md)")
      ->option_text("PARAM")
      ->group(what);
  command
      ->add_flag(
          "--gradient-steps", run.gradient_steps,
          "with --gradient: also prove for each beam how far each parameter may move before the visible "
          "edges change")
      ->group(what);
  command
      ->add_option(
          "--tolerance", run.tolerance,
          "permitted error: 0.1dB (RMS over bins with an echo), 1e-3 or 0.1% (relative L1). tubefoot "
          "then selects engine and settings as 'advise' does. With --reference: the relative bound "
          "(default: 1e-9)")
      ->option_text("ERROR")
      ->group(how);
  command->add_option("--engine", run.engine, "tube computes exact footprints, ray samples them")
      ->check(CLI::IsMember({"tube", "ray"}))
      ->group(how);
  command
      ->add_option(
          "--binning", run.binning,
          "tube engine: exact divides footprints at the borders of range bins. spread and centroid use the "
          "energy at the centroid of the footprint; spread distributes it over the ranges of the footprint")
      ->check(CLI::IsMember({"exact", "spread", "centroid"}))
      ->group(how);
  command
      ->add_option("--coarsen", run.coarsen,
                   "merge facets where no point moves by more than this share of the resolution of the "
                   "sonars, 0 to 1 (default: 0, no merging; docs/accuracy-and-speed.md)")
      ->option_text("SHARE")
      ->group(how);
  command->add_option("--sampling", run.sampling, "ray engine: distribution of rays")
      ->check(CLI::IsMember({"stratified", "sobol", "adaptive", "regular", "random", "column"}))
      ->group(how);
  CLI::Option* rays = command->add_option("--rays", run.rays, "ray engine: rays per ping")
                          ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000'000}))
                          ->group(how);
  command->add_option("--rays-per-beam", run.rays_per_beam, "ray engine: rays per beam, instead of --rays")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000'000}))
      ->excludes(rays)
      ->group(how);
  command->add_option("--seed", run.seed, "ray engine: seed of the sampling")
      ->check(CLI::NonNegativeNumber)
      ->group(how);
  command
      ->add_option("--shard", run.part,
                   "compute shard I of N of the pings, into OUTPUT.part-I-of-N. 'join' combines all shards")
      ->option_text("I/N")
      ->group(how);
  command
      ->add_flag("--resume", run.resume,
                 "continue an interrupted run from OUTPUT.partial; start from the beginning if there is none")
      ->group(how);
  add_common(*command, run, how);
  add_files(*command, run);
  command
      ->add_option("-o,--output", run.output,
                   "result folder. It appears when the run is complete; a failed run leaves no folder")
      ->required()
      ->option_text("FOLDER")
      ->group(where);
  command->footer(
      "Example:\n  tubefoot run scenes/wellhead/scene.toml -o out/wellhead\n"
      "  tubefoot run scenes/wellhead/scene.toml -o out/some --sensor sidescan --pings 100:120");
  command->callback(
      [&requested] { requested.command = [&requested] { return run_command(requested.run); }; });
}

void add_join(CLI::App& app, CommandOptions& requested) {
  JoinOptions& join = requested.join;
  CLI::App* command = app.add_subcommand("join", "Combine the shards of a run (run --shard)");
  command->add_option("SCENE", join.scene, "scene file of the shards")->required();
  command->add_option("-o,--output", join.output, "the folder that the shards were computed for")
      ->required()
      ->option_text("FOLDER");
  add_files(*command, join);
  command->add_flag("--keep-shards", join.keep_parts, "keep the files of the shards");
  command
      ->add_option("--threads", join.threads,
                   "number of threads (default: 'threads' of the scene, else all cores)")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*command, join);
  command->footer(
      "Example:\n  tubefoot run scenes/wellhead/scene.toml -o out/wellhead --shard 1/2\n"
      "  tubefoot run scenes/wellhead/scene.toml -o out/wellhead --shard 2/2\n"
      "  tubefoot join scenes/wellhead/scene.toml -o out/wellhead");
  command->callback(
      [&requested] { requested.command = [&requested] { return join_command(requested.join); }; });
}

}  // namespace tubefoot
