// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command_options.hpp"

namespace tubefoot {

void add_check(CLI::App& app, CommandOptions& requested) {
  CheckOptions& check = requested.check;
  CLI::App* command =
      app.add_subcommand("check", "Load everything a scene names and say what was understood");
  add_common(*command, check);
  command->add_option("--png", check.picture,
                      "draw the scene: plan and side views with bed, objects, tracks and where sensors look");
  command->footer("Example:\n  tubefoot check scenes/wellhead/scene.toml --png scene.png");
  command->callback(
      [&requested] { requested.command = [&requested] { return check_command(requested.check); }; });
}

void add_audit(CLI::App& app, CommandOptions& requested) {
  AuditOptions& audit = requested.audit;
  CLI::App* command = app.add_subcommand(
      "audit", "Prove the closure law, tube by tube, in rationals: visible pieces + open water = the tube");
  add_common(*command, audit);
  command->add_option("--sensor", audit.sensor, "only this sensor");
  command->add_option("--pings", audit.pings, "pings A:B, both included, counted from 0 (default: all)");
  command->footer("Example:\n  tubefoot audit scenes/wellhead/scene.toml --sensor camera --pings 0:2");
  command->callback(
      [&requested] { requested.command = [&requested] { return audit_command(requested.audit); }; });
}

void add_footprints(CLI::App& app, CommandOptions& requested) {
  FootprintOptions& footprints = requested.footprints;
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
  command->callback([&requested] {
    requested.command = [&requested] { return footprints_command(requested.footprints); };
  });
}

void add_coverage(CLI::App& app, CommandOptions& requested) {
  CoverageOptions& coverage = requested.coverage;
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
  command->callback(
      [&requested] { requested.command = [&requested] { return coverage_command(requested.coverage); }; });
}

void add_strength(CLI::App& app, CommandOptions& requested) {
  StrengthOptions& strength = requested.strength;
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
  command->callback(
      [&requested] { requested.command = [&requested] { return strength_command(requested.strength); }; });
}

void add_view(CLI::App& app, CommandOptions& requested) {
  ViewOptions& view = requested.view;
  CLI::App* command = app.add_subcommand(
      "view", "Write a page that shows footprints in 3-D beside the picture they make (docs/viewer.md)");
  command->add_option("RESULT", view.scene, "folder that 'run' wrote, or a scene file")->required();
  command->add_option("-o,--output", view.output, "HTML file to write; needs no network")->required();
  command->add_option("--sensor", view.sensor, "the sensor (default: the scene's first)");
  command->add_option("--pings", view.pings,
                      "pings A:B, both included, counted from 0 (default: 0; of a sidescan or an echosounder "
                      "as many as a page shows well)");
  CLI::Option* candidate =
      command
          ->add_option(
              "--candidate", view.candidate,
              "echo file of another engine, or the folder of its run: show its picture and its error")
          ->transform(echoes_of_run());
  command
      ->add_option(
          "--reference", view.reference,
          "with --candidate: echo file of the reference, or the folder of its run (default: RESULT's)")
      ->needs(candidate)
      ->transform(echoes_of_run());
  command->add_option("--scene", view.moved_scene, "where the scene of RESULT is, if it has moved");
  command
      ->add_option("--arithmetic", view.arithmetic,
                   "number type of the exact kernel; default: as the run or the scene says")
      ->check(CLI::IsMember({"fixed", "filtered", "rational", "double"}));
  command->add_option("--threads", view.threads, "threads to use; default: as the scene says, else all cores")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*command, view);
  command->footer("Example:\n  tubefoot view out/wellhead -o wellhead.html --sensor camera");
  command->callback(
      [&requested] { requested.command = [&requested] { return view_command(requested.view); }; });
}

void add_refine(CLI::App& app, CommandOptions& requested) {
  RefineOptions& refine = requested.refine;
  CLI::App* command = app.add_subcommand(
      "refine", "Write the seabed with its relief in facets, for mesh tools and for mode = \"offline\"");
  command->add_option("SCENE", refine.scene, "scene file (docs/scene-file.md)")->required();
  command->add_option("-o,--output", refine.output, "PLY file to write")->required();
  command->add_option("--threads", refine.threads, "number of threads (default: all cores)")
      ->check(CLI::Range(0, 1024));
  add_scene_flags(*command, refine);
  command->footer("Example:\n  tubefoot refine scenes/sand/ripples.toml -o ripples.ply");
  command->callback(
      [&requested] { requested.command = [&requested] { return refine_command(requested.refine); }; });
}

void add_export(CLI::App& app, CommandOptions& requested) {
  ExportOptions& exported = requested.exported;
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
  command->callback(
      [&requested] { requested.command = [&requested] { return export_command(requested.exported); }; });
}

void add_presets(CLI::App& app, CommandOptions& requested) {
  PresetsOptions& presets = requested.presets;
  CLI::App* command =
      app.add_subcommand("presets", "List the sonars that a scene's sensors can be, with their sources");
  command->add_option(
      "NAME", presets.name,
      "print the keys of the preset with this name, or list the presets that contain this text");
  command->footer("Example:\n  tubefoot presets oculus\n  tubefoot presets klein-3000-445");
  command->callback(
      [&requested] { requested.command = [&requested] { return presets_command(requested.presets); }; });
}

}  // namespace tubefoot
