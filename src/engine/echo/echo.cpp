// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/echo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/echo/quadratures.hpp"

// Validates the arguments of integrate() and calls the quadrature for monostatic or bistatic visibility
// (quadratures.hpp). integrate_echo() sums the parts per beam and range sample.

namespace tubefoot {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument(what); }

void check(const BeamPatterns& patterns, const ReceiveBeams& beams, std::size_t tubes) {
  bool fits = patterns.receive.size() == std::size_t(beams.count) && patterns.fan_of_tube.size() == tubes &&
              patterns.beams_of_tube.size() == tubes;
  for (const std::uint32_t fan : patterns.fan_of_tube) fits = fits && fan < patterns.transmit.size();
  fits = fits && (patterns.baselines.empty() || patterns.baselines.size() == patterns.transmit.size());
  for (const TransmitPattern& fan : patterns.transmit) fits = fits && !fan.beams.empty();
  fits = fits && (patterns.least.empty() || patterns.least.size() == patterns.receive.size());
  for (const auto& [first, end] : patterns.beams_of_tube)
    fits = fits && first <= end && end <= std::uint32_t(beams.count);
  if (!fits) refuse("the beam patterns belong to other beams or other tubes");
}

void check_one_apex(const CommonVisibility& visibility, const ReceiveBeams& beams,
                    const RangeSamples& samples, const EchoModel& model, Binning binning) {
  if (model.path.over_mirrors() || model.path.rx || model.path.tx.to_true != glm::dmat3(1))
    refuse(
        "footprints of one apex need equal transmit and receive legs; different legs need the common "
        "visibility of two apexes");
  if (model.patterns == nullptr) return;
  check(*model.patterns, beams, beams.of_tube.size());
  for (const ReceiverBaseline& baseline : model.patterns->baselines)
    if (!(baseline.baseline_m >= 0 && baseline.baseline_m <= samples.first_m))
      refuse(
          fmt::format("a baseline of {} m needs range samples that begin at this range or later, not at {} m",
                      baseline.baseline_m, samples.first_m));
  if (!model.patterns->baselines.empty() && binning == Binning::exact &&
      visibility.first() < visibility.end())
    refuse(
        "footprints of one apex cannot be divided for the two receivers of a receiver pair "
        "(receiver_pair_echo.hpp)");
}

void check_two_apexes(const BistaticHistory& history, const ReceiveBeams& beams, const RangeSamples& samples,
                      const EchoModel& model, const Quadrature& how) {
  const std::size_t sent = history.transmit.tubes.size(), received = history.receive.tubes.size();
  if (beams.of_tube.size() != received)
    refuse(
        fmt::format("the receiver has {} tubes, but {} tubes have a beam", received, beams.of_tube.size()));
  for (const std::uint32_t beam : beams.of_tube)
    if (beam >= std::uint32_t(beams.count))
      refuse(fmt::format("a tube belongs to beam {}, but there are {} beams", beam, beams.count));
  const bool fans = !beams.fan_of_transmit_tube.empty() || !beams.fan_of_receive_tube.empty();
  if (fans && (beams.fan_of_transmit_tube.size() != sent || beams.fan_of_receive_tube.size() != received))
    refuse("fans must be given for all transmit and all receive tubes, or for none");
  if (!model.path.facet_factor.empty() && !history.bistatic.empty())
    refuse("factors of facets cannot be combined with facets at two apparent positions");
  if (!history.bistatic.empty() && history.bistatic.size() != history.shared.facets.size())
    refuse("the bistatic facets of the history belong to other facets");
  if (!(how.path_tolerance > 0))
    refuse(fmt::format("a tolerance must be above 0, not {}", how.path_tolerance));
  if (model.patterns != nullptr) check(*model.patterns, beams, received);
  const double last = samples.first_m + samples.count * samples.step_m;
  if (samples.count < 1 || !(samples.first_m >= 0) || !std::isfinite(last) || !(samples.step_m > 0))
    refuse(
        fmt::format("range samples need a first range of 0 or more, a step above 0 and a count of 1 or more, "
                    "all finite, not {} m, {} m and {}",
                    samples.first_m, samples.step_m, samples.count));
}

