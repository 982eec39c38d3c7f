// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/atomic_output.hpp"
#include "footprints/coverage_file.hpp"
#include "footprints/coverage_picture.hpp"

namespace tubefoot {

/// Where a coverage is written: a GeoPackage (.gpkg), the table of facets (.csv), or a folder with both, the
/// table of depths and a plan; and a plan by itself, if asked for. Complete or not there.
class CoverageOutput {
 public:
  /// Refuses places that cannot be written, before any work: throws UsageError. `inputs` are never written
  /// over.
  CoverageOutput(const std::filesystem::path& place, const std::optional<std::filesystem::path>& picture,
                 const Inputs& inputs);
  /// Before the first facet. The survey outlives this.
  void begin(const Survey& survey, std::vector<CountedPing> pings);
  void add(const CoveredFacet& facet);
  /// Throws std::runtime_error naming what could not be written.
  void finish(const std::string& title);

 private:
  std::optional<OutputFolder> folder_;
  std::optional<OutputFile> file_, picture_file_;
  bool package_ = false, table_ = false, any_facet_ = false;
  std::vector<CountedPing> pings_;
  std::optional<CoverageFile> layers_;
  std::optional<CoverageTables> tables_;
  std::optional<CoveragePicture> picture_;
};

}  // namespace tubefoot
