// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/coherent_paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"

// Reflects the ends of the channels in the mirrors of the images, and adds the signals of all scattered
// paths and arrivals with their phases. Source: docs/notes/signals.md, "Mirrors".

namespace tubefoot {
namespace {

glm::dvec3 units(const Vec64& v) { return {double(v.x), double(v.y), double(v.z)}; }

/// Positions of images in the local frame, and images of channels.
class ImageFrame {
 public:
  ImageFrame(const PathImages& images, const EchoModel& model)
      : apex_(images.sent().front().windows.apex),
        apex_m_(model.path.tx.apex_m),
        unit_m_(images.grid_unit_m()) {}

  glm::dvec3 place_m(const Image& image) const {
    return apex_m_ + displacement_m(apex_, image.windows.apex, unit_m_);
  }
  glm::dvec3 image_of(glm::dvec3 place_m, const Image& image) const {
    return image_of_place(place_m, image.chain, apex_, apex_m_, unit_m_);
  }
  SignalChannel image_of(SignalChannel channel, const Image& sent, const Image& received) const {
    channel.transmit_m = image_of(channel.transmit_m, sent);
    channel.receive_m = image_of(channel.receive_m, received);
    // Same reflection as in as_images_have().
    channel.transmit.axis = glm::transpose(sent.leg.to_true) * channel.transmit.axis;
    channel.receive.axis = glm::transpose(received.leg.to_true) * channel.receive.axis;
    return channel;
  }

