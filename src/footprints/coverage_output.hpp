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

/// The file or folder that receives a coverage: a GeoPackage (.gpkg), the table of facets (.csv), or a
/// folder. A folder has both files, the table of depths and a plan. A separate plan is optional. The output
/// is complete or does not exist.
class CoverageOutput {
 public:
  /// Rejects places that cannot be written before any computation: throws UsageError. `inputs` are never
  /// overwritten.
  CoverageOutput(const std::filesystem::path& place, const std::optional<std::filesystem::path>& picture,
                 const Inputs& inputs);
  /// Must be called before the first facet. The survey must outlive this object.
  void begin(const Survey& survey, std::vector<CountedPing> pings);
  void add(const CoveredFacet& facet);
  /// Throws std::runtime_error that names the file that could not be written.
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
