// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <string>

#include "app/command_options.hpp"

namespace tubefoot {
namespace {

/// Of commands that write pictures of a run.
void add_pictures(CLI::App& command, RunOptions& run) {
  command
      .add_option_function<std::string>(
          "--pictures",
          [&run](const std::string& word) {
            using Which = PictureSettings::Which;
            run.pictures.which = word == "none" ? Which::none : word == "all" ? Which::all : Which::sequence;
          },
          "none; sequence: those of several pings at once; all: and of each ping, where a sonar shows such "
          "(default: as the sensor says, else all)")
      ->check(CLI::IsMember({"none", "sequence", "all"}));
  command.add_flag("--animate", run.pictures.animated,
                   "also write pings of cameras and imaging sonars one after the other, as a GIF");
  command.add_option("--picture-bits", run.pictures.bits, "bits a colour of a PNG: 8 or 16 (default: 8)")
      ->check(CLI::IsMember({8, 16}));
}

}  // namespace

void add_run(CLI::App& app, CommandOptions& requested) {
  RunOptions& run = requested.run;
  CLI::App* command =
      app.add_subcommand("run", "Simulate all pings of a scene and write echoes, pictures and statistics");
  add_common(*command, run);
  command->add_option("-o,--output", run.output, "folder to write; made whole or not at all")->required();
  command->add_option("--sensor", run.selection.sensor, "only this sensor");
  command->add_option("--ping,--pings", run.selection.pings,
                      "only pings A:B of each sensor, both included, counted from 0 (default: all)");
  command->add_option(
      "--beam,--beams", run.selection.beams,
      "only echoes of beams A:B, both included, or several such between commas (default: all)");
  add_pictures(*command, run);
  command->add_option("--engine", run.engine, "tube (exact) or ray (sampling)")
      ->check(CLI::IsMember({"tube", "ray"}));
  command
      ->add_option("--binning", run.binning,
                   "tube engine: cut footprints at the samples' borders (exact), or use their centroid's "
                   "energy, spread over their ranges or not")
      ->check(CLI::IsMember({"exact", "spread", "centroid"}));
  command
      ->add_option("--sampling", run.sampling,
                   "ray engine: stratified, sobol, adaptive, regular, random or column")
      ->check(CLI::IsMember({"stratified", "sobol", "adaptive", "regular", "random", "column"}));
  CLI::Option* rays = command->add_option("--rays", run.rays, "ray engine: rays per ping")
                          ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000'000}));
  command->add_option("--rays-per-beam", run.rays_per_beam, "ray engine: rays per beam instead")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000'000}))
      ->excludes(rays);
  command->add_option("--seed", run.seed, "ray engine: seed of the sampling")->check(CLI::NonNegativeNumber);
  command->add_flag("--reference", run.reference,
                    "tube engine: certify every energy and write energy_bound beside it");
  command->add_option("--tolerance", run.tolerance,
                      "error allowed, 0.1dB (RMS of lit bins), 1e-3 or 0.1% (relative L1): picks engine and "
                      "settings as 'advise' does; with --reference: the bound asked for (default: 1e-9)");
  command->add_option("--coarsen", run.coarsen,
                      "let facets become fewer and larger where no point of them moves by more than this "
                      "part of what the scene's sonars tell apart there, 0 to 1 (default: 0, not at all; "
                      "docs/coarse.md)");
  command->add_flag("--labels", run.labels,
                    "write the shares of objects and materials in each range bin, its label, mean height and "
                    "mean range (docs/truth.md)");
  command->add_option(
      "--label-level", run.label_level_db,
      "with --labels: label a range bin by contributions within this many dB of the two-way peak of the "
      "beam pattern (default: 20)");
  command->add_flag(
      "--resume", run.resume,
      "go on with a run that was interrupted or killed, from '<output>.partial'; begin if there is "
      "none");
  command->add_option(
      "--shard", run.part,
      "compute only shard I of N (I/N) of the pings, into '<output>.part-I-of-N'; 'join' combines all "
      "shards");
  command->footer(
      "Example:\n  tubefoot run scenes/wellhead/scene.toml -o out/wellhead\n"
      "  tubefoot run scenes/wellhead/scene.toml -o out/some --sensor sidescan --pings 100:120");
  command->callback(
      [&requested] { requested.command = [&requested] { return run_command(requested.run); }; });
}

void add_join(CLI::App& app, CommandOptions& requested) {
  JoinOptions& join = requested.join;
  CLI::App* command = app.add_subcommand("join", "Combine the shards of a run (run --shard)");
  command->add_option("SCENE", join.scene, "the scene file of the parts")->required();
  command
      ->add_option("-o,--output", join.output,
                   "the output that the parts were given: folder to write; made whole or not at all")
      ->required();
  add_pictures(*command, join);
  command->add_flag("--keep-parts", join.keep_parts, "leave the parts' files beside the result");
  command->add_option("--threads", join.threads, "threads to use; default: as the scene says, else all cores")
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
