// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <boost/random/binomial_distribution.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>

#include "engine/rays/ray_shares.hpp"
#include "geometry/numbers/int128.hpp"

// Generates the directions and weights of rays for all samplings except the adaptive one. Random bits come
// from a counter-based generator (SplitMix64), so each ray depends only on the seed and its number.

namespace tubefoot {
namespace {

using namespace splitmix;

/// Returns the first ray of a row if `rays` are distributed among `rows`.
std::int64_t row_begin(std::int64_t row, std::int64_t rays, std::int64_t rows) {
  return std::int64_t(Int128(row) * rays / rows);
}

/// Returns the numbers of independent rays, of `rays` in total, that fall into each part.
std::vector<std::int64_t> drawn(const std::vector<double>& parts, std::int64_t rays, std::uint64_t seed) {
  boost::random::mt19937_64 random(mixed(seed + golden));
  double left = 0;
  for (const double part : parts) left += part;
  std::vector<std::int64_t> counts;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const double chance = k + 1 == parts.size() ? 1 : std::min(parts[k] / left, 1.0);
    counts.push_back(boost::random::binomial_distribution<std::int64_t, double>(rays, chance)(random));
    rays -= counts.back();
    left = std::max(left - parts[k], std::numeric_limits<double>::min());
  }
  return counts;
}

}  // namespace

RaySampling ray_sampling_from_name(std::string_view name) {
  for (const RaySampling sampling : all_samplings)
    if (name_of(sampling) == name) return sampling;
  throw std::invalid_argument(fmt::format(
      "unknown sampling '{}': expected stratified, sobol, adaptive, regular, random or column", name));
}

std::string_view name_of(RaySampling sampling) {
  switch (sampling) {
    case RaySampling::regular:
      return "regular";
    case RaySampling::random:
      return "random";
    case RaySampling::column:
      return "column";
    case RaySampling::sobol:
      return "sobol";
    case RaySampling::adaptive:
      return "adaptive";
    case RaySampling::stratified:
      break;
  }
  return "stratified";
}

RayPlan::RayPlan(const TubeSet& tubes, const RaySettings& settings,
                 std::span<const std::uint32_t> beam_of_tube)
    : settings_(settings) {
  if (settings.sampling == RaySampling::adaptive)
    throw std::invalid_argument("trace_rays() plans adaptive rays itself, because they depend on the hits");
  const bool in_columns = settings.sampling == RaySampling::column;
  const bool by_beam = settings.per == RaySettings::Per::beam;
  patches_ = ray_patches(tubes, settings, beam_of_tube);
  std::vector<double> solid_angles;
  for (const RayPatch& patch : patches_) solid_angles.push_back(patch.solid_angle(0, 1, 0, 1));
  if (patches_.empty() || settings.rays == 0) return;
  if (!in_columns) {
    share_out(solid_angles, ray_groups(patches_.size(), settings, beam_of_tube));
    return;
  }
  std::vector<double> parts;
  for (const auto& beam : tubes_of_beams(beam_of_tube)) {
    columns_.emplace_back(tubes, patches_, beam);
    parts.push_back(columns_.back().solid_angle());
  }
  std::vector<std::int64_t> counts(columns_.size(), settings.rays);
  if (!by_beam) counts = dealt(parts, settings.rays);
  for (const std::int64_t rays : counts) {
    shares_.push_back({rays_, rays, 0, 0});
    rays_ += rays;
  }
}

void RayPlan::share_out(std::span<const double> solid_angles,
                        const std::vector<std::vector<std::uint32_t>>& groups) {
  shares_.resize(solid_angles.size());
  std::size_t group = 0;
  for (const auto& tubes : groups) {
    std::vector<double> parts;
    double total = 0;
    for (const std::uint32_t t : tubes) {
      parts.push_back(solid_angles[t]);
      total += solid_angles[t];
    }
    const bool random = settings_.sampling == RaySampling::random;
    const auto counts =
        random ? drawn(parts, settings_.rays, settings_.seed + mixed(++group)) : dealt(parts, settings_.rays);
    for (std::size_t k = 0; k < tubes.size(); ++k)
      shares_[tubes[k]] = {0, counts[k], 0, total / double(settings_.rays)};
  }
  for (std::size_t t = 0; t < shares_.size(); ++t) {
    Share& share = shares_[t];
    share.first = rays_;
    rays_ += share.rays;
    const PatchSides sides(patches_[t]);
    const double rows = std::round(std::sqrt(double(share.rays) * sides.height / sides.width));
    share.rows = std::int64_t(std::clamp(rows, 1.0, std::max(double(share.rays), 1.0)));
  }
}

