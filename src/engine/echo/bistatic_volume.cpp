// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "engine/echo/volume_echo.hpp"
#include "engine/echo/water_cells.hpp"
#include "engine/scattering/density.hpp"
#include "engine/scattering/radial_model.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/tubes/tube_finder.hpp"

// Volume reverberation for a separate receiver. The receive tubes are divided into small cells of directions,
// each of which belongs to one beam. In a cell, the density is integrated along the ray of its centre, from
// one ellipsoid of equal path length to the next.

namespace tubefoot {
namespace {

/// The water that a transmitter insonifies.
class InsonifiedWater {
 public:
  explicit InsonifiedWater(const History& history) : finder_(history.tubes) {
    std::size_t surface = 0, open = 0;
    for (std::uint32_t tube = 0; tube < history.tubes.tubes.size(); ++tube) {
      Tube own;
      for (const DoubleSpace::Polygon& polygon : tube_content(history, tube, surface, open).surfaces) {
        own.surfaces.emplace_back(polygon);
        own.nearest_m = std::min(own.nearest_m, polygon.plane.distance_m);
      }
      tubes_.push_back(std::move(own));
    }
  }

  /// Calls take(tube) for the tubes in which a point relative to the transmitter is in front of all surfaces.
  template <class Take>
  void find(const glm::dvec3& point, double range_m, const Take& take) const {
    finder_.find(point, [&](std::uint32_t tube) {
      if (range_m <= tubes_[tube].nearest_m || !tubes_[tube].hides(point)) take(tube);
    });
  }

 private:
  struct Tube {
    std::vector<SpacePolygon> surfaces;
    double nearest_m = std::numeric_limits<double>::infinity();  ///< no plane is nearer

    bool hides(const glm::dvec3& point) const {
      return std::ranges::any_of(surfaces, [&](const SpacePolygon& polygon) {
        if (!(-glm::dot(polygon.plane.normal, point) > polygon.plane.distance_m)) return false;
        const auto& corners = polygon.corners_m;
        for (std::size_t i = 0; i < corners.size(); ++i)
          if (glm::dot(glm::cross(corners[i], corners[i + 1 == corners.size() ? 0 : i + 1]), point) < 0)
            return false;
        return true;
      });
    }
  };
  TubeFinder finder_;
  std::vector<Tube> tubes_;
};

/// Integrates along rays of the receiver.
class BistaticRays {
 public:
  BistaticRays(const History& transmit, glm::dvec3 receiver_m, const ReceiveBeams& beams,
               const RangeSamples& samples, const EchoModel& model, const VolumeScattering& volume,
               double cell_width_rad)
      : water_(transmit),
        cell_width_rad_(cell_width_rad),
        transmitter_m_(-receiver_m),
        beams_(beams),
        borders_(sample_borders_m(samples)),
        model_(model),
        volume_(volume),
        beta_(absorption_per_m(model.absorption_db_per_m)),
        energy_(std::size_t(beams.count) * std::size_t(samples.count)) {
    check(volume);
    for (double& border : volume_.borders_m) border -= model.path.tx.apex_m.z + receiver_m.z;
  }

  /// Adds a solid angle about a direction of a receive tube, between two ranges from the receiver.
  void add(const glm::dvec3& direction, double solid_angle, double from_m, double to_m, std::uint32_t tube) {
    const double baseline2 = glm::dot(transmitter_m_, transmitter_m_),
                 along = glm::dot(direction, transmitter_m_);
    const auto half_path = [&](double r) { return (r + glm::length(r * direction - transmitter_m_)) / 2; };
    // Range on the ellipsoid of a half path.
    const auto range_on = [&](double half) {
      const double across = 4 * half * half - baseline2;
      return across > 0 ? across / (4 * half - 2 * along) : 0.0;
    };
    const double first = half_path(from_m);
    auto k = std::size_t(
        std::max<std::ptrdiff_t>(std::ranges::upper_bound(borders_, first) - borders_.begin() - 1, 0));
    for (; k + 1 < borders_.size(); ++k) {
      const double begin = std::max(range_on(borders_[k]), from_m),
                   end = std::min(range_on(borders_[k + 1]), to_m);
      if (begin >= to_m) return;
      if (!(end > begin)) continue;
      // Walls of transmit tubes and shadows cross the ray. Panels are therefore about as long as cells are
      // wide, each with a Gauss-Legendre rule of two nodes.
      const double panels = std::clamp(std::ceil((end - begin) / (2 * cell_width_rad_ * end)), 1.0, 64.0),
                   half = (end - begin) / panels / 2;
      for (double panel = 0; panel < panels; ++panel)
        for (const double node : {-0.57735026918962576, 0.57735026918962576})
          add_point(direction, begin + half * (2 * panel + 1 + node), half * solid_angle, k, tube);
    }
  }
  std::vector<double> energies() { return std::move(energy_); }

