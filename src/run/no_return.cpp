// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/no_return.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "run/paths.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission.hpp"
#include "run/water_targets.hpp"
#include "scene/extent.hpp"

// This file finds sensors that receive nothing, before a run from a few pings or after it from the
// recordings. It derives the reason from the positions of sensor, facets and range gate.

namespace tubefoot {
namespace {

/// Interval of distances to an object, in metres.
struct Span {
  double lo_m = std::numeric_limits<double>::infinity(), hi_m = -std::numeric_limits<double>::infinity();
  bool empty() const { return lo_m > hi_m; }
  void add(double m) {
    lo_m = std::min(lo_m, m);
    hi_m = std::max(hi_m, m);
  }
};

Span window_of(const Sensor& sensor) {
  const RangeSamples& samples = sensor.samples();
  // The receivers of a receiver pair are at some distance from the origin of the range.
  const double aside_m = sensor.receiver_pair().baseline_m / 2;
  return {samples.first_m - aside_m, samples.first_m + samples.step_m * samples.count + aside_m};
}

/// Returns whether the sensor may receive some of the footprints. A separate receiver has other ranges than
/// the transmitter.
bool receives(const Sensor& sensor, const History& history) {
  const Span window = window_of(sensor);
  return std::ranges::any_of(history.footprints.footprints, [&](const Footprint& footprint) {
    return sensor.has_separate_receiver() ||
           (footprint.slant_range_max_m >= window.lo_m && footprint.slant_range_min_m <= window.hi_m);
  });
}

/// Returns the middle, the first and the last ping, and then pings between them, at most `most` of all
/// pings.
std::vector<std::size_t> spread(std::size_t pings, std::size_t most) {
  std::vector<std::size_t> chosen{pings / 2, 0, pings - 1};
  for (std::size_t parts = 4; parts < 2 * most; parts *= 2)
    for (std::size_t k = 1; k < parts; k += 2) chosen.push_back(k * pings / parts);
  std::vector<std::size_t> once;
  for (const std::size_t ping : chosen)
    if (once.size() < most && std::ranges::find(once, ping) == once.end()) once.push_back(ping);
  return once;
}

TubeSet some_of(TubeSet set, std::size_t most) {
  const std::size_t step = set.tubes.size() / most + 1;
  std::vector<Tube> some;
  for (std::size_t t = 0; t < set.tubes.size(); t += step) some.push_back(set.tubes[t]);
  set.tubes = std::move(some);
  return set;
}

/// Removes those sensors from `silent` that receive a transmission.
void listen(const Transmission& transmission, std::vector<std::size_t>& silent) {
  const auto received_in = [&](const History& history) {
    std::erase_if(silent, [&](std::size_t s) { return receives(transmission.sensor(s), history); });
  };
  constexpr std::size_t few = 64;  // for most sensors, a few tubes are enough to receive something
  const TubeSet all = transmission.tubes();
  if (all.tubes.size() > few) received_in(transmission.trace(some_of(all, few)));
  if (!silent.empty()) received_in(transmission.trace(all));
}

/// Finds the reason why a sensor receives nothing at a ping.
class Reason {
 public:
  Reason(const Survey& survey, const RunRequest& request, std::size_t s, std::size_t ping)
      : survey_(survey),
        scene_(survey.scene),
        pings_(survey.sensors[s]),
        sensor_(*pings_.sensor),
        ping_(ping),
        at_m_(pings_.transmission_pose(ping, 0).position_m),
        tubes_(sensor_.transmit_tubes(pings_.transmission_pose(ping, 0), scene_.grid, 0)),
        all_(extent_of(scene_, Components::all)),
        terrain_(extent_of(scene_, Components::terrains)) {
    if (terrain_.empty()) terrain_ = all_;
    const glm::dvec3 far_m = glm::max(glm::abs(all_.lo_m - at_m_), glm::abs(all_.hi_m - at_m_));
    tubes_.reach = 1.01 * glm::length(far_m) / scene_.grid.unit_m() + 1;
    if (!survey.loaded_scene->is_tiled()) {
      const TransmissionSurface surface = surface_at(*survey.loaded_scene, pings_.times_s[ping]);
      for (const Footprint& footprint :
           TubeEngine(surface.mesh(), surface.tree(), scene_.grid.unit_m(), request.visibility)
               .trace(tubes_)
               .footprints.footprints) {
        met_.add(footprint.slant_range_min_m);
        met_.add(footprint.slant_range_max_m);
      }
    }
    for (const GridPoint& ray : tubes_.rays) {
      const glm::dvec3 direction(ray.x, ray.y, ray.z);
      elevation_.add(glm::degrees(std::asin(direction.z / glm::length(direction))));
      middle_ += glm::normalize(direction);
    }
  }

