// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/transmission_images.hpp"

#include <stdexcept>
#include <utility>

#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/visibility/part_label.hpp"
#include "run/refraction.hpp"

namespace tubefoot {

bool is_order_wanted(const Scene& scene, std::size_t order) {
  return scene.description.paths.only_order.value_or(int(order)) == int(order);
}

PathEnds::PathEnds(const Transmission& transmission, std::size_t s)
    : transmit(transmission.tubes()), receive(transmission.receive_tubes(s)) {
  transmit.reach = receive.reach = 2 * transmission.sensor(s).reach(transmission.scene().grid);
}

TransmissionImages::TransmissionImages(const Transmission& transmission, std::size_t s, PathSettings settings,
                                       PathEnds ends, bool open_water, bool weights)
    : transmission_(transmission), settings_(std::move(settings)), ends_(std::move(ends)) {
  const WorldGrid& grid = transmission.scene().grid;
  if (transmission.scene().water->refracts())
    water_.emplace(path_water(transmission, s, ends_.transmit.reach * grid.unit_m()));
  if (water_) water_->limits.weights = weights;
  // In refracting water, images make apparent surfaces of their own.
  if (water_ || has_path_surface(transmission.scene()) ||
      (weights && transmission.loaded_scene().has_surface_per_transmission()))
    lying_.emplace(path_surface_of(transmission, weights));
  VisibilityOptions options = transmission.request().visibility;
  options.open_water = open_water;
  try {
    images_ = std::make_unique<const PathImages>(
        surface_mesh().mesh(), surface_mesh().tree(), grid.unit_m(), options, ends_.transmit, ends_.receive,
        settings_, absorption_db_per_m(transmission.scene(), transmission.sensor(s), transmission.number()),
        water_ ? &*water_ : nullptr);
  } catch (const RefinementTooLarge&) {
    rethrow_as_seen_by(transmission);
  } catch (const std::range_error&) {
    rethrow_as_seen_by(transmission);
  } catch (const std::length_error& error) {
    throw too_many_images(transmission.sensor(s).description(), error);
  }
}

void audit_paths(const Transmission& transmission, std::uint64_t label,
                 const std::function<void(const PathAudit&)>& use) {
  constexpr std::uint64_t of_paths = std::uint64_t{1} << 61;
  std::uint64_t number = 0;
  for (const std::size_t s : transmission.group().sensors) {
    const auto settings = path_settings(transmission, s);
    if (!settings || settings->order < 2) continue;
    const auto audit = [&](PathEnds ends) {
      const TransmissionImages images(transmission, s, *settings, std::move(ends), true);
      use(audit_paths(images.images(), label_of_part(label, of_paths + number++)));
    };
    const PathEnds ends(transmission, s);
    if (!transmission.sensor(s).has_receiver_pair()) {
      audit(ends);
      continue;
    }
    const std::vector<std::uint32_t> fans = transmission.sensor(s).fan_of_tube(transmission.number());
    const SensorModel model = transmission.model(s);
    for (std::uint32_t fan = 0; fan < model.patterns.baselines.size(); ++fan)
      for (const double end : {1.0, -1.0}) {
        PathEnds own = ends;
        own.transmit = tubes_of_fan(ends.transmit, fans, fan);
        own.receive = moved_along(tubes_of_fan(ends.receive, fans, fan), model.patterns.baselines[fan], end,
                                  transmission.scene().grid.unit_m());
        audit(std::move(own));
      }
  }
}

}  // namespace tubefoot
