// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "app/commands.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "files/atomic_output.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/survey.hpp"

namespace tubefoot {

int export_command(const ExportOptions& options) {
  const ExchangeFormat format = exchange_format(options.to);
  const SceneDescription description = described(options);
  OutputFolder output(options.output, inputs_of(description));
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const ExchangedScene scene =
      exchanged_scene(*survey, options.sensor, static_cast<std::size_t>(options.ping));
  const WrittenScene written = write_scene(format, scene, output.staging());
  output.commit();
  if (!options.quiet) {
    for (const std::string& line : scene.left_out) say("left out: {}\n", line);
    for (const std::string& line : written.notes) say("different: {}\n", line);
  }
  tell("wrote {} ({} triangles in {} pieces, {} sonars; README.txt describes axes, poses and omissions)\n",
       (options.output / written.files.front()).string(), scene.triangles(), scene.pieces.size(),
       scene.sonars.size());
  return 0;
}

}  // namespace tubefoot
