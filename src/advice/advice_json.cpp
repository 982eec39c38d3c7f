// SPDX-License-Identifier: GPL-3.0-or-later
#include "advice/advice_json.hpp"

#include <nlohmann/json.hpp>

#include "study/ping_spread.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Advice& advice, const Candidate& candidate) {
  Json json{{"engine", candidate.setting.engine}, {"setting", candidate.setting.setting}};
  json["options"] = command_options(candidate.setting.run);
  json["left_out"] = left_out_by(candidate.setting.run);
  json["predicted"] = {{"error", candidate.predicted_error}, {"seconds", candidate.predicted_seconds}};
  if (candidate.others)
    json["measured"] = {{"error", error_of(*candidate.others, advice.tolerance.measure)},
                        {"l1_error", candidate.others->l1_error},
                        {"rms_db_error", candidate.others->rms_db_error},
                        {"seconds", candidate.others->work.processor_seconds}};
  json["tried"] = candidate.tried;
  if (!candidate.note.empty()) json["note"] = candidate.note;
  json["holds"] = advice.holds(candidate);
  return json;
}

}  // namespace

nlohmann::ordered_json json_of(const Advice& advice, const SceneDescription& scene) {
  Json json{{"scene", scene.file.string()},
            {"scene_hash", scene.sha256},
            {"tolerance", to_text(advice.tolerance)},
            {"measure", advice.tolerance.measure == ErrorMeasure::l1 ? "l1_error" : "rms_db_error"},
            {"confidence", error_limit_confidence}};
  for (const LookedAt& s : advice.sensors)
    json["sensors"].push_back({{"name", s.sensor},
                               {"pings", s.pings},
                               {"probe_pings", s.probes},
                               {"measured_pings", s.others},
                               {"measured_pings_are_the_probes", s.others_are_probes}});
  json["silent_sensors"] = advice.silent;
  for (const Candidate& c : advice.candidates) json["candidates"].push_back(json_of(advice, c));
  json["cheapest"] = json_of(advice, advice.best());
  return json;
}

}  // namespace tubefoot
