// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/visibility/path_footprints.hpp"
#include "run/transmission_ends.hpp"

namespace tubefoot::python {

/// A transmission as one sensor receives it.
struct ReceivedTransmission {
  std::size_t sensor = 0, ping = 0, transmission = 0;
};

class NativeTransmission;

/// What one transmission met, with all that its arrays point into.
struct NativeHistory {
  std::shared_ptr<const NativeTransmission> transmission;
  FootprintSet footprints;
  std::vector<std::uint32_t> receive_tube;  ///< by footprint: the tube itself, unless the receiver is apart
  std::vector<double> receive_distance_m;   ///< of the receiver from the facet's plane
};

/// One transmission of one sensor, where terrain is read by tiles with those that it needs: its ground, its
/// tubes and how it listens.
class NativeTransmission : public std::enable_shared_from_this<NativeTransmission> {
 public:
  /// Throws UsageError where there is no such transmission.
  NativeTransmission(const Survey& survey, const RunRequest& request, ReceivedTransmission which);

  const Survey& survey() const { return transmissions_.survey(); }
  const ReceivedTransmission& which() const { return which_; }
  const SensorPings& pings() const { return survey().sensors[which_.sensor]; }
  const Sensor& sensor() const { return *pings().sensor; }
  const Pose& pose() const { return transmission_.pose(); }
  const Pose& receiver_pose() const { return transmission_.receiver_pose(); }
  /// Of facets that both ends see: where the transmitter sees them.
  const FacetMesh& mesh() const { return ends_.shared_mesh(); }
  const TransmissionEnds& ends() const { return ends_; }
  const TubeSet& tubes() const { return ends_.tx().tubes; }
  const TubeSet& receive_tubes() const { return ends_.rx().tubes; }
  const std::vector<glm::dvec3>& vertices_m() const;
  glm::dvec3 metres(GridPoint apex) const { return survey().scene.grid.to_metres(apex); }

  /// Visible footprints, measured, by the exact engine in the arithmetic that the scene names; with a
  /// separate receiver, those of both ends.
  std::shared_ptr<NativeHistory> trace() const;

 private:
  const ReceivedTransmission which_;
  const Transmissions transmissions_;
  const Transmission transmission_;  ///< whose ground is made already, so that threads may share it
  const TransmissionEnds ends_;
  mutable std::once_flag vertices_made_;
  mutable std::vector<glm::dvec3> vertices_m_;  ///< of facets of its own
};

}  // namespace tubefoot::python
