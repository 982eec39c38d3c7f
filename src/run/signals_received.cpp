// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "engine/gradient/signal_parameters.hpp"
#include "engine/signal/certified_signals.hpp"
#include "engine/signal/smooth_signals.hpp"
#include "engine/targets/target_signals.hpp"
#include "engine/targets/targets_in_tubes.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/paths.hpp"
#include "run/signal_paths.hpp"
#include "run/signals.hpp"
#include "run/transmission_images.hpp"
#include "run/water_targets.hpp"

// This file computes the signals that the elements of a sensor receive, with phase (docs/signals.md). It
// sums rough surfaces over scatterers, smooth surfaces over their visible polygons, and adds paths over
// mirrors. With a tolerance, polygons of suitable smooth surfaces have certified bounds.

namespace tubefoot {
namespace {

/// Limit of scatterers in one common visibility. That many take most of an hour, and a typing error easily
/// causes a million times as many.
constexpr double most_scatterers = 1e10;
/// Fraction of the largest amplitude of a channel. Smaller amplitudes need no greater precision.
constexpr double signal_floor = 1e-3;

/// Throws std::invalid_argument if a field has too many scatterers on the visible polygons.
void check_number(const VisiblePolygons& seen, const SurfaceField& field) {
  double count = 0;
  for (const VisiblePolygon& patch : seen.patches) {
    const std::span<const glm::dvec3> corners = seen.corners(patch);
    glm::dvec3 twice(0);
    for (std::size_t k = 2; k < corners.size(); ++k)
      twice += glm::cross(corners[k - 1] - corners[0], corners[k] - corners[0]);
    count += glm::length(twice) / 2 / field.area_m2(patch.normal);
  }
  if (count > most_scatterers)
    throw std::invalid_argument(fmt::format(
        "the visible surface has {:.2g} scatterers at a spacing of {:.3g} m, but the limit is {:g}: set "
        "'spacing_m' to {:.2g} m or more in [scatterers], or reduce the visible surface",
        count, field.spacing_m, most_scatterers,
        1.05 * field.spacing_m * std::sqrt(count / most_scatterers)));
}

/// Middle of the waveform's band, relative to which its bandwidth is smallest.
double carrier_hz(const SignalModel& model) { return model.waveform.centre_hz(); }

CoherentReceiver receiver_of(const Transmission& transmission, std::size_t s) {
  const SignalModel& model = *transmission.sensor(s).signals();
  const FrequencyBand band = band_of(model.waveform);
  // Flanks extend beyond the waveform's band. The part that samples contain counts, up to four times the
  // band, and above frequency 0.
  const double band_hz = band.high_hz - band.low_hz,
               held_hz = std::max(band_hz,
                                  std::min({model.sampling.rate_hz, 4 * band_hz, 1.9 * carrier_hz(model)}));
  CoherentReceiver receiver;
  receiver.channels = signal_channels(transmission, s);
  receiver.pulse = {[waveform = model.waveform, carrier = carrier_hz(model)](double time_s) {
                      return baseband_at(waveform, carrier, time_s);
                    },
                    0, model.waveform.duration_s, held_hz};
  receiver.pulse.slope = [waveform = model.waveform, carrier = carrier_hz(model)](double time_s) {
    return baseband_slope_at(waveform, carrier, time_s);
  };
  set_flanks(receiver.pulse, model.waveform.taper, model.waveform.stop_hz - model.waveform.start_hz);
  receiver.times = {model.sampling.first_s, model.sampling.rate_hz, model.sampling.samples};
  receiver.carrier_hz = carrier_hz(model);
  receiver.sound_speed_m_s = transmission.survey().sensors[s].sound_speed_m_s;
  return receiver;
}

/// Returns the part of a track that a ping needs, with times from the start of the ping. Times in seconds
/// since years ago would be rounded to steps that are too coarse to describe motion within a ping.
Trajectory track_from(const Trajectory& track, double start_s, double until_s) {
  std::vector<Trajectory::Sample> samples;
  for (const Trajectory::Sample& sample : track.samples()) {
    const double after_s = sample.time_s - start_s;
    if (after_s <= 0) samples.clear();
    samples.push_back({after_s, sample.pose});
    if (after_s >= until_s) break;
  }
  return Trajectory(std::move(samples));
}

/// Shifts the signals from the middle of the pulse's band to the frequency with which the sonar mixes.
void mix(ChannelSignals& signals, const SignalModel& model) {
  const double shift_hz = model.sampling.baseband_hz - carrier_hz(model);
  if (shift_hz == 0) return;
  for (std::size_t channel = 0; channel < signals.channels; ++channel)
    for (std::size_t k = 0; k < signals.samples; ++k)
      signals.value[channel * signals.samples + k] *=
          std::polar(1.0, 2 * pi * shift_hz * model.sampling.time_s(k));
}

}  // namespace

SurfaceField surface_field_of(const Survey& survey) {
  const ScatterersDescription& requested = survey.scene.description.scatterers;
  SurfaceField field;
  field.seed = survey.scene.description.run.seed;
  field.texture = requested.texture == "gamma"        ? SurfaceTexture::gamma
                  : requested.texture == "log_normal" ? SurfaceTexture::log_normal
                                                      : SurfaceTexture::none;
  field.shape = requested.texture_shape;
  field.texture_cell_m = requested.texture_cell_m;
  field.spacing_m = requested.spacing_m.value_or(HUGE_VAL);
  for (std::size_t s = 0; s < survey.sensors.size() && !requested.spacing_m; ++s) {
    const SignalModel* model = survey.sensors[s].sensor->signals();
    if (model == nullptr) continue;
    const Sensor& sensor = *survey.sensors[s].sensor;
    const double c = survey.sensors[s].sound_speed_m_s;
    const FrequencyBand band = band_of(model->waveform);
    field.spacing_m =
        std::min(field.spacing_m, speckle_spacing_m(band.high_hz - band.low_hz, c / carrier_hz(*model), c,
                                                    sensor.beams().front().azimuth_width_rad));
  }
  return field;
}

std::vector<SignalChannel> signal_channels(const Transmission& transmission, std::size_t s) {
  const Sensor& sensor = transmission.sensor(s);
  const SensorPings& pings = transmission.survey().sensors[s];
  const ElementArray& array = sensor.signals()->array;
  const Pose& sent = pings.transmission_pose(transmission.ping(), transmission.number());
  const Pose& received = pings.receiver_pose(transmission.ping(), transmission.number());
  SignalChannel channel;
  channel.transmit_m = sent.position_m + sent.attitude * array.transmitter_m;
  if (sensor.has_patterns()) {
    const BeamPatterns patterns = sensor.patterns(sent, pings.sound_speed_m_s, transmission.number());
    if (!patterns.transmit.front().beams.empty()) channel.transmit = patterns.transmit.front().beams.front();
    channel.receive = patterns.receive.front();
  }
  const Trajectory& track = transmission.scene().trajectories[transmission.scene().sensor_trajectory[s]];
  std::shared_ptr<const Trajectory> on_the_way;
  if (!sensor.signals()->stop_and_hop && !track.is_fixed())
    on_the_way = std::make_shared<const Trajectory>(
        track_from(track, pings.times_s[transmission.ping()], sensor.signals()->sampling.end_s()));
  /// Returns the motion of a position on the sensor, from the pose of the sensor or of its receiver.
  const auto motion = [&](Pose (Sensor::*pose_on)(const Pose&) const, glm::dvec3 place) -> PlatformMotion {
    if (!on_the_way) return {};
    return [&sensor, on_the_way, pose_on, place](double after_start_s) {
      const Pose pose = (sensor.*pose_on)(on_the_way->at(after_start_s));
      return pose.position_m + pose.attitude * place;
    };
  };
  channel.transmit_motion = motion(&Sensor::pose_on, array.transmitter_m);
  std::vector<SignalChannel> channels;
  for (const glm::dvec3 place : array.receivers_m) {
    channel.receive_m = received.position_m + received.attitude * place;
    channel.receive_motion = motion(&Sensor::receiver_pose_on, place);
    channels.push_back(channel);
  }
  return channels;
}

namespace {

/// The signals that the elements of a sensor receive from a transmission.
class TransmissionSignals {
 public:
  TransmissionSignals(const Transmission& transmission, std::size_t s)
      : transmission_(transmission),
        sensor_(s),
        model_(*transmission.sensor(s).signals()),
        echo_model_(transmission, transmission.surface_mesh(), s),
        receiver_(receiver_of(transmission, s)),
        field_(surface_field_of(transmission.survey())) {}

