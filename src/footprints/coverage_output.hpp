// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/atomic_output.hpp"
#include "footprints/coverage_file.hpp"
#include "footprints/coverage_mesh.hpp"
#include "footprints/coverage_picture.hpp"

namespace tubefoot {

/// The file or folder that receives a coverage. A file is a GeoPackage (.gpkg), the table of facets (.csv) or
/// the facets as a mesh (.vtp, .glb). A folder has all of these files, the table of depths and a picture. A
/// separate picture is optional. The output is complete or does not exist.
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
  enum class Kind { folder, package, table, vtp, glb };
  Kind kind_ = Kind::folder;
  bool any_facet_ = false;
  std::vector<CountedPing> pings_;
  std::optional<CoverageFile> layers_;
  std::optional<CoverageTables> tables_;
  std::optional<CoverageMesh> mesh_;
  std::optional<CoveragePicture> picture_;
};

}  // namespace tubefoot
