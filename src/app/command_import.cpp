// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "app/commands.hpp"
#include "compare/echo_pairs.hpp"
#include "compare/output_model_reference.hpp"
#include "exchange/readers/kmall_scene.hpp"
#include "files/absolute_path.hpp"
#include "files/atomic_output.hpp"
#include "files/staging.hpp"
#include "files/usage_error.hpp"
#include "import/foreign_file.hpp"
#include "import/imported.hpp"
#include "import/measured_column.hpp"
#include "import/originals.hpp"
#include "import/scene_truth.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

/// Longest list of originals, in bytes, that the attributes of the file contain. The folder of originals
/// contains longer lists.
constexpr std::size_t longest_list = 1 << 14;

std::string list_of(const std::vector<Original>& originals) {
  std::string list;
  for (const auto& [name, hash] : originals) list += fmt::format("{}  {}\n", hash, name);
  return list.size() <= longest_list ? list : fmt::format("{} files, listed in list.txt\n", originals.size());
}

/// Imports a measured water column. The scene gives the poses and beams. Without one, it is that of
/// `import-scene`.
int import_column(const ImportOptions& options) {
  ImportOptions plain = options;
  if (options.results.size() > 1) throw UsageError("a water column is imported alone: give one file .kmwcd");
  plain.scene.reset();
  plain.confined = false;
  if (const std::string given = words_of(plain);
      options.like || options.sensor || options.output_model || options.strict || !given.empty())
    throw UsageError("only --scene and -o apply to a water column: its file states ranges, beams and gain");
  const KmallSurvey line = read_kmall_survey(options.results[0], true);
  Inputs inputs = line.inputs();
  std::optional<SceneDescription> scene;
  if (options.scene) {
    scene = read_scene_file(*options.scene, options.confined);
    const Inputs of_scene = inputs_of(*scene);
    inputs.insert(inputs.end(), of_scene.begin(), of_scene.end());
  }
  OutputFile output(options.output, inputs);
  std::optional<Staging> staging;
  if (!scene) {
    staging.emplace(absolute_path(options.output), 0700);
    write_kmall_scene(line, {}, staging->path());
    scene = read_scene_file(staging->path() / "scene.toml");
  }
  const MeasuredColumnReport report = write_measured_column(output.path(), line, *open_survey(*scene));
  output.commit();
  for (const std::string& note : line.notes) say("{}\n", note);
  const double share = report.samples == 0 ? 0 : 100.0 * double(report.clipped) / double(report.samples);
  tell(
      "wrote {}: {} sensors, {} pings, {} beams; {:.1f} % of the samples have the lowest code and the energy "
      "0\n",
      options.output.string(), report.sensors, report.pings, report.beams, share);
  return 0;
}

}  // namespace

int import_command(const ImportOptions& options) {
  if (options.output.extension() != ".nc")
    throw UsageError(fmt::format("'{}': the name of an echo file must end in .nc", options.output.string()));
  if (std::ranges::any_of(options.results, is_kmall_name)) return import_column(options);
  const std::vector<std::filesystem::path> files = files_in_order(options.results);
  std::optional<std::filesystem::path> azimuths;
  if (options.azimuths.ends_with(".csv")) azimuths = options.azimuths;
  std::optional<SceneDescription> scene;
  Inputs inputs = files;
  if (azimuths) inputs.push_back(*azimuths);
  if (options.scene) {
    scene = read_scene_file(*options.scene, options.confined);
    if (!options.sensor && scene->sensors.size() > 1)
      throw UsageError(fmt::format("{} has {} sensors: choose the sensor of the pictures with --sensor",
                                   options.scene->string(), scene->sensors.size()));
    const Inputs of_scene = inputs_of(*scene);
    inputs.insert(inputs.end(), of_scene.begin(), of_scene.end());
  } else {
    inputs.push_back(*options.like);
  }
  std::optional<OutputModel> output_model;
  if (options.output_model) {
    output_model = read_output_model(*options.output_model);
    inputs.push_back(*options.output_model);
    if (output_model->solid_angles) inputs.push_back(*output_model->solid_angles);
  }
  OutputFile output(options.output, inputs);
  OriginalsFolder originals(options.output, inputs);
  std::optional<ImportReference> reference;
  const auto reference_of = [&](std::size_t pings) -> const ImportReference& {
    if (!scene) {
      reference.emplace(ImportReference{read_whole_echo_file(*options.like), 0});
    } else {
      const Staging staging(absolute_path(options.output), 0700);
      reference.emplace(ImportReference{truth_of_scene(*scene, options.sensor, pings, staging.path()), 0});
    }
    reference->sensor = sensor_of(reference->file, options.sensor);
    if (output_model) {
      EchoContents& truth = reference->file.contents;
      apply_output_model(*output_model, truth,
                         pair_echoes(truth, truth, truth.sensors.at(reference->sensor).name, true));
    }
    return *reference;
  };
  Imported result = imported(options, files, reference_of);
  result.candidate.attributes.emplace_back("import_originals", list_of(originals.keep(files, azimuths)));
  write_candidate(output.path(), result.candidate, reference->file, reference->sensor);
  originals.commit();
  output.commit();
  for (const std::string& words : result.warnings) say("warning: {}\n", words);
  if (options.output_model) tell("tested in the units of {}\n", options.output_model->string());
  for (const std::string& words : result.told) tell("read      {}\n", words);
  for (const std::string& words : result.found) tell("found     {}\n", words);
  const CandidateEchoes& candidate = result.candidate;
  tell("wrote {}: {} pings x {} beams x {} range bins; originals in {}\n", options.output.string(),
       candidate.pings, candidate.axes.beams.count(), candidate.axes.samples.count(),
       originals.path().string());
  return 0;
}

}  // namespace tubefoot
