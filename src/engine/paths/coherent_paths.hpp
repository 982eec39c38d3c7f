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

// Computes signals of paths over mirrors, with their phases. An unscattered path contributes `amplitude`
// e^{ik path} g(t - path / c) to a channel. Source: docs/notes/signals.md, "Mirrors".
namespace tubefoot {

/// Image of a place in a chain of mirrors, computed in doubles from the exact planes.
/// Law I5 (unfolding): its distance from a place behind the last mirror is the length of the path over the
/// chain. `apex`, `apex_m`: any place on the grid, and its position in the local frame.
glm::dvec3 image_of_place(glm::dvec3 place_m, std::span<const MirrorPlane> chain, GridPoint apex,
                          glm::dvec3 apex_m, double grid_unit_m);

/// Single scattering between two images, as channels receive it. Paths are straight lines between the images
/// of the channels' ends. The model contains the losses of the mirrors, and the signal is multiplied by
/// `phase`.
struct CoherentPath {
  std::size_t order = 0;  ///< number of interactions: reflections and the scattering
  const Image *sent = nullptr, *received = nullptr;
  VisiblePolygons patches;
  std::vector<SignalChannel> channels;  ///< given channels with their ends replaced by images
  EchoModel model;
  std::complex<double> phase = 1;  ///< product of the reflections' phases, of modulus 1
};

/// Calls `take` for each pair of images that has a mirror. (visible_polygons() covers the paths without
/// mirrors.) In a monostatic sonar each pair of different images has two signals, one per direction of
/// sound. Both are reported.
///
/// `model`: model of the paths between the apexes. Channels have their own patterns, so those of the model
/// are not used. The apexes of `images` must be near the ends of the channels, which see the surface that
/// these apexes and their images see.
/// Law Y6 (images): the signals equal those of sources and receivers at the positions of the images, without
/// mirrors.
/// Law Y7 (reciprocity): the sum over all paths is the same if the ends of all channels are exchanged.
/// Throws std::invalid_argument in refracting water and without a channel, and the exceptions of
/// PathImages::pairs().
void for_coherent_paths(const PathImages& images, const EchoModel& model,
                        std::span<const SignalChannel> channels,
                        const std::function<void(const CoherentPath&)>& take);

/// Unscattered arrival at a channel: `amplitude` e^{ik path} g(t - path / c).
struct ArrivingWave {
  double way_m = 0;
  std::complex<double> amplitude;  ///< includes the phases of the reflections
};
/// Unscattered arrivals over one chain of mirrors at all channels.
struct CoherentArrival {
  std::size_t order = 0;  ///< number of reflections
  const Image* sent = nullptr;
  std::vector<ArrivingWave> waves;  ///< per channel
};

/// Calls `take` for each arrival of path_echo(). The apexes decide whether sound arrives. Path lengths and
/// patterns are those of each channel. Throws the exceptions of for_coherent_paths(), and
/// std::invalid_argument for a direct path between ends of a channel at one place.
void for_coherent_arrivals(const PathImages& images, const EchoModel& model,
                           std::span<const SignalChannel> channels,
                           const std::function<void(const CoherentArrival&)>& take);

/// Adds an arrival to signals of the same channels. Throws the exceptions of element_signals(), and
/// std::invalid_argument if the numbers of channels differ.
void add_arrival(const CoherentArrival& arrival, const CoherentReceiver& receiver, ChannelSignals& signals);

/// Adds signals times a factor. Throws std::invalid_argument if the numbers of channels or samples differ.
void superpose(const ChannelSignals& part, std::complex<double> factor, ChannelSignals& sum);

/// Signals of all paths over mirrors for a scene-fixed scatterer field: element_signals() of every scattered
/// path, and the arrivals. The result excludes the signals of paths without mirrors. All paths meet the same
/// field, so they interfere. Throws the exceptions of both functions.
ChannelSignals mirrored_signals(const PathImages& images, const CoherentReceiver& receiver,
                                const EchoModel& model, const SurfaceField& field, double tolerance = 1e-3);

}  // namespace tubefoot
