// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/commands.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/shot.hpp"
#include "run/tiles_in_view.hpp"

namespace tubefoot {

int audit_command(const AuditOptions& options) {
  SceneDescription description = described(options);
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const std::size_t only = options.sensor ? survey->fleet->sensor_named(*options.sensor) : 0;
  const Shots all(*survey, request_of(description.run));
  require_able(*survey, all.request(), Feature::audit, options.sensor ? std::optional(only) : std::nullopt);

  struct Asked {
    const SharedShots* group;
    std::size_t ping, shot;
    std::uint64_t label;  ///< of all three, so that a shot's share of the hash does not depend on what
                          ///< else is audited
  };
  std::vector<Asked> shots;
  for (const SharedShots& group : survey->shots) {
    if (options.sensor && std::find(group.sensors.begin(), group.sensors.end(), only) == group.sensors.end())
      continue;
    const PingRange range = resolved(options.pings, survey->fleet->pings(group));
    for (std::int64_t ping = range.first; ping <= range.last; ++ping)
      for (std::size_t shot = 0; shot < survey->fleet->shots_a_ping(group); ++shot)
        shots.push_back({&group, static_cast<std::size_t>(ping), shot,
                         (std::uint64_t{shot} << 40) |
                             (static_cast<std::uint64_t>(&group - survey->shots.data()) << 24) |
                             static_cast<std::uint64_t>(ping)});
  }

  std::size_t tubes = 0, pieces = 0, facets = 0, failures = 0;
  double worst = 0;
  TopologyHash hash;
  ShotsAround around(all);
  Progress progress("audited shots", shots.size(), options.quiet);
  for (const Asked& asked : shots) {
    stop_if_wanted();
    const Shot shot = around.at(*asked.group, asked.ping).of(*asked.group, asked.ping, asked.shot);
    const std::vector<TubeAudit> audits = shot.audit(asked.label);
    for (std::size_t tube = 0; tube < audits.size(); ++tube) {
      const TubeAudit& audit = audits[tube];
      ++tubes;
      pieces += audit.pieces;
      facets += audit.facets;
      hash += audit.hash;
      if (audit.closes) continue;
      if (++failures <= 10)
        say("sensor '{}', ping {}, shot {}, tube {}: off by {:.3e} of the tube\n",
            shot.pings().sensor->description().name, asked.ping, asked.shot, tube, audit.defect);
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
