// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the commands that describe a scene or its contents: check, audit, footprints, coverage,
// strength, rays, view, refine, export, presets and keys.
#include "app/command_options.hpp"

namespace tubefoot {

void add_check(CLI::App& app, CommandOptions& requested) {
  CheckOptions& check = requested.check;
  CLI::App* command = app.add_subcommand("check", "Load a scene with all its files and print its contents");
  add_common(*command, check);
  command
      ->add_option(
          "--png", check.picture,
          "draw the scene into this file: plan and side views with seabed, objects, tracks and sectors")
      ->option_text("FILE");
  command->footer("Example:\n  tubefoot check scenes/wellhead/scene.toml --png scene.png");
  command->callback(
      [&requested] { requested.command = [&requested] { return check_command(requested.check); }; });
}

void add_audit(CLI::App& app, CommandOptions& requested) {
  AuditOptions& audit = requested.audit;
  CLI::App* command = app.add_subcommand(
      "audit",
      "Verify in rational arithmetic that visible polygons and unobstructed region add up to each tube");
  add_common(*command, audit);
  command->add_option("--sensor", audit.sensor, "audit this sensor only")->option_text("NAME");
  command
      ->add_option("--pings", audit.pings, "audit pings A to B, both included, counted from 0 (default: all)")
      ->option_text("A:B");
  command->footer("Example:\n  tubefoot audit scenes/wellhead/scene.toml --sensor camera --pings 0:2");
  command->callback(
      [&requested] { requested.command = [&requested] { return audit_command(requested.audit); }; });
}

void add_footprints(CLI::App& app, CommandOptions& requested) {
  FootprintOptions& footprints = requested.footprints;
  CLI::App* command =
      app.add_subcommand("footprints", "Write the visible polygons of some pings of a sensor");
  add_common(*command, footprints);
  command->add_option("--sensor", footprints.sensor, "name of the sensor")->required()->option_text("NAME");
  command->add_option("--pings", footprints.pings, "pings A to B, both included, counted from 0 (default: 0)")
      ->option_text("A:B");
  command
      ->add_option("--beams", footprints.beams,
                   "beams A to B, both included. Separate several ranges by commas (default: all)")
      ->option_text("A:B");
  command
      ->add_option(
          "-o,--output", footprints.output,
          "file to write. Its suffix selects the format: .gpkg (GeoPackage), .geojson, .csv (WKT), .vtp "
          "(VTK, ParaView), .obj, .ply, .nc (netCDF) or .txt (exact corners); docs/footprints.md")
      ->required()
      ->option_text("FILE");
  command
      ->add_option("--rationals", footprints.rationals,
                   "also write the exact corners, as fractions, into this file")
      ->option_text("FILE");
  command->footer(
      "Example:\n  tubefoot footprints scenes/wellhead/scene.toml --sensor camera --pings 0 -o camera.gpkg\n"
      "  tubefoot footprints scenes/wellhead/scene.toml --sensor camera --beams 40:50 -o beams.vtp");
  command->callback([&requested] {
    requested.command = [&requested] { return footprints_command(requested.footprints); };
  });
}

void add_coverage(CLI::App& app, CommandOptions& requested) {
  CoverageOptions& coverage = requested.coverage;
  CLI::App* command =
      app.add_subcommand("coverage", "Compute which parts of each facet a survey insonifies, and how often");
  add_common(*command, coverage);
  command->add_option("--sensor", coverage.sensor, "use this sensor only")->option_text("NAME");
  command
      ->add_option("--pings", coverage.pings,
                   "pings A to B of each sensor, both included, counted from 0 (default: all)")
      ->option_text("A:B");
  command
      ->add_option(
          "-o,--output", coverage.output,
          "file to write: .gpkg (GeoPackage with polygons and tables), .csv (one row per facet), .vtp "
          "or .glb (mesh of the facets with their values). Any other name is a folder for these "
          "files and a picture")
      ->required()
      ->option_text("FILE");
  command
      ->add_option(
          "--order", coverage.order,
          "largest number of interactions per path; 1: direct paths only (default: 'order' of [paths])")
      ->check(CLI::Range(1, 8));
  command->add_option("--picture", coverage.picture, "also draw the coverage into this PNG file")
      ->option_text("FILE");
  command->footer("Example:\n  tubefoot coverage scenes/survey/scene.toml --pings 200:299 -o out/coverage");
  command->callback(
      [&requested] { requested.command = [&requested] { return coverage_command(requested.coverage); }; });
}

void add_strength(CLI::App& app, CommandOptions& requested) {
  StrengthOptions& strength = requested.strength;
  CLI::App* command = app.add_subcommand(
      "strength", "Compute the target strength of a mesh for directions and frequencies (docs/signals.md)");
  command->add_option("MESH", strength.mesh, "mesh file in a format of scenes: .obj, .ply, .stl, .off, ...")
      ->required();
  command
      ->add_option("--frequencies", strength.frequencies,
                   "FIRST:LAST:STEP, or numbers separated by commas, in Hz, kHz or MHz: 38kHz,120kHz")
      ->required()
      ->option_text("LIST");
  command
      ->add_option("--azimuths", strength.azimuths,
                   "directions to the sonar in degrees from x towards y, as FIRST:LAST:STEP or a list "
                   "(default: 0:359:1)")
      ->option_text("LIST");
  command
      ->add_option("--elevations", strength.elevations,
                   "elevations of the sonar in degrees towards z, as FIRST:LAST:STEP or a list (default: 0)")
      ->option_text("LIST");
  command
      ->add_option("--sound-speed", strength.sound_speed, "sound speed of the water in m/s (default: 1500)")
      ->check(finite_number(0, true));
  command
      ->add_option("--reflection", strength.reflection,
                   "reflection coefficient of the surface: rigid, soft, a number from -1 to 1, or "
                   "fluid:DENSITY:SPEED[:LOSS] (default: rigid)")
      ->option_text("VALUE");
  command
      ->add_option("--roughness", strength.roughness_m,
                   "standard deviation of the surface height in m (default: 0)")
      ->check(finite_number(0, false));
  CLI::Option* reference =
      command->add_flag("--reference", strength.reference,
                        "certify each value: the output then contains a bound for each (docs/signals.md)");
  command
      ->add_option("--tolerance", strength.tolerance,
                   "with --reference: requested relative bound, 1e-12 to 0.1; wider bounds cause a warning "
                   "(default: 1e-3)")
      ->check(finite_number(0, true))
      ->needs(reference);
  command
      ->add_option(
          "--compare", strength.compared,
          "CSV file with other target strengths at some of these directions and frequencies: columns "
          "azimuth_deg, frequency_hz, target_strength_db and optionally elevation_deg. The output "
          "then contains the differences")
      ->option_text("FILE");
  command
      ->add_option("--unit", strength.unit_m,
                   "length of the mesh unit in m (default: the unit that the file states, else 1)")
      ->check(finite_number(0, true));
  command
      ->add_option("--up", strength.up,
                   "axis of the mesh that becomes z (default: the axis that the file states, else z)")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command
      ->add_option("-o,--output", strength.output,
                   "file to write: .csv, .nc (netCDF) or .png. Any other name is a folder for all three")
      ->required()
      ->option_text("FILE");
  command->add_option("--threads", strength.threads, "number of threads (default: all cores)")
      ->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", strength.quiet, "print results and errors only");
  command->footer(
      "Example:\n  tubefoot strength mine.stl --unit 1e-3 --frequencies 38kHz,120kHz -o out/mine");
  command->callback(
      [&requested] { requested.command = [&requested] { return strength_command(requested.strength); }; });
}

void add_rays(CLI::App& app, CommandOptions& requested) {
  RaysOptions& rays = requested.rays;
  CLI::App* command = app.add_subcommand(
      "rays", "Compute eigenrays in the water, or a fan of rays, as a table and a picture (docs/rays.md)");
  CLI::Option* scene = command->add_option("SCENE", rays.scene, "scene file (docs/scene-keys.md)");
  command
      ->add_option(
          "--profile", rays.profile,
          "instead of SCENE: CSV file with the columns depth_m and sound_speed_m_s. The surface is at "
          "height 0")
      ->excludes(scene)
      ->option_text("FILE");
  CLI::Option* from =
      command
          ->add_option("--from", rays.from,
                       "position of the source in m, z upwards (default: the sensor of the scene)")
          ->option_text("X,Y,Z");
  command->add_option("--sensor", rays.sensor, "sensor that is the source (default: the first of the scene)")
      ->excludes(from)
      ->option_text("NAME");
  command->add_option("--pings", rays.pings, "ping of the sensor, counted from 0 (default: 0)")
      ->excludes(from)
      ->option_text("N");
  command
      ->add_option("--to", rays.to,
                   "compute the eigenrays to this position in m, or to the positions of a CSV file with the "
                   "columns x_m, y_m and z_m. The option may be repeated")
      ->allow_extra_args(false)
      ->option_text("X,Y,Z");
  command
      ->add_option(
          "--ranges", rays.ranges,
          "with --depths: horizontal ranges of the points, as FIRST:LAST:STEP or a list, in m or km. "
          "With --angles: range at which the rays end")
      ->option_text("LIST");
  CLI::Option* depths =
      command
          ->add_option("--depths", rays.depths,
                       "depths of the points below the surface, as FIRST:LAST:STEP or a list")
          ->option_text("LIST");
  command
      ->add_option("--angles", rays.angles,
                   "instead of eigenrays, trace a fan of rays with these launch angles in degrees, positive "
                   "downwards, as FIRST:LAST:STEP or a list")
      ->excludes(depths)
      ->option_text("LIST");
  command
      ->add_option("--reflections", rays.reflections,
                   "largest number of reflections at the sea surface and at --bottom (default: 0; with "
                   "--angles, any number)")
      ->check(CLI::Range(0, 100));
  command
      ->add_option(
          "--bottom", rays.bottom_m,
          "depth in m of a level bottom that reflects. Rays ignore the terrain of the scene (default: "
          "no bottom)")
      ->check(finite_number(-1e8, false));
  command
      ->add_option("--turns", rays.turns,
                   "largest number of turning points of a ray without reflections (default: 16)")
      ->check(CLI::Range(0, 100));
  command
      ->add_option(
          "--frequency-khz", rays.frequency_khz,
          "frequency of the absorption (default: that of the sensor; without a sensor, the absorption "
          "is that of the scene file or 0)")
      ->check(finite_number(0, true));
  command->add_option("-o,--output", rays.output, "CSV file to write (default: print the table)")
      ->option_text("FILE");
  command
      ->add_option("--picture", rays.picture,
                   "draw the paths and the sound speed profile into this file: .png or .svg")
      ->option_text("FILE");
  command
      ->add_option(
          "--environment", rays.environment,
          "also write a BELLHOP environment file (.env) for the same water, source and points, or for "
          "the same fan")
      ->option_text("FILE");
  command->add_option("--threads", rays.threads, "number of threads (default: all cores)")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*command, rays);
  command->footer(
      "Example:\n  tubefoot rays scenes/refraction/scene.toml --ranges 10:70:20 --depths 15 -o rays.csv\n"
      "  tubefoot rays --profile cast.csv --from 0,0,-50 --angles -10:10:1 --ranges 5km --picture fan.svg");
  command->callback(
      [&requested] { requested.command = [&requested] { return rays_command(requested.rays); }; });
}

