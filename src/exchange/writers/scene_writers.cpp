// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a scene in the format of an engine, with a README.txt that lists properties of the scene that the
// format cannot represent.
#include "exchange/writers/scene_writers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exchange/obj_mesh.hpp"
#include "exchange/plain_number.hpp"
#include "files/checked_file.hpp"
#include "files/shown.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/recordings/pose_angles.hpp"

namespace tubefoot {
namespace {

std::string matrix_lines(const Axes& axes) {
  std::string text;
  for (const auto& row : axes.rows) text += fmt::format("    [{:2} {:2} {:2}]\n", row[0], row[1], row[2]);
  return text;
}

std::string placed_words(const Placement& ours, ExchangeFormat format, const Axes& of_what) {
  const Placement theirs = to_theirs(ours, axes_of(format).world, of_what);
  const glm::dvec3 rpy = roll_pitch_yaw(theirs.turn);
  const auto q = quaternion_xyzw(theirs.turn);
  const PoseAngles angles = angles_of(glm::quat_cast(ours.turn));
  return fmt::format(
      "    ours: east, north, up = {} m; heading {:.10g}, pitch {:.10g}, roll {:.10g} degrees\n"
      "    theirs: x, y, z = {} m; roll, pitch, yaw about fixed x, y, z = {} rad;\n"
      "            quaternion x, y, z, w = {} {} {} {}\n",
      numbers_text(ours.position_m), angles.heading_deg + 0.0, angles.pitch_deg + 0.0, angles.roll_deg + 0.0,
      numbers_text(theirs.position_m), numbers_text(rpy), plain(q[0], 1), plain(q[1], 1), plain(q[2], 1),
      plain(q[3], 1));
}

std::string beams_words(const ExchangedSonar& sonar) {
  using Shape = ExchangedSonar::Shape;
  if (sonar.shape == Shape::two_sides)
    return fmt::format(
        "    beam 0 looks to port, beam 1 to starboard; each {} degrees wide along the track and {} degrees "
        "high,\n    its centre {} degrees below the horizontal\n",
        sonar.along_track_deg, sonar.vertical_deg, sonar.depression_deg);
  std::string text = fmt::format(
      "    {} beams, {}; beam 0 is the port-most: its axis is at {:.10g} degrees, and that of the last beam "
      "at {:.10g},\n    starboard positive, {}\n",
      sonar.azimuth_deg.size(), sonar.even ? "equiangular" : "not equiangular", sonar.azimuth_deg.front(),
      sonar.azimuth_deg.back(),
      sonar.looks_down ? "in the plane across the track, 0 straight down"
                       : "in the sonar's own plane, 0 ahead");
  text += sonar.shape == Shape::turning
              ? fmt::format(
                    "    one beam that a motor turns: {:.10g} x {:.10g} degrees, {:.10g} degrees per step\n",
                    sonar.horizontal_deg, sonar.vertical_deg, sonar.step_deg)
              : fmt::format("    together {:.10g} degrees wide, each {:.10g} degrees high\n",
                            sonar.horizontal_deg, sonar.vertical_deg);
  if (!sonar.even) {
    text += "    axes [degrees]:";
    for (std::size_t k = 0; k < sonar.azimuth_deg.size(); ++k)
      text += fmt::format("{}{:.10g}", k % 10 == 0 ? "\n      " : " ", sonar.azimuth_deg[k]);
    text += "\n";
  }
  return text;
}

std::string sonar_text(const ExchangedSonar& sonar, ExchangeFormat format) {
  const EngineAxes& axes = axes_of(format);
  std::string text =
      fmt::format("sonar '{}' ({}), {} kHz\n", shown_line(sonar.name), sonar.kind, sonar.frequency_khz);
  text += beams_words(sonar);
  text += fmt::format(
      "    {} range samples from {} m to {} m, {} m each; sample 0 is the nearest; slant ranges for a sound "
      "speed of {} m/s\n    absorption {:.10g} dB/km one way\n",
      sonar.samples, sonar.range_min_m, sonar.range_max_m,
      plain((sonar.range_max_m - sonar.range_min_m) / sonar.samples), sonar.sound_speed_m_s,
      sonar.absorption_db_per_km);
  text += "  its carrier\n" + placed_words(sonar.carrier, format, axes.body);
  text += fmt::format("  the sonar itself{}\n",
                      sonar.looks_down ? ", turned so that ahead is straight down" : "") +
          placed_words(sonar.placement, format, axes.sonar);
  return text;
}

std::string readme(ExchangeFormat format, const ExchangedScene& scene, const WrittenScene& written) {
  const EngineAxes& axes = axes_of(format);
  std::string text =
      fmt::format("{}\nfor {}, written by 'tubefoot export', ping {}\n\nFILES\n",
                  scene.title.empty() ? "A scene" : shown_line(scene.title), axes.engine, scene.ping);
  for (const std::string& file : written.files) text += fmt::format("  {}\n", file);
  text += fmt::format(
      "  {} triangles in {} pieces, in the scene's order\n\nAXES\n"
      "  ours: the world is x east, y north, z up; a body is x starboard, y forward, z up; metres, "
      "right-handed\n"
      "  theirs: the world is {}; a body is {}; a sonar's own frame is {}\n"
      "  from ours to theirs, (theirs) = M (ours), determinant +1:\n  world M =\n{}  body M =\n{}  sonar M "
      "=\n{}"
      "  a rotation R of ours is (world M) R (body or sonar M)^T in theirs\n\nSONARS\n",
      scene.triangles(), scene.pieces.size(), axes.world.words, axes.body.words, axes.sonar.words,
      matrix_lines(axes.world), matrix_lines(axes.body), matrix_lines(axes.sonar));
  for (const ExchangedSonar& sonar : scene.sonars) text += sonar_text(sonar, format);
  text += "\nMATERIALS, each with its lambert_db: 10 log10 of mu of Lambert's law (docs/environment.md)\n";
  for (const ExchangedMaterial& material : scene.materials)
    text += fmt::format("  {} {} dB\n", shown_line(material.name), material.lambert_db);
  text += fmt::format(
      "\nROUNDING\n  Numbers in text have the shortest decimals that restore the same doubles. An engine "
      "that stores floats moves\n  a vertex by up to {:.3g} m in each coordinate (the largest coordinate is "
      "{:.6g} m)\n",
      float_rounding_m(scene.largest_coordinate_m()), scene.largest_coordinate_m());
  text += "\nLEFT OUT, because these files cannot represent it\n";
  for (const std::string& line : scene.left_out) text += fmt::format("  {}\n", shown_line(line));
  text += "  properties of transmitter and receiver: source level, gain, noise, speckle, pulse\n";
  if (!written.notes.empty()) text += fmt::format("\nDIFFERENT IN {}\n", axes.engine);
  for (const std::string& line : written.notes) text += fmt::format("  {}\n", line);
  return text;
}

}  // namespace

std::string axes_words(ExchangeFormat format) {
  const EngineAxes& axes = axes_of(format);
  const auto formula = [](const Axes& of, std::array<const char*, 3> ours) {
    std::string text;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column)
        if (const int sign = of.rows[row][column]; sign != 0)
          text += fmt::format("{}{}{}", row == 0 ? "" : ", ", sign < 0 ? "-" : "", ours[column]);
    return text;
  };
  return fmt::format(
      "Written by tubefoot. Axes: world {}: (x, y, z) = ({});\nbody {}: (x, y, z) = ({});\nsonar {}: (x, y, "
      "z) = ({}). Metres, right-handed. See README.txt for the rest.\n",
      axes.world.words, formula(axes.world, {"east", "north", "up"}), axes.body.words,
      formula(axes.body, {"starboard", "forward", "up"}), axes.sonar.words,
      formula(axes.sonar, {"starboard", "ahead", "up"}));
}

