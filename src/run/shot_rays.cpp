// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/shot_rays.hpp"

namespace tubefoot {
namespace {

/// Tells pings of a survey apart.
std::uint64_t label_of(const Shot& shot) {
  std::uint64_t label = shot.ping();
  for (const SharedShots& group : shot.survey().shots) {
    if (&group == &shot.group()) break;
    label += shot.survey().fleet->pings(group);
  }
  return label + (std::uint64_t(shot.number()) << 40);
}

}  // namespace

RaySettings rays_of(const Shot& shot) {
  RaySettings settings = shot.request().rays;
  settings.seed += 0x9e3779b97f4a7c15u * label_of(shot);
  return settings;
}

}  // namespace tubefoot