void add_view(CLI::App& app, CommandOptions& requested) {
  ViewOptions& view = requested.view;
  CLI::App* command = app.add_subcommand(
      "view", "Write an HTML page that shows footprints in 3-D and the sonar picture (docs/footprints.md)");
  command->add_option("RESULT", view.scene, "result folder of 'run', or a scene file")->required();
  command->add_option("-o,--output", view.output, "HTML file to write; the page needs no network")
      ->required()
      ->option_text("FILE");
  command->add_option("--sensor", view.sensor, "name of the sensor (default: the first of the scene)")
      ->option_text("NAME");
  command
      ->add_option("--pings", view.pings,
                   "pings A to B, both included, counted from 0 (default: from 0, as many pings as fit on "
                   "the page)")
      ->option_text("A:B");
  CLI::Option* candidate =
      command
          ->add_option(
              "--candidate", view.candidate,
              "echo file of another engine, or the folder of its run: show its picture and its error")
          ->transform(echoes_of_run())
          ->option_text("FILE");
  command
      ->add_option("--reference", view.reference,
                   "with --candidate: echo file of the reference, or the folder of its run (default: RESULT)")
      ->needs(candidate)
      ->transform(echoes_of_run())
      ->option_text("FILE");
  command->add_option("--scene", view.moved_scene, "scene file of RESULT, if the file has moved")
      ->option_text("FILE");
  command
      ->add_option("--arithmetic", view.arithmetic,
                   "number type of exact visibility (default: that of the run or the scene)")
      ->check(CLI::IsMember({"fixed", "filtered", "rational", "double"}));
  command
      ->add_option("--threads", view.threads,
                   "number of threads (default: 'threads' of the scene, else all cores)")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*command, view);
  command->footer("Example:\n  tubefoot view out/wellhead -o wellhead.html --sensor camera");
  command->callback(
      [&requested] { requested.command = [&requested] { return view_command(requested.view); }; });
}