  ChannelSignals no_return() const { return silence_of(receiver_.channels); }
  /// Returns the signals of direct paths to the common visibility and back. All receivers share one common
  /// visibility, or each has its own.
  ChannelSignals straight(const History& history) const {
    ChannelSignals all = silence_of({});
    for_views(history, [&](const CommonVisibility& visibility, const std::vector<SignalChannel>& channels) {
      const ChannelSignals its =
          of(visible_polygons(visibility, echo_model_.model), channels, echo_model_.model);
      all.channels += its.channels;
      all.value.insert(all.value.end(), its.value.begin(), its.value.end());
    });
    return all;
  }
  /// Returns the signals of direct paths with bounds, after mixing.
  CertifiedSignals certified(const History& history, double tolerance) const {
    CertifiedSignals all{silence_of({}), {}};
    for_views(history, [&](const CommonVisibility& visibility, const std::vector<SignalChannel>& channels) {
      const CertifiedSignals its = certified(visibility, channels, tolerance);
      all.signals.channels += its.signals.channels;
      all.signals.value.insert(all.signals.value.end(), its.signals.value.begin(), its.signals.value.end());
      all.bound.insert(all.bound.end(), its.bound.begin(), its.bound.end());
    });
    return all;
  }
  /// Returns the derivatives of straight() by parameters, of smooth surfaces only.
  std::vector<ChannelSignals> derivatives(const History& history,
                                          std::span<const EchoParameter> parameters) const {
    const EchoModel& echo_model = echo_model_.model;
    const VisiblePolygons patches = split_polygons(visible_polygons(history, echo_model), [&](FacetId facet) {
                                      return surface_of(facet, echo_model) != nullptr;
                                    }).smooth;
    return smooth_signal_derivatives(
        patches, receiver_, echo_model, [&](FacetId facet) { return surface_of(facet, echo_model); },
        signal_parameters(transmission_.surface_mesh().mesh(), history, patches, receiver_.channels,
                          parameters),
        model_.tolerance);
  }
  bool has_mirrors() const {
    return path_settings(transmission_.scene(), transmission_.sensor(sensor_).frequency_khz()).has_value();
  }
  /// Adds the signals of paths over mirrors.
  void add_mirrored(ChannelSignals& sum) const {
    for_signal_paths(transmission_, sensor_, receiver_.channels,
                     {[&](const CoherentPath& path) {
                        superpose(of(path.patches, path.channels, path.model), path.phase, sum);
                      },
                      [&](const CoherentArrival& arrival) { add_arrival(arrival, receiver_, sum); }});
  }

