// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprints/coverage_output.hpp"

#include <fmt/format.h>

#include <utility>

#include "files/checked_file.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

CoverageOutput::CoverageOutput(const fs::path& place, const std::optional<fs::path>& picture,
                               const Inputs& inputs) {
  const std::string ending = place.extension().string();
  for (const auto& [suffix, kind] :
       {std::pair{".gpkg", Kind::package}, {".csv", Kind::table}, {".vtp", Kind::vtp}, {".glb", Kind::glb}})
    if (ending == suffix) kind_ = kind;
  const bool folder = kind_ == Kind::folder;
  if (folder && !ending.empty() && !fs::is_directory(place))
    throw UsageError(
        fmt::format("'{}': unknown suffix: expected .gpkg, .csv, .vtp or .glb, or no suffix for a folder",
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
  const auto is = [&](Kind kind) { return kind_ == kind || kind_ == Kind::folder; };
  if (is(Kind::package)) layers_.emplace(survey.scene);
  if (is(Kind::table)) tables_.emplace(survey.scene);
  if (is(Kind::vtp) || is(Kind::glb)) mesh_.emplace(survey.scene);
  if (folder_ || picture_file_) picture_.emplace(survey);
}

void CoverageOutput::add(const CoveredFacet& facet) {
  any_facet_ = true;
  if (tables_) tables_->add(facet);
  if (layers_) layers_->add(facet, pings_);
  if (mesh_) mesh_->add(facet);
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
    mesh_->write_vtp(folder_->staging() / "coverage.vtp");
    mesh_->write_glb(folder_->staging() / "coverage.glb");
    if (any_facet_) picture_->write(folder_->staging() / "coverage.png", title);
    folder_->commit();
    return;
  }
  switch (kind_) {
    case Kind::package:
      layers_->write(file_->path());
      break;
    case Kind::table:
      write_file(file_->path(), tables_->facets());
      break;
    case Kind::vtp:
      mesh_->write_vtp(file_->path());
      break;
    default:
      mesh_->write_glb(file_->path());
  }
  file_->commit();
}

}  // namespace tubefoot
