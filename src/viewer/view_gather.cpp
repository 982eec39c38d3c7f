// SPDX-License-Identifier: GPL-3.0-or-later
// Collects the data of a page of the viewer. It traces the chosen pings and links footprints to cells of the
// picture. Then it adds tubes, hidden parts of facets and the surrounding mesh.
#include "viewer/view_gather.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <span>

#include "engine/echo/echo.hpp"
#include "engine/visibility/path_footprints.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/progress.hpp"
#include "run/surfaces.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission_ends.hpp"
#include "sensors/recordings/sensor_kind.hpp"
#include "viewer/view_surroundings.hpp"

namespace tubefoot {
namespace {

/// With beam patterns each beam receives from all footprints. Smaller shares of the energy of a range bin are
/// not linked. A note on the page states this value.
constexpr double min_energy_share = 1e-3;

/// Returns the angle of each beam across the fan, in the horizontal plane of the sensor or in the plane
/// across the track. Axes: x to starboard, y ahead, z up.
std::vector<double> beam_angles_deg(const Sensor& sensor) {
  std::vector<double> horizontal, across;
  for (const BeamAxis& beam : sensor.beams()) {
    const double cos_elevation = std::cos(beam.elevation_rad);
    const double x = cos_elevation * std::sin(beam.azimuth_rad),
                 y = cos_elevation * std::cos(beam.azimuth_rad), z = std::sin(beam.elevation_rad);
    horizontal.push_back(180 / std::numbers::pi * std::atan2(x, y));
    across.push_back(180 / std::numbers::pi * std::atan2(x, -z));
  }
  return sensor.is_across_track() ? across : horizontal;
}

class ViewBuilder {
 public:
  ViewBuilder(const Transmissions& transmissions, std::size_t sensor, const ViewLimits& limits)
      : transmissions_(transmissions),
        around_(transmissions),
        pings_(transmissions.survey().sensors[sensor]),
        sensor_(*pings_.sensor),
        sensor_index_(sensor),
        limits_(limits),
        bins_per_ping_(sensor_.beams().size() * static_cast<std::size_t>(sensor_.samples().count)) {}

  void add_ping(std::size_t ping) {
    const auto view_ping = static_cast<std::uint32_t>(view.pings.size());
    view.pings.push_back({static_cast<std::uint32_t>(ping), pings_.times_s[ping],
                          pings_.poses[ping].position_m,
                          sensor_.has_separate_receiver() ? pings_.receiver_pose(ping, 0).position_m
                                                          : pings_.poses[ping].position_m,
                          0});
    view.energy_j.resize(view.energy_j.size() + bins_per_ping_, 0.0);
    const Transmissions& around =
        around_.at(transmissions_.survey().sensor_set->transmissions_of(sensor_index_), ping);
    const std::size_t shadows_before = view.shadows.corners_of.size();
    for (std::size_t number = 0; number < sensor_.transmissions(); ++number) {
      const Transmission transmission = around.received_by(sensor_index_, ping, number);
      const TransmissionEnds ends(transmission, sensor_index_);
      if (ends.are_two())
        add_bistatic(transmission, ends, view_ping);
      else
        add_monostatic(transmission, ends.tx(), view_ping);
      if (view.pings.size() == 1 && number == 0 && ends.tx().refined != nullptr &&
          ends.tx().apparent == nullptr)
        refined_mesh_ = *ends.tx().mesh;
    }
    if (surfaces_are_known(around.survey(), sensor_index_))
      for (const int samples : samples_with_surfaces(around.survey(), sensor_index_, ping,
                                                     std::span(view.energy_j).last(bins_per_ping_)))
        view.surfaces.push_back(static_cast<std::uint32_t>(samples));
    view.pings.back().shadows = static_cast<std::uint32_t>(view.shadows.corners_of.size() - shadows_before);
  }

