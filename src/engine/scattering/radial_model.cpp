// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/radial_model.hpp"

#include <algorithm>
#include <bit>
#include <list>
#include <mutex>
#include <tuple>

#include "engine/scattering/density.hpp"
#include "engine/scattering/echo_model.hpp"
#include "engine/scattering/volume_scattering.hpp"

namespace tubefoot {
namespace {

RadialIntegral made_lambert(const RangeSamples& samples, double absorption_db_per_m) {
  const double beta = absorption_per_m(absorption_db_per_m);
  return RadialIntegral(sample_borders_m(samples),
                        [beta](double r) { return lambert_density(TwoWayRange<double>::of(r), beta); });
}

VolumeRadials made_volume(const RangeSamples& samples, double absorption_db_per_m) {
  const double beta = absorption_per_m(absorption_db_per_m);
  const std::vector<double> borders = sample_borders_m(samples);
  const auto solid_angle = [](double r) { return 1 / (r * r * r); };
  const auto partial = [&](double r) {
    return volume_spreading(sample_start_m(borders, r), r, beta) / (r * r * r);
  };
  VolumeRadials radials{RadialIntegral(borders, solid_angle), RadialIntegral(borders, partial)};
  // Each integrand is split at the cells of the other one until the cells are equal.
  const auto ends = [](const RadialIntegral& radial) {
    std::vector<double> values;
    for (const RadialIntegral::Cell& cell : radial.cells()) values.push_back(cell.hi);
    return values;
  };
  while (ends(radials.solid_angle) != ends(radials.partial)) {
    radials.solid_angle = RadialIntegral(borders, solid_angle, ends(radials.partial));
    radials.partial = RadialIntegral(borders, partial, ends(radials.solid_angle));
  }
  return radials;
}

/// Cache of results, the most recently used first.
template <class Radial>
class Kept {
 public:
  using Make = Radial (*)(const RangeSamples&, double absorption_db_per_m);
  explicit Kept(Make make) : make_(make) {}

  std::shared_ptr<const Radial> get(const RangeSamples& samples, double absorption_db_per_m) {
    // Keys are compared by bits, because values that compare equal, such as the two zeros, may give different
    // results.
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    const Key key{bits(samples.first_m), bits(samples.step_m), samples.count, bits(absorption_db_per_m)};
    if (auto found = find(key)) return found;
    // No lock is held during the computation. Two threads with the same request at the same time compute it
    // twice.
    auto fresh = std::make_shared<const Radial>(make_(samples, absorption_db_per_m));
    put(key, fresh);
    return fresh;
  }

 private:
  using Key = std::tuple<std::uint64_t, std::uint64_t, int, std::uint64_t>;
  struct Entry {
    Key key;
    std::shared_ptr<const Radial> radial;
  };

  std::shared_ptr<const Radial> find(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(entries_, key, &Entry::key);
    if (found == entries_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found);
    return found->radial;
  }

  void put(const Key& key, std::shared_ptr<const Radial> radial) {
    const std::lock_guard lock(mutex_);
    entries_.push_front({key, std::move(radial)});
    std::size_t cells = 0;
    for (auto entry = std::next(entries_.begin()); entry != entries_.end();) {
      if (entry->key != key) cells += entry->radial->cells().size();
      entry = entry->key == key || cells > most_cells_kept ? entries_.erase(entry) : std::next(entry);
    }
  }

  const Make make_;
  std::mutex mutex_;
  std::list<Entry> entries_;
};

}  // namespace

std::shared_ptr<const RadialIntegral> lambert_radial_integral(const RangeSamples& samples,
                                                              double absorption_db_per_m) {
  static Kept<RadialIntegral> kept(made_lambert);
  return kept.get(samples, absorption_db_per_m);
}

std::shared_ptr<const VolumeRadials> volume_radial_integrals(const RangeSamples& samples,
                                                             double absorption_db_per_m) {
  static Kept<VolumeRadials> kept(made_volume);
  return kept.get(samples, absorption_db_per_m);
}

double sample_start_m(std::span<const double> borders_m, double range_m) {
  const auto above = std::ranges::upper_bound(borders_m, range_m);
  return above == borders_m.begin() ? borders_m.front() : *std::prev(above);
}

}  // namespace tubefoot