EngineRanges engine_ranges(const ExchangedSonar& sonar, double least_m, bool even) {
  // Engines draw one row of a texture per bin. Graphics cards have textures of at least this size.
  constexpr int most_rows = 16384;
  const double step_m = (sonar.range_max_m - sonar.range_min_m) / sonar.samples;
  EngineRanges ranges;
  const double steps = (sonar.range_min_m - least_m) / step_m;
  // A difference of rounding does not remove a bin.
  ranges.nearer = static_cast<int>(std::clamp(std::floor(steps + 1e-9), 1.0 - sonar.samples,
                                              std::max(0.0, most_rows - 2.0 - sonar.samples)));
  ranges.samples = sonar.samples + ranges.nearer;
  if (even && ranges.samples % 2 != 0) ranges.farther = 1;
  ranges.samples += ranges.farther;
  ranges.range_min_m = plain(sonar.range_min_m - ranges.nearer * step_m, sonar.range_max_m);
  ranges.range_max_m = plain(sonar.range_max_m + ranges.farther * step_m, sonar.range_max_m);
  return ranges;
}

std::string ranges_words(const ExchangedSonar& sonar, const EngineRanges& ranges) {
  if (ranges.nearer == 0 && ranges.farther == 0) return {};
  std::string words = fmt::format("{} range bins from {} m to {} m instead of {} from {} m to {} m",
                                  ranges.samples, ranges.range_min_m, ranges.range_max_m, sonar.samples,
                                  sonar.range_min_m, sonar.range_max_m);
  if (ranges.nearer > 0) words += fmt::format("; remove the {} nearest bins from the picture", ranges.nearer);
  if (ranges.nearer < 0) words += fmt::format("; the {} nearest bins are missing", -ranges.nearer);
  if (ranges.farther > 0)
    words += fmt::format("; remove the {} farthest bin from the picture", ranges.farther);
  return words;
}

Placement turned_to(const Placement& ours, double azimuth_rad) {
  const double s = std::sin(azimuth_rad), c = std::cos(azimuth_rad);
  return {ours.position_m, ours.turn * glm::dmat3(c, -s, 0, s, c, 0, 0, 0, 1)};
}

double grey_of(const ExchangedMaterial& material) {
  return std::round(100 * std::clamp(0.9 + material.lambert_db / 50, 0.1, 0.9)) / 100;
}

std::vector<std::string> write_piece_meshes(ExchangeFormat format, const ExchangedScene& scene,
                                            const std::filesystem::path& folder) {
  const Axes& world = axes_of(format).world;
  std::vector<std::string> names;
  for (const ExchangedPiece& piece : scene.pieces) {
    const std::string name = piece.file_stem + ".obj";
    ObjMesh mesh(folder / name, axes_words(format));
    std::vector<glm::dvec3> points;
    points.reserve(piece.points_m.size());
    for (const glm::dvec3& p : piece.points_m) points.push_back(world.to_theirs(p));
    mesh.object(piece.file_stem, {}, points, piece.triangles, true);
    mesh.close();
    names.push_back(name);
  }
  return names;
}

WrittenScene write_scene(ExchangeFormat format, const ExchangedScene& scene,
                         const std::filesystem::path& folder) {
  constexpr std::array writers{write_sdf_scene, write_stonefish_scene, write_gltf_scene, write_obj_scene,
                               write_holoocean_scene};
  WrittenScene written = writers[static_cast<std::size_t>(format)](scene, folder);
  written.files.push_back("README.txt");
  write_file(folder / "README.txt", std::string_view(readme(format, scene, written)));
  return written;
}

}  // namespace tubefoot
