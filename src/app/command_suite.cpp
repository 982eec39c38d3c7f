// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "app/commands.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "files/atomic_output.hpp"
#include "files/limits.hpp"
#include "files/staging.hpp"
#include "files/usage_error.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "suite/write_suite.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Writes the scene in the formats of other engines, into forms/sdf and similar folders.
void write_forms(const Survey& survey, const fs::path& folder) {
  const ExchangedScene scene = exchanged_scene(survey, {}, 0);
  for (const EngineAxes& form : engine_axes()) {
    const fs::path place = folder / "forms" / form.engine;
    make_folder(place);
    write_scene(exchange_format(form.engine), scene, place);
  }
}

}  // namespace

int suite_command(const SuiteOptions& options) {
  const SuiteVersion& version = suite_version(options.version.value_or(newest_suite));
  const SuiteRequest request{version, options.seed, aspects_named(version, options.scenes),
                             !options.without_answers, options.quiet};
  if (options.seed && (options.seed->empty() || options.seed->size() > limits::name_bytes))
    throw UsageError(
        fmt::format("--seed must have 1 to {} characters, not {}: choose a text that nobody knows yet",
                    limits::name_bytes, options.seed->size()));
  std::error_code ignored;
  if (fs::exists(options.output, ignored) && !fs::is_empty(options.output, ignored))
    throw UsageError(
        fmt::format("'{}' already exists: name a new or empty folder with -o", options.output.string()));
  OutputFolder output(options.output, {});
  const ThreadLimit limit(options.threads.value_or(0));
  const std::vector<WrittenSuiteScene> scenes = write_suite(output.staging(), request, write_forms);
  output.commit();
  for (const WrittenSuiteScene& scene : scenes) {
    if (options.quiet) break;
    const std::string answer = options.without_answers
                                   ? std::string()
                                   : fmt::format(", {} in {:.1f} s", scene.result, scene.seconds);
    const std::string wider =
        scene.bins_over > 0 ? fmt::format(", {} values with wider bounds than requested", scene.bins_over)
                            : std::string();
    tell("{:<17} {} facets{}{}\n", scene.aspect->name, scene.facets, answer, wider);
  }
  tell("wrote {}: {} of {} scenes\n", options.output.string(),
       options.seed ? "a validation set" : "the debug set", scenes.size());
  return 0;
}

}  // namespace tubefoot