RaySource::RaySource(const RayPlan& plan, std::int64_t first, std::int64_t end)
    : plan_(plan), next_(first), end_(end) {}

bool RaySource::next(RayPacket& packet) {
  int lane = 0;
  const bool net = plan_.settings_.sampling == RaySampling::sobol;
  while (lane < RayPacket::size && next_ < end_) {
    if (run_next_ == run_end_) start_run();
    int count = int(std::min<std::int64_t>(RayPacket::size - lane, run_end_ - run_next_));
    if (net) {  // blocks of cells are packets, and stay together
      const auto in_block = (run_next_ - net_first_) % RayPacket::size;
      if (lane > 0 && (in_block > 0 || run_end_ - run_next_ >= RayPacket::size)) break;
      count = int(std::min<std::int64_t>(count, RayPacket::size - in_block));
      next_of_net(packet, lane, count);
    } else if (!plan_.columns_.empty())
      next_of_column(packet, lane, count);
    else if (plan_.settings_.sampling == RaySampling::random)
      next_random(packet, lane, count);
    else if (count < RayPacket::size || !next_block(packet))
      next_cells(packet, lane, count);
    lane += count;
    next_ += count;
  }
  packet.count = lane;
  return lane > 0;
}

void RaySource::start_run() {
  const auto& shares = plan_.shares_;
  const auto after =
      std::upper_bound(shares.begin(), shares.end(), next_,
                       [](std::int64_t ray, const RayPlan::Share& share) { return ray < share.first; });
  run_ = std::size_t(after - shares.begin() - 1);
  const RayPlan::Share& share = shares[run_];
  run_next_ = next_ - share.first;
  run_end_ = std::min(end_ - share.first, share.rays);
  key_ = mixed(mixed(plan_.settings_.seed + golden) + golden * (run_ + 1));
  if (!plan_.columns_.empty())
    cursor_ = plan_.columns_[run_].start(run_next_, share.rays);
  else if (plan_.settings_.sampling == RaySampling::random)
    draw_run();
  else if (plan_.settings_.sampling == RaySampling::sobol)
    start_net();
  else
    start_band(std::int64_t((Int128(run_next_ + 1) * share.rows - 1) / share.rays));
}

/// The number of rays of a tube is divided into powers of two, the largest first. Each of them is a net.
void RaySource::start_net() {
  const RayPlan::Share& share = plan_.shares_[run_];
  constexpr std::int64_t sequence = std::int64_t{1} << RayNet::most_bits;
  const std::int64_t number = run_next_ / sequence, rays = std::min(share.rays - number * sequence, sequence);
  std::int64_t first = 0, size = std::int64_t(std::bit_floor(std::uint64_t(rays)));
  for (; run_next_ - number * sequence >= first + size;
       size = std::int64_t(std::bit_floor(std::uint64_t(rays - first))))
    first += size;
  net_first_ = number * sequence + first;
  run_end_ = std::min(run_end_, net_first_ + size);
  const int bits = int(std::bit_width(std::uint64_t(size))) - 1;
  const PatchSides sides(plan_.patches_[run_]);
  const int row_bits =
      int(std::clamp(std::round((bits + std::log2(sides.height / sides.width)) / 2), 0.0, double(bits)));
  net_ = RayNet(mixed(key_ + std::uint64_t(number)), std::uint32_t(first), bits - row_bits, row_bits);
}

void RaySource::next_of_net(RayPacket& packet, int lane, int count) {
  const auto t = std::uint32_t(run_next_ - net_first_), at = t % RayPacket::size;
  const NetBlock points = net_.block(t - at);
  const RayPatch& patch = plan_.patches_[run_];
  const double weight = 1 / double(plan_.shares_[run_].rays);
  if (count == RayPacket::size) {
    aim_at_net(patch, points, weight, packet);
  } else {
    RayPacket whole;
    aim_at_net(patch, points, weight, whole);
    take_lanes(whole, int(at), packet, lane, count);
  }
  std::fill_n(packet.tube.begin() + lane, count, std::uint32_t(run_));
  run_next_ += count;
}

