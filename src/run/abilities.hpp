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

// This header declares the table of features that cannot be combined. Every command reads this table, and
// docs/limits.md shows it.
namespace tubefoot {

struct RunRequest;
struct Survey;

/// Features of a scene, features that a run requests, and commands that can be applied to a scene.
enum class Feature : unsigned char {
  // features of a scene
  refraction,                ///< water whose sound speed varies
  mirrors,                   ///< paths over mirrors, and paths with two scatterings
  separate_receiver,         ///< a receiver that is separate from its transmitter
  motion,                    ///< a receiver that moves during a ping
  two_receivers,             ///< two receivers, one above the other, for phase differences
  signals,                   ///< signals of array elements, with phase
  tiles,                     ///< terrain of which only parts are in memory
  relief,                    ///< relief by which facets are refined, once or for each transmission
  relief_each_transmission,  ///< relief that is refined again for each transmission
  scattering_model,          ///< a scattering model other than Lambert's law
  micro_texture,
  unbounded_texture,  ///< a micro-texture of the user without a certified enclosure
  inclined_mirrors,   ///< facets that are mirrors and are not horizontal
  scatterings,        ///< more than one scattering on a path
  moving_objects,     ///< objects on trajectories
  volume,             ///< scattering in the water
  water_targets,      ///< targets in the water
  fresnel_borders,    ///< a sensor with shadow = "fresnel"
  sea_waves,          ///< a sea surface with facets, which moves as waves
  // features of a run
  reference,
  double_arithmetic,
  fast_binning,
  rays,
  own_engine,
  labels,
  coarsening,
  gradient,
  // commands
  audit,
  coverage,
  view,
  footprints,
  exact_corners,
  refine,
  trial,         ///< trials of settings: chart, advise, --tolerance
  transmission,  ///< a transmission that the Python module traces individually
};
inline constexpr int features = static_cast<int>(Feature::transmission) + 1;

/// Returns the name that docs/limits.md uses.
std::string_view name_of(Feature feature);

/// Two features that cannot be combined, the reason, and a remedy.
struct Refusal {
  Feature first, second;
  /// further features that must be present, too, for the refusal to apply
  std::array<std::optional<Feature>, 2> more;
  std::string_view reason;
};
std::span<const Refusal> refusals();

/// The first refusal of the table that applies to a scene, and the place of the feature that causes it.
struct Refused {
  const Refusal* refusal;
  SourcePlace place;  ///< place of the scene's feature in the scene file
  std::string what;   ///< sentence for the message: "sensor 'a' has its separate receiver, and ..."
  bool requested;     ///< true if the command requests the feature, false if the scene has it
};
std::optional<Refused> refused(const Survey& survey, std::span<const Feature> requested,
                               std::optional<std::size_t> sensor = {});

/// Returns the features that a run requests.
std::vector<Feature> requested_by(const RunRequest& request);

/// Throws InputError at the place of the scene's feature, or UsageError if the command requests the feature.
/// With `sensor`, only the features of this sensor count.
void require_able_to_run(const Survey& survey, const RunRequest& request);
void require_able(const Survey& survey, const RunRequest& request, Feature requested,
                  std::optional<std::size_t> sensor = {});
/// Checks the command line alone, before the scene is opened.
void require_able(const RunRequest& request, Feature requested);

}  // namespace tubefoot
