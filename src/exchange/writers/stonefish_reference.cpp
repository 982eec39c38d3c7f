// SPDX-License-Identifier: GPL-3.0-or-later
// Writes scenes of tubefoot with the beams, range bins and vertical taper of Stonefish's FLS, and the output
// model of its pictures. Source: OpenGLFLS.cpp, flsOutput.comp and flsPostprocessF32.comp of Stonefish 1.6.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exchange/plain_number.hpp"
#include "exchange/stonefish_beams.hpp"
#include "exchange/toml_text.hpp"
#include "exchange/writers/stonefish_sonar.hpp"
#include "files/checked_file.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

/// Returns the table of a vertical beam pattern: t^2 (3 - 2 t). The variable t increases from 0 at a border
/// of the picture to 1 at a fifth of its height.
std::string taper_text(double vertical_deg) {
  constexpr double least = 0.003, ratio = 1.15, part = 0.2;
  std::vector<double> ts;
  for (double t = 1; t > least; t /= ratio) ts.push_back(t);
  ts.push_back(least);
  const double edge = std::tan(radians(vertical_deg) / 2);
  const auto row = [&](double t, double side) {
    return fmt::format("{:.9g},{:.9g}\n", side * degrees(std::atan(edge * (1 - 2 * part * t))),
                       10 * std::log10(t * t * (3 - 2 * t)));
  };
  std::string text = "angle_deg,level_db\n";
  for (std::size_t k = ts.size(); k > 0; --k) text += row(ts[k - 1], -1);
  for (const double t : ts) text += row(t, 1);
  return text;
}

std::string fls_text(const ExchangedSonar& sonar, std::size_t number, const std::string& taper) {
  const StonefishFan fan = stonefish_fan(sonar);
  const EngineRanges ranges = stonefish_ranges(sonar);
  std::string text = fmt::format("\n[[trajectories]]\nname = \"of sonar {}\"\nkind = \"fixed\"\n{}", number,
                                 place_keys(fan.placement));
  text += fmt::format(
      "\n[[sensors]]\nname = {}\nkind = \"imaging\"\ntrajectory = \"of sonar {}\"\nfrequency_khz = {}\n",
      toml_quoted(sonar.name), number, sonar.frequency_khz);
  text += fmt::format(
      "beam_angles_deg = {}\nvertical_deg = {}\nsamples = {}\nrange_min_m = {}\nrange_max_m = {}\n",
      toml_list(stonefish_beam_angles_deg(fan.beams, fan.width_deg)), sonar.vertical_deg, ranges.samples,
      ranges.range_min_m, ranges.range_max_m);
  if (!taper.empty())
    text += fmt::format(
        "transmit_pattern = \"table\"\ntransmit_pattern_angle = \"elevation\"\ntransmit_pattern_file = {}\n",
        toml_quoted(taper));
  return text;
}

/// `tapers`: files of the vertical taper of each sonar; empty for a scene in which the energies are solid
/// angles divided by r^2.
std::string fls_scene_text(const ExchangedScene& scene, const std::vector<std::string>& meshes,
                           const std::vector<std::string>& tapers) {
  std::string text = fmt::format("title = {}\n\n[water]\nsound_speed_m_s = {}\nabsorption_db_per_km = 0\n",
                                 toml_quoted(scene.title), scene.sound_speed_m_s);
  for (const ExchangedMaterial& material : scene.materials) {
    text += fmt::format("\n[[materials]]\nname = {}\n", toml_quoted(material.name));
    text += tapers.empty() ? "law = \"gsab\"\noblique_db = 0\noblique_exponent = 1\nunbounded = true\n"
                           : fmt::format("lambert_db = {}\n", material.lambert_db);
  }
  const Placement meshes_placed{{}, glm::transpose(axes_of(ExchangeFormat::stonefish).world.matrix())};
  for (std::size_t k = 0; k < scene.pieces.size(); ++k)
    text += fmt::format("\n[[objects]]\nname = {}\nshape = \"mesh\"\nmaterial = {}\nfile = {}\n{}",
                        toml_quoted(scene.pieces[k].name),
                        toml_quoted(scene.materials[scene.pieces[k].material].name), toml_quoted(meshes[k]),
                        place_keys(meshes_placed));
  for (std::size_t k = 0; k < scene.sonars.size(); ++k)
    text += fls_text(scene.sonars[k], k, tapers.empty() ? std::string() : tapers[k]);
  return text;
}

