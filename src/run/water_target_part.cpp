// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <type_traits>
#include <vector>

#include "engine/certified/receiver_pair_reference.hpp"
#include "engine/targets/target_echo.hpp"
#include "engine/targets/targets_in_tubes.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"
#include "run/receiver_pair_rows.hpp"
#include "run/refraction.hpp"
#include "run/water_targets.hpp"

// This file adds the echoes of targets in the water to the energies of a transmission. Paths are straight, or
// follow eigenrays in stratified water. They lead to one receiver, a separate receiver or a receiver pair.

namespace tubefoot {
namespace {

/// The sum of a sensor's echoes from targets, with all that it refers to.
template <class N>
class SensorTargets {
 public:
  SensorTargets(const Transmission& transmission, std::size_t s)
      : transmission_(transmission),
        sensor_(s),
        model_(transmission, TransmissionSurface(transmission.loaded_scene()), s),
        finder_(transmission.samples(s)),
        fans_(transmission.sensor(s).fan_of_tube(transmission.number())),
        beams_(transmission.beams_by_fans(s, fans_)),
        sum_(beams_, finder_, model_.model),
        frequency_hz_(1e3 * transmission.sensor(s).frequency_khz(transmission.number())) {}
  SensorTargets(const SensorTargets&) = delete;
  SensorTargets& operator=(const SensorTargets&) = delete;

  std::size_t sensor() const { return sensor_; }
  const SampleFinder& finder() const { return finder_; }
  const EchoModel& model() const { return model_.model; }
  TargetEchoSum<N>& sum() { return sum_; }
  double frequency_hz() const { return frequency_hz_; }

  void add_to(const EchoContribution& plan, PingSums& sums) const {
    if (!sum_.has_any()) return;
    if constexpr (std::is_same_v<N, Interval>) {
      CertifiedEcho certified = certified_echo_of(sum_.sums(), static_cast<std::size_t>(beams_.count));
      compare_with(certified, *plan.tolerance);
      sums.add(transmission_, sensor_, certified);
    } else {
      sums.add(transmission_, sensor_, 1, sum_.sums());
    }
  }

