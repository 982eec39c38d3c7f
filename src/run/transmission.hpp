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
#include "run/survey.hpp"
#include "run/transmission_surface.hpp"

// This header declares the only interface from a survey to the surface and the echoes of a transmission. All
// code that computes, certifies, draws or writes a ping uses its transmissions.
namespace tubefoot {

class Transmission;
class LabelChannels;

/// The echo model of a sensor at a transmission, and the beam patterns to which it refers. The loaded scene
/// and the objects to which the surface mesh refers must outlive it.
struct SensorModel {
  /// On an apparent surface, the baselines of receiver pairs are longer by the factor that
  /// integrate_receiver_pair_echo() requires.
  SensorModel(const Transmission& transmission, const TransmissionSurface& surface_mesh, std::size_t sensor);
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;

  EchoModel model;
  BeamPatterns patterns;
  std::vector<FacetMap> facet_maps;
};

/// The transmissions of a survey for one run, and the objects that they share. Thread-safe.
class Transmissions {
 public:
  Transmissions(Survey survey, RunRequest request);
  ~Transmissions();
  Transmissions(const Transmissions&) = delete;
  Transmissions& operator=(const Transmissions&) = delete;

  const Survey& survey() const { return survey_; }
  const RunRequest& request() const { return request_; }
  /// Returns the channels of the labels; null if the run does not request labels.
  const LabelChannels* labels() const { return labels_.get(); }
  /// Returns transmission `number` of a ping of one of the survey's groups. This object must outlive it.
  Transmission of(const SharedTransmissions& group, std::size_t ping, std::size_t number) const;
  /// Returns a transmission that a sensor receives.
  Transmission received_by(std::size_t sensor, std::size_t ping, std::size_t number) const;

 private:
  friend class Transmission;
  const Survey survey_;
  const RunRequest request_;
  const TransmissionSurface whole_;  ///< the facets of the loaded scene itself
  /// engine for these facets, which keeps its threads' buffers from transmission to transmission
  const TubeEngine engine_;
  const std::unique_ptr<const LabelChannels> labels_;
};

/// One transmission of the sensors of a group. The first call of surface_mesh() makes its surface mesh,
/// which the transmission then keeps. That call must come from one thread.
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
  /// Returns "transmission 0 of ping 3 of sensor 'a'", for messages.
  std::string name() const;

  /// Returns the first sensor of the group. Positions, times and tubes are the same for all its sensors.
  std::size_t first() const { return group_.sensors.front(); }
  const SensorPings& pings() const { return survey().sensors[first()]; }
  const Sensor& sensor(std::size_t s) const { return *survey().sensors[s].sensor; }
  const SteeredPose& pose() const { return pings().transmission_pose(ping_, number_); }
  const SteeredPose& receiver_pose() const { return pings().receiver_pose(ping_, number_); }
  /// Returns the time at which it is sent.
  double time_s() const { return pings().times_s[ping_] + pings().sensor->transmission_delay_s(number_); }
  /// Returns whether the receiver is separate. A sensor with a separate receiver shares its transmissions
  /// with no other sensor.
  bool has_separate_receiver() const { return pings().sensor->has_separate_receiver(); }
  /// Returns the range bins of a sensor that receive this transmission.
  RangeSamples samples(std::size_t s) const { return sensor(s).samples(number_); }
  /// Returns the shortest range sample of the group's sensors.
  double sample_length_m() const;

  /// Returns the tubes with the largest reach of the group's sensors.
  TubeSet tubes() const;
  /// Returns the tubes that one sensor sends, with its own reach.
  TubeSet tubes_of(std::size_t sensor) const;
  /// Returns the tubes of a sensor's receiver. They equal the transmit tubes, unless the receiver is
  /// separate.
  TubeSet receive_tubes(std::size_t sensor) const;
  /// Returns the requirements on relief that is refined for this transmission, by its tubes. `tubes` has two
  /// sets for a separate receiver, and must outlive the result.
  std::vector<Look> looks(std::span<const TubeSet> tubes) const;
  /// Returns the facets that this transmission meets, for all its sensors and a separate receiver. Throws
  /// InputError if there are too many facets.
  const TransmissionSurface& surface_mesh() const;
  /// Returns the model by which a sensor receives the echoes of the surface.
  SensorModel model(std::size_t sensor) const { return {*this, surface_mesh(), sensor}; }

  /// Returns the history of its tubes, limited to the `wanted` tubes, or of other tubes from the same apex
  /// (TubeEngine).
  History trace(std::size_t* candidates = nullptr, bool measured = true,
                const std::vector<bool>& wanted = {}) const;
  History trace(TubeSet tubes, std::size_t* candidates = nullptr, bool measured = true) const;
  /// Returns the common visibility of transmitter and separate receiver in isovelocity water.
  BistaticHistory trace_both() const;
  /// Samples the common visibility by rays, in portions.
  void trace_rays_of_both(const RayScene& scene, const RaySettings& settings,
                          const std::function<void(const BistaticHistory&)>& take) const;
  /// Returns the common visibility of a fan's transmitter and the two receivers of its receiver pair.
  ReceiverPairHistory trace_receiver_pair(std::size_t sensor, std::uint32_t fan,
                                          const ReceiverBaseline& receiver_pair) const;
  /// Checks the closure law for each of its tubes. `label` distinguishes transmissions in the hash.
  std::vector<TubeAudit> audit(std::uint64_t label) const;

  /// Returns the number of beams of this transmission that a sensor receives
  /// (Sensor::beams_of_transmission).
  int beams(std::size_t s) const { return static_cast<int>(sensor(s).beams_of_transmission(number_).size()); }
  /// Returns the assignment of beams to tubes. `fans`: the sensor's fan_of_tube(), which must outlive the
  /// result.
  ReceiveBeams beams_by_fans(std::size_t sensor, const std::vector<std::uint32_t>& fans) const;
  /// Returns the echo that a sensor receives from the common visibility, by an echo model of this
  /// transmission.
  Echo echo(const CommonVisibility& visibility, std::size_t sensor, const EchoModel& model) const;
  ReceiverPairEcho echo(const ReceiverPairHistory& history, std::size_t sensor, std::uint32_t fan,
                        const SensorModel& model) const;

 private:
  const TubeEngine& engine() const;

  const Transmissions& transmissions_;
  const SharedTransmissions& group_;
  std::size_t ping_, number_;
  mutable std::optional<TransmissionSurface> surface_mesh_;
  mutable std::optional<TubeEngine> own_engine_;  ///< engine for a surface mesh of its own
};

}  // namespace tubefoot