/// Mean over the samples of a bin without spreading loss, then a blur of 5 x 5 bins, limited to 0 to 1.
std::string fls_output_model(const ExchangedScene& scene) {
  double strongest_db = scene.materials.front().lambert_db;
  for (const ExchangedMaterial& material : scene.materials)
    strongest_db = std::max(strongest_db, material.lambert_db);
  return fmt::format(
      "# Output model of the pictures of Stonefish's FLS with gain 1 and without noise.\n"
      "title = \"Stonefish FLS\"\n"
      "solid_angles = \"angles/echoes.nc\"   # of 'tubefoot run fls-angles.toml -o angles'\n"
      "solid_angle_strength_db = 0\n\n[[steps]]\nstep = \"mean\"\n\n"
      "[[steps]]\nstep = \"range-law\"\nexponent = 2\n\n"
      "[[steps]]\nstep = \"gain\"\nfactor = {}   # the strongest material has restitution 1\n\n"
      "[[steps]]\nstep = \"blur\"\nbeams = 1\nsamples = 1\nsize = 5\n\n"
      "[[steps]]\nstep = \"clamp\"\nlow = 0\nhigh = 1\n",
      plain(std::pow(10, -strongest_db / 10)));
}

bool is_fls(const ExchangedSonar& sonar) {
  constexpr double highest_deg = 170;  // of an imaging sonar of tubefoot
  const StonefishFan fan = stonefish_fan(sonar);
  return sonar.shape == ExchangedSonar::Shape::fan && sonar.vertical_deg <= highest_deg &&
         !stonefish_beam_angles_deg(fan.beams, fan.width_deg).empty();
}

}  // namespace

EngineRanges stonefish_ranges(const ExchangedSonar& sonar) {
  constexpr double least_m = 0.02;  // setRangeMin() of FLS, MSIS and SSS
  // Camera.cpp rounds odd numbers up. An SSS has one row for both sides, whose number of bins is even.
  return engine_ranges(sonar, least_m, sonar.shape != ExchangedSonar::Shape::two_sides);
}

StonefishFan stonefish_fan(const ExchangedSonar& sonar) {
  const int beams = static_cast<int>(sonar.azimuth_deg.size());
  if (beams % 2 == 0) return {beams, sonar.horizontal_deg, sonar.placement, false};
  const double beam_deg = sonar.horizontal_deg / beams;
  return {beams + 1, plain(sonar.horizontal_deg + beam_deg),
          turned_to(sonar.placement, radians(beam_deg) / 2), true};
}

void add_stonefish_reference(const ExchangedScene& scene, const std::vector<std::string>& meshes,
                             const std::filesystem::path& folder, WrittenScene& written) {
  if (scene.sonars.empty() || !std::ranges::all_of(scene.sonars, is_fls)) {
    written.notes.push_back(
        "there is no output model, because a sonar is not an FLS, or Stonefish cannot represent its fan; "
        "export an acoustic camera or a multibeam alone with --sensor");
    return;
  }
  std::vector<std::string> tapers;
  for (std::size_t k = 0; k < scene.sonars.size(); ++k) {
    tapers.push_back(fmt::format("fls-taper-{}.csv", k));
    write_file(folder / tapers.back(), std::string_view(taper_text(scene.sonars[k].vertical_deg)));
  }
  for (const auto& [name, text] : {std::pair("fls-reference.toml", fls_scene_text(scene, meshes, tapers)),
                                   std::pair("fls-angles.toml", fls_scene_text(scene, meshes, {})),
                                   std::pair("fls-output-model.toml", fls_output_model(scene))}) {
    write_file(folder / name, std::string_view(text));
    written.files.emplace_back(name);
  }
  written.files.insert(written.files.end(), tapers.begin(), tapers.end());
  written.notes.push_back(
      "fls-reference.toml is the scene with the beams, range bins and vertical taper of the FLS. For "
      "each row of a picture at the height v from 0 to 1, the taper is the product of two cubic steps, "
      "from 0 to 0.2 and from 1 to 0.8. In this folder, 'tubefoot run fls-reference.toml -o reference' "
      "and 'tubefoot run fls-angles.toml -o angles' compute the reference. Import pictures with --like "
      "reference/echoes.nc --profile stonefish --output-model fls-output-model.toml, and 8-bit pictures also "
      "with --scale 8bit. Compare with the same output model");
  written.notes.push_back(
      "fls-output-model.toml approximates two properties: the rows of a picture are equidistant, so "
      "samples near its upper and lower border weigh less in the mean, and the taper depends on the "
      "azimuth in a view");
}

}  // namespace tubefoot
