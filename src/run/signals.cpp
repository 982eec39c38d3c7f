// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "engine/signal/smooth_signals.hpp"
#include "run/echo_parts.hpp"
#include "run/paths.hpp"
#include "run/shot_images.hpp"
#include "run/signal_paths.hpp"
#include "run/stored_pings.hpp"
#include "sensors/recordings/signal_recording.hpp"

namespace tubefoot {
namespace {

constexpr double pi = std::numbers::pi;

const SignalModel* model_of(const Survey& survey, std::size_t s) {
  return survey.sensors[s].sensor->signals();
}

/// As many in one sight take most of an hour, and a slip of the pen soon asks for a million times as many.
constexpr double most_scatterers = 1e10;

/// Throws std::invalid_argument for a field that has too many scatterers on what is seen.
void check_number(const SeenPatches& seen, const GroundField& field) {
  double count = 0;
  for (const SeenPatch& patch : seen.patches) {
    const std::span<const glm::dvec3> corners = seen.corners(patch);
    glm::dvec3 twice(0);
    for (std::size_t k = 2; k < corners.size(); ++k)
      twice += glm::cross(corners[k - 1] - corners[0], corners[k] - corners[0]);
    count += glm::length(twice) / 2 / field.area_m2(patch.normal);
  }
  if (count > most_scatterers)
    throw std::invalid_argument(
        fmt::format("{:.2g} scatterers {:.3g} m apart lie on what it sees, {:g} are the most: give a "
                    "'spacing_m' of {:.2g} m "
                    "or more in [scatterers], or let it look at less",
                    count, field.spacing_m, most_scatterers,
                    1.05 * field.spacing_m * std::sqrt(count / most_scatterers)));
}

std::size_t values_of(const SignalModel& model) {
  return 2 * model.array.receivers_m.size() * model.sampling.samples;
}

/// About the middle of the waveform's band, where its bandwidth is least.
double carrier_hz(const SignalModel& model) { return model.waveform.centre_hz(); }

CoherentReceiver receiver_of(const Shot& shot, std::size_t s) {
  const SignalModel& model = *shot.sensor(s).signals();
  const FrequencyBand band = band_of(model.waveform);
  // Flanks have tails beyond the waveform's band: what samples hold of them counts, up to four times the
  // band, and above frequency 0.
  const double band_hz = band.high_hz - band.low_hz,
               held_hz = std::max(band_hz,
                                  std::min({model.sampling.rate_hz, 4 * band_hz, 1.9 * carrier_hz(model)}));
  CoherentReceiver receiver;
  receiver.channels = signal_channels(shot, s);
  receiver.pulse = {[waveform = model.waveform, carrier = carrier_hz(model)](double time_s) {
                      return baseband_at(waveform, carrier, time_s);
                    },
                    0, model.waveform.duration_s, held_hz};
  receiver.times = {model.sampling.first_s, model.sampling.rate_hz, model.sampling.samples};
  receiver.carrier_hz = carrier_hz(model);
  receiver.sound_speed_m_s = shot.survey().sensors[s].sound_speed_m_s;
  return receiver;
}

/// What a ping needs of a track, with times from its start on: clocks that count seconds of years would round
/// times within a ping to steps, on which nothing can be told to move.
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

/// What a sensor's elements record, [receiver][sample][real, imaginary]: about the frequency that the sonar
/// mixes with.
std::vector<double> recorded(const ChannelSignals& signals, const SignalModel& model) {
  std::vector<double> values;
  values.reserve(2 * signals.value.size());
  const double shift_hz = model.sampling.baseband_hz - carrier_hz(model);
  for (std::size_t channel = 0; channel < signals.channels; ++channel)
    for (std::size_t k = 0; k < signals.samples; ++k) {
      std::complex<double> value = signals.at(channel, k);
      if (shift_hz != 0) value *= std::polar(1.0, 2 * pi * shift_hz * model.sampling.time_s(k));
      values.insert(values.end(), {value.real(), value.imag()});
    }
  return values;
}

}  // namespace

std::size_t place_of_signals(const Survey& survey, std::size_t sensor) {
  return survey.sensors.size() + sensor;
}

std::size_t places_of_signals(const Survey& survey) {
  for (std::size_t s = 0; s < survey.sensors.size(); ++s)
    if (model_of(survey, s) != nullptr) return survey.sensors.size();
  return 0;
}

void add_signals(StoreLayout& layout, const Survey& survey, const std::vector<ChosenEchoes>& chosen) {
  if (places_of_signals(survey) == 0) return;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    const SignalModel* model = model_of(survey, s);
    layout.sensors.push_back(
        {model != nullptr ? chosen[s].pings : 0, model != nullptr ? values_of(*model) : 0});
  }
  for (StoreLayout::Group& group : layout.groups) {
    const std::vector<std::size_t> sensors = group.sensors;
    for (const std::size_t s : sensors)
      if (model_of(survey, s) != nullptr) group.sensors.push_back(place_of_signals(survey, s));
  }
}

