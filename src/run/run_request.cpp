// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_request.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "files/usage_error.hpp"
#include "scene/description/scene_description.hpp"

namespace tubefoot {
namespace {

Engine engine_from_name(std::string_view name) {
  for (const Engine engine : {Engine::tube, Engine::ray})
    if (name_of(engine) == name) return engine;
  throw std::invalid_argument(fmt::format("unknown engine '{}'", name));
}

/// Returns the result of `make`, and converts its exceptions about unknown texts to UsageError.
template <class Make>
RunRequest of_words(const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

std::string_view name_of(Engine engine) { return engine == Engine::tube ? "tube" : "ray"; }

RunRequest request_of(const RunDescription& run) {
  return of_words([&] {
    RunRequest request;
    request.engine = engine_from_name(run.engine);
    request.visibility.arithmetic = arithmetic_from_name(run.arithmetic);
    request.visibility.facets_per_split = static_cast<std::uint32_t>(run.facets_per_split);
    request.visibility.tolerance = run.zero_tolerance;
    request.binning = binning_from_name(run.binning);
    request.rays = {ray_sampling_from_name(run.sampling), run.rays_per_beam.value_or(run.rays_per_ping),
                    run.rays_per_beam ? RaySettings::Per::beam : RaySettings::Per::ping, run.seed};
    return request;
  });
}

nlohmann::ordered_json json_of(const RunRequest& request) {
  const bool by_beam = request.rays.per == RaySettings::Per::beam;
  nlohmann::ordered_json json{{"engine", name_of(request.engine)},
                              {"arithmetic", name_of(request.visibility.arithmetic)},
                              {"binning", name_of(request.binning)},
                              {"facets_per_split", request.visibility.facets_per_split},
                              {"zero_tolerance", request.visibility.tolerance},
                              {"sampling", name_of(request.rays.sampling)},
                              {by_beam ? "rays_per_beam" : "rays_per_ping", request.rays.rays},
                              {"seed", request.rays.seed}};
  if (request.labels) {
    json["labels"] = true;
    json["label_level_db"] = request.label_level_db;
  }
  if (request.coarseness > 0) json["coarsen"] = request.coarseness;
  if (!request.gradient.empty()) json["gradient"] = request.gradient;
  if (request.gradient_steps) json["gradient_steps"] = true;
  return json;
}

RunRequest request_of(const nlohmann::ordered_json& settings, RunRequest otherwise) {
  return of_words([&] {
    RunRequest request = std::move(otherwise);
    request.engine = engine_from_name(settings.at("engine").get<std::string>());
    request.visibility.arithmetic = arithmetic_from_name(settings.at("arithmetic").get<std::string>());
    request.visibility.facets_per_split = settings.at("facets_per_split");
    request.visibility.tolerance = settings.at("zero_tolerance");
    request.binning = binning_from_name(settings.at("binning").get<std::string>());
    const bool by_beam = settings.contains("rays_per_beam");
    request.rays = {ray_sampling_from_name(settings.at("sampling").get<std::string>()),
                    settings.at(by_beam ? "rays_per_beam" : "rays_per_ping"),
                    by_beam ? RaySettings::Per::beam : RaySettings::Per::ping, settings.at("seed")};
    // Files of earlier versions have the name "truth".
    request.labels = settings.value("labels", settings.value("truth", false));
    request.label_level_db = settings.value("label_level_db", request.label_level_db);
    request.coarseness = settings.value("coarsen", 0.0);
    request.gradient = settings.value("gradient", std::vector<std::string>());
    request.gradient_steps = settings.value("gradient_steps", false);
    return request;
  });
}

}  // namespace tubefoot