 private:
  GridPoint apex_;
  glm::dvec3 apex_m_;
  double unit_m_;
};

void check_coherent(const PathImages& images, std::span<const SignalChannel> channels) {
  if (images.is_cut())
    throw std::invalid_argument(
        "signals with mirror paths need straight rays: use water with a constant sound speed, or leave out "
        "mirrors or signals");
  if (std::ranges::any_of(channels, [](const SignalChannel& channel) { return channel.has_path(); }))
    throw std::invalid_argument(
        "signals with mirror paths need transmitters and receivers at rest: leave out the motions of the "
        "channels, or the mirrors");
  if (channels.empty()) throw std::invalid_argument("signals need at least one channel");
}

}  // namespace

glm::dvec3 image_of_place(glm::dvec3 place_m, std::span<const MirrorPlane> chain, GridPoint apex,
                          glm::dvec3 apex_m, double grid_unit_m) {
  for (const MirrorPlane& plane : chain) {
    const glm::dvec3 normal = units(plane.normal);
    const double length = glm::length(normal);
    const glm::dvec3 unit = normal / length;
    // Exact distance of the grid point, plus the distance of the place from there.
    const double distance_m =
        static_cast<double>(plane.side(apex)) / length * grid_unit_m + glm::dot(unit, place_m - apex_m);
    place_m -= 2 * distance_m * unit;
  }
  return place_m;
}

void for_coherent_paths(const PathImages& images, const EchoModel& model,
                        std::span<const SignalChannel> channels,
                        const std::function<void(const CoherentPath&)>& take) {
  check_coherent(images, channels);
  const ImageFrame frame(images, model);
  EchoModel own = model;
  own.patterns = nullptr;
  const auto tell = [&](const Image& sent, const Image& received, const BistaticHistory& seen) {
    stop_if_wanted();
    CoherentPath path;
    path.order = sent.mirrors + received.mirrors + 1;
    path.sent = &sent;
    path.received = &received;
    path.patches = patches_between(seen, frame.place_m(sent));
    for (const SignalChannel& channel : channels)
      path.channels.push_back(frame.image_of(channel, sent, received));
    path.model = images.model(sent, received, own, {}).model;
    path.phase = sent.phase * received.phase;
    take(path);
  };
  for (const ImagePair& pair : images.pairs()) {
    const Image &sent = images.sent()[pair.sent], &received = images.received()[pair.received];
    BistaticHistory seen = images.history(sent, received);
    if (seen.shared.pieces.empty()) continue;
    tell(sent, received, seen);
    if (!images.one_place() || &sent == &received) continue;
    std::swap(seen.transmit, seen.receive);
    seen.shared = exchanged(std::move(seen.shared));
    tell(received, sent, seen);
  }
}

void for_coherent_arrivals(const PathImages& images, const EchoModel& model,
                           std::span<const SignalChannel> channels,
                           const std::function<void(const CoherentArrival&)>& take) {
  check_coherent(images, channels);
  const ImageFrame frame(images, model);
  const double beta = absorption_per_m(model.absorption_db_per_m);
  const glm::dvec3 receiver_m = frame.place_m(images.received().front());
  for (const Image& sent : images.arriving()) {
    const MirrorLoss& loss = sent.leg.loss;
    if (!(loss.at(glm::normalize(receiver_m - frame.place_m(sent))) > images.least())) continue;
    CoherentArrival arrival{sent.mirrors, &sent, {}};
    for (const SignalChannel& channel : channels) {
      const glm::dvec3 way = channel.receive_m - frame.image_of(channel.transmit_m, sent);
      const double length = glm::length(way);
      if (!(length > 0))
        throw std::invalid_argument(
            fmt::format("channel {} transmits and receives at the same position: move one of its ends, or "
                        "leave out the direct path",
                        arrival.waves.size()));
      const glm::dvec3 direction = way / length;
      arrival.waves.push_back({length, std::sqrt(loss.at(direction) * std::exp(-beta * length)) / length *
                                           amplitude_pattern(channel.transmit, sent.leg.to_true * direction) *
                                           amplitude_pattern(channel.receive, -direction) * sent.phase});
    }
    take(arrival);
  }
}

void add_arrival(const CoherentArrival& arrival, const CoherentReceiver& receiver, ChannelSignals& signals) {
  check(receiver.pulse, receiver.times);
  if (arrival.waves.size() != receiver.channels.size() || signals.channels != arrival.waves.size() ||
      signals.samples != receiver.times.count)
    throw std::invalid_argument(
        fmt::format("{} arrivals do not match {} channels with {} samples, or the signals have another size: "
                    "{} channels with {} samples",
                    arrival.waves.size(), receiver.channels.size(), receiver.times.count, signals.channels,
                    signals.samples));
  const PulseTable table(receiver.pulse, receiver.times);
  const double k = 2 * std::numbers::pi * receiver.carrier_hz / receiver.sound_speed_m_s;
  for (std::size_t c = 0; c < arrival.waves.size(); ++c) {
    const ArrivingWave& wave = arrival.waves[c];
    table.add(wave.amplitude * std::polar(1.0, k * wave.way_m), wave.way_m / receiver.sound_speed_m_s,
              &signals.value[c * signals.samples]);
  }
}

void superpose(const ChannelSignals& part, std::complex<double> factor, ChannelSignals& sum) {
  if (part.channels != sum.channels || part.samples != sum.samples || part.value.size() != sum.value.size())
    throw std::invalid_argument(fmt::format(
        "signals of {} channels with {} samples cannot be added to signals of {} channels with {} samples",
        part.channels, part.samples, sum.channels, sum.samples));
  for (std::size_t n = 0; n < sum.value.size(); ++n) sum.value[n] += factor * part.value[n];
}

ChannelSignals mirrored_signals(const PathImages& images, const CoherentReceiver& receiver,
                                const EchoModel& model, const SurfaceField& field, double tolerance) {
  ChannelSignals sum{receiver.channels.size(), receiver.times.count, {}};
  sum.value.assign(sum.channels * sum.samples, 0);
  CoherentReceiver own = receiver;
  for_coherent_paths(images, model, receiver.channels, [&](const CoherentPath& path) {
    own.channels = path.channels;
    superpose(element_signals(path.patches, own, path.model, field, tolerance), path.phase, sum);
  });
  for_coherent_arrivals(images, model, receiver.channels,
                        [&](const CoherentArrival& arrival) { add_arrival(arrival, receiver, sum); });
  return sum;
}

}  // namespace tubefoot
