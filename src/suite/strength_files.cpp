// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the scenes of target strength of the benchmark suite, and their answers as tables.
#include "suite/strength_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "files/staging.hpp"
#include "strength/strength_comparison.hpp"
#include "strength/strength_output.hpp"
#include "suite/texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double sound_speed_m_s = 1500;

std::string_view body_file(const std::string& name) {
  const std::span<const SuiteText> files = suite_texts(suite_bodies);
  return std::ranges::find(files, name, &SuiteText::file)->content;
}

Json strength_numbers(const SuiteScene& scene, const WrittenSuiteScene& written) {
  Json judged = Json::array();
  for (const Decider& decider : scene.deciders)
    judged.push_back({{"measure", decider.measure}, {"limit", decider.limit}});
  return {{"scene", written.aspect->name},
          {"tests", written.aspect->tests},
          {"title", scene.title},
          {"body", {{"obj", fmt::format("{}.obj", scene.strength->name)}, {"facets", written.facets}}},
          {"water", {{"sound_speed_m_s", sound_speed_m_s}}},
          {"reflection", 1},
          {"azimuths_deg", scene.strength->azimuths_deg},
          {"frequencies_hz", scene.strength->frequencies_hz},
          {"judged_by", judged}};
}

}  // namespace

void write_strength_scene(const fs::path& place, const std::optional<fs::path>& answers,
                          const SuiteScene& scene, WrittenSuiteScene& written) {
  const std::string body(scene.strength->name), mesh_name = body + ".obj";
  make_folder(place);
  write_file(place / mesh_name, body_file(mesh_name));
  const ComponentMesh mesh = strength_mesh(place / mesh_name, {}, {});
  written.facets = mesh.triangles.size();
  write_file(place / "scene.json", text_of(strength_numbers(scene, written)) + "\n");
  if (!answers) return;
  const StrengthRequest request{scene.strength->azimuths_deg,
                                {0},
                                scene.strength->frequencies_hz,
                                sound_speed_m_s,
                                {},
                                "rigid",
                                scene.certified};
  make_folder(*answers);
  const fs::path published = *answers / "boundary-elements.csv";
  write_file(published, body_file(body + ".csv"));
  StrengthTable table = strength_of(mesh, mesh_name, request, true);
  table.comparison = read_comparison(published, request);
  write_file(*answers / "strength.csv", to_csv(table));
  const BoundsHeld held = bounds_held(table);
  const auto [weakest, strongest] = spread_db(table);
  written.result = fmt::format("{:.2f} to {:.2f} dB re 1 m2", weakest, strongest);
  written.bins_over = held.over;
  Json differences = Json::array();
  for (const StrengthDifference& difference : differences_of(table))
    differences.push_back({{"frequency_hz", difference.frequency_hz},
                           {"directions", difference.directions},
                           {"median_db", difference.median_db},
                           {"ninth_decile_db", difference.ninth_decile_db},
                           {"largest_db", difference.largest_db},
                           {"mean_cross_section_db", difference.mean_db}});
  write_file(*answers / "answer.json", text_of(Json{{"scene", written.aspect->name},
                                                    {"units", "dB re 1 m2"},
                                                    {"certified", true},
                                                    {"bound_asked", *scene.certified},
                                                    {"bins_with_wider_bounds", held.over},
                                                    {"widest_bound_m", held.most_m},
                                                    {"kirchhoff_minus_boundary_elements", differences}}) +
                                           "\n");
}

}  // namespace tubefoot
