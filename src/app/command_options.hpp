// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "app/commands.hpp"

// What the command line is read into, and what its commands have in common.
namespace tubefoot {

/// What the command line asks for: the options of each command, and the one command that is called.
struct CommandOptions {
  RunOptions run;
  JoinOptions join;
  CheckOptions check;
  AuditOptions audit;
  FootprintOptions footprints;
  CoverageOptions coverage;
  StrengthOptions strength;
  ViewOptions view;
  RefineOptions refine;
  ExportOptions exported;
  ImportSceneOptions import_scene;
  CompareOptions compare;
  ImportOptions import;
  ChartOptions chart;
  AdviseOptions advise;
  PresetsOptions presets;
  SuiteOptions suite;
  std::function<int()> command;
};

/// Of every command that reads a scene.
template <class Options>
void add_scene_flags(CLI::App& command, Options& options, const std::string& group = "Options") {
  command
      .add_flag("--confined", options.confined,
                "reject a scene that names files outside of its folder, also through links")
      ->group(group);
  command.add_flag("--quiet", options.quiet, "print results and errors only")->group(group);
}

/// Of every command that computes with one.
void add_common(CLI::App& command, CommonOptions& options, const std::string& group = "Options");

/// CLI11's own range checks let NaN through, as it is neither too small nor too large.
CLI::Validator finite_number(double least, bool above);

/// Of the folder of a run, its echoes.nc; every other name stays as it is.
CLI::Validator echoes_of_run();

// The commands that end in a result folder (requested_run.cpp).
void add_run(CLI::App& app, CommandOptions& requested);
void add_join(CLI::App& app, CommandOptions& requested);

// Those that say what a scene, or what is in it, is like (requested_scene.cpp).
void add_check(CLI::App& app, CommandOptions& requested);
void add_audit(CLI::App& app, CommandOptions& requested);
void add_footprints(CLI::App& app, CommandOptions& requested);
void add_coverage(CLI::App& app, CommandOptions& requested);
void add_strength(CLI::App& app, CommandOptions& requested);
void add_view(CLI::App& app, CommandOptions& requested);
void add_refine(CLI::App& app, CommandOptions& requested);
void add_export(CLI::App& app, CommandOptions& requested);
void add_presets(CLI::App& app, CommandOptions& requested);

// Those that hold one result against another, and bring in what others made (requested_validation.cpp).
void add_import_scene(CLI::App& app, CommandOptions& requested);
void add_compare(CLI::App& app, CommandOptions& requested);
void add_import(CLI::App& app, CommandOptions& requested);
void add_chart(CLI::App& app, CommandOptions& requested);
void add_advise(CLI::App& app, CommandOptions& requested);
void add_suite(CLI::App& app, CommandOptions& requested);

}  // namespace tubefoot
