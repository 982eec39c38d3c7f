// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/path_on_facet.hpp"

#include <algorithm>

// Sets up the geometry of a path on a facet (path_on_facet.hpp). The settings of quadratures follow from the
// smoothness of model, patterns, texture and mirror losses.

namespace tubefoot {

PathOnFacet::PathOnFacet(const FacetPlane& plane, const PlaneFrame& frame,
                         const PathCutter::Receiver& tx_over, const PathCutter::Receiver& rx_over,
                         FacetId facet, const EchoModel& model)
    : seabed(model.seabed(facet)) {
  tx.over = tx_over;
  rx.over = rx_over;
  for (EndOverPlane* end : {&tx, &rx}) {
    end->seen.foot_m =
        -end->over.distance * plane.normal - end->over.foot.x * frame.u - end->over.foot.y * frame.v;
    end->seen.u = frame.u;
    end->seen.v = frame.v;
  }
  if (seabed.texture != nullptr) lies = model.path.tx.lying(facet, plane, frame);
  finish(model);
}

PathOnFacet::PathOnFacet(const BistaticFacet& bistatic, FacetId facet, const EchoModel& model)
    : tx{{bistatic.transmit_distance_m, glm::dvec2(0)}, bistatic.transmit_seen, true},
      rx{{bistatic.receive_distance_m, bistatic.receive_foot_m}, bistatic.receive_seen, true},
      seabed(model.seabed(facet)),
      lies(bistatic.lies) {
  const double own = bistatic_factor(bistatic, seabed.scattering);
  seabed.factor *= own;
  seabed.mu *= own;
  finish(model);
}

void PathOnFacet::finish(const EchoModel& model) {
  beta_per_m = absorption_per_m(model.absorption_db_per_m);
  if (!model.path.tx.loss.none()) tx_loss = &model.path.tx.loss;
  if (!model.path.back().loss.none()) rx_loss = &model.path.back().loss;
}

double smooth_angle_rad(const Path& path) {
  constexpr double least = 1e-3;
  double angle = 1;
  for (const MirrorLoss* loss : {&path.tx.loss, &path.back().loss})
    if (!loss->rough_normals.empty())
      angle = std::min(angle, 1 / std::sqrt(loss->roughness * double(loss->rough_normals.size())));
  return std::max(angle, least);
}

PathOnFacet path_on(const CommonVisibility& visibility, std::size_t number, const PlaneFrame& frame,
                    const EchoModel& model) {
  const SeenFacet facet = visibility[number];
  if (const BistaticFacet* bistatic = visibility.bistatic(number))
    return PathOnFacet(*bistatic, facet.facet, model);
  return PathOnFacet(facet.plane, frame, {facet.plane.distance_m, glm::dvec2(0)},
                     {facet.rx_distance_m, frame.project(visibility.rx_m())}, facet.facet, model);
}

PathCutter::Receiver over_plane(const FacetPlane& plane, const PlaneFrame& frame, glm::dvec3 at_m) {
  return {plane.distance_m + glm::dot(plane.normal, at_m), frame.project(at_m)};
}

void assign(PlanarPolygon& polygon, std::span<const glm::dvec3> corners_m, const FacetPlane& plane,
            const PlaneFrame& frame, const BistaticFacet* bistatic) {
  if (bistatic == nullptr) return polygon.assign(corners_m, plane, frame);
  polygon.distance = bistatic->transmit_distance_m;
  polygon.first = glm::dvec2(bistatic->to_plane.at(corners_m[0]));
  polygon.offsets.clear();
  for (const glm::dvec3& corner : corners_m)
    polygon.offsets.emplace_back(glm::dvec2(bistatic->to_plane.linear * (corner - corners_m[0])));
}

void Smoothness::take(const SurfaceProperties& seabed) {
  textured = seabed.texture != nullptr;
  const ScatteringModel* model = seabed.scattering;
  if (model == nullptr) return;
  angle_rad = std::min(angle_rad, resolution_of([&](double y) { return model->growth(y); }));
  if (model->pieces().size() == 1 && !model->is_pointed()) return;
  cornered = true;
  angle_rad = std::min(angle_rad, 0.1);  // rules with few nodes miss a kink
}

void Smoothness::take(const Directivity& sent, const Directivity& received) {
  angle_rad =
      std::min(angle_rad, resolution_of([&](double y) { return sent.growth(y) + received.growth(y); }));
  for (const Directivity* pattern : {&sent, &received})
    tables = tables || pattern->kind == Directivity::Kind::table;
}

/// No rule converges across a kink of a model or a row of a table. There, cells are halved up to a limited
/// depth and then accepted.
PathCutter::Work Smoothness::work(double tolerance) const {
  constexpr int most_refinements_with_tables = 12;
  constexpr int most_refinements_with_limit = 0;
  constexpr double tolerance_with_corners = 1e-6, tolerance_with_limit = 1e-3;
  PathCutter::Work work;
  work.resolution_rad = angle_rad;
  work.tolerance = cornered ? std::max(tolerance, tolerance_with_corners) : tolerance;
  // Two rules disagree across the border of the limit. Labels need this border only to a fraction of a cell.
  if (limited) work.tolerance = std::max(work.tolerance, tolerance_with_limit);
  work.agreements = cornered ? 2 : 1;
  work.analytic = !cornered && !tables && !textured;
  if (cornered || tables) work.most_refinements = most_refinements_with_tables;
  if (limited) work.most_refinements = most_refinements_with_limit;
  return work;
}

}  // namespace tubefoot
