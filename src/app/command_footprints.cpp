// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "app/commands.hpp"
#include "app/footprint_file.hpp"
#include "app/interrupt.hpp"
#include "app/progress.hpp"
#include "app/refraction.hpp"
#include "app/settings.hpp"
#include "app/shot_ground.hpp"
#include "app/survey.hpp"
#include "app/usage_error.hpp"
#include "engine/tube_engine.hpp"

namespace tubefoot {
namespace fs = std::filesystem;

int footprints_command(const FootprintOptions& options) {
  const SceneDescription description = described(options);
  if (fs::is_directory(options.output))
    throw UsageError(fmt::format("'{}' is a folder: name a file with -o", options.output.string()));
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  const Scene& scene = survey->scene;
  refuse_refraction(*survey, false);
  print_warnings(scene.report.warnings, options.quiet);
  const std::size_t index = survey->sensor_named(options.sensor);
  const SensorPings& pings = survey->sensors[index];
  const PingRange range = resolved(options.pings, pings.times_s.size());

  VisibilityOptions visibility;
  visibility.arithmetic = arithmetic_from_name(description.run.arithmetic);
  const SharedShots& group =
      *std::find_if(survey->shots.begin(), survey->shots.end(), [&](const SharedShots& g) {
        return std::find(g.sensors.begin(), g.sensors.end(), index) != g.sensors.end();
      });
  // Written beside its place and moved there when complete, so that an earlier file is not lost to a failed
  // run.
  fs::path partial = options.output;
  partial.replace_filename(".partial-" + options.output.filename().string());
  fs::remove(partial);
  struct Remover {
    const fs::path& file;
    ~Remover() {
      std::error_code ignored;
      fs::remove(file, ignored);
    }
  } remover{partial};
  const InterruptGuard interrupt;
  std::size_t footprints = 0;
  {
    FootprintFile file(partial, survey->relief.cell_m > 0 || scene.water->refracts());
    Progress progress("pings", static_cast<std::size_t>(range.last - range.first + 1), options.quiet);
    for (auto ping = static_cast<std::size_t>(range.first); ping <= static_cast<std::size_t>(range.last);
         ++ping) {
      if (InterruptGuard::requested()) throw std::runtime_error("interrupted: nothing was written");
      for (std::size_t shot = 0; shot < pings.sensor->shots(); ++shot) {
        const ShotGround ground = ground_of(*survey, group, ping, shot);
        const TubeEngine engine(ground.mesh(), ground.tree(), scene.grid.unit_m(), visibility);
        const History history =
            engine.trace(pings.sensor->tubes(pings.shot_pose(ping, shot), scene.grid, shot));
        std::vector<std::uint32_t> beam_of_tube;
        for (const std::uint32_t beam : pings.sensor->beam_of_tube(shot))
          beam_of_tube.push_back(pings.sensor->beams_of_shot(shot)[beam]);
        file.add(scene, ground, history, beam_of_tube, ping);
        footprints += history.footprints.footprints.size();
      }
      progress.step();
    }
    file.close();
  }
  fs::rename(partial, options.output);
  fmt::print("wrote {} ({} footprints)\n", options.output.string(), footprints);
  return 0;
}

}  // namespace tubefoot