GroundField ground_field_of(const Survey& survey) {
  const ScatterersDescription& asked = survey.scene.description.scatterers;
  GroundField field;
  field.seed = survey.scene.description.run.seed;
  field.texture = asked.texture == "gamma"        ? GroundTexture::gamma
                  : asked.texture == "log_normal" ? GroundTexture::log_normal
                                                  : GroundTexture::none;
  field.shape = asked.texture_shape;
  field.texture_cell_m = asked.texture_cell_m;
  field.spacing_m = asked.spacing_m.value_or(HUGE_VAL);
  for (std::size_t s = 0; s < survey.sensors.size() && !asked.spacing_m; ++s) {
    const SignalModel* model = model_of(survey, s);
    if (model == nullptr) continue;
    const Sensor& sensor = *survey.sensors[s].sensor;
    const double c = survey.sensors[s].sound_speed_m_s;
    const FrequencyBand band = band_of(model->waveform);
    field.spacing_m =
        std::min(field.spacing_m, ground_spacing_m(band.high_hz - band.low_hz, c / carrier_hz(*model), c,
                                                   sensor.beams().front().azimuth_width_rad));
  }
  return field;
}

std::vector<SignalChannel> signal_channels(const Shot& shot, std::size_t s) {
  const Sensor& sensor = shot.sensor(s);
  const SensorPings& pings = shot.survey().sensors[s];
  const ElementArray& array = sensor.signals()->array;
  const Pose& sent = pings.shot_pose(shot.ping(), shot.number());
  const Pose& heard = pings.receiver_pose(shot.ping(), shot.number());
  SignalChannel channel;
  channel.transmit_m = sent.position_m + sent.attitude * array.transmitter_m;
  if (sensor.has_patterns()) {
    const BeamPatterns patterns = sensor.patterns(sent, pings.sound_speed_m_s, shot.number());
    if (!patterns.transmit.front().beams.empty()) channel.transmit = patterns.transmit.front().beams.front();
    channel.receive = patterns.receive.front();
  }
  const Trajectory& track = shot.scene().trajectories[shot.scene().sensor_trajectory[s]];
  std::shared_ptr<const Trajectory> on_the_way;
  if (!sensor.signals()->stop_and_hop && !track.is_fixed())
    on_the_way = std::make_shared<const Trajectory>(
        track_from(track, pings.times_s[shot.ping()], sensor.signals()->sampling.end_s()));
  /// Of a place on the sensor, by where that or its receiver is.
  const auto way = [&](Pose (Sensor::*pose_on)(const Pose&) const, glm::dvec3 place) -> EndWay {
    if (!on_the_way) return {};
    return [&sensor, on_the_way, pose_on, place](double after_start_s) {
      const Pose pose = (sensor.*pose_on)(on_the_way->at(after_start_s));
      return pose.position_m + pose.attitude * place;
    };
  };
  channel.transmit_way = way(&Sensor::pose_on, array.transmitter_m);
  std::vector<SignalChannel> channels;
  for (const glm::dvec3 place : array.receivers_m) {
    channel.receive_m = heard.position_m + heard.attitude * place;
    channel.receive_way = way(&Sensor::receiver_pose_on, place);
    channels.push_back(channel);
  }
  return channels;
}

void attach_signals(std::vector<Recording>& recordings, const Survey& survey,
                    const std::vector<ChosenEchoes>& chosen, const std::shared_ptr<PingStore>& store) {
  std::size_t number = 0;
  for (std::size_t s = 0; s < chosen.size(); ++s) {
    if (chosen[s].pings == 0) continue;
    Recording& recording = recordings.at(number++);
    if (model_of(survey, s) == nullptr) continue;
    const auto signals = std::make_shared<SignalRecording>();
    const std::size_t place = place_of_signals(survey, s);
    signals->values = in_memory(store, place);
    signals->packed = packed_pings(store, place);
    signals->keeper = store;
    if (recording.sensor->description().look_at_m)
      for (std::size_t ping = 0; ping < recording.pings(); ++ping)
        signals->track.push_back({recording.ping_time_s[ping], recording.ping_pose[ping]});
    else
      signals->track = survey.scene.trajectories[survey.scene.sensor_trajectory[s]].samples();
    recording.signals = signals;
  }
}

