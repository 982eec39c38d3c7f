// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "app/commands.hpp"
#include "app/footprint_file.hpp"
#include "app/footprint_rationals.hpp"
#include "app/interrupt.hpp"
#include "app/progress.hpp"
#include "app/refraction.hpp"
#include "app/settings.hpp"
#include "app/survey.hpp"
#include "app/usage_error.hpp"

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

/// The file of columns, if one was asked for, and that of exact corners.
class Files {
 public:
  Files(const FootprintOptions& options, const Survey& survey, std::size_t sensor)
      : survey_(survey), sensor_(sensor) {
    const bool only_exact = options.output.extension() == ".txt";
    if (only_exact && options.rationals)
      throw UsageError("-o with the ending .txt writes what --rationals does: leave one of them out");
    if (!only_exact) {
      const FootprintFileMaker make = footprint_file_maker(options.output);
      columns_place_.emplace(options.output);
      columns_ =
          make(columns_place_->path(), {survey.scene, survey.sensors[sensor].sensor->description().name});
    }
    if (only_exact || options.rationals) {
      exact_place_.emplace(only_exact ? options.output : *options.rationals);
      exact_.emplace(exact_place_->path(), survey, sensor);
    }
  }

  /// Footprints written; without columns, pieces.
  std::size_t add(std::size_t ping, std::size_t shot, std::span<const std::uint32_t> beams) {
    const std::size_t pieces = exact_ ? exact_->add(ping, shot, beams) : 0;
    if (!columns_) return pieces;
    const FootprintTable table = footprint_table(survey_, sensor_, ping, shot, beams);
    columns_->add(table);
    return table.rows();
  }

  void close() {
    if (columns_) columns_->close();
    if (exact_) exact_->close();
    if (columns_place_) columns_place_->commit();
    if (exact_place_) exact_place_->commit();
  }
  const char* counted() const { return columns_ ? "footprints" : "pieces"; }

 private:
  const Survey& survey_;
  std::size_t sensor_;
  std::optional<FileBeside> columns_place_, exact_place_;  // outlive what writes there
  std::unique_ptr<FootprintFile> columns_;
  std::optional<RationalsFile> exact_;
};

}  // namespace

int footprints_command(const FootprintOptions& options) {
  if (options.output.extension() != ".txt") footprint_file_maker(options.output);  // before any work
  const SceneDescription description = described(options);
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  refuse_refraction(*survey, false);
  print_warnings(survey->scene.report.warnings, options.quiet);
  const std::size_t index = survey->sensor_named(options.sensor);
  const SensorPings& pings = survey->sensors[index];
  const PingRange range = resolved(options.pings, pings.times_s.size());
  const std::vector<std::uint32_t> beams = resolved_beams(options.beams, pings.sensor->beams().size());
  if (description.paths.order > 1 || description.paths.only_order)
    print_warnings({"footprints are those of paths of order 1: what mirrors and second scatterings add is in "
                    "the energies of 'run' only"},
                   options.quiet);

  const InterruptGuard interrupt;
  Files files(options, *survey, index);
  std::size_t count = 0;
  Progress progress("pings", static_cast<std::size_t>(range.last - range.first + 1), options.quiet);
  for (auto ping = static_cast<std::size_t>(range.first); ping <= static_cast<std::size_t>(range.last);
       ++ping) {
    for (std::size_t shot = 0; shot < pings.sensor->shots(); ++shot) {
      if (InterruptGuard::requested()) throw std::runtime_error("interrupted: nothing was written");
      count += files.add(ping, shot, beams);
    }
    progress.step();
  }
  files.close();
  fmt::print("wrote {} ({} {})\n", options.output.string(), count, files.counted());
  if (options.rationals) fmt::print("wrote {} (exact corners)\n", options.rationals->string());
  return 0;
}

}  // namespace tubefoot
