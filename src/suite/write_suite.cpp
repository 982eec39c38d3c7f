// SPDX-License-Identifier: GPL-3.0-or-later

// Writes the benchmark suite (docs/reference-results.md): scene files, meshes, scenes in numbers, reference
// answers with certified bounds where they are possible, and SHA-256 sums.

#include "suite/write_suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "files/checked_file.hpp"
#include "files/durable.hpp"
#include "files/file_hash.hpp"
#include "files/input_registry.hpp"
#include "files/json_text.hpp"
#include "files/staging.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "geometry/steps/stop.hpp"
#include "run/console/progress.hpp"
#include "run/run_steps.hpp"
#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "suite/npy.hpp"
#include "suite/scene_numbers.hpp"
#include "suite/strength_files.hpp"
#include "suite/texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view sums_name = "SHA256SUMS", answers_name = "answers";

void write_json(const fs::path& file, const Json& json) { write_file(file, text_of(json) + "\n"); }

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Writes the inputs of a scene before it is loaded: scene file and meshes.
void write_inputs(const fs::path& folder, const SuiteScene& scene, const SuiteVersion& version) {
  make_folder(folder);
  for (const Solid& solid : scene.solids) {
    write_file(folder / (solid.name + ".obj"), obj_text(solid));
    write_file(folder / (solid.name + ".stl"), stl_bytes(solid));
  }
  write_file(folder / "scene.toml", std::string(version.heading) + scene.text);
}

/// Energies and bounds of a scene, and its derivatives with their bounds: [parameter][beam][sample].
struct SuiteAnswer {
  std::array<std::size_t, 3> shape{};
  std::vector<double> energy, bound, gradient, gradient_bound;
  std::vector<Recording> recordings;
  std::size_t bins_over = 0;
};

SuiteAnswer answer_of(const Survey& survey, const SuiteScene& scene, const SuiteVersion& version) {
  RunRequest request = request_of(survey.scene.description.run);
  request.reference_tolerance = scene.certified;
  request.rounds_corners = true;
  request.keeps_midpoints = version.has_midpoints;
  request.gradient = scene.gradient;
  SimulationStats stats;
  SuiteAnswer answer;
  answer.recordings = simulate(survey, request, stats);
  answer.bins_over = stats.reference.bins_over;
  const Recording& recording = answer.recordings.front();
  answer.shape = {recording.pings(), recording.sensor->beams().size(),
                  static_cast<std::size_t>(recording.sensor->samples().count)};
  answer.energy.assign(recording.energy.begin(), recording.energy.end());
  answer.bound.assign(recording.energy_bound.begin(), recording.energy_bound.end());
  for (const RecordedVariable& variable : recording.further) {
    const PingEnergies stored = variable.of(0);
    const std::span<const double> values = stored.values();
    const bool bounds = variable.meaning.name.starts_with("gradient_bound.");
    std::vector<double>& all = bounds ? answer.gradient_bound : answer.gradient;
    all.insert(all.end(), values.begin(), values.end());
  }
  return answer;
}

/// Writes the energies of the same scene with sharp shadow borders.
void write_sharp_answer(const fs::path& folder, const SuiteScene& scene, SceneDescription description,
                        const SuiteVersion& version) {
  description.sensors.front().shadow = "sharp";
  SuiteScene sharp = scene;
  sharp.certified = SuiteScene().certified;
  const std::unique_ptr<const Survey> survey = open_survey(description);
  const SuiteAnswer answer = answer_of(*survey, sharp, version);
  write_npy(folder / "sharp.npy", answer.shape, answer.energy);
  write_npy(folder / "sharp_bound.npy", answer.shape, answer.bound);
}

void write_answer(const fs::path& folder, const SuiteScene& scene, const Survey& survey,
                  const SuiteVersion& version, WrittenSuiteScene& written) {
  const SuiteAnswer answer = answer_of(survey, scene, version);
  const double energy_j = sum(answer.energy);
  written.result = fmt::format("{:.4g} J/m2", energy_j);
  written.bins_over = answer.bins_over;
  make_folder(folder);
  write_npy(folder / "energy.npy", answer.shape, answer.energy);
  Json json{
      {"scene", written.aspect->name},
      {"scene_hash", survey.scene.description.sha256},
      {"units", version.has_midpoints ? "J for a source of 1 J/sr at 1 m" : "J/m2 for a source of 1 J/sr"},
      {"shape", answer.shape},
      {"energy_j", energy_j},
      {"strongest_j", *std::ranges::max_element(answer.energy)}};
  if (scene.certified) {
    write_npy(folder / "bound.npy", answer.shape, answer.bound);
    json["certified"] = true;
    json["bound_asked"] = *scene.certified;
    json["bins_with_wider_bounds"] = answer.bins_over;
    json["bound_l1"] = sum(answer.bound) / energy_j;
  } else {
    json["certified"] = false;
    json["tolerance_l1"] = scene.tolerance_l1;
  }
  if (!scene.gradient.empty()) {
    const std::array<std::size_t, 3> shape{scene.gradient.size(), answer.shape[1], answer.shape[2]};
    write_npy(folder / "gradient.npy", shape, answer.gradient);
    write_npy(folder / "gradient_bound.npy", shape, answer.gradient_bound);
    json["gradient"] = scene.gradient;
  }
  if (scene.has_sharp_answer) write_sharp_answer(folder, scene, survey.scene.description, version);
  write_json(folder / "answer.json", json);
  RunRequest request = request_of(survey.scene.description.run);
  request.reference_tolerance = scene.certified;
  request.rounds_corners = true;
  write_echoes(folder / "echoes.nc", answer.recordings, provenance_of(survey.scene, request));
}

