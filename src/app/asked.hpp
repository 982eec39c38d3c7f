// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "app/commands.hpp"

// What the command line is read into, and what its commands have in common.
namespace tubefoot {

/// What the command line asks for: the options of each command, and the one command that is called.
struct Asked {
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
  PackOptions pack;
  std::function<int()> command;
};

/// Of every command that reads a scene.
template <class Options>
void add_scene_flags(CLI::App& command, Options& options) {
  command.add_flag("--confined", options.confined,
                   "read nothing that lies outside of the scene file's folder, links followed");
  command.add_flag("--quiet", options.quiet, "print results and errors only");
}

/// Of every command that computes with one.
void add_common(CLI::App& command, CommonOptions& options);

/// CLI11's own range checks let NaN through, as it is neither too small nor too large.
CLI::Validator finite_number(double least, bool above);

// The commands that end in a result folder.
void add_run(CLI::App& app, Asked& asked);
void add_join(CLI::App& app, Asked& asked);

}  // namespace tubefoot
