// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/path_audit.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>

#include "engine/visibility/part_label.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

double windows_sr(const TubeSet& windows) {
  double sum = 0;
  for (const Tube& tube : windows.tubes) {
    std::array<glm::dvec3, 4> d;
    for (std::size_t k = 0; k < 4; ++k) {
      const GridPoint ray = windows.rays[tube[k]];
      d[k] = glm::normalize(glm::dvec3(ray.x, ray.y, ray.z));
    }
    sum += std::abs(solid_angle(d[0], d[1], d[2]) + solid_angle(d[0], d[2], d[3]));
  }
  return sum;
}

}  // namespace

ImageAudit audit_image(const Image& image, bool of_receiver, std::uint64_t label) {
  // Half a unit in both directions for rays of 2^29 units, and the rounding of the sums.
  constexpr double ray_rad = 0x1p-29, relative = 1e-12;
  return {of_receiver,
          image.mirrors,
          audit_tubes(*image.mesh, image.windows, image.seen, label),
          image.mirror_sr,
          windows_sr(image.windows),
          ray_rad * image.border_rad + relative * image.mirror_sr};
}

bool ImageAudit::fills() const { return mirrors == 0 || std::abs(windows_sr - mirror_sr) <= rounding_sr; }

PathAudit audit_paths(const PathImages& images, std::uint64_t label) {
  constexpr std::uint64_t receiver = std::uint64_t{1} << 32, pair = std::uint64_t{1} << 33;
  PathAudit result;
  const auto add = [&](std::span<const Image> some, bool of_receiver) {
    for (std::size_t i = 0; i < some.size(); ++i) {
      stop_if_wanted();
      if (some[i].mirrors == 0 && some[i].origin.empty()) continue;
      result.images.push_back(
          audit_image(some[i], of_receiver, label_of_part(label, (of_receiver ? receiver : 0) + i)));
    }
  };
  add(images.sent(), false);
  if (!images.one_place()) add(images.received(), true);
  for (const ImagePair& of : images.pairs()) {
    const Image &sent = images.sent()[of.sent], &received = images.received()[of.received];
    ++result.pairs;
    if (&sent == &received) continue;  // an image shares everything that it sees with itself
    std::vector<SharedAudit> shared =
        audit_shared(images.sharer(sent, received), label_of_part(label, pair + result.pairs));
    std::move(shared.begin(), shared.end(), std::back_inserter(result.shared));
  }
  return result;
}

}  // namespace tubefoot
