// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/visibility/path_footprints.hpp"
#include "run/transmission_ends.hpp"

namespace tubefoot::python {

/// A transmission as received by one sensor.
struct ReceivedTransmission {
  std::size_t sensor = 0, ping = 0, transmission = 0;
};

class NativeTransmission;

/// Footprints of one transmission. It owns the memory of its arrays.
struct NativeHistory {
  std::shared_ptr<const NativeTransmission> transmission;
  FootprintSet footprints;
  /// By footprint; equal to the tube, unless the receiver is separate.
  std::vector<std::uint32_t> receive_tube;
  std::vector<double> receive_distance_m;  ///< distance of the receiver from the plane of the facet
};

/// One transmission of one sensor: its surface mesh, its tubes and its receive beams. Terrain that is read
/// by tiles includes the tiles that the transmission needs.
class NativeTransmission : public std::enable_shared_from_this<NativeTransmission> {
 public:
  /// Throws UsageError if the transmission does not exist.
  NativeTransmission(const Survey& survey, const RunRequest& request, ReceivedTransmission which);

  const Survey& survey() const { return transmissions_.survey(); }
  const ReceivedTransmission& which() const { return which_; }
  const SensorPings& pings() const { return survey().sensors[which_.sensor]; }
  const Sensor& sensor() const { return *pings().sensor; }
  const SteeredPose& pose() const { return transmission_.pose(); }
  const SteeredPose& receiver_pose() const { return transmission_.receiver_pose(); }
  /// Mesh of the facets that both ends see, at the positions that the transmitter sees.
  const FacetMesh& mesh() const { return ends_.shared_mesh(); }
  const TransmissionEnds& ends() const { return ends_; }
  const TubeSet& tubes() const { return ends_.tx().tubes; }
  const TubeSet& receive_tubes() const { return ends_.rx().tubes; }
  const std::vector<glm::dvec3>& vertices_m() const;
  glm::dvec3 metres(GridPoint apex) const { return survey().scene.grid.to_metres(apex); }

  /// Returns the measured visible footprints of the exact engine, in the arithmetic of the scene. With a
  /// separate receiver, they are those that both ends see.
  std::shared_ptr<NativeHistory> trace() const;

 private:
  const ReceivedTransmission which_;
  const Transmissions transmissions_;
  /// Its surface mesh exists already, so that threads may share the transmission.
  const Transmission transmission_;
  const TransmissionEnds ends_;
  mutable std::once_flag vertices_made_;
  mutable std::vector<glm::dvec3> vertices_m_;  ///< vertices of a mesh of its own
};

}  // namespace tubefoot::python