void check(const CommonVisibility& visibility, const ReceiveBeams& beams, const RangeSamples& samples,
           const EchoModel& model, const Quadrature& how) {
  if (beams.count < 0) refuse(fmt::format("a receiver cannot have {} beams", beams.count));
  check(model);
  if (visibility.one_apex())
    check_one_apex(visibility, beams, samples, model, how.binning);
  else
    check_two_apexes(*visibility.two_apexes(), beams, samples, model, how);
}

/// Bistatic quadrature with the patterns' axes reflected for images.
void between_two_apexes(const CommonVisibility& visibility, const ReceiveBeams& beams,
                        const RangeSamples& samples, const EchoModel& model, const Quadrature& how,
                        const Sink<double>& sink) {
  const bool through_images =
      model.path.tx.to_true != glm::dmat3(1) || model.path.back().to_true != glm::dmat3(1);
  if (model.patterns == nullptr || !through_images)
    return integrate_two_apexes(visibility, beams, samples, model, how, sink);
  const BeamPatterns patterns = as_images_have(*model.patterns, model.path);
  EchoModel own = model;
  own.patterns = &patterns;
  integrate_two_apexes(visibility, beams, samples, own, how, sink);
}

}  // namespace

Binning binning_from_name(std::string_view name) {
  for (const Binning binning : {Binning::exact, Binning::spread, Binning::centroid})
    if (name_of(binning) == name) return binning;
  throw std::invalid_argument(fmt::format("unknown binning '{}': expected exact, spread or centroid", name));
}

std::string_view name_of(Binning binning) {
  switch (binning) {
    case Binning::spread:
      return "spread";
    case Binning::centroid:
      return "centroid";
    case Binning::exact:
      break;
  }
  return "exact";
}

void integrate(const CommonVisibility& visibility, const ReceiveBeams& beams, const RangeSamples& samples,
               const EchoModel& model, const Quadrature& how, const Sink<double>& sink) {
  check(visibility, beams, samples, model, how);
  if (!visibility.one_apex()) return between_two_apexes(visibility, beams, samples, model, how, sink);
  const std::vector<double> energy =
      integrate_one_apex(visibility, beams, samples, model, how, sink, {}).energy;
  if (how.by_owner && visibility.hits().empty()) return;  // the sink has all parts
  const auto count = std::size_t(samples.count);
  for (std::size_t bin = 0; bin < energy.size(); ++bin)
    if (energy[bin] != 0) sink({std::uint32_t(bin / count), std::uint32_t(bin % count), energy[bin]});
}

Echo integrate_echo(const CommonVisibility& visibility, const ReceiveBeams& beams,
                    const RangeSamples& samples, const EchoModel& model, Quadrature how,
                    std::vector<double> buffer) {
  how.by_owner = false;
  check(visibility, beams, samples, model, how);
  // Without a sink, because a sink takes most of the time of pings with many bins.
  if (visibility.one_apex())
    return integrate_one_apex(visibility, beams, samples, model, how, {}, std::move(buffer));
  Echo echo{beams.count, samples.count, std::move(buffer)};
  echo.energy.resize(std::size_t(beams.count) * std::size_t(samples.count));
  between_two_apexes(visibility, beams, samples, model, how, [&](const Part<double>& part) {
    echo.energy[part.beam * std::size_t(samples.count) + part.sample] += part.value;
  });
  return echo;
}

std::vector<double> cleared_buffer(Echo echo) {
  const std::span energy(echo.energy);
  if (echo.nonzero.empty()) std::ranges::fill(energy, 0.0);
  for (std::size_t row = 0; row < echo.nonzero.size(); ++row) {
    const auto [first, end] = echo.nonzero[row];
    if (first < end)
      std::ranges::fill(energy.subspan(row * std::size_t(echo.samples) + first, end - first), 0.0);
  }
  return std::move(echo.energy);
}

}  // namespace tubefoot
