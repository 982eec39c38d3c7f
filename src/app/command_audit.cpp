// SPDX-License-Identifier: GPL-3.0-or-later
// The command `audit`. It audits each selected transmission: the visible polygons and the unobstructed
// region of each tube must add up to the tube. For separate receivers and mirror images it also audits the
// parts of facets that both ends see. It prints the counts, the largest defect and a hash of the
// combinatorics.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "app/commands.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission_ends.hpp"
#include "run/transmission_images.hpp"

namespace tubefoot {

int audit_command(const AuditOptions& options) {
  SceneDescription description = described(options);
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const std::size_t only = options.sensor ? survey->sensor_set->sensor_named(*options.sensor) : 0;
  const Transmissions all(*survey, request_of(description.run));
  require_able(*survey, all.request(), Feature::audit, options.sensor ? std::optional(only) : std::nullopt);

  struct RequestedTransmission {
    const SharedTransmissions* group;
    std::size_t ping, transmission;
    std::uint64_t label;  ///< identifies group, ping and transmission, so that the hash of a transmission
                          ///< does not depend on the other audited transmissions
  };
  std::vector<RequestedTransmission> transmissions;
  for (const SharedTransmissions& group : survey->transmissions) {
    if (options.sensor && std::find(group.sensors.begin(), group.sensors.end(), only) == group.sensors.end())
      continue;
    const PingRange range = resolved(options.pings, survey->sensor_set->pings(group));
    for (std::int64_t ping = range.first; ping <= range.last; ++ping)
      for (std::size_t transmission = 0; transmission < survey->sensor_set->transmissions_per_ping(group);
           ++transmission)
        transmissions.push_back(
            {&group, static_cast<std::size_t>(ping), transmission,
             (std::uint64_t{transmission} << 40) |
                 (static_cast<std::uint64_t>(&group - survey->transmissions.data()) << 24) |
                 static_cast<std::uint64_t>(ping)});
  }

  std::size_t tubes = 0, pieces = 0, facets = 0, shared_facets = 0, shared_pieces = 0, failures = 0,
              images = 0, pairs = 0;
  double worst = 0;
  TopologyHash hash;
  bool has_shared = false;  // whether parts of facets that two ends or two images see were audited
  const auto fail = [&](const Transmission& transmission, const std::string& what, double defect,
                        const char* whole) {
    if (++failures <= 10)
      say("sensor '{}', ping {}, transmission {}, {}: the areas differ by {:.3e} of {}\n",
          transmission.pings().sensor->description().name, transmission.ping(), transmission.number(), what,
          defect, whole);
    worst = std::max(worst, std::abs(defect));
  };
  const auto add_tubes = [&](const Transmission& transmission, const char* of_whom,
                             const std::vector<TubeAudit>& audits) {
    for (std::size_t tube = 0; tube < audits.size(); ++tube) {
      const TubeAudit& audit = audits[tube];
      ++tubes;
      pieces += audit.pieces;
      facets += audit.facets;
      hash += audit.hash;
      if (!audit.closes)
        fail(transmission, fmt::format("{}tube {}", of_whom, tube), audit.defect, "the tube");
    }
  };
  const auto add_shared = [&](const Transmission& transmission, const char* who,
                              const std::vector<SharedAudit>& audits) {
    for (const SharedAudit& shared : audits) {
      shared_facets += shared.pieces > 0;
      shared_pieces += shared.pieces;
      hash += shared.hash;
      if (!shared.closes)
        fail(transmission, fmt::format("common visibility of {}", who), shared.defect, "a facet");
    }
  };
  const auto add_paths = [&](const Transmission& transmission, const PathAudit& paths) {
    has_shared = true;
    images += paths.images.size();
    pairs += paths.pairs;
    for (const ImageAudit& image : paths.images) {
      const std::string whose =
          fmt::format("image of the {} in {} mirror{}", image.of_receiver ? "receiver" : "transmitter",
                      image.mirrors, image.mirrors == 1 ? "" : "s");
      add_tubes(transmission, (whose + ", ").c_str(), image.windows);
      if (!image.fills())
        fail(transmission, whose + ", windows", (image.windows_sr - image.mirror_sr) / image.mirror_sr,
             "the visible part of the mirror");
    }
    add_shared(transmission, "two images", paths.shared);
  };
  TransmissionsAround around(all);
  Progress progress("audited transmissions", transmissions.size(), options.quiet);
  for (const RequestedTransmission& requested : transmissions) {
    stop_if_wanted();
    const Transmission transmission = around.at(*requested.group, requested.ping)
                                          .of(*requested.group, requested.ping, requested.transmission);
    if (transmission.has_separate_receiver()) {
      has_shared = true;
      const BistaticAudit audit = TransmissionEnds(transmission, transmission.first()).audit(requested.label);
      add_tubes(transmission, "transmitter's ", audit.transmit);
      add_tubes(transmission, "receiver's ", audit.receive);
      add_shared(transmission, "both ends", audit.shared);
    } else {
      add_tubes(transmission, "", transmission.audit(requested.label));
    }
    audit_paths(transmission, requested.label,
                [&](const PathAudit& paths) { add_paths(transmission, paths); });
    progress.step();
  }
  tell("arithmetic     {}\n", description.run.arithmetic);
  tell("transmissions  {}\n", transmissions.size());
  tell("tubes          {}\n", tubes);
  tell("footprints     {}\n", facets);
  tell("pieces         {}\n", pieces);
  if (pairs > 0) {
    tell("images         {}\n", images);
    tell("image pairs    {}\n", pairs);
  }
  if (has_shared) {
    tell("shared facets  {}\n", shared_facets);
    tell("shared pieces  {}\n", shared_pieces);
  }
  tell("failures       {}\n", failures);
  if (failures > 0) tell("worst defect   {:.3e} of the {}\n", worst, has_shared ? "tube or facet" : "tube");
  tell("topology hash  {}\n", hash.hex());
  return failures == 0 ? 0 : 1;
}

}  // namespace tubefoot
