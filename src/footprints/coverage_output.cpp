// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprints/coverage_output.hpp"

#include <fmt/format.h>

#include "files/checked_file.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

CoverageOutput::CoverageOutput(const fs::path& place, const std::optional<fs::path>& picture,
                               const Inputs& inputs) {
  const std::string ending = place.extension().string();
  package_ = ending == ".gpkg";
  table_ = ending == ".csv";
  const bool folder = !package_ && !table_;
  if (folder && !ending.empty() && !fs::is_directory(place))
    throw UsageError(fmt::format("'{}': unknown suffix: expected .gpkg or .csv, or no suffix for a folder",
                                 place.string()));
  if (picture && picture->extension() != ".png")
    throw UsageError(fmt::format("'{}': the name of a picture must end in .png", picture->string()));
  if (picture) picture_file_.emplace(*picture, inputs);
  if (folder)
    folder_.emplace(place, inputs);
  else
    file_.emplace(place, inputs);
}

void CoverageOutput::begin(const Survey& survey, std::vector<CountedPing> pings) {
  pings_ = std::move(pings);
  if (!table_) layers_.emplace(survey.scene);
  if (!package_) tables_.emplace(survey.scene);
  if (folder_ || picture_file_) picture_.emplace(survey);
}

void CoverageOutput::add(const CoveredFacet& facet) {
  any_facet_ = true;
  if (tables_) tables_->add(facet);
  if (layers_) layers_->add(facet, pings_);
  if (picture_) picture_->add(facet);
}

void CoverageOutput::finish(const std::string& title) {
  if (picture_file_) {
    picture_->write(picture_file_->path(), title);
    picture_file_->commit();
  }
  if (folder_) {
    layers_->write(folder_->staging() / "coverage.gpkg");
    write_file(folder_->staging() / "facets.csv", tables_->facets());
    write_file(folder_->staging() / "depths.csv", tables_->depths());
    if (any_facet_) picture_->write(folder_->staging() / "coverage.png", title);
    folder_->commit();
    return;
  }
  if (package_)
    layers_->write(file_->path());
  else
    write_file(file_->path(), tables_->facets());
  file_->commit();
}

}  // namespace tubefoot