 private:
  void add_point(const glm::dvec3& direction, double range_m, double weight, std::size_t sample,
                 std::uint32_t tube) {
    const auto layer = std::ranges::upper_bound(volume_.borders_m, range_m * direction.z);
    const double s_v = volume_.s_v_per_m[std::size_t(layer - volume_.borders_m.begin())];
    if (s_v == 0) return;
    const glm::dvec3 from_transmitter = range_m * direction - transmitter_m_;
    const double transmit_m = glm::length(from_transmitter);
    if (!(transmit_m > 0)) return;
    const double density =
        s_v * weight * std::exp(-beta_ * (range_m + transmit_m)) / (transmit_m * transmit_m);
    water_.find(from_transmitter, transmit_m, [&](std::uint32_t transmit_tube) {
      if (!beams_.in_one_fan(transmit_tube, tube)) return;
      const std::size_t row = borders_.size() - 1;
      if (model_.patterns == nullptr) {
        energy_[beams_.of_tube[tube] * row + sample] += density;
        return;
      }
      const BeamPatterns& patterns = *model_.patterns;
      const double sent = patterns.transmit[patterns.fan_of_tube[tube]].gain(from_transmitter / transmit_m);
      const auto [first, end] = patterns.beams_of_tube[tube];
      for (std::uint32_t beam = first; beam < end; ++beam) {
        const double gain = sent * patterns.receive[beam].gain(direction);
        if (patterns.receives(beam, gain)) energy_[beam * row + sample] += gain * density;
      }
    });
  }

  InsonifiedWater water_;
  double cell_width_rad_;
  glm::dvec3 transmitter_m_;  ///< relative to the receiver
  const ReceiveBeams& beams_;
  std::vector<double> borders_;
  const EchoModel& model_;
  VolumeScattering volume_;  ///< heights relative to the receiver
  double beta_;
  std::vector<double> energy_;
};

void add_cell(const WaterCell& cell, std::uint32_t tube, BistaticRays& rays) {
  struct Seen {
    glm::dvec3 direction;
    double solid_angle, range_m;
  };
  std::vector<Seen> parts;
  double solid_angle_sum = 0, nearest = std::numeric_limits<double>::infinity();
  glm::dvec3 mean(0);
  PlanarPolygon polygon;
  for (const SpacePolygon& part : cell.polygons) {
    const PlaneFrame frame(part.plane);
    polygon.assign(part.corners_m, part.plane, frame);
    const double solid_angle_part = solid_angle(polygon);
    if (!(solid_angle_part > 0)) continue;
    const glm::dvec2 at = polygon.first + centroid_offset(polygon);
    const glm::dvec3 centre = at.x * frame.u + at.y * frame.v - part.plane.distance_m * part.plane.normal;
    parts.push_back({glm::normalize(centre), solid_angle_part, glm::length(centre)});
    solid_angle_sum += solid_angle_part;
    mean += solid_angle_part * parts.back().direction;
    nearest = std::min(nearest, nearest_point(polygon).range);
  }
  if (parts.empty()) return;
  // In front of all polygons, the cell is one ray. Behind the nearest one, each polygon has its own ray.
  rays.add(glm::normalize(mean), solid_angle_sum, 0, nearest, tube);
  for (const Seen& part : parts) rays.add(part.direction, part.solid_angle, nearest, part.range_m, tube);
}

}  // namespace

Echo bistatic_volume_echo(const History& transmit, const History& receive, glm::dvec3 receiver_m,
                          const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                          const VolumeScattering& volume, double cell_width_rad) {
  BistaticRays rays(transmit, receiver_m, beams, samples, model, volume, cell_width_rad);
  VolumeRegions<DoubleSpace> regions({{}, {1}}, 0, samples.border_m(samples.count) + glm::length(receiver_m));
  std::size_t surface = 0, open = 0;
  for (std::uint32_t tube = 0; tube < receive.tubes.tubes.size(); ++tube) {
    stop_if_wanted();
    each_small(water_cell(tube_content(receive, tube, surface, open), regions), cell_width_rad,
               [&](const WaterCell& part) { add_cell(part, tube, rays); });
  }
  return {beams.count, samples.count, rays.energies()};
}

}  // namespace tubefoot