 private:
  const Transmission& transmission_;
  std::size_t sensor_;
  SensorModel model_;
  SampleFinder finder_;
  std::vector<std::uint32_t> fans_;
  ReceiveBeams beams_;
  TargetEchoSum<N> sum_;
  double frequency_hz_;
};

template <class N>
std::array<N, 3> target_vector(glm::dvec3 v) {
  return {N(v.x), N(v.y), N(v.z)};
}

/// Returns the cross-section of a target, or its enclosure.
template <class N>
N cross_section_of(const WaterTarget& target, glm::dvec3 from_transmitter, glm::dvec3 from_receiver,
                   double frequency_hz) {
  const double value = target.cross_section(from_transmitter, from_receiver, frequency_hz);
  if constexpr (std::is_same_v<N, Interval>) {
    const double error = target.table ? target.table->rounding_m2() : 0;
    return outwards(std::max(value - error, 0.0), value + error, library_units);
  } else {
    return value;
  }
}

/// Positions of a receiver that moves during the ping, at the times of both borders of an interval of its
/// record. Neighbouring intervals compute their common border from the same numbers.
struct IntervalOfRecord {
  glm::dvec3 begin_receiver_m{0}, end_receiver_m{0};
  double end_m = 0;  ///< first border of the next interval
};

/// Returns the interval of a transmission. Empty for a receiver with one pose per ping.
std::optional<IntervalOfRecord> interval_of(const Transmission& transmission) {
  const Sensor& sensor = transmission.sensor(transmission.first());
  if (!sensor.receiver_moves()) return {};
  const Scene& scene = transmission.scene();
  const Trajectory& track = scene.trajectories[scene.sensor_trajectory[transmission.first()]];
  const std::size_t first = sensor.first_sample(transmission.number()),
                    end = first + static_cast<std::size_t>(sensor.samples(transmission.number()).count);
  const auto border_m = [&](std::size_t k) { return sensor.samples().border_m(static_cast<double>(k)); };
  const auto receiver_at = [&](std::size_t k) {
    const double time_s = transmission.time_s() + 2 * border_m(k) / transmission.pings().sound_speed_m_s;
    return sensor.receiver_pose_on(track.at(std::clamp(time_s, track.begin_s(), track.end_s()))).position_m;
  };
  return IntervalOfRecord{receiver_at(first), receiver_at(end), border_m(end)};
}

/// Throws InputError for a single target at the position of an end.
void refuse_at(const Transmission& transmission, const WaterTargets& targets, GridPoint apex) {
  for (const WaterTarget& target : targets.single)
    if (target.at == apex) throw target_at_sensor(transmission, target);
}

/// Adds the echoes along straight paths for sensors with one receiver.
template <class N>
void add_straight(const EchoContribution& plan, const Transmission& transmission, const WaterTargets& targets,
                  std::span<const std::unique_ptr<SensorTargets<N>>> sensors, PingSums& sums) {
  const Scene& scene = transmission.scene();
  const double unit_m = scene.grid.unit_m();
  const FacetMesh& mesh = transmission.surface_mesh().mesh();
  const SceneTree& tree = transmission.surface_mesh().tree();
  const TubeWalls tx(transmission.tubes());
  std::optional<TubeWalls> rx;
  if (transmission.has_separate_receiver()) rx.emplace(transmission.receive_tubes(transmission.first()));
  refuse_at(transmission, targets, tx.apex());
  if (rx) refuse_at(transmission, targets, rx->apex());
  const std::optional<IntervalOfRecord> interval = interval_of(transmission);
  std::array<GridPoint, 2> at_borders;
  if (interval)
    at_borders = {scene.grid.snap(interval->begin_receiver_m), scene.grid.snap(interval->end_receiver_m)};
  std::vector<std::uint32_t> rx_tubes;
  each_target_in(
      targets, tx, scene.grid, target_reach(transmission),
      [&](const WaterTarget& target, std::span<const std::uint32_t> tx_tubes) {
        if (rx) {
          rx->find(target.at, rx_tubes);
          if (rx_tubes.empty()) return;
        }
        if (!is_target_in_view(mesh, tree, tx.apex(), target.at) ||
            (rx && !is_target_in_view(mesh, tree, rx->apex(), target.at)))
          return;
        const glm::dvec3 there = displacement_m(tx.apex(), target.at, unit_m),
                         back = rx ? displacement_m(rx->apex(), target.at, unit_m) : there;
        for (const auto& sensor : sensors) {
          const TargetLeg<N> out = straight_leg<N>(target_vector<N>(there), sensor->model()),
                             in = rx ? straight_leg<N>(target_vector<N>(back), sensor->model()) : out;
          const auto half_path_m = [&](const TargetLeg<N>& leg) -> N {
            return 0.5 * (out.range_m + leg.range_m);
          };
          const auto half_path_from = [&](GridPoint receiver) {
            return half_path_m(straight_leg<N>(target_vector<N>(displacement_m(receiver, target.at, unit_m)),
                                               sensor->model()));
          };
          const std::optional<TargetBins> bins =
              interval
                  ? bin_of_moving_receiver(sensor->finder(), interval->end_m,
                                           MovingHalfPaths<N>{half_path_from(at_borders[0]), half_path_m(in),
                                                              half_path_from(at_borders[1])})
              : rx ? bin_of_half_path(sensor->finder(), half_path_m(in))
                   : bin_of_range(sensor->finder(), tx.apex(), target.at, unit_m);
          if (!bins) continue;
          sensor->sum().add(cross_section_of<N>(target, there, back, sensor->frequency_hz()), out, in, *bins,
                            tx_tubes, rx_tubes, !rx);
        }
      });
  for (const auto& sensor : sensors) sensor->add_to(plan, sums);
}

/// Adds the echoes along straight paths for a receiver pair, fan by fan.
template <class N>
void add_to_pair(const EchoContribution& plan, const Transmission& transmission, const WaterTargets& targets,
                 std::size_t s, PingSums& sums) {
  const Scene& scene = transmission.scene();
  const double unit_m = scene.grid.unit_m();
  const FacetMesh& mesh = transmission.surface_mesh().mesh();
  const SceneTree& tree = transmission.surface_mesh().tree();
  const Sensor& sensor = transmission.sensor(s);
  const SampleFinder finder(transmission.samples(s));
  const SensorModel model(transmission, TransmissionSurface(transmission.loaded_scene()), s);
  const std::vector<std::uint32_t> fans = sensor.fan_of_tube(transmission.number());
  const TubeSet sent = transmission.tubes(),
                received = transmission.has_separate_receiver() ? transmission.receive_tubes(s) : sent;
  const double frequency_hz = 1e3 * sensor.frequency_khz(transmission.number());
  ReceiverPairRows rows(transmission, s);
  bool has_any = false;
  for (std::uint32_t fan = 0; fan < model.patterns.baselines.size(); ++fan) {
    const ReceiverBaseline& receiver_pair = model.patterns.baselines[fan];
    const TubeSet of_fan = tubes_of_fan(received, fans, fan);
    const TubeWalls tx(tubes_of_fan(sent, fans, fan)), upper(moved_along(of_fan, receiver_pair, 1, unit_m)),
        lower(moved_along(of_fan, receiver_pair, -1, unit_m));
    for (const GridPoint apex : {tx.apex(), upper.apex(), lower.apex()})
      refuse_at(transmission, targets, apex);
    TargetPairSum<N> sum(receiver_pair, fan, finder, model.model);
    std::vector<std::uint32_t> found;
    each_target_in(targets, tx, scene.grid, target_reach(transmission),
                   [&](const WaterTarget& target, std::span<const std::uint32_t>) {
                     if (!is_target_in_view(mesh, tree, tx.apex(), target.at)) return;
                     const auto sees = [&](const TubeWalls& end) {
                       end.find(target.at, found);
                       return !found.empty() && is_target_in_view(mesh, tree, end.apex(), target.at);
                     };
                     const glm::dvec3 there = displacement_m(tx.apex(), target.at, unit_m),
                                      back = displacement_m(received.apex, target.at, unit_m);
                     sum.add(cross_section_of<N>(target, there, back, frequency_hz), there, back, sees(upper),
                             sees(lower));
                   });
    if (!sum.has_any()) continue;
    has_any = true;
    const std::size_t samples = finder.borders().size() - 1;
    if constexpr (std::is_same_v<N, Interval>) {
      CertifiedEcho certified = certified_echo_of(sum.sums(), 4);
      compare_receiver_pair_with(certified, *plan.tolerance);
      rows.set(fan, certified);
    } else {
      const auto row = [&](std::size_t k) {
        const auto first = sum.sums().begin() + static_cast<std::ptrdiff_t>(k * samples);
        return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(samples));
      };
      rows.set(fan, ReceiverPairEcho{row(0), row(1), row(2), row(3)});
    }
  }
  if (has_any) rows.add_to(sums, transmission, s, 1);
}

/// A ray between an end and a target in stratified water that nothing hides. By reciprocity, sound travels
/// along it in both directions, with different spreading.
struct SeenRay {
  TargetLeg<double> sent, received;  ///< from the end to the target, and back
  glm::dvec3 arrival{0};             ///< direction of travel at the target
  std::vector<std::uint32_t> tubes;  ///< that contain the apparent position
};

/// One end of a transmission in stratified water: it sees targets at their apparent positions, between the
/// apparent facets.
class RefractedEnd {
 public:
  /// The arguments must outlive this object, except the tubes.
  RefractedEnd(const ApparentMap& water, const TubeSet& tubes, const FacetMesh& mesh, const SceneTree& tree,
               const WorldGrid& grid)
      : water_(water), walls_(tubes), mesh_(mesh), tree_(tree), grid_(grid) {}