void RaySource::next_of_column(RayPacket& packet, int lane, int count) {
  for (const int end = lane + count; lane < end; ++lane) {
    const RayColumn::Ray ray =
        plan_.columns_[run_].next(cursor_, plan_.patches_, run_next_++, plan_.shares_[run_].rays);
    packet.x[lane] = ray.direction.x;
    packet.y[lane] = ray.direction.y;
    packet.z[lane] = ray.direction.z;
    packet.weight[lane] = ray.solid_angle_sr;
    packet.tube[lane] = ray.tube;
  }
}

void RaySource::start_band(std::int64_t row) {
  const RayPlan::Share& share = plan_.shares_[run_];
  const std::int64_t first_row = row - row % band_rows;
  band_height_ = int(std::min<std::int64_t>(band_rows, share.rows - first_row));
  full_columns_ = std::numeric_limits<std::int64_t>::max();
  for (int k = 0; k < band_height_; ++k) {
    const std::int64_t begin = row_begin(first_row + k, share.rays, share.rows);
    const std::int64_t count = row_begin(first_row + k + 1, share.rays, share.rows) - begin;
    row_[k] = {begin, count, 1 / double(count), -1, 1};
    full_columns_ = std::min(full_columns_, count);
  }
  // Rows differ by one ray at most. The last rays of the longer rows follow at the end.
  const std::int64_t walked = run_next_ - row_[0].begin, full = full_columns_ * band_height_;
  column_ = std::min(walked / band_height_, full_columns_);
  row_in_band_ = walked < full ? int(walked % band_height_) : 0;
  block_row_ = -1;
  if (walked < full) return;
  for (std::int64_t skip = walked - full;; ++row_in_band_)
    if (row_[row_in_band_].count > full_columns_ && skip-- == 0) break;
}

double RaySource::row_factor(const Row& row) const {
  const RayPlan::Share& share = plan_.shares_[run_];
  const RayPatch& patch = plan_.patches_[run_];
  const std::int64_t from = row.segment * segment_length, to = std::min(from + segment_length, row.count);
  const double v = (double(row.begin) + 0.5 * double(row.count)) / double(share.rays);
  double sum = 0;
  for (std::int64_t column = from; column < to; ++column) {
    const double u = (double(column) + 0.5) * row.u_step;
    const glm::dvec3 p = patch.at(u, v);
    const double inverse = 1 / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    sum += patch.triple(u, v) * (inverse * inverse * inverse);
  }
  return patch.solid_angle(double(from) * row.u_step, double(to) * row.u_step,
                           double(row.begin) / double(share.rays),
                           double(row.begin + row.count) / double(share.rays)) /
         (sum / double(share.rays));
}

/// Generates sixteen jittered cells inside a band at once. Returns false if the band has no more blocks.
bool RaySource::next_block(RayPacket& packet) {
  constexpr int columns = RayPacket::size / band_rows;
  if (plan_.settings_.sampling != RaySampling::stratified || band_height_ != band_rows ||
      column_ + columns >= full_columns_)
    return false;
  if (block_row_ != row_in_band_) {  // the row of each lane
    block_row_ = row_in_band_;
    block_.share = 1 / double(plan_.shares_[run_].rays);
    for (int k = 0; k < RayPacket::size; ++k) {
      const Row& row = row_[(row_in_band_ + k) % band_rows];
      block_.column[k] = double((row_in_band_ + k) / band_rows);
      block_.u_step[k] = row.u_step;
      block_.begin[k] = double(row.begin);
      block_.count[k] = double(row.count);
      block_.weight[k] = block_.share;
    }
  }
  block_.first_column = double(column_);
  aim_into(plan_.patches_[run_], block_, key_, std::uint64_t(run_next_ + 1), packet);
  packet.tube.fill(std::uint32_t(run_));
  column_ += columns;
  run_next_ += RayPacket::size;
  return true;
}

