// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/echo/echo.hpp"
#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "run/run_request.hpp"
#include "run/sensor_model.hpp"
#include "run/survey.hpp"
#include "run/transmission_surface.hpp"

// The one way from a survey to what a transmission meets and returns: whatever computes, proves, draws or
// writes a ping asks its transmissions.
namespace tubefoot {

class Transmission;
class LabelChannels;

/// The transmissions of a survey, as one run asks for them, and what they share. Thread-safe.
class Transmissions {
 public:
  Transmissions(Survey survey, RunRequest request);
  ~Transmissions();
  Transmissions(const Transmissions&) = delete;
  Transmissions& operator=(const Transmissions&) = delete;

  const Survey& survey() const { return survey_; }
  const RunRequest& request() const { return request_; }
  /// Null where it is not asked for.
  const LabelChannels* labels() const { return labels_.get(); }
  /// Transmission `number` of a ping of one of the survey's groups. This outlives it.
  Transmission of(const SharedTransmissions& group, std::size_t ping, std::size_t number) const;
  /// The one that a sensor takes part in.
  Transmission received_by(std::size_t sensor, std::size_t ping, std::size_t number) const;

 private:
  friend class Transmission;
  const Survey survey_;
  const RunRequest request_;
  const TransmissionSurface whole_;  ///< the loaded scene's own facets
  const TubeEngine engine_;  ///< of these: keeps its threads' buffers from transmission to transmission
  const std::unique_ptr<const LabelChannels> labels_;
};

/// One transmission of the sensors of a group. Its ground is made when it is first asked for, by one thread,
/// and kept.
class Transmission {
 public:
  Transmission(const Transmissions& transmissions, const SharedTransmissions& group, std::size_t ping,
               std::size_t number);
  Transmission(const Transmission&) = delete;
  Transmission& operator=(const Transmission&) = delete;

  const Survey& survey() const { return transmissions_.survey_; }
  const LoadedScene& loaded_scene() const { return *survey().loaded_scene; }
  const Scene& scene() const { return survey().scene; }
  const RunRequest& request() const { return transmissions_.request_; }
  const LabelChannels* labels() const { return transmissions_.labels(); }
  const SharedTransmissions& group() const { return group_; }
  std::size_t ping() const { return ping_; }
  std::size_t number() const { return number_; }
  /// "transmission 0 of ping 3 of sensor 'a'", for messages.
  std::string name() const;

  /// Of the group's first sensor: places, times and tubes are all its sensors'.
  std::size_t first() const { return group_.sensors.front(); }
  const SensorPings& pings() const { return survey().sensors[first()]; }
  const Sensor& sensor(std::size_t s) const { return *survey().sensors[s].sensor; }
  const Pose& pose() const { return pings().transmission_pose(ping_, number_); }
  const Pose& receiver_pose() const { return pings().receiver_pose(ping_, number_); }
  /// A receiver that is apart shares its transmissions with nobody.
  bool has_separate_receiver() const { return pings().sensor->has_separate_receiver(); }
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
  const TransmissionSurface& surface_mesh() const;
  /// How a sensor receives the surface.
  SensorModel model(std::size_t sensor) const { return {*this, surface_mesh(), sensor}; }

  /// What its tubes see, those that are `wanted`, or others from the same place (TubeEngine).
  History trace(std::size_t* candidates = nullptr, bool measured = true,
                const std::vector<bool>& wanted = {}) const;
  History trace(TubeSet tubes, std::size_t* candidates = nullptr, bool measured = true) const;
  /// What transmitter and receiver, apart, both see in isovelocity water.
  BistaticHistory trace_both() const;
  /// The same by rays, in portions.
  void trace_rays_of_both(const RayScene& scene, const RaySettings& settings,
                          const std::function<void(const BistaticHistory&)>& take) const;
  /// What a fan's transmitter and the two receivers on its receiver pair see.
  ReceiverPairHistory trace_receiver_pair(std::size_t sensor, std::uint32_t fan,
                                          const ReceiverBaseline& receiver_pair) const;
  /// The closure law for each of its tubes; `label` tells transmissions apart in the hash.
  std::vector<TubeAudit> audit(std::uint64_t label) const;

  /// The beams of a transmission that a sensor receives in (Sensor::beams_of_transmission).
  int beams(std::size_t s) const { return static_cast<int>(sensor(s).beams_of_transmission(number_).size()); }
  /// Which beams receive what; `fans`, which outlives it, is the sensor's fan_of_tube().
  ReceiveBeams beams_by_fans(std::size_t sensor, const std::vector<std::uint32_t>& fans) const;
  /// What a sensor receives of what is seen, by a law of this transmission.
  Echo echo(const CommonVisibility& visibility, std::size_t sensor, const EchoModel& model) const;
  ReceiverPairEcho echo(const ReceiverPairHistory& history, std::size_t sensor, std::uint32_t fan,
                        const SensorModel& model) const;

 private:
  const TubeEngine& engine() const;

  const Transmissions& transmissions_;
  const SharedTransmissions& group_;
  std::size_t ping_, number_;
  mutable std::optional<TransmissionSurface> surface_mesh_;
  mutable std::optional<TubeEngine> own_engine_;  ///< of ground of its own
};

}  // namespace tubefoot
