// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/certified/reference.hpp"
#include "engine/echo/finer_relief.hpp"
#include "engine/echo/lit_echo.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Keeps the worse of two pings' bounds; of equals the one met first.
void keep_worst(PingCounts& kept, const PingCounts& met);

/// Where the parts of a ping's echoes are added up: energies and bounds, and what was counted.
class PingSums {
 public:
  /// `values` are zero. `chosen`, by sensor, outlives it, as they do: what is not chosen is not kept.
  PingSums(const std::vector<ChosenEchoes>& chosen, PingValues& values) : chosen_(chosen), values_(values) {}

  PingCounts counts;
  FinerRelief finer_relief;

  /// Energies of paths with `order` interactions that a sensor receives of a transmission:
  /// [channel][beam of the transmission][sample].
  /// `lit`, by row of samples: those outside are 0; none: any may be lit.
  void add(const Transmission& transmission, std::size_t sensor, std::size_t order,
           std::span<const double> energy, std::span<const SampleSpan> lit = {});
  /// The same with their bounds.
  void add(const Transmission& transmission, std::size_t sensor, const CertifiedEcho& certified,
           std::size_t order = 1);
  /// To a channel of the truth of what a sensor receives (Truth::channels()): [beam of the
  /// transmission][sample], and more channels, which are not read.
  void add_labels(const Transmission& transmission, std::size_t sensor, std::size_t channel,
                  std::span<const double> values);
  /// To the signals of what its elements record: [receiver][sample][real, imaginary]; with their bounds, or
  /// none.
  void add_signals(const Transmission& transmission, std::size_t sensor, std::span<const double> values,
                   std::span<const double> bounds);
  /// What finer relief than the facets that are seen would change of it.
  void add_finer_relief(const Transmission& transmission, const CommonVisibility& visibility,
                        const FacetMesh& mesh, double sample_m);
  /// Transmission::echo(), in memory that pings share one after the other, and `use` of it.
  void with_echo(const Transmission& transmission, const CommonVisibility& visibility, std::size_t sensor,
                 const EchoModel& model, const std::function<void(const LitEcho&)>& use);
  /// Does a part of the work whose seconds are the echo's, not those of what is seen.
  template <class Work>
  void as_echo(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    counts.echo_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  /// What the last transmission saw of the surface that all transmissions share, for one that looks through
  /// the same tubes.
  struct Seen {
    History history;
    std::size_t candidates = 0;
    std::vector<bool> wanted;
  };
  std::optional<Seen> seen;

  const ChosenEchoes& chosen(std::size_t sensor) const { return chosen_[sensor]; }

 private:
  const std::vector<ChosenEchoes>& chosen_;
  PingValues& values_;
};

}  // namespace tubefoot