void RaySource::next_cells(RayPacket& packet, int lane, int count) {
  const RayPlan::Share& share = plan_.shares_[run_];
  const bool jitter = plan_.settings_.sampling == RaySampling::stratified;
  const double cell = 1 / double(share.rays);
  RayPacket::Numbers u{}, v{}, weight{};
  for (int k = 0; k < count; ++k, ++run_next_) {
    while (column_ == full_columns_ && (row_in_band_ < band_height_) &&
           row_[row_in_band_].count == full_columns_)
      ++row_in_band_;
    if (column_ == full_columns_ && row_in_band_ == band_height_)
      start_band(std::int64_t((Int128(run_next_ + 1) * share.rows - 1) / share.rays));
    Row& row = row_[row_in_band_];
    double du = 0.5, dv = 0.5;
    if (jitter) {
      const std::uint64_t bits = mixed(key_ + golden * std::uint64_t(run_next_ + 1));
      du = upper_uniform(bits);
      dv = lower_uniform(bits);
    } else if (row.segment != column_ / segment_length) {
      row.segment = column_ / segment_length;
      row.factor = row_factor(row);
    }
    u[k] = (double(column_) + du) * row.u_step;
    v[k] = (double(row.begin) + dv * double(row.count)) * cell;
    weight[k] = row.factor * cell;
    if (++row_in_band_ == band_height_ && column_ < full_columns_) {
      row_in_band_ = 0;
      ++column_;
    }
  }
  place(packet, lane, count, u, v, weight);
}

void RaySource::draw_run() {
  const RayPlan::Share& share = plan_.shares_[run_];
  const RayPatch& patch = plan_.patches_[run_];
  const double bound = patch.density_bound();
  const auto draw = [&](std::int64_t ray) {
    std::uint64_t state = mixed(key_ + golden * std::uint64_t(ray + 1));
    std::array<double, 2> place{0.5, 0.5};
    constexpr int patience = 1000;  // never reached: a quarter or more of the draws are accepted
    for (int attempt = 0; attempt < patience; ++attempt) {
      const std::uint64_t bits = mixed(state += golden);
      place = {upper_uniform(bits), lower_uniform(bits)};
      const glm::dvec3 p = patch.at(place[0], place[1]);
      const double length2 = p.x * p.x + p.y * p.y + p.z * p.z;
      const double density = patch.triple(place[0], place[1]) / (length2 * std::sqrt(length2));
      if (upper_uniform(mixed(state += golden)) * bound <= density) break;
    }
    return place;
  };
  // The rays are sorted by position (a counting sort into bins of about a packet), so that packets are
  // coherent.
  const auto count = std::size_t(run_end_ - run_next_);
  const double bins = double(count) / RayPacket::size + 1;
  const double aspect = double(share.rows) / double(share.rays) * double(share.rows);
  const auto rows = std::size_t(std::clamp(std::round(std::sqrt(bins * aspect)), 1.0, bins));
  const auto columns = std::size_t(bins / double(rows)) + 1;
  drawn_.resize(count);
  sorted_.resize(count);
  bin_.resize(count);
  bin_begin_.assign(rows * columns + 1, 0);
  for (std::size_t k = 0; k < count; ++k) {
    drawn_[k] = draw(run_next_ + std::int64_t(k));
    bin_[k] = std::uint32_t(std::size_t(drawn_[k][1] * double(rows)) * columns +
                            std::size_t(drawn_[k][0] * double(columns)));
    ++bin_begin_[bin_[k] + 1];
  }
  for (std::size_t b = 1; b < bin_begin_.size(); ++b) bin_begin_[b] += bin_begin_[b - 1];
  for (std::size_t k = 0; k < count; ++k) sorted_[bin_begin_[bin_[k]]++] = drawn_[k];
  sorted_begin_ = run_next_;
}

void RaySource::next_random(RayPacket& packet, int lane, int count) {
  RayPacket::Numbers u{}, v{}, weight{};
  for (int k = 0; k < count; ++k, ++run_next_) {
    const auto& place = sorted_[std::size_t(run_next_ - sorted_begin_)];
    u[k] = place[0];
    v[k] = place[1];
  }
  place(packet, lane, count, u, v, weight);
  std::fill_n(packet.weight.begin() + lane, count, plan_.shares_[run_].weight);
}

void RaySource::place(RayPacket& packet, int lane, int count, const RayPacket::Numbers& u,
                      const RayPacket::Numbers& v, const RayPacket::Numbers& weight) const {
  if (count == RayPacket::size) {
    aim(plan_.patches_[run_], u, v, weight, packet);
  } else {  // other lanes may belong to other runs
    RayPacket some;
    aim(plan_.patches_[run_], u, v, weight, some);
    take_lanes(some, 0, packet, lane, count);
  }
  std::fill_n(packet.tube.begin() + lane, count, std::uint32_t(run_));
}

}  // namespace tubefoot