/// Writes the SHA-256 sums of all files below `folder` except `left_out`, in the format of sha256sum.
void write_sums(const fs::path& folder, const fs::path& left_out) {
  std::map<std::string, std::string> digests;
  for (fs::recursive_directory_iterator entry(folder), end; entry != end; ++entry) {
    stop_if_wanted();
    if (entry->path() == left_out) entry.disable_recursion_pending();
    if (!entry->is_regular_file() || entry->path().filename() == list_name) continue;
    digests[entry->path().lexically_relative(folder).generic_string()] = sha256_of(entry->path());
  }
  std::string text;
  for (const auto& [name, digest] : digests) text += fmt::format("{}  {}\n", digest, name);
  write_file(folder / sums_name, text);
}

/// Writes the files of subfolders to disk. OutputFolder::commit() writes only the files directly in the
/// folder.
void sync_below(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_directory()) {
      sync_below(entry.path());
      sync_files_in(entry.path());
    }
}

/// Writes a scene of echoes, and its answer into the folder `answer`.
void write_scene_of_echoes(const fs::path& place, const std::optional<fs::path>& answer,
                           const SuiteScene& scene, const SuiteRequest& request,
                           const OtherForms& other_forms, WrittenSuiteScene& written) {
  write_inputs(place, scene, request.version);
  const std::unique_ptr<const Survey> survey = open_survey(read_scene_file(place / "scene.toml"));
  write_json(place / "scene.json", scene_numbers(*written.aspect, scene, *survey));
  if (other_forms) other_forms(*survey, place);
  written.facets = survey->scene.mesh.facets.size();
  if (answer) write_answer(*answer, scene, *survey, request.version, written);
}

void write_frame(const fs::path& folder, const SuiteRequest& request) {
  for (const SuiteText& text : suite_texts(request.version.number)) {
    make_folder((folder / text.file).parent_path());
    write_file(folder / text.file, text.content);
  }
  Json names = Json::array();
  for (const Aspect* aspect : request.scenes) names.push_back(aspect->name);
  Json json{{"pack", request.version.title},
            {"version", request.version.full_number},
            {"set", request.seed ? "validation" : "debug"}};
  const bool seed_is_public = request.version.number <= 2;
  if (request.seed && seed_is_public) json["seed"] = *request.seed;
  json["scenes"] = names;
  json["made_by"] = "tubefoot " TUBEFOOT_VERSION;
  json["licence"] = "GPL-3.0-or-later";
  write_json(folder / "pack.json", json);
  // Participants could write the answers with the seed.
  if (!request.seed || seed_is_public || !request.answers) return;
  make_folder(folder / answers_name);
  write_json(folder / answers_name / "seed.json", {{"seed", *request.seed}});
}

}  // namespace

std::vector<const Aspect*> aspects_named(const SuiteVersion& version, const std::string& names) {
  std::vector<std::string> known, requested;
  for (const Aspect& aspect : version.aspects) known.emplace_back(aspect.name);
  for (std::size_t begin = 0; begin < names.size() + 1 && !names.empty();) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    requested.push_back(names.substr(begin, end - begin));
    begin = end + 1;
    if (std::ranges::find(known, requested.back()) != known.end()) continue;
    const std::string_view meant = nearest(requested.back(), known);
    throw UsageError(fmt::format("the suite has no scene '{}': {}", requested.back(),
                                 meant.empty() ? "it has " + fmt::format("{}", one_of(known, '\''))
                                               : fmt::format("did you mean '{}'?", meant)));
  }
  std::vector<const Aspect*> found;
  for (const Aspect& aspect : version.aspects)
    if (names.empty() || std::ranges::find(requested, aspect.name) != requested.end())
      found.push_back(&aspect);
  return found;
}

std::vector<WrittenSuiteScene> write_suite(const fs::path& folder, const SuiteRequest& request,
                                           const OtherForms& other_forms) {
  using Clock = std::chrono::steady_clock;
  std::vector<WrittenSuiteScene> all;
  write_frame(folder, request);
  const fs::path answers = folder / answers_name;
  Progress progress("packing", request.scenes.size(), request.quiet);
  for (const Aspect* aspect : request.scenes) {
    const Clock::time_point start = Clock::now();
    Draw draw(request.seed, aspect->name);
    SuiteScene scene = aspect->scene(draw);
    WrittenSuiteScene written{aspect};
    const fs::path place = folder / "scenes" / aspect->name;
    const std::optional<fs::path> answer =
        request.answers ? std::optional(answers / aspect->name) : std::nullopt;
    for (Decider& decider : scene.deciders)
      if (decider.measure == "samples_moved" && request.version.samples_moved_limit)
        decider.limit = std::min(decider.limit, *request.version.samples_moved_limit);
    if (scene.strength)
      write_strength_scene(place, answer, scene, written);
    else
      write_scene_of_echoes(place, answer, scene, request, other_forms, written);
    written.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    all.push_back(written);
    progress.step();
  }
  if (request.answers) write_sums(answers, {});
  write_sums(folder, answers);
  sync_below(folder);
  return all;
}

}  // namespace tubefoot