  std::string in_words() const {
    if (!met_.empty()) return of_window();
    const double beside_m = terrain_.distance_in_plan_m(at_m_);
    if (const auto words = of_frame(beside_m)) return *words;
    if (elevation_.lo_m >= 0 && all_.hi_m.z <= at_m_.z)
      return fmt::format(
          "it looks {}, but the whole scene lies below it: 'tilt_deg' is positive downwards; 'pitch_deg' and "
          "'roll_deg' rotate the carrier",
          look());
    if (beside_m > 0)
      return fmt::format(
          "it looks {}, but it is {:.4g} m outside of the terrain, which covers {}: move it over the "
          "terrain, or turn it",
          look(), beside_m, to_text(terrain_));
    if (const auto words = of_level_surface()) return *words;
    return fmt::format("it looks {}, and no facet is there{}; the terrain covers {}: turn it or move it",
                       look(), survey_.loaded_scene->is_tiled() ? " within its range gate" : "",
                       to_text(terrain_));
  }

  /// Returns the position of the sensor.
  std::string place() const {
    return fmt::format(
        "east {:.2f}, north {:.2f}, up {:.2f} m{}", at_m_.x, at_m_.y, at_m_.z,
        std::isnan(altitude_m()) ? std::string() : fmt::format(", {:.4g} m above the terrain", altitude_m()));
  }

 private:
  double altitude_m() const {
    return ping_ < pings_.altitudes_m.size() ? pings_.altitudes_m[ping_]
                                             : std::numeric_limits<double>::quiet_NaN();
  }

  std::string window() const {
    const RangeSamples& samples = sensor_.samples();
    return fmt::format("its range gate is {:.4g} to {:.4g} m: change the range gate or the position",
                       samples.first_m, samples.first_m + samples.step_m * samples.count);
  }

  std::string of_window() const {
    const Span window_m = window_of(sensor_);
    if (met_.lo_m <= window_m.hi_m && met_.hi_m >= window_m.lo_m)
      return fmt::format(
          "the facets in its beams are at ranges of {:.4g} to {:.4g} m, within its range gate, but return no "
          "energy: check 'absorption_db_per_km', the materials and the beam patterns",
          met_.lo_m, met_.hi_m);
    return fmt::format("the facets in its beams are at ranges of {:.4g} to {:.4g} m, but {}", met_.lo_m,
                       met_.hi_m, window());
  }

  /// Returns a reason for terrain that is read by tiles. It assumes a horizontal seabed at the altitude
  /// vertically below the sensor, because no tiles beyond those of the pings are read.
  std::optional<std::string> of_level_surface() const {
    if (!survey_.loaded_scene->is_tiled() || std::isnan(altitude_m()) || elevation_.lo_m >= 0)
      return std::nullopt;
    const auto range_m = [&](double elevation_deg) {
      return elevation_deg < 0 ? altitude_m() / std::sin(-glm::radians(elevation_deg))
                               : std::numeric_limits<double>::infinity();
    };
    const double nearest_m = range_m(elevation_.lo_m), farthest_m = range_m(elevation_.hi_m);
    const Span window_m = window_of(sensor_);
    if (nearest_m <= window_m.hi_m && farthest_m >= window_m.lo_m) return std::nullopt;
    return fmt::format("a horizontal seabed would be at ranges of {:.4g} m or more in its beams, but {}",
                       nearest_m, window());
  }

  /// Returns a reason if sensor and terrain have coordinates in two different frames.
  std::optional<std::string> of_frame(double beside_m) const {
    if (const std::optional<std::array<double, 2>>& origin =
            scene_.description.georeference ? scene_.description.georeference->origin_lat_lon_deg
                                            : std::nullopt;
        origin && beside_m > 0 && std::hypot((*origin)[1] - at_m_.x, (*origin)[0] - at_m_.y) < 1)
      return fmt::format(
          "its east {:.6g} and north {:.6g} look like longitude and latitude, but tubefoot reads them as "
          "metres from the origin of the local frame; the terrain covers {}: convert the positions to the "
          "local frame",
          at_m_.x, at_m_.y, to_text(terrain_));
    const std::string hint = mixed_frames(at_m_, terrain_);
    if (hint.empty()) return std::nullopt;
    return fmt::format("it is {:.4g} km from the terrain, which covers {}: {}", beside_m / 1000,
                       to_text(terrain_), hint);
  }

