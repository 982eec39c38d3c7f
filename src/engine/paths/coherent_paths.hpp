// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/paths/path_images.hpp"
#include "engine/signal/coherent_signals.hpp"

// Signals over mirrors, with their phases. docs/signals.md, "Over mirrors"
namespace tubefoot {

/// A place's image over the mirrors of an image of an apex: by their exact planes, in doubles.
/// Law I5 (unfolding): as far from a place behind the last mirror as the way over the chain is long.
/// `apex`, `apex_m`: any place on the grid, and where it is in the local frame.
glm::dvec3 image_of_place(glm::dvec3 place_m, std::span<const MirrorPlane> chain, GridPoint apex,
                          glm::dvec3 apex_m, double grid_unit_m);

/// What is scattered once between two images, as channels receive it: of straight ways between images of
/// their ends, by a law with the mirrors' losses, times `phase`.
struct CoherentPath {
  std::size_t order = 0;  ///< interactions: reflections and the scattering
  const Image *sent = nullptr, *received = nullptr;
  VisiblePolygons patches;
  std::vector<SignalChannel> channels;  ///< as they were given, but images
  EchoModel model;
  std::complex<double> phase = 1;  ///< of modulus 1: of all reflections
};

/// Calls `take` for all pairs of images, straight ways from apex to apex aside (those are
/// visible_polygons()'). At one place the two ways round, out over the one chain and home over the other or
/// the other way about, are two signals: both are reported.
///
/// `model`: of the ways between the apexes; its patterns are not read, channels have theirs. Channels see
/// what the apexes of `images`, which they are near to, and their images see. Law Y6 (images): the channels'
/// signals are those of sources and receivers at the images' places without mirrors. Law Y7 (reciprocity):
/// all ends exchanged, the sum over all paths is the same. Throws std::invalid_argument in refracting water
/// and for no channel; as PathImages::pairs().
void for_coherent_paths(const PathImages& images, const EchoModel& model,
                        std::span<const SignalChannel> channels,
                        const std::function<void(const CoherentPath&)>& take);

/// What comes to a channel over mirrors alone: `amplitude` e^{ik way} g(t - way / c).
struct ArrivingWave {
  double way_m = 0;
  std::complex<double> amplitude;  ///< with the phases of its reflections
};
/// The same over one chain, to all channels.
struct CoherentArrival {
  std::size_t order = 0;  ///< reflections
  const Image* sent = nullptr;
  std::vector<ArrivingWave> waves;  ///< by channel
};

/// Calls `take` for what path_echo() counts as arrivals: whether it comes is decided at the apexes, ways and
/// patterns are each channel's own. Throws as for_coherent_paths(), and for ends of a channel in one place
/// between which sound goes straight.
void for_coherent_arrivals(const PathImages& images, const EchoModel& model,
                           std::span<const SignalChannel> channels,
                           const std::function<void(const CoherentArrival&)>& take);

/// Adds them to signals of the same channels. Throws as element_signals(), and where channels are not as
/// many.
void add_arrival(const CoherentArrival& arrival, const CoherentReceiver& receiver, ChannelSignals& signals);

/// Adds signals of the same channels and samples, times a factor. Throws std::invalid_argument where they are
/// not.
void superpose(const ChannelSignals& part, std::complex<double> factor, ChannelSignals& sum);

/// All of it by a field that belongs to the surface: element_signals() of every path, and arrivals; what
/// comes straight is not in it. Paths meet the same field, so they interfere. Throws as these.
ChannelSignals mirrored_signals(const PathImages& images, const CoherentReceiver& receiver,
                                const EchoModel& model, const SurfaceField& field, double tolerance = 1e-3);

}  // namespace tubefoot