  GridPoint apex() const { return walls_.apex(); }
  /// Returns the rays to a target: all rays, or the first one to arrive.
  std::vector<SeenRay> rays_to(glm::dvec3 at_m, bool all) const {
    std::vector<SeenRay> seen;
    std::vector<ApparentPoint> points;
    if (all) {
      points = water_.all_apparent(at_m);
    } else if (const auto first = water_.apparent(at_m)) {
      points.push_back(*first);
    }
    for (const ApparentPoint& point : points) {
      SeenRay ray;
      GridPoint at;
      try {
        at = grid_.snap(point.at_m);
      } catch (const GridRangeError&) {
        continue;  // beyond the reach of the tubes, which lies in the grid
      }
      walls_.find(at, ray.tubes);
      if (ray.tubes.empty() || !is_target_in_view(mesh_, tree_, walls_.apex(), at)) continue;
      ray.arrival = water_.arrival_direction(at_m, point.ray);
      const double range_m = water_.reference_speed_m_s() * point.ray.time_s,
                   passed = std::exp(-point.ray.absorption_db * std::numbers::ln10 / 10),
                   // On a caustic the area is that which diffraction leaves.
          widened = point.ray.tube_area_m2_per_sr < point.ray.caustic_area_m2_per_sr
                        ? point.ray.caustic_area_m2_per_sr / point.ray.tube_area_m2_per_sr
                        : 1,
                   area = point.ray.tube_area_m2_per_sr * widened,
                   area_back = water_.return_area_m2_per_sr(at_m, point.ray) * widened;
      if (!(area > 0 && std::isfinite(area) && area_back > 0 && range_m > 0)) continue;
      const glm::dvec3 direction = glm::normalize(point.at_m - water_.apex_m());
      const std::array<double, 3> launch{direction.x, direction.y, direction.z};
      ray.sent = {range_m, passed / area, launch};
      ray.received = {range_m, passed / area_back, launch};
      seen.push_back(std::move(ray));
    }
    return seen;
  }

