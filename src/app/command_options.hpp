// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "app/commands.hpp"

// Options of the command line, and the functions that add the subcommands to the parser.
namespace tubefoot {

/// The options of each command, and the command to call.
struct CommandOptions {
  RunOptions run;
  JoinOptions join;
  CheckOptions check;
  AuditOptions audit;
  FootprintOptions footprints;
  CoverageOptions coverage;
  StrengthOptions strength;
  RaysOptions rays;
  ViewOptions view;
  RefineOptions refine;
  ExportOptions exported;
  ImportSceneOptions import_scene;
  CompareOptions compare;
  ImportOptions import;
  ChartOptions chart;
  AdviseOptions advise;
  PresetsOptions presets;
  KeysOptions keys;
  SuiteOptions suite;
  std::function<int()> command;
};

/// Adds the flags of every command that reads a scene.
template <class Options>
void add_scene_flags(CLI::App& command, Options& options, const std::string& group = "Options") {
  command
      .add_flag("--confined", options.confined,
                "reject a scene that names files outside of its folder, even via links")
      ->group(group);
  command.add_flag("--quiet", options.quiet, "print results and errors only")->group(group);
}

/// Adds the options of every command that computes with a scene.
void add_common(CLI::App& command, CommonOptions& options, const std::string& group = "Options");

/// Accepts finite numbers from `least` on, or above it. The range checks of CLI11 accept NaN.
CLI::Validator finite_number(double least, bool above);

/// Replaces the folder of a run by its echoes.nc and leaves every other name as it is.
CLI::Validator echoes_of_run();

// Commands that write a result folder (options_of_run.cpp).
void add_run(CLI::App& app, CommandOptions& requested);
void add_join(CLI::App& app, CommandOptions& requested);

// Commands that describe a scene or its contents (options_of_scene.cpp).
void add_check(CLI::App& app, CommandOptions& requested);
void add_audit(CLI::App& app, CommandOptions& requested);
void add_footprints(CLI::App& app, CommandOptions& requested);
void add_coverage(CLI::App& app, CommandOptions& requested);
void add_strength(CLI::App& app, CommandOptions& requested);
void add_rays(CLI::App& app, CommandOptions& requested);
void add_view(CLI::App& app, CommandOptions& requested);
void add_refine(CLI::App& app, CommandOptions& requested);
void add_export(CLI::App& app, CommandOptions& requested);
void add_presets(CLI::App& app, CommandOptions& requested);
void add_keys(CLI::App& app, CommandOptions& requested);

// Commands that compare results or import those of other programs (options_of_validation.cpp).
void add_import_scene(CLI::App& app, CommandOptions& requested);
void add_compare(CLI::App& app, CommandOptions& requested);
void add_import(CLI::App& app, CommandOptions& requested);
void add_chart(CLI::App& app, CommandOptions& requested);
void add_advise(CLI::App& app, CommandOptions& requested);
void add_suite(CLI::App& app, CommandOptions& requested);

}  // namespace tubefoot
