// SPDX-License-Identifier: GPL-3.0-or-later
// The sensor kind "interferometric": a sidescan sonar with a receiver pair on each side. Defines its scene
// keys, its model and its files.

#include "sensors/kinds/kind_interferometric.hpp"

#include <cmath>

#include "scene/file/sensor_ranges.hpp"
#include "scene/file/toml_reader.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/received.hpp"
#include "sensors/products/receiver_pair_files.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// A sidescan with a receiver pair on each side: two receivers, half a baseline above and below the
/// transmitter. The baseline is perpendicular to the direction that the pair faces. Each receiver has its
/// own ranges and visible polygons.
class Interferometric : public Sidescan {
 public:
  /// Throws std::invalid_argument for an invalid sidescan, and for a baseline that is not above 0 or exceeds
  /// the nearest range.
  explicit Interferometric(const SensorDescription& description);
};

Interferometric::Interferometric(const SensorDescription& description)
    : Sidescan(description, description.kind.as<InterferometricDescription>()) {
  const auto& receiver_pair = description.kind.as<InterferometricDescription>();
  require(receiver_pair.baseline_m > 0 && receiver_pair.baseline_m <= receiver_pair.range_min_m, description,
          "baseline_m", receiver_pair.baseline_m, "above 0 and at most range_min_m");
  receiver_pair_ = {receiver_pair.baseline_m, receiver_pair.receiver_pair_tilt_deg};
  const double tilt_rad = radians(receiver_pair.receiver_pair_tilt_deg);
  for (Fan& fan : transmissions_.front().fans) {
    const double side = fan.first_beam == 0 ? -1.0 : 1.0;
    fan.receiver_pair = std::sin(tilt_rad) * side * starboard_axis + std::cos(tilt_rad) * up_axis;
  }
}

class InterferometricKind : public SensorKind {
 public:
  InterferometricKind() : SensorKind("interferometric") {}

  void add_keys(TomlSection<SensorDescription>& section) const override {
    using I = InterferometricDescription;
    std::vector<TomlField<I>> fields = inherited<I>(sidescan_fields());
    fields.push_back(field("baseline_m", &I::baseline_m,
                           {.meaning = "Distance between the two receivers, at most `range_min_m`. Up to "
                                       "half a wavelength, each phase corresponds to a single angle.",
                            .ranges = {{.lo = 0, .hi = 10, .lo_excluded = true}}}));
    fields.push_back(field("receiver_pair_tilt_deg", &I::receiver_pair_tilt_deg,
                           {.meaning = "Angle below the horizontal at which each receiver pair faces "
                                       "outwards, on its side of the track.",
                            .ranges = {pitch},
                            .former_name = "staff_tilt_deg"}));
    fields.push_back(field("phase_noise", &I::phase_noise,
                           {.meaning = "true: the phases of soundings contain the random error of a single "
                                       "look, which depends on the coherence of the range bin."}));
    section.kind<I>("kind", name(),
                    "Sidescan sonar with a receiver pair on each side. One receiver is above the "
                    "transmitter, the other below.",
                    fields);
  }
  void check(const SensorDescription& sensor, const TomlTable& table) const override {
    const auto& own = sensor.kind.as<InterferometricDescription>();
    if (own.baseline_m > own.range_min_m)
      throw InputError(place_of_pair(table, "baseline_m", "range_min_m"),
                       fmt::format("'baseline_m' ({}) must be at most 'range_min_m' ({})", own.baseline_m,
                                   own.range_min_m));
    check_sidescan(own, table);
    check_ranges(own.range_min_m, own.range_max_m, table);
  }
  SensorFigures figures(const SensorDescription& sensor) const override {
    return sidescan_figures(sensor.kind.as<InterferometricDescription>());
  }

  std::unique_ptr<Sensor> model(const SensorDescription& sensor) const override {
    return std::make_unique<Interferometric>(sensor);
  }

  std::vector<std::string> products() const override {
    std::vector<std::string> names = two_sided_picture_products();
    std::ranges::copy(receiver_pair_products(), std::back_inserter(names));
    return names;
  }
  std::vector<fs::path> write_products(const fs::path& folder, const Recording& recording,
                                       const RunContext& run,
                                       std::vector<std::string>& warnings) const override {
    const bool phase_noise =
        recording.sensor->description().kind.as<InterferometricDescription>().phase_noise;
    std::vector<fs::path> files = write_two_sided_pictures(
        folder, recording, receiver_output_of(recording, run), run.pictures, warnings, run.omitted);
    append(files, write_receiver_pair_files(folder, recording, run, phase_noise));
    return files;
  }
  std::optional<SonarOutline> outline(const SensorDescription& sensor) const override {
    return sidescan_outline(sensor.kind.as<InterferometricDescription>());
  }
  WritingCost writing_cost(const Recording& recording, const RunContext& run) const override {
    WritingCost cost = cost_of_two_sided_pictures(recording, receiver_output_of(recording, run).has_value(),
                                                  run.pictures, run.omitted);
    constexpr double sounding_s = 1.2e-6, sounding_bytes = 200;
    if (run.writes("soundings.csv")) cost += cost_by_cells(recording, sounding_s, sounding_bytes);
    return cost;
  }
};

}  // namespace

const SensorSection& InterferometricDescription::kind() {
  static const InterferometricKind kind;
  return kind;
}
const SensorSection& interferometric_kind() { return InterferometricDescription::kind(); }

}  // namespace tubefoot