  void finish() {
    const Scene& scene = transmissions_.survey().scene;
    add_transmissions();
    note_motion_between_transmissions();
    const std::size_t left_out = add_mesh_near_footprints();
    if (left_out > 0)
      view.notes.push_back(
          fmt::format("The page shows only the part of the scene near the footprints; it omits {} of the "
                      "facets around them.",
                      left_out));
    if (shadow_limit_reached_)
      view.notes.push_back(
          fmt::format("The page shows only the first {} hidden parts of facets.", limits_.shadow_polygons));
    if (!refined_mesh_.facets.empty() && view.pings.size() * sensor_.transmissions() > 1)
      view.notes.push_back(
          "Relief is refined for each transmission; the page shows the facets of the first transmission.");
    if (scene.water->refracts())
      view.notes.push_back(
          "The water refracts: footprints have their true positions, but angles and ranges are apparent. "
          "Tubes are curved, so the page does not draw them.");
    if (sensor_.has_separate_receiver())
      view.notes.push_back(
          "The receiver is separate. A footprint is the part of a facet that is visible both in a tube of "
          "the receiver and in a tube of the transmitter. Slant ranges are half of the path lengths, and "
          "angles refer to the transmitter. Dark parts lie in tubes of one end but are hidden from that "
          "end.");
    if (view.weak_links_left_out)
      view.notes.push_back(
          "Beams have patterns, so each beam receives echoes from all footprints of its fan. Contributions "
          "below a thousandth of the energy of a range bin are not linked.");
  }

  ViewData view;

 private:
  std::size_t add_mesh_near_footprints() {
    const Survey& survey = transmissions_.survey();
    const ViewSurroundings about = surroundings(view);
    if (!refined_mesh_.facets.empty())
      return take_mesh(survey.scene, refined_mesh_, about, limits_.mesh_facets, view);
    if (!survey.loaded_scene->is_tiled())
      return take_mesh(survey.scene, survey.scene.mesh, about, limits_.mesh_facets, view);
    const TileChoice tiles = TilesInView(*survey.loaded_scene).within(about.lo_m, about.hi_m);
    const Survey near = survey_with_tiles(survey, tiles);
    return take_mesh(near.scene, near.scene.mesh, about, limits_.mesh_facets, view);
  }

  void add_transmissions() {
    if (sensor_.transmissions() < 2) return;
    for (std::size_t transmission = 0; transmission < sensor_.transmissions(); ++transmission)
      view.transmissions.push_back(
          {sensor_.transmission_delay_s(transmission), sensor_.beams_of_transmission(transmission)});
  }

  /// Adds a note on the largest displacement between the first and the last transmission of a ping, if the
  /// carrier moves.
  void note_motion_between_transmissions() {
    const std::size_t transmissions = sensor_.transmissions();
    if (transmissions < 2 || !sensor_.transmit_sectors().empty()) return;
    double moves_m = 0, turns_deg = 0;
    for (const ViewPing& ping : view.pings) {
      const Pose &first = pings_.transmission_pose(ping.number, 0),
                 &last = pings_.transmission_pose(ping.number, transmissions - 1);
      moves_m = std::max(moves_m, glm::distance(first.position_m, last.position_m));
      // The angle of the rotation between two attitudes q and p is 2 acos |q p|.
      const double cosine =
          std::min(1.0, std::abs(glm::dot(glm::normalize(first.attitude), glm::normalize(last.attitude))));
      turns_deg = std::max(turns_deg, 2 * 180 / std::numbers::pi * std::acos(cosine));
    }
    // acos near 1 resolves about 2e-6 degrees
    constexpr double still_m = 1e-6, still_deg = 1e-5;
    if (moves_m < still_m && turns_deg < still_deg) return;
    std::string motion;
    if (moves_m >= still_m) motion = fmt::format(" moves by {:.2g} cm", 100 * moves_m);
    if (turns_deg >= still_deg)
      motion += fmt::format("{} turns by {:.2g} degrees", motion.empty() ? "" : " and", turns_deg);
    view.stripes = fmt::format(
        "Stripes along the beams are an effect of the sonar: it fires its {} beams in {} cycles within "
        "{:.3g} ms, and{} meanwhile, so adjacent beams see the scene from different positions.",
        view.beams, transmissions, 1000 * sensor_.transmission_delay_s(transmissions - 1), motion);
    view.notes.push_back(view.stripes);
  }

  void require_space(std::size_t more) const {
    if (view.footprints.size() + more > limits_.footprints)
      throw UsageError(
          view.pings.size() > 1
              ? fmt::format(
                    "a page can hold {} footprints, but ping {} exceeds this number: use --pings {}:{}",
                    limits_.footprints, view.pings.back().number, view.pings.front().number,
                    view.pings[view.pings.size() - 2].number)
              : fmt::format(
                    "a page can hold {} footprints, but ping {} has more: use larger facets in the scene",
                    limits_.footprints, view.pings.back().number));
  }