 private:
  const ApparentMap& water_;
  TubeWalls walls_;
  const FacetMesh& mesh_;
  const SceneTree& tree_;
  const WorldGrid& grid_;
};

/// Returns the reach in metres of rays whose travel time corresponds to a range. No path is longer than the
/// largest sound speed times its time.
TargetReach refracted_reach(const Transmission& transmission) {
  double fastest = 0;
  for (const ProfilePoint& point : transmission.scene().water->profile().points())
    fastest = std::max(fastest, point.sound_speed_m_s);
  return {0, target_reach(transmission).farthest_m * fastest / transmission.pings().sound_speed_m_s};
}

void add_refracted(const EchoContribution& plan, const Transmission& transmission,
                   const WaterTargets& targets,
                   std::span<const std::unique_ptr<SensorTargets<double>>> sensors, PingSums& sums) {
  const Scene& scene = transmission.scene();
  const TargetReach reach = refracted_reach(transmission);
  const std::optional<IntervalOfRecord> interval = interval_of(transmission);
  const auto add = [&](const WaterTarget& target, const SeenRay& out, const SeenRay& in, bool same_ray) {
    const double half_path_m = (out.sent.range_m + in.received.range_m) / 2;
    // To first order, the displacement of the receiver along the ray shortens the path.
    const auto half_path_from = [&](glm::dvec3 receiver_m) {
      const auto& [x, y, z] = in.received.direction;
      return half_path_m -
             glm::dot(glm::dvec3(x, y, z), receiver_m - transmission.receiver_pose().position_m) / 2;
    };
    for (const auto& sensor : sensors) {
      const std::optional<TargetBins> bins =
          interval ? bin_of_moving_receiver(
                         sensor->finder(), interval->end_m,
                         MovingHalfPaths<double>{half_path_from(interval->begin_receiver_m), half_path_m,
                                                 half_path_from(interval->end_receiver_m)})
                   : bin_of_half_path(sensor->finder(), half_path_m);
      if (bins)
        sensor->sum().add(target.cross_section(out.arrival, in.arrival, sensor->frequency_hz()), out.sent,
                          in.received, *bins, out.tubes, in.tubes, same_ray);
    }
  };
  if (transmission.has_separate_receiver()) {
    const RefractedPair pair = refracted_pair_of(transmission);
    const FacetMesh &sent = pair.apparent.transmit.refined.mesh,
                    &received = pair.apparent.receive.refined.mesh;
    const SceneTree sent_tree(sent, SceneTree::HeightFieldSearch::ignored),
        received_tree(received, SceneTree::HeightFieldSearch::ignored);
    const RefractedEnd tx(pair.transmit_water, pair.transmit_tubes, sent, sent_tree, scene.grid),
        rx(pair.receive_water, pair.receive_tubes, received, received_tree, scene.grid);
    refuse_at(transmission, targets, tx.apex());
    refuse_at(transmission, targets, rx.apex());
    each_target_about(targets, tx.apex(), scene.grid, reach,
                      [&](const WaterTarget& target, std::span<const std::uint32_t>) {
                        stop_if_wanted();
                        const glm::dvec3 at_m = scene.grid.to_metres(target.at);
                        const std::vector<SeenRay> out = tx.rays_to(at_m, false);
                        if (out.empty()) return;
                        const std::vector<SeenRay> in = rx.rays_to(at_m, false);
                        if (!in.empty()) add(target, out.front(), in.front(), false);
                      });
  } else {
    const TubeSet tubes = transmission.tubes();
    const ApparentMap water = apparent_map_of(transmission.loaded_scene(), transmission.pings(),
                                              transmission.number(), scene.grid.to_metres(tubes.apex));
    const RefractedEnd end(water, tubes, transmission.surface_mesh().mesh(),
                           transmission.surface_mesh().tree(), scene.grid);
    refuse_at(transmission, targets, tubes.apex);
    each_target_about(targets, tubes.apex, scene.grid, reach,
                      [&](const WaterTarget& target, std::span<const std::uint32_t>) {
                        stop_if_wanted();
                        const std::vector<SeenRay> rays = end.rays_to(scene.grid.to_metres(target.at), true);
                        for (const SeenRay& out : rays)
                          for (const SeenRay& in : rays) add(target, out, in, &out == &in);
                      });
  }
  for (const auto& sensor : sensors) sensor->add_to(plan, sums);
}

template <class N>
void add_of(const EchoContribution& plan, const Transmission& transmission, const WaterTargets& targets,
            PingSums& sums) {
  std::vector<std::unique_ptr<SensorTargets<N>>> sensors;
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0) continue;
    if (transmission.sensor(s).has_receiver_pair())
      add_to_pair<N>(plan, transmission, targets, s, sums);
    else
      sensors.push_back(std::make_unique<SensorTargets<N>>(transmission, s));
  }
  if (sensors.empty()) return;
  if constexpr (std::is_same_v<N, double>)
    if (transmission.scene().water->refracts())
      return add_refracted(plan, transmission, targets, sensors, sums);
  add_straight<N>(plan, transmission, targets, sensors, sums);
}

}  // namespace

