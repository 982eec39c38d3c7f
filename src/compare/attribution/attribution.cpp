// SPDX-License-Identifier: GPL-3.0-or-later
// Attribution of the error of a sensor to objects, materials, kinds of bins, ranges and beams. Each bin has
// the shares of its owners in the energy; ErrorSplit divides the error of a bin with several owners. The
// largest errors are listed with the facets behind them.
#include "compare/attribution/attribution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "compare/attribution/bin_origins.hpp"
#include "geometry/steps/stop.hpp"
#include "run/console/progress.hpp"
#include "run/paths.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t most_bands = 10, most_facets = 8;

/// Divides `count` items into at most `most_bands` spans of equal length.
class Bands {
 public:
  explicit Bands(std::size_t count) : count_(count), bands_(std::min(count, most_bands)) {}
  std::size_t size() const { return bands_; }
  std::size_t of(std::size_t place) const { return place * bands_ / count_; }
  std::size_t first(std::size_t band) const { return (band * count_ + bands_ - 1) / bands_; }

 private:
  std::size_t count_, bands_;
};

class Attributor {
 public:
  Attributor(const SceneAtHand& scene, const SensorEchoes& reference, const EchoPair& pair, std::size_t worst)
      : scene_(scene.survey().scene),
        pair_(pair),
        most_worst_(worst),
        ranges_(pair.shape.samples),
        beams_(pair.shape.beams) {
    for (const ComponentReport& component : scene_.report.components)
      result_.object_names.push_back(component.name);
    for (const MaterialDescription& material : scene_.description.materials)
      result_.material_names.push_back(material.name);
    nobody_ = number_of(static_cast<std::uint16_t>(result_.object_names.size()),
                        static_cast<std::uint16_t>(result_.material_names.size()));
    for (std::size_t k = 0; k < bin_kinds; ++k)
      result_.kinds.push_back({std::string(name_of(static_cast<BinKind>(k))), {}, 0});
    const std::vector<double>& bounds = reference.slant_range_bounds_m;
    const double step_m =
        pair.shape.samples > 1 ? pair.slant_range_m[1] - pair.slant_range_m[0] : 2 * pair.slant_range_m[0];
    const auto border_m = [&](std::size_t sample) {
      return bounds.empty()                ? pair.slant_range_m[0] + (double(sample) - 0.5) * step_m
             : sample < pair.shape.samples ? bounds[2 * sample]
                                           : bounds[2 * sample - 1];
    };
    for (std::size_t k = 0; k < ranges_.size(); ++k)
      result_.ranges.push_back(
          {fmt::format("{:.4g} to {:.4g} m", border_m(ranges_.first(k)), border_m(ranges_.first(k + 1))),
           {},
           0});
    for (std::size_t k = 0; k < beams_.size(); ++k)
      result_.beams.push_back({fmt::format("{} to {}", beams_.first(k), beams_.first(k + 1) - 1), {}, 0});
  }

  void add(std::size_t ping, const SensorPlace& place, const BinOrigins& origins) {
    const std::size_t samples = pair_.shape.samples;
    for (std::size_t beam = 0; beam < pair_.shape.beams; ++beam) {
      std::optional<BinPart> caster;
      bool by_silhouette = false;
      for (std::size_t sample = 0; sample < samples; ++sample) {
        const auto in_scene = static_cast<std::uint32_t>(place.beams[beam] * samples + sample);
        const auto of_bin = [&](const std::vector<BinPart>& all) {
          return std::span<const BinPart>(std::ranges::lower_bound(all, in_scene, {}, &BinPart::bin),
                                          std::ranges::upper_bound(all, in_scene, {}, &BinPart::bin));
        };
        const std::span<const BinPart> parts = of_bin(origins.parts), edges = of_bin(origins.casters);
        if (!edges.empty()) caster = edges.front();
        by_silhouette = by_silhouette || !edges.empty();
        if (!by_silhouette && !parts.empty()) caster = parts.front();
        if (parts.empty() && caster) caster->energy_j = 1;  // the caster owns the whole dark bin
        add_bin({ping, beam, sample}, origins.kind[in_scene],
                parts.empty() && caster ? std::span<const BinPart>(&*caster, 1) : parts);
      }
    }
  }

  Attribution done() {
    const std::vector<ErrorSums> table = split_.finish(owners_.size());
    for (std::size_t k = 0; k <= result_.object_names.size(); ++k)
      result_.objects.push_back(
          {k < result_.object_names.size() ? result_.object_names[k] : "nothing", {}, 0});
    for (std::size_t k = 0; k <= result_.material_names.size(); ++k)
      result_.materials.push_back(
          {k < result_.material_names.size() ? result_.material_names[k] : "nothing", {}, 0});
    std::map<std::pair<std::size_t, std::size_t>, ErrorPart> causes;
    for (std::size_t owner = 0; owner < owners_.size(); ++owner)
      for (std::size_t kind = 0; kind < bin_kinds; ++kind) {
        const ErrorSums& sums = table[owner * bin_kinds + kind];
        const std::size_t bins = bins_of_[owner][kind];
        if (bins == 0) continue;
        const auto [object, material] = owners_[owner];
        result_.objects[object].sums += sums;
        result_.objects[object].bins += bins;
        result_.materials[material].sums += sums;
        result_.materials[material].bins += bins;
        ErrorPart& cause = causes[{object, kind}];
        cause.name = fmt::format("{}, {}", result_.objects[object].name, result_.kinds[kind].name);
        cause.sums += sums;
        cause.bins += bins;
      }
    for (auto& [key, cause] : causes) result_.causes.push_back(std::move(cause));
    std::ranges::stable_sort(result_.causes, std::ranges::greater{},
                             [](const ErrorPart& part) { return part.sums.error; });
    for (auto* list : {&result_.kinds, &result_.objects, &result_.materials})
      std::erase_if(*list, [](const ErrorPart& part) { return part.bins == 0; });
    for (WorstBin& bin : result_.worst)
      bin.share_of_difference = std::abs(bin.candidate_j - bin.reference_j) / result_.whole.error;
    return std::move(result_);
  }