  void add_hidden_parts(const Transmission& transmission, const TransmissionEnd& end,
                        const History& history) {
    if (!shadow_limit_reached_)
      shadow_limit_reached_ =
          !add_shadows(transmission.scene(), end, history, limits_.shadow_polygons, view.shadows);
  }

  void add_monostatic(const Transmission& transmission, const TransmissionEnd& end, std::uint32_t view_ping) {
    const History history = transmission.trace();
    require_space(history.footprints.footprints.size());
    const TransmissionSurface& surface_mesh = transmission.surface_mesh();
    const glm::dvec3 apex = transmission.scene().grid.to_metres(history.tubes.apex);
    const std::uint32_t first_tube = add_tubes(transmission, history.tubes, history, view_ping, apex);
    const auto first_footprint = static_cast<std::uint32_t>(view.footprints.size());
    for (const Footprint& f : history.footprints.footprints) {
      const double true_area_ratio =
          surface_mesh.apparent() == nullptr
              ? 1
              : surface_mesh.apparent()->area_ratio(f.facet, transmission.scene().grid);
      add_footprint(transmission, f, history.footprints, view_ping, f.tube, first_tube, first_tube,
                    surface_mesh.base_facet(f.facet), surface_mesh.mesh(), true_area_ratio * f.area_m2,
                    f.occluder_count, [&](glm::dvec3 apparent_offset_m) {
                      return surface_mesh.apparent() == nullptr
                                 ? apex + apparent_offset_m
                                 : surface_mesh.apparent()->true_place(f.facet, apex + apparent_offset_m,
                                                                       transmission.scene().grid);
                    });
    }
    SensorModel model = transmission.model(sensor_index_);
    model.patterns.baselines.clear();  // the view shows the visibility from the transmitter
    const std::vector<std::uint32_t>& beam_of_tube = sensor_.beam_of_tube(transmission.number());
    link(transmission, history, {transmission.beams(sensor_index_), beam_of_tube},
         transmission.echo(history, sensor_index_, model.model), model.model, view_ping, first_footprint);
    add_hidden_parts(transmission, end, history);
  }

  /// Adds the parts that both ends (transmitter and receiver) see, and those in the tubes of either end that
  /// are hidden from it.
  void add_bistatic(const Transmission& transmission, const TransmissionEnds& ends, std::uint32_t view_ping) {
    const TransmissionEnds::Seen all = ends.seen();
    const PathFootprints& seen = all.together;
    require_space(seen.footprints.footprints.size());
    std::array<std::uint32_t, 2> first_tube{};
    std::array<std::map<std::pair<FacetId, std::uint32_t>, std::uint32_t>, 2> occluders;
    for (std::size_t k = 0; k < 2; ++k) {
      const TransmissionEnd& end = ends.all()[k];
      const History& history = all.alone[k];
      first_tube[k] = add_tubes(transmission, end.tubes, history, view_ping,
                                transmission.scene().grid.to_metres(end.tubes.apex));
      for (const Footprint& f : history.footprints.footprints)
        occluders[k][{end.name_of(f.facet), f.tube}] = f.occluder_count;
      add_hidden_parts(transmission, end, history);
    }
    const glm::dvec3 apex = transmission.scene().grid.to_metres(ends.tx().tubes.apex);
    const auto first_footprint = static_cast<std::uint32_t>(view.footprints.size());
    for (std::size_t k = 0; k < seen.footprints.footprints.size(); ++k) {
      const Footprint& f = seen.footprints.footprints[k];
      const std::uint32_t rx = seen.receive_tube[k];
      add_footprint(transmission, f, seen.footprints, view_ping, rx, first_tube[0], first_tube[1],
                    ends.base_facet(f.facet), ends.shared_mesh(), seen.area_m2(k),
                    occluders[0][{f.facet, f.tube}] + occluders[1][{f.facet, rx}],
                    [&](glm::dvec3 apparent_offset_m) { return seen.place(k, apparent_offset_m, apex); });
    }
    const std::unique_ptr<SensorModel> model = ends.model(sensor_index_);
    model->patterns.baselines.clear();  // as in add_monostatic()
    const std::vector<std::uint32_t> fans = sensor_.fan_of_tube(transmission.number());
    link(transmission, seen.history, transmission.beams_by_fans(sensor_index_, fans),
         transmission.echo(seen.history, sensor_index_, model->model), model->model, view_ping,
         first_footprint);
  }