void add_refine(CLI::App& app, CommandOptions& requested) {
  RefineOptions& refine = requested.refine;
  CLI::App* command = app.add_subcommand(
      "refine", "Write the seabed with its relief as a mesh, for mesh tools and for mode = \"offline\"");
  command->add_option("SCENE", refine.scene, "scene file (docs/scene-keys.md)")->required();
  command->add_option("-o,--output", refine.output, "PLY file to write")->required()->option_text("FILE");
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
      "export",
      "Write a scene for another engine, with the same mesh, poses and sonar (docs/exchange-formats.md)");
  command->add_option("SCENE", exported.scene, "scene file (docs/scene-keys.md)")->required();
  command->add_option("--threads", exported.threads, "number of threads (default: all cores)")
      ->check(CLI::Range(1, 4096));
  add_scene_flags(*command, exported);
  command
      ->add_option("--to", exported.to,
                   "format: sdf for Gazebo, stonefish for Stonefish (.scn), holoocean for HoloOcean (JSON)")
      ->required()
      ->check(CLI::IsMember({"sdf", "stonefish", "gltf", "obj", "holoocean"}));
  command->add_option("-o,--output", exported.output, "folder to write; a failed export leaves no folder")
      ->required()
      ->option_text("FOLDER");
  command->add_option("--pings", exported.ping, "export the pose of this ping, counted from 0 (default: 0)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--sensor", exported.sensor, "export this sensor only (default: all)")
      ->option_text("NAME");
  command->footer("Example:\n  tubefoot export scenes/imaging/scene.toml --to stonefish -o out/imaging-scn");
  command->callback(
      [&requested] { requested.command = [&requested] { return export_command(requested.exported); }; });
}