  /// Adds the signals of targets in the water. Sets infinite bounds for the samples that they reach; `bound`
  /// may be empty.
  void add_targets(ChannelSignals& sum, std::span<std::complex<double>> bound) const {
    const WaterTargets& targets = *transmission_.loaded_scene().targets;
    if (targets.empty()) return;
    const auto add = [&](const TubeSet& sent, const TubeSet* received, std::size_t first, std::size_t end) {
      const std::span<const SignalChannel> channels =
          std::span(receiver_.channels).subspan(first, end - first);
      add_targets_between(targets, sent, received, reach_m(channels), [&](const WaterTarget& target) {
        for (std::size_t channel = first; channel < end; ++channel) {
          const std::size_t from = channel * sum.samples;
          const ReachedSamples reached = add_target_signal(
              target, transmission_.scene().grid.to_metres(target.at), receiver_.channels[channel], receiver_,
              echo_model_.model.absorption_db_per_m, std::span(sum.value).subspan(from, sum.samples));
          constexpr double open = std::numeric_limits<double>::infinity();
          for (std::size_t k = reached.first; !bound.empty() && k < reached.end; ++k)
            bound[from + k] = {open, open};
        }
      });
    };
    const std::size_t channels = receiver_.channels.size();
    if (model_.own_views) {
      const TubeSet sent = transmission_.tubes_of(sensor_);
      for (std::size_t channel = 0; channel < channels; ++channel) {
        const TubeSet received = tubes_from(receiver_.channels[channel].receive_m);
        add(sent, &received, channel, channel + 1);
      }
    } else if (transmission_.has_separate_receiver()) {
      const TubeSet received = transmission_.receive_tubes(sensor_);
      add(transmission_.tubes(), &received, 0, channels);
    } else {
      add(transmission_.tubes_of(sensor_), nullptr, 0, channels);
    }
  }

