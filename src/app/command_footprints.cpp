// SPDX-License-Identifier: GPL-3.0-or-later
// The command `footprints`. It writes the visible polygons of selected pings and beams of one sensor, as
// columns, as exact corners, or both (docs/footprints.md).
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "app/commands.hpp"
#include "files/atomic_output.hpp"
#include "files/usage_error.hpp"
#include "footprints/footprint_file.hpp"
#include "footprints/footprint_rationals.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission.hpp"

namespace tubefoot {
namespace {

/// Output files of the columns and of the exact corners; each is empty if it is not requested.
struct Places {
  std::optional<OutputFile> columns, exact;

  Places(const FootprintOptions& options, const Inputs& inputs) {
    const bool only_exact = options.output.extension() == ".txt";
    if (only_exact && options.rationals)
      throw UsageError(
          "-o with the suffix .txt already writes the exact corners: leave out --rationals, or choose "
          "another suffix");
    if (options.rationals && same_file(*options.rationals, options.output))
      throw UsageError("-o and --rationals name the same file: choose different names");
    if (!only_exact) columns.emplace(options.output, inputs);
    if (only_exact || options.rationals)
      exact.emplace(only_exact ? options.output : *options.rationals, inputs);
  }
};

/// Writes footprints into the files of `Places`.
class Files {
 public:
  Files(Places& places, FootprintFileMaker make, const Transmissions& transmissions, std::size_t sensor)
      : transmissions_(transmissions), around_(transmissions), sensor_(sensor), places_(places) {
    const Survey& survey = transmissions.survey();
    if (places.columns)
      columns_ =
          make(places.columns->path(), {survey.scene, survey.sensors[sensor].sensor->description().name});
    if (places.exact) exact_.emplace(places.exact->path(), transmissions, sensor);
  }

  /// Returns the number of footprints written or, without columns, the number of pieces.
  std::size_t add(std::size_t ping, std::size_t number, std::span<const std::uint32_t> beams) {
    const Transmissions& around =
        around_.at(transmissions_.survey().sensor_set->transmissions_of(sensor_), ping);
    const Transmission transmission = around.received_by(sensor_, ping, number);
    const std::size_t pieces = exact_ ? exact_->add(transmission, beams) : 0;
    if (!columns_) return pieces;
    const FootprintTable table = footprint_table(transmission, sensor_, beams);
    columns_->add(table);
    facets_of_several_rays_ += table.facets_of_several_rays;
    return table.rows();
  }
  std::size_t facets_of_several_rays() const { return facets_of_several_rays_; }

  void close() {
    if (columns_) columns_->close();
    if (exact_) exact_->close();
    if (places_.columns) places_.columns->commit();
    if (places_.exact) places_.exact->commit();
  }

  const char* counted() const { return columns_ ? "footprints" : "pieces"; }

 private:
  const Transmissions& transmissions_;
  TransmissionsAround around_;
  std::size_t sensor_, facets_of_several_rays_ = 0;
  Places& places_;
  std::unique_ptr<FootprintFile> columns_;
  std::optional<RationalsFile> exact_;
};

}  // namespace

int footprints_command(const FootprintOptions& options) {
  const FootprintFileMaker make =
      options.output.extension() == ".txt" ? nullptr : footprint_file_maker(options.output);
  const SceneDescription description = described(options);
  Places places(options, inputs_of(description));
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  const std::size_t index = survey->sensor_set->sensor_named(options.sensor);
  const Transmissions transmissions(*survey, request_of(description.run));
  require_able(*survey, transmissions.request(), Feature::footprints, index);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const SensorPings& pings = survey->sensors[index];
  const PingRange range = resolved(options.pings, pings.times_s.size());
  const std::vector<std::uint32_t> beams = resolved_beams(options.beams, pings.sensor->beams().size());
  if (description.paths.scatterings > 1)
    print_warnings(
        {"footprints contain single scattering only; 'run' adds the energies of second scattering"},
        options.quiet);
  if (places.exact && description.paths.order > 1)
    print_warnings({"exact corners are written only for paths of order 1; the other formats also contain "
                    "footprints of mirror paths"},
                   options.quiet);

  Files files(places, make, transmissions, index);
  std::size_t count = 0;
  Progress progress("pings", static_cast<std::size_t>(range.last - range.first + 1), options.quiet);
  for (auto ping = static_cast<std::size_t>(range.first); ping <= static_cast<std::size_t>(range.last);
       ++ping) {
    for (std::size_t transmission = 0; transmission < pings.sensor->transmissions(); ++transmission) {
      stop_if_wanted();
      count += files.add(ping, transmission, beams);
    }
    progress.step();
  }
  files.close();
  if (files.facets_of_several_rays() > 0)
    print_warnings({fmt::format("several rays lead to {} facets; the footprints of these facets contain only "
                                "the first arrival, so 'energy_j' is less than the energy of the echo",
                                files.facets_of_several_rays())},
                   options.quiet);
  tell("wrote {} ({} {})\n", options.output.string(), count, files.counted());
  if (options.rationals) tell("wrote {} (exact corners)\n", options.rationals->string());
  return 0;
}

}  // namespace tubefoot