  std::vector<std::string>& notes() { return result_.notes; }

 private:
  std::uint32_t number_of(std::uint16_t object, std::uint16_t material) {
    const auto [at, is_new] =
        number_.try_emplace({object, material}, static_cast<std::uint32_t>(owners_.size()));
    if (is_new) {
      owners_.emplace_back(object, material);
      bins_of_.emplace_back();
    }
    return at->second;
  }

  void add_bin(const BinPlace& place, BinKind kind, std::span<const BinPart> parts) {
    const std::size_t bin =
        (place.ping * pair_.shape.beams + place.beam) * pair_.shape.samples + place.sample;
    const double reference = pair_.reference_j[bin], candidate = pair_.candidate_j[bin];
    const ErrorSums sums{std::abs(candidate - reference), candidate - reference, reference};
    const auto k = static_cast<std::size_t>(kind);
    result_.whole += sums;
    for (ErrorPart* part : {&result_.kinds[k], &result_.ranges[ranges_.of(place.sample)],
                            &result_.beams[beams_.of(place.beam)]}) {
      part->sums += sums;
      ++part->bins;
    }
    shares_.clear();
    double total = 0;
    for (const BinPart& part : parts) total += part.energy_j;
    for (const BinPart& part : parts) {
      const std::uint32_t owner = number_of(part.object, part.material);
      const double share = part.energy_j / total;
      const auto own = std::ranges::find(shares_, owner, &OwnerShare::owner);
      if (own != shares_.end())
        own->share += share;
      else
        shares_.push_back({owner, share});
    }
    if (shares_.empty()) shares_.push_back({nobody_, 1});
    for (const OwnerShare& share : shares_) ++bins_of_[share.owner][k];
    split_.add(k, shares_, sums);
    keep_worst(place, kind, reference, candidate, parts, total);
  }

  void keep_worst(const BinPlace& place, BinKind kind, double reference, double candidate,
                  std::span<const BinPart> parts, double total) {
    const auto size = [](const WorstBin& bin) { return std::abs(bin.candidate_j - bin.reference_j); };
    const double error = std::abs(candidate - reference);
    std::vector<WorstBin>& worst = result_.worst;
    if (most_worst_ == 0 || error == 0 || (worst.size() == most_worst_ && error <= size(worst.back())))
      return;
    WorstBin bin{place, pair_.slant_range_m[place.sample], reference, candidate, 0, kind, {}};
    for (const BinPart& part : parts.first(std::min(parts.size(), most_facets)))
      bin.facets.push_back({part.object, part.material, part.facet, part.energy_j / total});
    // The first of equal errors stays first.
    worst.insert(std::ranges::find_if(worst, [&](const WorstBin& other) { return size(other) < error; }),
                 bin);
    if (worst.size() > most_worst_) worst.pop_back();
  }

  const Scene& scene_;
  const EchoPair& pair_;
  std::size_t most_worst_;
  Bands ranges_, beams_;
  Attribution result_;
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::uint32_t> number_;
  std::vector<std::pair<std::size_t, std::size_t>> owners_;  // object and material of each owner
  std::vector<std::array<std::size_t, bin_kinds>> bins_of_;  // by owner and kind
  std::uint32_t nobody_ = 0;
  ErrorSplit split_{bin_kinds};
  std::vector<OwnerShare> shares_;  // shares of the current bin
};

}  // namespace

Attribution attribute(const SceneAtHand& scene, const SensorEchoes& reference, const EchoPair& pair,
                      std::size_t worst, bool quiet) {
  const SensorPlace place = scene.place_of(reference);
  const Transmissions transmissions(scene.survey(), RunRequest{});
  TransmissionsAround around(transmissions);
  Attributor attributor(scene, reference, pair, worst);
  Progress progress("pings", reference.pings, quiet);
  for (std::size_t ping = 0; ping < reference.pings; ++ping) {
    stop_if_wanted();
    attributor.add(ping, place, bin_origins(transmissions, around, place.sensor, place.pings[ping]));
    progress.step();
  }
  const Sensor& sensor = *scene.survey().sensors[place.sensor].sensor;
  if (path_settings(scene.survey().scene, sensor.frequency_khz()))
    attributor.notes().push_back(
        "mirror paths and second scattering have no footprints; their echoes are attributed to the surface "
        "that the straight path reaches in the same bin");
  if (sensor.has_separate_receiver())
    attributor.notes().push_back(
        "the receiver is separate; the kinds of bins refer to its view of the scene");
  return attributor.done();
}

}  // namespace tubefoot