 private:
  /// Returns the largest distance from the transmitter at which a channel may receive a target. Half of the
  /// path is then as long as the range of the sensor. It is no less than the distance from the transmitter,
  /// minus half of the distances of both elements. An element that moves counts at the times at which it
  /// sends and at the end of the record.
  double reach_m(std::span<const SignalChannel> channels) const {
    const glm::dvec3 transmitter_m = transmission_.pose().position_m;
    const double pulse_s = model_.waveform.duration_s, end_s = model_.sampling.end_s();
    double beyond_m = 0;
    for (const SignalChannel& channel : channels) {
      double sent_m = glm::distance(transmitter_m, channel.transmit_m),
             received_m = glm::distance(transmitter_m, channel.receive_m);
      if (channel.transmit_motion)
        sent_m = std::max(sent_m, glm::distance(transmitter_m, channel.transmit_motion(pulse_s)));
      if (channel.receive_motion)
        for (const double at_s : {std::max(end_s - pulse_s, 0.0), end_s})
          received_m = std::max(received_m, glm::distance(transmitter_m, channel.receive_motion(at_s)));
      beyond_m = std::max(beyond_m, (sent_m + received_m) / 2);
    }
    return target_reach(transmission_).farthest_m + beyond_m;
  }
  /// Calls use(target) for the targets within a reach in the tubes of both ends that both ends see; null: one
  /// end.
  template <class Use>
  void add_targets_between(const WaterTargets& targets, const TubeSet& sent, const TubeSet* received,
                           double farthest_m, const Use& use) const {
    const FacetMesh& mesh = transmission_.surface_mesh().mesh();
    const SceneTree& tree = transmission_.surface_mesh().tree();
    const TubeWalls tx(sent);
    std::optional<TubeWalls> rx;
    if (received != nullptr) rx.emplace(*received);
    std::vector<std::uint32_t> found;
    each_target_in(targets, tx, transmission_.scene().grid, {0, farthest_m},
                   [&](const WaterTarget& target, std::span<const std::uint32_t>) {
                     if (rx) {
                       rx->find(target.at, found);
                       if (found.empty()) return;
                     }
                     if (is_target_in_view(mesh, tree, tx.apex(), target.at) &&
                         (!rx || is_target_in_view(mesh, tree, rx->apex(), target.at)))
                       use(target);
                   });
  }
  /// Returns the tubes of the sensor's receiver at a position.
  TubeSet tubes_from(glm::dvec3 receiver_m) const {
    Pose pose = transmission_.receiver_pose();
    pose.position_m = receiver_m;
    return transmission_.sensor(sensor_).tubes(pose, transmission_.scene().grid, transmission_.number());
  }
  ChannelSignals silence_of(const std::vector<SignalChannel>& channels) const {
    ChannelSignals none{channels.size(), receiver_.times.count, {}};
    none.value.assign(none.channels * none.samples, 0);
    return none;
  }
  /// Calls use(common visibility, its channels), in the order of the channels.
  template <class Use>
  void for_views(const History& history, const Use& use) const {
    if (model_.own_views)
      for (const SignalChannel& channel : receiver_.channels)
        use(CommonVisibility(seen_with(channel.receive_m)), std::vector{channel});
    else if (transmission_.has_separate_receiver())
      use(CommonVisibility(transmission_.trace_both()), receiver_.channels);
    else
      use(CommonVisibility(history), receiver_.channels);
  }
  CoherentReceiver receiver_with(std::vector<SignalChannel> channels) const {
    CoherentReceiver receiver = receiver_;
    receiver.channels = std::move(channels);
    return receiver;
  }
  const SmoothSurface* surface_of(FacetId facet, const EchoModel& echo_model) const {
    return transmission_.scene().smooth_surface(echo_model.material[facet]);
  }
  /// Returns null for mirrors, because the images of paths over mirrors already contain the echo of the
  /// mirror's plane.
  const SmoothSurface* received_of(FacetId facet, const EchoModel& echo_model) const {
    return transmission_.scene().material_reflection[echo_model.material[facet]] > 0
               ? nullptr
               : surface_of(facet, echo_model);
  }
  ChannelSignals of(const VisiblePolygons& seen, std::vector<SignalChannel> channels,
                    const EchoModel& echo_model) const {
    const CoherentReceiver receiver = receiver_with(std::move(channels));
    const SplitPolygons patches =
        split_polygons(seen, [&](FacetId facet) { return surface_of(facet, echo_model) != nullptr; });
    check_number(patches.rough, field_);
    ChannelSignals all = element_signals(patches.rough, receiver, echo_model, field_, model_.tolerance);
    if (!patches.smooth.patches.empty())
      superpose(smooth_signals(
                    patches.smooth, receiver, echo_model,
                    [&](FacetId facet) { return received_of(facet, echo_model); }, model_.tolerance),
                1, all);
    return all;
  }
  CertifiedSignals certified(const CommonVisibility& visibility, const std::vector<SignalChannel>& channels,
                             double tolerance) const {
    const EchoModel& echo_model = echo_model_.model;
    const SplitPolygons patches =  // polygons with a bound first
        split_polygons(visible_polygons(visibility, echo_model), [&](FacetId facet) {
          const SmoothSurface* surface = surface_of(facet, echo_model);
          return surface != nullptr && std::ranges::all_of(channels, [&](const SignalChannel& channel) {
                   return CertifiedSmoothSignals::can_bound(*surface, channel, echo_model.path);
                 });
        });
    const auto surface = [&](FacetId facet) { return received_of(facet, echo_model); };
    const TransmitWaveform& waveform = model_.waveform;
    const BistaticHistory* apart = visibility.two_apexes();
    const CertifiedSmoothSignals enclosing(
        {transmission_.surface_mesh().mesh(),
         apart != nullptr ? apart->transmit.apex : transmission_.tubes_of(sensor_).apex, visibility.rx_m(),
         visibility.grid_unit_m()},
        {waveform.start_hz, waveform.stop_hz, waveform.duration_s, waveform.taper}, receiver_.times,
        model_.sampling.baseband_hz, receiver_.sound_speed_m_s);
    // The largest amplitude determines the permitted bound of all samples.
    const ChannelSignals about = patches.smooth.patches.empty()
                                     ? silence_of(channels)
                                     : smooth_signals(patches.smooth, receiver_with(channels), echo_model,
                                                      surface, std::max(model_.tolerance, 1e-2));
    std::vector<double> allowed;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      double loudest = 0;
      for (std::size_t k = 0; k < about.samples; ++k) loudest = std::max(loudest, std::abs(about.at(c, k)));
      allowed.push_back(tolerance * signal_floor * loudest);
    }
    CertifiedSignals all =
        enclosing.of(patches.smooth, channels, echo_model.absorption_db_per_m, surface, allowed);
    if (patches.rough.patches.empty()) return all;
    enclosing.leave_open(patches.rough, channels, all.bound);
    ChannelSignals others = of(patches.rough, channels, echo_model);
    mix(others, model_);
    for (std::size_t k = 0; k < all.bound.size(); ++k)
      if (std::isinf(all.bound[k].real())) all.signals.value[k] += others.value[k];
    return all;
  }
  BistaticHistory seen_with(glm::dvec3 receiver_m) const {
    const Scene& scene = transmission_.scene();
    TubeSet sent = transmission_.tubes_of(sensor_), received = tubes_from(receiver_m);
    // Half of a path is no less than the range from either end, minus half of the distance between the ends.
    const double apart =
        glm::distance(receiver_m, transmission_.pose().position_m) / (2 * scene.grid.unit_m());
    sent.reach += apart;
    received.reach += apart;
    return trace_bistatic(transmission_.surface_mesh().mesh(), transmission_.surface_mesh().tree(),
                          scene.grid.unit_m(), transmission_.request().visibility, sent, received);
  }

