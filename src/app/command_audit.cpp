// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/commands.hpp"
#include "engine/sight/tube_engine.hpp"
#include "files/usage_error.hpp"
#include "geometry/work/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/refraction.hpp"
#include "run/settings.hpp"
#include "run/shot_ground.hpp"
#include "run/survey.hpp"

namespace tubefoot {

int audit_command(const AuditOptions& options) {
  SceneDescription description = described(options);
  const ThreadLimit limit(description.run.threads);
  require_able(description, Feature::audit);
  const auto survey = open_survey(description);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const Scene& scene = survey->scene;
  const std::size_t only = options.sensor ? survey->sensor_named(*options.sensor) : 0;
  require_able(*survey, {Feature::audit}, options.sensor ? std::optional(only) : std::nullopt);
  const VisibilityOptions visibility = options_of(description.run);

  struct Shot {
    const SharedShots* group;
    std::size_t ping, shot;
    std::uint64_t label;  ///< of all three, so that a shot's share of the hash does not depend on what
                          ///< else is audited
  };
  std::vector<Shot> shots;
  for (const SharedShots& group : survey->shots) {
    if (options.sensor && std::find(group.sensors.begin(), group.sensors.end(), only) == group.sensors.end())
      continue;
    const PingRange range = resolved(options.pings, survey->pings(group));
    for (std::int64_t ping = range.first; ping <= range.last; ++ping)
      for (std::size_t shot = 0; shot < survey->shots_a_ping(group); ++shot)
        shots.push_back({&group, static_cast<std::size_t>(ping), shot,
                         (std::uint64_t{shot} << 40) |
                             (static_cast<std::uint64_t>(&group - survey->shots.data()) << 24) |
                             static_cast<std::uint64_t>(ping)});
  }

  std::size_t tubes = 0, pieces = 0, facets = 0, failures = 0;
  double worst = 0;
  TopologyHash hash;
  Progress progress("audited shots", shots.size(), options.quiet);
  for (std::size_t k = 0; k < shots.size(); ++k) {
    stop_if_wanted();
    const ShotGround ground = ground_of(*survey, *shots[k].group, shots[k].ping, shots[k].shot);
    const TubeEngine engine(ground.mesh(), ground.tree(), scene.grid.unit_m(), visibility);
    const TubeSet set = survey->tubes(*shots[k].group, shots[k].ping, shots[k].shot);
    const std::vector<TubeAudit> audits = engine.audit(set, shots[k].label);
    for (std::size_t tube = 0; tube < audits.size(); ++tube) {
      const TubeAudit& audit = audits[tube];
      ++tubes;
      pieces += audit.pieces;
      facets += audit.facets;
      hash += audit.hash;
      if (audit.closes) continue;
      if (++failures <= 10)
        say("sensor '{}', ping {}, shot {}, tube {}: off by {:.3e} of the tube\n",
            survey->sensors[shots[k].group->sensors.front()].sensor->description().name, shots[k].ping,
            shots[k].shot, tube, audit.defect);
      worst = std::max(worst, std::abs(audit.defect));
    }
    progress.step();
  }
  tell("arithmetic     {}\n", description.run.arithmetic);
  tell("shots          {}\n", shots.size());
  tell("tubes          {}\n", tubes);
  tell("footprints     {}\n", facets);
  tell("pieces         {}\n", pieces);
  tell("failures       {}\n", failures);
  if (failures > 0) tell("worst defect   {:.3e} of its tube\n", worst);
  tell("topology hash  {}\n", hash.hex());
  return failures == 0 ? 0 : 1;
}

}  // namespace tubefoot