  std::string look() const {
    const double level = glm::length(glm::dvec2(middle_));
    const auto degrees = [](double value) { return fmt::format("{:.3g}", std::abs(value)); };
    std::string words =
        elevation_.lo_m >= 0
            ? fmt::format("{} to {} degrees up", degrees(elevation_.lo_m), degrees(elevation_.hi_m))
        : elevation_.hi_m <= 0
            ? fmt::format("{} to {} degrees down", degrees(elevation_.hi_m), degrees(elevation_.lo_m))
            : fmt::format("from {} degrees down to {} degrees up", degrees(elevation_.lo_m),
                          degrees(elevation_.hi_m));
    if (level > 0.1 * glm::length(middle_))
      words += fmt::format(", towards {:.0f} degrees (clockwise from north)",
                           std::fmod(glm::degrees(std::atan2(middle_.x, middle_.y)) + 360, 360.0));
    return words;
  }

  const Survey& survey_;
  const Scene& scene_;
  const SensorPings& pings_;
  const Sensor& sensor_;
  const std::size_t ping_;
  const glm::dvec3 at_m_;
  TubeSet tubes_;
  Extent all_, terrain_;
  Span met_, elevation_;  ///< elevation of its rays in degrees
  glm::dvec3 middle_{0};
};

/// `when`: " at any of 9 pings", or empty.
/// `requested`: the selected pings.
NoReturn no_return(const Survey& survey, const RunRequest& request, std::size_t s, PingSpan requested,
                   const std::string& when) {
  const SensorPings& pings = survey.sensors[s];
  const std::size_t ping = requested.first + (requested.end - requested.first) / 2;
  const Reason reason(survey, request, s, ping);
  return {s, fmt::format("{}: sensor '{}' receives nothing{}: at ping {} ({}) {}",
                         to_string(pings.sensor->description().place), pings.sensor->description().name, when,
                         ping, reason.place(), reason.in_words())};
}

bool has_facets(const Scene& scene) { return !scene.mesh.facets.empty() || !scene.tiled.empty(); }

bool is_silent(const Recording& recording) {
  for (std::size_t ping = 0; ping < recording.pings(); ++ping)
    for (std::size_t channel = 0; channel < recording.channels(); ++channel) {
      const PingEnergies kept = recording.channel_of(ping, channel);
      if (std::ranges::any_of(kept.values(), [](double e) { return e != 0; })) return false;
    }
  return true;
}

}  // namespace

std::vector<NoReturn> expected_no_returns(const Survey& survey, const RunRequest& request) {
  std::vector<NoReturn> found;
  if (!has_facets(survey.scene)) return found;  // another message reports this already
  // Sensors may receive sound without a facet.
  if (has_water_targets(survey.scene.description) || survey.scene.volume.any()) return found;
  const Transmissions transmissions(survey, request);
  TransmissionsAround around(transmissions);
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, request.selection);
  for (const SharedTransmissions& group : survey.transmissions) {
    std::vector<std::size_t> silent = group.sensors;
    std::erase_if(silent, [&](std::size_t s) {
      return chosen[s].pings == 0 ||
             path_settings(survey.scene, survey.sensors[s].sensor->frequency_khz()).has_value();
    });
    constexpr std::size_t most_pings = 33;
    constexpr std::chrono::seconds enough(3);
    const auto start = std::chrono::steady_clock::now();
    if (silent.empty()) continue;
    const std::size_t first = chosen[silent.front()].first_ping, pings = chosen[silent.front()].pings;
    std::size_t looked = 0;
    for (const std::size_t place : spread(pings, most_pings)) {
      const std::size_t ping = first + place;
      if (silent.empty() || (looked > 0 && std::chrono::steady_clock::now() - start > enough)) break;
      ++looked;
      for (std::size_t number = 0;
           number < survey.sensor_set->transmissions_per_ping(group) && !silent.empty(); ++number)
        listen(around.at(group, ping).of(group, ping, number), silent);
    }
    for (const std::size_t s : silent)
      found.push_back(no_return(survey, request, s, {first, first + pings},
                                pings == 1        ? std::string()
                                : looked == pings ? std::string(" at any ping")
                                                  : fmt::format(" at any of {} tested pings", looked)));
  }
  return found;
}

std::vector<NoReturn> met_no_returns(const Survey& survey, const RunRequest& request,
                                     const std::vector<Recording>& recordings) {
  std::vector<NoReturn> found;
  if (!has_facets(survey.scene)) return found;
  for (const Recording& recording : recordings) {
    if (!is_silent(recording)) continue;
    const SensorDescription& sensor = recording.sensor->description();
    const std::size_t s = survey.sensor_set->sensor_named(sensor.name);
    const std::size_t first = recording.number_of(0);
    if (!recording.beam_numbers
             .empty())  // other beams may receive something, so that the sensor itself is correct
      found.push_back(
          {s, fmt::format("{}: sensor '{}' receives nothing in the requested beams: all energies are 0",
                          to_string(sensor.place), sensor.name)});
    else
      found.push_back(no_return(survey, request, s, {first, first + recording.pings()},
                                recording.pings() == 1 ? "" : " at any ping: all energies are 0"));
  }
  return found;
}

}  // namespace tubefoot
