// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/signals.hpp"

#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include "run/signal_gradients.hpp"
#include "run/stored_pings.hpp"
#include "run/transmission_images.hpp"
#include "sensors/recordings/signal_recording.hpp"

namespace tubefoot {
namespace {

const SignalModel* model_of(const Survey& survey, std::size_t s) {
  return survey.sensors[s].sensor->signals();
}

}  // namespace

std::vector<double> parts_of(std::span<const std::complex<double>> values) {
  std::vector<double> parts;
  parts.reserve(2 * values.size());
  for (const std::complex<double>& value : values) parts.insert(parts.end(), {value.real(), value.imag()});
  return parts;
}

void attach_signals(std::vector<Recording>& recordings, const Survey& survey,
                    const std::vector<ChosenEchoes>& chosen, const std::shared_ptr<PingStore>& store) {
  std::size_t number = 0;
  for (std::size_t s = 0; s < chosen.size(); ++s) {
    if (chosen[s].pings == 0) continue;
    Recording& recording = recordings.at(number++);
    if (model_of(survey, s) == nullptr) continue;
    const auto signals = std::make_shared<SignalRecording>();
    signals->pressure = recorded_channel(store, s, "signals");
    signals->bound = recorded_channel(store, s, "signals_bound");
    signals->derivatives = recorded_signal_gradients(survey, s, store);
    if (recording.sensor->description().look_at_m)
      for (std::size_t ping = 0; ping < recording.pings(); ++ping)
        signals->track.push_back({recording.ping_time_s[ping], recording.ping_pose[ping]});
    else
      signals->track = survey.scene.trajectories[survey.scene.sensor_trajectory[s]].samples();
    recording.signals = signals;
  }
}

void add_signals(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0) continue;
    const bool sees_itself = transmission.sensor(s).signals()->own_views ||
                             transmission.has_separate_receiver() ||
                             !is_order_wanted(transmission.scene(), 1);
    const History nothing{};
    const History& history = sees_itself ? nothing : traced(transmission, sums);
    sums.as_echo([&] {
      const CertifiedSignals received = signals_received(transmission, s, history);
      sums.add_signals(s, parts_of(received.signals.value), parts_of(received.bound));
    });
  }
}

}  // namespace tubefoot