  const Transmission& transmission_;
  std::size_t sensor_;
  const SignalModel& model_;
  SensorModel echo_model_;
  CoherentReceiver receiver_;
  SurfaceField field_;
};

}  // namespace

std::vector<ChannelSignals> signal_derivatives(const Transmission& transmission, std::size_t s,
                                               const History& history,
                                               std::span<const EchoParameter> parameters) {
  std::vector<ChannelSignals> all = TransmissionSignals(transmission, s).derivatives(history, parameters);
  for (ChannelSignals& signals : all) mix(signals, *transmission.sensor(s).signals());
  return all;
}

CertifiedSignals signals_received(const Transmission& transmission, std::size_t s, const History& history) {
  try {
    const TransmissionSignals received(transmission, s);
    const SignalModel& model = *transmission.sensor(s).signals();
    const auto tolerance = transmission.request().reference_tolerance;
    ChannelSignals others = received.no_return();
    CertifiedSignals all;
    const bool direct = is_order_wanted(transmission.scene(), 1);
    if (tolerance && direct)
      all = received.certified(history, *tolerance);
    else if (direct)
      others = received.straight(history);
    received.add_mirrored(others);
    if (tolerance && !direct)
      all = {received.no_return(), std::vector<std::complex<double>>(others.value.size())};
    const bool has_targets = direct && has_water_targets(transmission.scene().description);
    if (has_targets) received.add_targets(others, all.bound);
    mix(others, model);
    if (!tolerance) return {std::move(others), {}};
    if (received.has_mirrors() || has_targets) superpose(others, 1, all.signals);
    if (received.has_mirrors()) {
      constexpr double open = std::numeric_limits<double>::infinity();
      std::ranges::fill(all.bound, std::complex(open, open));
    }
    return all;
  } catch (const std::invalid_argument& error) {
    throw InputError(transmission.sensor(s).description().place,
                     fmt::format("{}: {}", transmission.name(), error.what()));
  }
}

}  // namespace tubefoot
