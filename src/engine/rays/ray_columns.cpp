// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <stdexcept>

// Places rays at equal angles along the centre line of a beam. Each ray gets the solid angle of the beam
// between its borders, as the sum over the tubes side by side.

namespace tubefoot {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

double angle_between(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// Returns the tubes of a beam as grid[row][column], rows along v and columns along u, from the edges that
/// they share.
std::vector<std::vector<std::uint32_t>> grid_of(const TubeSet& tubes, std::span<const std::uint32_t> beam) {
  std::map<Edge, std::uint32_t> at_low_u, at_low_v;
  for (const std::uint32_t t : beam) {
    const Tube& c = tubes.tubes[t];
    at_low_u[{c[0], c[3]}] = t;
    at_low_v[{c[0], c[1]}] = t;
  }
  auto starts = at_low_v;
  for (const std::uint32_t t : beam) {
    const Tube& c = tubes.tubes[t];
    if (const auto above = at_low_v.find({c[3], c[2]}); above != at_low_v.end()) starts.erase(above->first);
    if (const auto beside = at_low_u.find({c[1], c[2]}); beside != at_low_u.end()) {
      const Tube& next = tubes.tubes[beside->second];
      starts.erase({next[0], next[1]});
    }
  }
  std::vector<std::vector<std::uint32_t>> grid;
  std::size_t count = 0;
  if (starts.size() == 1) {
    for (auto row = starts.begin()->second;;) {
      grid.emplace_back();
      for (auto cell = row;;) {
        grid.back().push_back(cell);
        const Tube& c = tubes.tubes[cell];
        const auto beside = at_low_u.find({c[1], c[2]});
        if (beside == at_low_u.end() || grid.back().size() == beam.size()) break;
        cell = beside->second;
      }
      count += grid.back().size();
      const Tube& c = tubes.tubes[row];
      const auto above = at_low_v.find({c[3], c[2]});
      if (above == at_low_v.end() || count >= beam.size()) break;
      row = above->second;
    }
  }
  bool is_grid = count == beam.size();
  for (const auto& row : grid) is_grid = is_grid && row.size() == grid.front().size();
  if (!is_grid)
    throw std::invalid_argument(
        fmt::format("the sampling 'column' needs beams that are grids of tubes, but the {} tubes of the beam "
                    "with tube {} do not form a grid",
                    beam.size(), beam.front()));
  return grid;
}

}  // namespace

RayColumn::RayColumn(const TubeSet& tubes, std::span<const RayPatch> patches,
                     std::span<const std::uint32_t> beam) {
  std::vector<std::vector<std::uint32_t>> grid = grid_of(tubes, beam);
  double width = 0, height = 0;
  for (const std::uint32_t t : grid.front())
    width += angle_between(patches[t].at(0, 0.5), patches[t].at(1, 0.5));
  for (const auto& row : grid)
    height += angle_between(patches[row.front()].at(0.5, 0), patches[row.front()].at(0.5, 1));
  along_u_ = width > height;
  if (along_u_) {
    std::vector<std::vector<std::uint32_t>> turned(grid.front().size());
    for (const auto& row : grid)
      for (std::size_t k = 0; k < row.size(); ++k) turned[k].push_back(row[k]);
    grid = std::move(turned);
  }
  for (auto& row : grid) {
    Piece piece;
    const std::size_t middle = row.size() / 2;
    piece.middle = row[middle];
    // For an even number of tubes side by side, the column is the wall between the middle two.
    const double u = row.size() % 2 == 1 ? 0.5 : 0;
    const RayPatch& patch = patches[piece.middle];
    const glm::dvec3 begin = along_u_ ? patch.at(0, u) : patch.at(u, 0);
    const glm::dvec3 end = along_u_ ? patch.at(1, u) : patch.at(u, 1);
    piece.begin_length = glm::length(begin);
    piece.end_length = glm::length(end);
    piece.begin = glm::normalize(begin);
    piece.onward = glm::normalize(end - glm::dot(end, piece.begin) * piece.begin);
    piece.angle_before = angle_;
    const double angle = angle_between(begin, end);
    piece.sine = std::sin(angle);
    piece.cosine = std::cos(angle);
    angle_ += angle;
    for (const std::uint32_t t : row) solid_angle_ += patches[t].solid_angle(0, 1, 0, 1);
    piece.tubes = std::move(row);
    pieces_.push_back(std::move(piece));
  }
}

double RayColumn::v_at(const Piece& piece, double angle) const {
  // Law of sines in the triangle of the apex and the two ends.
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const double from = piece.begin_length * sine,
               to = piece.end_length * (piece.sine * cosine - piece.cosine * sine);
  return std::clamp(from / (from + to), 0.0, 1.0);
}

double RayColumn::solid_angle(const Piece& piece, std::span<const RayPatch> patches, double v0,
                              double v1) const {
  double sum = 0;
  for (const std::uint32_t t : piece.tubes)
    sum += along_u_ ? patches[t].solid_angle(v0, v1, 0, 1) : patches[t].solid_angle(0, 1, v0, v1);
  return sum;
}

RayColumn::Cursor RayColumn::start(std::int64_t index, std::int64_t rays) const {
  const double angle = angle_ * (double(index) / double(rays));
  Cursor cursor;
  while (cursor.piece + 1 < pieces_.size() && pieces_[cursor.piece + 1].angle_before <= angle) ++cursor.piece;
  const Piece& piece = pieces_[cursor.piece];
  cursor.v = v_at(piece, angle - piece.angle_before);
  return cursor;
}

RayColumn::Ray RayColumn::next(Cursor& cursor, std::span<const RayPatch> patches, std::int64_t index,
                               std::int64_t rays) const {
  const double middle = angle_ * ((double(index) + 0.5) / double(rays));
  const double upper = angle_ * (double(index + 1) / double(rays));
  Ray ray{};
  const auto place_ray = [&](const Piece& piece) {
    const double a = middle - piece.angle_before;
    ray.direction = std::cos(a) * piece.begin + std::sin(a) * piece.onward;
    ray.tube = piece.middle;
  };
  place_ray(pieces_[cursor.piece]);
  while (cursor.piece + 1 < pieces_.size() && pieces_[cursor.piece + 1].angle_before <= upper) {
    ray.solid_angle_sr += solid_angle(pieces_[cursor.piece], patches, cursor.v, 1);
    cursor = {cursor.piece + 1, 0};
    if (pieces_[cursor.piece].angle_before <= middle) place_ray(pieces_[cursor.piece]);
  }
  const Piece& piece = pieces_[cursor.piece];
  const double v = v_at(piece, upper - piece.angle_before);
  ray.solid_angle_sr += solid_angle(piece, patches, cursor.v, v);
  cursor.v = v;
  return ray;
}

}  // namespace tubefoot
