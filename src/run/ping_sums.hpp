// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/certified/reference.hpp"
#include "engine/echo/echo.hpp"
#include "engine/echo/finer_relief.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Keeps the worse of two pings' bounds, or the first one if they are equal.
void keep_worst(PingCounts& kept, const PingCounts& met);

/// Sums of the parts of a ping's echoes: energies, bounds and counts.
class PingSums {
 public:
  /// `values` are zero at first. `chosen` has one entry per sensor; energies outside of the selection are
  /// dropped. Both arguments must outlive this object.
  PingSums(const std::vector<ChosenEchoes>& chosen, PingValues& values) : chosen_(chosen), values_(values) {}

  PingCounts counts;
  FinerRelief finer_relief;

  /// Adds the energies of paths with `order` interactions that a sensor receives from a transmission:
  /// [channel][beam of the transmission][sample].
  /// `nonzero`: see Echo.
  void add(const Transmission& transmission, std::size_t sensor, std::size_t order,
           std::span<const double> energy, std::span<const SampleSpan> nonzero = {});
  /// Adds energies with their bounds.
  void add(const Transmission& transmission, std::size_t sensor, const CertifiedEcho& certified,
           std::size_t order = 1);
  /// Adds values to one of the arrays over beams and samples in an output channel of a sensor: [beam of the
  /// transmission][sample]. Further values are ignored.
  void add_to_channel(const Transmission& transmission, std::size_t sensor, std::string_view channel,
                      std::size_t array, std::span<const double> values);
  /// Adds values to an output channel over beams: one per beam of the transmission.
  void add_to_beams(const Transmission& transmission, std::size_t sensor, std::string_view channel,
                    std::span<const double> values);
  /// Adds values to the signals that a sensor's elements record: [receiver][sample][real, imaginary].
  /// `bounds`: bounds of the values, or empty.
  void add_signals(std::size_t sensor, std::span<const double> values, std::span<const double> bounds);
  /// Adds values to an output channel with the layout of the signals.
  void add_to_signals(std::size_t sensor, std::string_view channel, std::span<const double> values);
  /// Adds the change that relief finer than the visible facets would cause.
  void add_finer_relief(const Transmission& transmission, const CommonVisibility& visibility,
                        const FacetMesh& mesh, double sample_m);
  /// Calls `use` with the result of Transmission::echo(). The memory of the echo is shared by successive
  /// pings.
  void with_echo(const Transmission& transmission, const CommonVisibility& visibility, std::size_t sensor,
                 const EchoModel& model, const std::function<void(const Echo&)>& use);
  /// Runs work whose duration counts as echo time, and not as visibility time.
  template <class Work>
  void as_echo(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    counts.echo_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  /// History of the last transmission. Further parts of this transmission reuse it. So does a later
  /// transmission with the same tubes, on a surface that all transmissions share.
  struct Seen {
    const SharedTransmissions* group = nullptr;
    std::size_t number = 0;
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
