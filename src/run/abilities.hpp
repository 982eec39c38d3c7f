// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"
#include "scene/description/run_description.hpp"

// What can be combined: one table, which every command reads and docs/abilities.md shows.
namespace tubefoot {

struct RunRequest;
struct Survey;

/// What a scene may have, what a run of it may ask for, and what else may be done with it.
enum class Feature : unsigned char {
  // of a scene
  refraction,                ///< water whose sound speed varies
  mirrors,                   ///< paths over mirrors, and of two scatterings
  separate_receiver,         ///< from its transmitter
  two_receivers,             ///< one above the other, for phases
  signals,                   ///< of elements, with phase
  tiles,                     ///< terrain of which only parts are in memory
  relief,                    ///< that facets are refined by, once or for each transmission
  relief_each_transmission,  ///< relief that is refined anew for each transmission
  scattering_model,          ///< another than Lambert's
  micro_texture,
  unbounded_texture,  ///< a micro-texture of one's own, that has no enclosure
  inclined_mirrors,   ///< facets that mirror and are not level
  scatterings,        ///< more than one on a path
  // of a run
  reference,
  double_arithmetic,
  fast_binning,
  rays,
  own_engine,
  labels,
  coarsening,
  // commands
  audit,
  coverage,
  view,
  footprints,
  exact_corners,
  refine,
  trial,         ///< of settings: chart, advise, --tolerance
  transmission,  ///< of the Python module, traced by itself
};
inline constexpr int features = static_cast<int>(Feature::transmission) + 1;

/// As in docs/abilities.md.
std::string_view name_of(Feature feature);

/// Features that do not go together, why, and what to do about it.
struct Refusal {
  Feature first, second;
  std::array<std::optional<Feature>, 2> more;  ///< that have to be there as well
  std::string_view reason;
};
std::span<const Refusal> refusals();

/// What of the table applies to a scene: the first refusal, and whose feature it is.
struct Refused {
  const Refusal* refusal;
  SourcePlace place;  ///< of the scene's feature
  std::string what;   ///< the sentence: "sensor 'a' has its separate receiver, and ..."
  bool requested;     ///< by the command, not by the scene
};
std::optional<Refused> refused(const Survey& survey, std::span<const Feature> requested,
                               std::optional<std::size_t> sensor = {});

/// What a run asks for.
std::vector<Feature> requested_by(const RunRequest& request);

/// Throw InputError at the scene's feature, or UsageError for what the command asks. Of one sensor where only
/// that is looked at.
void require_able_to_run(const Survey& survey, const RunRequest& request);
void require_able(const Survey& survey, const RunRequest& request, Feature requested,
                  std::optional<std::size_t> sensor = {});
/// Before the scene is opened: of what the command line says already.
void require_able(const RunRequest& request, Feature requested);

}  // namespace tubefoot
