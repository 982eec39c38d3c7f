// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/echo/echo.hpp"
#include "engine/echo/staff_echo.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/sight/tube_engine.hpp"
#include "run/run_request.hpp"
#include "run/sensor_law.hpp"
#include "run/shot_ground.hpp"
#include "run/survey.hpp"

// The one way from a survey to what a transmission meets and returns: whatever computes, proves, draws or
// writes a ping asks its shots.
namespace tubefoot {

class Shot;
class Truth;

/// The shots of a survey, as one run asks for them, and what they share. Thread-safe.
class Shots {
 public:
  Shots(Survey survey, RunRequest request);
  ~Shots();
  Shots(const Shots&) = delete;
  Shots& operator=(const Shots&) = delete;

  const Survey& survey() const { return survey_; }
  const RunRequest& request() const { return request_; }
  /// Null where it is not asked for.
  const Truth* truth() const { return truth_.get(); }
  /// Shot `number` of a ping of one of the survey's groups. This outlives it.
  Shot of(const SharedShots& group, std::size_t ping, std::size_t number) const;
  /// The one that a sensor takes part in.
  Shot heard_by(std::size_t sensor, std::size_t ping, std::size_t number) const;

 private:
  friend class Shot;
  const Survey survey_;
  const RunRequest request_;
  const ShotGround whole_;   ///< the site's own facets
  const TubeEngine engine_;  ///< of these: keeps its threads' buffers from shot to shot
  const std::unique_ptr<const Truth> truth_;
};

/// One transmission of the sensors of a group. Its ground is made when it is first asked for, by one thread,
/// and kept.
class Shot {
 public:
  Shot(const Shots& shots, const SharedShots& group, std::size_t ping, std::size_t number);
  Shot(const Shot&) = delete;
  Shot& operator=(const Shot&) = delete;

  const Survey& survey() const { return shots_.survey_; }
  const Site& site() const { return *survey().site; }
  const Scene& scene() const { return survey().scene; }
  const RunRequest& request() const { return shots_.request_; }
  const Truth* truth() const { return shots_.truth(); }
  const SharedShots& group() const { return group_; }
  std::size_t ping() const { return ping_; }
  std::size_t number() const { return number_; }
  /// "shot 0 of ping 3 of sensor 'a'", for messages.
  std::string name() const;

  /// Of the group's first sensor: places, times and tubes are all its sensors'.
  std::size_t first() const { return group_.sensors.front(); }
  const SensorPings& pings() const { return survey().sensors[first()]; }
  const Sensor& sensor(std::size_t s) const { return *survey().sensors[s].sensor; }
  const Pose& pose() const { return pings().shot_pose(ping_, number_); }
  const Pose& receiver_pose() const { return pings().receiver_pose(ping_, number_); }
  /// A receiver that is apart shares its shots with nobody.
  bool has_receiver_apart() const { return pings().sensor->has_receiver_apart(); }
  /// The shortest range sample of its sensors'.
  double sample_length_m() const;

  /// With the largest reach of its sensors.
  TubeSet tubes() const;
  /// As one of its sensors sends them, with its own reach.
  TubeSet tubes_of(std::size_t sensor) const;
  /// Those that a sensor receives in: the same tubes, unless its receiver is apart.
  TubeSet receive_tubes(std::size_t sensor) const;
  /// What it asks of relief that is refined for it, by its tubes (two sets where the receiver is apart),
  /// which outlive the looks.
  std::vector<Look> looks(std::span<const TubeSet> tubes) const;
  /// The facets that it meets, for all its sensors, and for a receiver that is apart. Throws InputError where
  /// that takes too many.
  const ShotGround& ground() const;
  /// How a sensor hears the ground.
  SensorLaw law(std::size_t sensor) const { return {*this, ground(), sensor}; }

  /// What its tubes see, those that are `wanted`, or others from the same place (TubeEngine).
  History trace(std::size_t* candidates = nullptr, bool measured = true,
                const std::vector<bool>& wanted = {}) const;
  History trace(TubeSet tubes, std::size_t* candidates = nullptr, bool measured = true) const;
  /// What transmitter and receiver, apart, both see in even water.
  BistaticHistory trace_both() const;
  /// The same by rays, in portions.
  void trace_rays_of_both(const RayScene& scene, const RaySettings& settings,
                          const std::function<void(const BistaticHistory&)>& take) const;
  /// What a fan's transmitter and the two receivers on its staff see.
  StaffHistory trace_staff(std::size_t sensor, std::uint32_t fan, const Fringe& staff) const;
  /// The closure law for each of its tubes; `label` tells shots apart in the hash.
  std::vector<TubeAudit> audit(std::uint64_t label) const;

  /// The beams of a shot that a sensor hears in (Sensor::beams_of_shot).
  int beams(std::size_t s) const { return static_cast<int>(sensor(s).beams_of_shot(number_).size()); }
  /// Which beams hear what; `fans`, which outlives it, is the sensor's fan_of_tube().
  ReceiveBeams beams_by_fans(std::size_t sensor, const std::vector<std::uint32_t>& fans) const;
  /// What a sensor hears of what is seen, by a law of this shot.
  Echo echo(const Sight& sight, std::size_t sensor, const EchoLaw& law) const;
  StaffEcho echo(const StaffHistory& history, std::size_t sensor, std::uint32_t fan,
                 const SensorLaw& law) const;

 private:
  const TubeEngine& engine() const;

  const Shots& shots_;
  const SharedShots& group_;
  std::size_t ping_, number_;
  mutable std::optional<ShotGround> ground_;
  mutable std::optional<TubeEngine> own_engine_;  ///< of ground of its own
};

}  // namespace tubefoot