  /// Adds the tubes, each up to its farthest footprint, or to the end of the samples in unobstructed water.
  /// Returns the index of the first.
  std::uint32_t add_tubes(const Transmission& transmission, const TubeSet& tubes, const History& history,
                          std::uint32_t view_ping, glm::dvec3 apex) {
    const auto first_tube = static_cast<std::uint32_t>(view.tubes.size());
    if (transmission.scene().water->refracts()) return first_tube;
    const std::vector<std::uint32_t>& beams = sensor_.beams_of_transmission(transmission.number());
    const std::vector<std::uint32_t>& beam_of_tube = sensor_.beam_of_tube(transmission.number());
    const RangeSamples& samples = sensor_.samples();
    std::vector<double> length_m(tubes.tubes.size(), 0.0);
    for (const Footprint& f : history.footprints.footprints)
      length_m[f.tube] = std::max(length_m[f.tube], f.slant_range_max_m);
    const double last_m = samples.first_m + samples.count * samples.step_m;
    for (double& length : length_m) length = length > 0 ? std::min(length, last_m) : last_m;
    for (std::size_t t = 0; t < tubes.tubes.size(); ++t) {
      ViewTube tube{view_ping, beams[beam_of_tube[t]], apex, {}};
      for (std::size_t k = 0; k < 4; ++k) {
        const GridPoint& ray = tubes.rays[tubes.tubes[t][k]];
        tube.ends_m[k] = apex + glm::normalize(glm::dvec3(ray.x, ray.y, ray.z)) * length_m[t];
      }
      view.tubes.push_back(tube);
    }
    return first_tube;
  }

  /// `true_position` maps an apparent position [m, relative to the apex] to the point on the surface [m].
  template <class TruePosition>
  void add_footprint(const Transmission& transmission, const Footprint& f, const FootprintSet& set,
                     std::uint32_t view_ping, std::uint32_t receive_tube, std::uint32_t first_tube,
                     std::uint32_t first_receive_tube, FacetId base, const FacetMesh& mesh, double area_m2,
                     std::uint32_t occluders, const TruePosition& true_position) {
    const std::uint32_t beam = sensor_.beams_of_transmission(
        transmission.number())[sensor_.beam_of_tube(transmission.number())[receive_tube]];
    view.footprints.push_back(
        {view_ping, beam, f.tube, base, receive_tube, first_tube + f.tube, first_receive_tube + receive_tube,
         f.piece_count, occluders, mesh.component[f.facet], mesh.material[f.facet], area_m2, f.solid_angle_sr,
         f.grazing_angle_rad, f.slant_range_min_m, f.slant_range_max_m, 0, true_position(f.centroid_m)});
    for (std::uint32_t p = 0; p < f.piece_count; ++p) {
      const Piece& piece = set.pieces[f.first_piece + p];
      view.shapes.corners_of.push_back(static_cast<std::uint16_t>(piece.count));
      for (std::uint32_t c = 0; c < piece.count; ++c)
        view.shapes.corners_m.push_back(true_position(set.corners_m[piece.first + c]));
    }
  }

  void link(const Transmission& transmission, const CommonVisibility& visibility,
            const ReceiveBeams& receivers, const Echo& echo, const EchoModel& model, std::uint32_t view_ping,
            std::uint32_t first_footprint) {
    const std::vector<std::uint32_t>& beams = sensor_.beams_of_transmission(transmission.number());
    const RangeSamples samples = transmission.samples(sensor_index_);
    const std::size_t offset = view_ping * bins_per_ping_ + sensor_.first_sample(transmission.number()),
                      all = static_cast<std::size_t>(sensor_.samples().count),
                      count = static_cast<std::size_t>(samples.count);
    const bool patterns = model.patterns != nullptr;
    for (std::size_t b = 0; b < beams.size(); ++b)
      for (std::size_t k = 0; k < count; ++k)
        view.energy_j[offset + beams[b] * all + k] += echo.energy[b * count + k];
    view.weak_links_left_out = view.weak_links_left_out || patterns;
    for (const Contribution& c :
         contributions(visibility, receivers, samples, model, transmission.request().binning, echo,
                       patterns ? min_energy_share : 0)) {
      view.links.push_back({first_footprint + c.footprint,
                            static_cast<std::uint32_t>(offset + beams[c.beam] * all + c.sample), c.energy_j});
      view.footprints[first_footprint + c.footprint].energy_j += c.energy_j;
    }
  }