void add_presets(CLI::App& app, CommandOptions& requested) {
  PresetsOptions& presets = requested.presets;
  CLI::App* command = app.add_subcommand(
      "presets", "List the presets of commercial sonars with their sources, or print the keys of one");
  command->add_option(
      "NAME", presets.name,
      "print the keys of the preset with this name, or list the presets that contain this text");
  command->footer("Example:\n  tubefoot presets oculus\n  tubefoot presets klein-3000-445");
  command->callback(
      [&requested] { requested.command = [&requested] { return presets_command(requested.presets); }; });
}

void add_keys(CLI::App& app, CommandOptions& requested) {
  KeysOptions& keys = requested.keys;
  CLI::App* command =
      app.add_subcommand("keys", "Print the keys of scene files with type, unit, default, range and meaning");
  command->add_option("NAME", keys.name,
                      "section, kind or key, for example 'water' or 'frequency_khz'; a part of a name "
                      "selects all keys that contain this part (default: list the sections)");
  command->add_flag("--json", keys.json, "print JSON for other programs, without NAME for all keys");
  command->footer("Example:\n  tubefoot keys water\n  tubefoot keys frequency_khz");
  command->callback(
      [&requested] { requested.command = [&requested] { return keys_command(requested.keys); }; });
}

}  // namespace tubefoot