TargetReach target_reach(const Transmission& transmission) {
  TargetReach reach{std::numeric_limits<double>::infinity(), 0};
  double beyond_m = 0;
  for (const std::size_t s : transmission.group().sensors) {
    const RangeSamples samples = transmission.samples(s);
    reach.nearest_m = std::min(reach.nearest_m, samples.first_m);
    reach.farthest_m = std::max(reach.farthest_m, samples.border_m(samples.count));
    beyond_m = std::max(beyond_m, transmission.sensor(s).receiver_pair().baseline_m / 2);
  }
  // Half of the path differs from the range of the transmitter by up to half of the distance of the ends.
  if (transmission.has_separate_receiver()) {
    const glm::dvec3 transmitter_m = transmission.pose().position_m;
    double apart_m = glm::distance(transmitter_m, transmission.receiver_pose().position_m);
    if (const auto interval = interval_of(transmission))
      apart_m = std::max({apart_m, glm::distance(transmitter_m, interval->begin_receiver_m),
                          glm::distance(transmitter_m, interval->end_receiver_m)});
    beyond_m += apart_m / 2;
  }
  if (beyond_m > 0) beyond_m += transmission.scene().grid.unit_m();
  return {std::max(reach.nearest_m - beyond_m, 0.0), reach.farthest_m + beyond_m};
}

InputError target_at_sensor(const Transmission& transmission, const WaterTarget& target) {
  const Scene& scene = transmission.scene();
  const std::vector<WaterTarget>& single = transmission.loaded_scene().targets->single;
  const auto found = std::ranges::find(single, target.at, &WaterTarget::at);
  const WaterTargetDescription& described =
      scene.description.targets.at(static_cast<std::size_t>(found - single.begin()));
  return InputError(
      described.place,
      fmt::format("target '{}' is at the position of the transmitter or of a receiver of {}, where "
                  "its echo is infinite: move the target or the sensor",
                  described.name, transmission.name()));
}

void add_water_targets(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const WaterTargets& targets = *transmission.loaded_scene().targets;
  transmission.surface_mesh();  // made outside of the echo time
  sums.as_echo([&] {
    if (plan.tolerance)
      add_of<Interval>(plan, transmission, targets, sums);
    else
      add_of<double>(plan, transmission, targets, sums);
  });
}

}  // namespace tubefoot