  const Transmissions& transmissions_;
  TransmissionsAround around_;
  const SensorPings& pings_;
  const Sensor& sensor_;
  std::size_t sensor_index_;
  const ViewLimits& limits_;
  std::size_t bins_per_ping_;
  bool shadow_limit_reached_ = false;
  FacetMesh refined_mesh_;  // mesh of the first transmission, if its relief is refined
};

PictureLayout picture_layout(const Sensor& sensor) {
  if (sensor.beams().size() == 1) return PictureLayout::echogram;
  return sensor.beams().size() == 2 ? PictureLayout::waterfall : PictureLayout::fan;
}

}  // namespace

ViewData gather_view(const Transmissions& transmissions, std::size_t sensor,
                     const std::optional<PingRange>& range, bool quiet, const ViewLimits& limits) {
  const Survey& survey = transmissions.survey();
  const SensorPings& pings = survey.sensors[sensor];
  const SensorDescription& description = pings.sensor->description();
  require_able(survey, transmissions.request(), Feature::view, sensor);
  ViewBuilder builder(transmissions, sensor, limits);
  ViewData& view = builder.view;
  const Scene& scene = survey.scene;
  view.title = scene.description.title;
  view.scene_hash = scene.description.sha256;
  view.sensor = description.name;
  view.kind = kind_of(description).name();
  view.separate_receiver = pings.sensor->has_separate_receiver();
  view.across_track = pings.sensor->is_across_track();
  for (const ComponentReport& component : scene.report.components) view.components.push_back(component.name);
  for (const MaterialDescription& material : scene.description.materials)
    view.materials.push_back(material.name);
  view.layout = picture_layout(*pings.sensor);
  view.beams = static_cast<std::uint32_t>(pings.sensor->beams().size());
  view.samples = static_cast<std::uint32_t>(pings.sensor->samples().count);
  view.first_m = pings.sensor->samples().first_m;
  view.step_m = pings.sensor->samples().step_m;
  view.beam_angle_deg = beam_angles_deg(*pings.sensor);
  view.display_gain_db = description.signal.display_gain_db;

  const bool as_many_as_fit = !range;
  const std::int64_t last_ping = static_cast<std::int64_t>(pings.times_s.size()) - 1;
  const PingRange requested = range ? *range : PingRange{0, last_ping};
  const auto bins = static_cast<double>(requested.last - requested.first + 1) * view.beams * view.samples;
  constexpr double max_bins = 5e7;
  if (range && bins > max_bins)
    throw UsageError(fmt::format(
        "a picture of {:.3g} range bins is too large for a page, which can hold {:.2g}: use --pings {}:{}",
        bins, max_bins, requested.first,
        requested.first +
            std::max<std::int64_t>(0, static_cast<std::int64_t>(max_bins / view.beams / view.samples) - 1)));
  constexpr std::size_t max_pings = 1000;  // more lines are too thin to be selected
  Progress progress("pings", static_cast<std::size_t>(requested.last - requested.first + 1), quiet);
  for (std::int64_t ping = requested.first; ping <= requested.last; ++ping) {
    stop_if_wanted();
    const bool full =
        view.footprints.size() >= limits.footprints_unasked || view.pings.size() == max_pings ||
        view.energy_j.size() + view.energy_j.size() / std::max<std::size_t>(view.pings.size(), 1) >
            limits.cells_unasked;
    if (as_many_as_fit && full && !view.pings.empty()) {
      view.notes.push_back(fmt::format("Pings {} to {} of {}: tubefoot view --pings A:B shows others.",
                                       requested.first, ping - 1, pings.times_s.size()));
      break;
    }
    builder.add_ping(static_cast<std::size_t>(ping));
    progress.step();
  }
  builder.finish();
  return std::move(builder.view);
}

}  // namespace tubefoot
