// SPDX-License-Identifier: GPL-3.0-or-later
// Computes contributions and energies per footprint, with sinks that request attribution. The energies are
// those of integrate(), distributed over footprints instead of bins.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "engine/echo/echo.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

/// Footprints per task. The energies do not depend on this number.
constexpr std::size_t footprints_per_task = 128;

/// All range samples as one sample, whose ends are exactly equal to theirs.
RangeSamples as_one(const RangeSamples& samples) {
  return {samples.first_m, samples.step_m * samples.count, 1};
}

/// Collects the consecutive parts of a footprint, and keeps those above the least share.
class Gatherer {
 public:
  Gatherer(const Echo& echo, double least_share, std::vector<Contribution>& all)
      : echo_(echo), least_share_(least_share), all_(all) {}

  void take(const Part<double>& part) {
    if (part.beam >= std::uint32_t(echo_.beams)) return;  // another channel
    if (!own_.empty() && own_.back().footprint != part.seen) settle();
    own_.push_back({part.seen, part.beam, part.sample, part.value});
  }

  void settle() {
    const auto bin = [](const Contribution& c) { return std::pair(c.beam, c.sample); };
    std::stable_sort(own_.begin(), own_.end(),
                     [&](const Contribution& a, const Contribution& b) { return bin(a) < bin(b); });
    std::size_t count = 0;
    for (const Contribution& c : own_) {
      if (count > 0 && bin(own_[count - 1]) == bin(c))
        own_[count - 1].energy_j += c.energy_j;
      else
        own_[count++] = c;
    }
    own_.resize(count);
    const std::size_t before = all_.size();
    for (const Contribution& c : own_) {
      const double whole = echo_.at(int(c.beam), int(c.sample));
      if (c.energy_j != 0 && std::abs(c.energy_j) >= least_share_ * whole) all_.push_back(c);
    }
    const auto largest = std::max_element(
        own_.begin(), own_.end(),
        [](const Contribution& a, const Contribution& b) { return a.energy_j < b.energy_j; });
    if (all_.size() == before && largest != own_.end() && largest->energy_j > 0) all_.push_back(*largest);
    own_.clear();
  }

 private:
  const Echo& echo_;
  double least_share_;
  std::vector<Contribution>& all_;
  std::vector<Contribution> own_;
};

}  // namespace

std::vector<Contribution> contributions(const CommonVisibility& visibility, const ReceiveBeams& beams,
                                        const RangeSamples& samples, const EchoModel& model,
                                        const Quadrature& how, const Echo& echo, double least_share) {
  std::vector<Contribution> all;
  Gatherer gatherer(echo, least_share, all);
  Quadrature owned = how;
  owned.by_owner = true;
  integrate(visibility.without_hits(), beams, samples, model, owned,
            [&](const Part<double>& part) { gatherer.take(part); });
  gatherer.settle();
  // Footprints with a reflectivity texture come after all others.
  std::stable_sort(all.begin(), all.end(),
                   [](const Contribution& a, const Contribution& b) { return a.footprint < b.footprint; });
  return all;
}

FootprintEnergies footprint_energies(const FootprintSet& footprints, const CommonVisibility& visibility,
                                     std::span<const std::uint32_t> beam_of_footprint_tube,
                                     const ReceiveBeams& beams, const RangeSamples& samples,
                                     const EchoModel& model, const Quadrature& how) {
  const std::size_t count = footprints.footprints.size();
  FootprintEnergies energies{std::vector<double>(count), std::vector<double>(count)};
  BeamPatterns patterns;
  EchoModel own_model = model;
  if (model.patterns != nullptr) {
    patterns = *model.patterns;
    patterns.baselines.clear();  // footprints are those of the transmitter
    own_model.patterns = &patterns;
  }
  Quadrature owned = how;
  owned.by_owner = true;
  const RangeSamples whole = as_one(samples);
  const auto add = [&](std::size_t footprint, const Part<double>& part) {
    energies.all_beams[footprint] += part.value;
    if (part.beam == beam_of_footprint_tube[footprints.footprints[footprint].tube])
      energies.own_beam[footprint] += part.value;
  };
  const CommonVisibility seen = visibility.without_hits();
  const std::size_t tasks = (count + footprints_per_task - 1) / footprints_per_task;
  Steps steps("energies", tasks);
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t k) {
    const std::size_t begin = k * footprints_per_task;
    integrate(seen.within(begin, begin + footprints_per_task), beams, whole, own_model, owned,
              [&](const Part<double>& part) { add(part.seen, part); });
    steps.done();
  });
  return energies;
}

}  // namespace tubefoot