namespace {

/// How the elements of a sensor hear a shot.
class ShotSignals {
 public:
  ShotSignals(const Shot& shot, std::size_t s)
      : shot_(shot),
        sensor_(s),
        model_(*shot.sensor(s).signals()),
        law_(shot, shot.ground(), s),
        receiver_(receiver_of(shot, s)),
        field_(ground_field_of(shot.survey())) {}

  ChannelSignals silence() const {
    ChannelSignals none{receiver_.channels.size(), receiver_.times.count, {}};
    none.value.assign(none.channels * none.samples, 0);
    return none;
  }
  /// What all receivers hear of one sight.
  ChannelSignals of(const Sight& sight) const {
    return of(seen_patches(sight, law_.law), receiver_.channels, law_.law);
  }
  /// What each hears of its own.
  ChannelSignals of_own_sights() const {
    ChannelSignals all{receiver_.channels.size(), receiver_.times.count, {}};
    for (const SignalChannel& channel : receiver_.channels) {
      const ChannelSignals its =
          of(seen_patches(seen_with(channel.receive_m), law_.law), {channel}, law_.law);
      all.value.insert(all.value.end(), its.value.begin(), its.value.end());
    }
    return all;
  }
  /// Adds what comes over mirrors.
  void add_mirrored(ChannelSignals& sum) const {
    for_signal_paths(shot_, sensor_, receiver_.channels,
                     {[&](const CoherentPath& path) {
                        superpose(of(path.patches, path.channels, path.law), path.phase, sum);
                      },
                      [&](const CoherentArrival& arrival) { add_arrival(arrival, receiver_, sum); }});
  }

 private:
  ChannelSignals of(const SeenPatches& seen, std::vector<SignalChannel> channels, const EchoLaw& law) const {
    CoherentReceiver receiver = receiver_;
    receiver.channels = std::move(channels);
    const auto surface_of = [&](FacetId facet) { return shot_.scene().smooth_surface(law.material[facet]); };
    // What mirrors is heard by its images, which have the echo of its plane.
    const auto heard_of = [&](FacetId facet) {
      return shot_.scene().material_reflection[law.material[facet]] > 0 ? nullptr : surface_of(facet);
    };
    const SplitPatches patches =
        split_patches(seen, [&](FacetId facet) { return surface_of(facet) != nullptr; });
    check_number(patches.rough, field_);
    ChannelSignals all = element_signals(patches.rough, receiver, law, field_, model_.tolerance);
    if (!patches.smooth.patches.empty())
      superpose(smooth_signals(patches.smooth, receiver, law, heard_of, model_.tolerance), 1, all);
    return all;
  }
  BistaticHistory seen_with(glm::dvec3 receiver_m) const {
    const Scene& scene = shot_.scene();
    Pose pose = shot_.receiver_pose();
    pose.position_m = receiver_m;
    TubeSet sent = shot_.tubes_of(sensor_),
            heard = shot_.sensor(sensor_).tubes(pose, scene.grid, shot_.number());
    // Half of a path is no less than the range from either end, less half of the way between them.
    const double apart = glm::distance(receiver_m, shot_.pose().position_m) / (2 * scene.grid.unit_m());
    sent.reach += apart;
    heard.reach += apart;
    return trace_bistatic(shot_.ground().mesh(), shot_.ground().tree(), scene.grid.unit_m(),
                          shot_.request().visibility, sent, heard);
  }

  const Shot& shot_;
  std::size_t sensor_;
  const SignalModel& model_;
  SensorLaw law_;
  CoherentReceiver receiver_;
  GroundField field_;
};

}  // namespace

ChannelSignals signals_heard(const Shot& shot, std::size_t s, const History& history) {
  try {
    const ShotSignals heard(shot, s);
    ChannelSignals all = !is_order_wanted(shot.scene(), 1)      ? heard.silence()
                         : shot.sensor(s).signals()->own_sights ? heard.of_own_sights()
                         : shot.has_receiver_apart()            ? heard.of(shot.trace_both())
                                                                : heard.of(history);
    heard.add_mirrored(all);
    return all;
  } catch (const std::invalid_argument& error) {
    throw InputError(shot.sensor(s).description().place, fmt::format("{}: {}", shot.name(), error.what()));
  }
}

void add_signals(const Shot& shot, PingSums& sums) {
  for (const std::size_t s : shot.group().sensors) {
    const SignalModel* model = shot.sensor(s).signals();
    if (model == nullptr || sums.chosen(s).pings == 0) continue;
    const bool sees_itself =
        model->own_sights || shot.has_receiver_apart() || !is_order_wanted(shot.scene(), 1);
    const History nothing{};
    const History& history = sees_itself ? nothing : traced(shot, sums);
    sums.as_echo([&] { sums.add_signals(shot, s, recorded(signals_heard(shot, s, history), *model)); });
  }
}

}  // namespace tubefoot
