// SPDX-License-Identifier: GPL-3.0-or-later
#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "app/rank_link.hpp"

namespace tubefoot {
namespace {

// MPI counts in int: longer messages go in portions.
constexpr std::size_t most_at_once = std::size_t{1} << 30;
constexpr int start_tag = 1, portion_tag = 2;

class MpiLink : public RankLink {
 public:
  MpiLink() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    MPI_Comm local;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &local);
    MPI_Comm_size(local, &local_ranks_);
    MPI_Comm_free(&local);
  }
  int rank() const override { return rank_; }
  int ranks() const override { return ranks_; }
  int local_ranks() const override { return local_ranks_; }
  std::string host() const override {
    char name[MPI_MAX_PROCESSOR_NAME];
    int length = 0;
    MPI_Get_processor_name(name, &length);
    return std::string(name, static_cast<std::size_t>(length));
  }

  void send(int to, std::string_view bytes) override {
    // The first portion takes the length with it.
    const std::uint64_t length = bytes.size();
    const std::size_t first = std::min(bytes.size(), most_at_once);
    std::string start(sizeof length + first, '\0');
    std::memcpy(start.data(), &length, sizeof length);
    std::memcpy(start.data() + sizeof length, bytes.data(), first);
    MPI_Send(start.data(), static_cast<int>(start.size()), MPI_BYTE, to, start_tag, MPI_COMM_WORLD);
    for (std::size_t sent = first; sent < bytes.size();) {
      const std::size_t portion = std::min(bytes.size() - sent, most_at_once);
      MPI_Send(bytes.data() + sent, static_cast<int>(portion), MPI_BYTE, to, portion_tag, MPI_COMM_WORLD);
      sent += portion;
    }
  }

  std::optional<RankMessage> receive() override {
    int there = 0, count = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, start_tag, MPI_COMM_WORLD, &there, &status);
    if (!there) return std::nullopt;
    MPI_Get_count(&status, MPI_BYTE, &count);
    std::string start(static_cast<std::size_t>(count), '\0');
    MPI_Recv(start.data(), count, MPI_BYTE, status.MPI_SOURCE, start_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    std::uint64_t length = 0;
    std::memcpy(&length, start.data(), sizeof length);
    RankMessage message{status.MPI_SOURCE, start.substr(sizeof length)};
    std::size_t received = message.bytes.size();
    message.bytes.resize(length);
    while (received < length) {
      const std::size_t portion = std::min(length - received, most_at_once);
      MPI_Recv(message.bytes.data() + received, static_cast<int>(portion), MPI_BYTE, message.from,
               portion_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      received += portion;
    }
    return message;
  }

  void leave() override { MPI_Finalize(); }

 private:
  int rank_ = 0, ranks_ = 1, local_ranks_ = 1;
};

}  // namespace
}  // namespace tubefoot

extern "C" __attribute__((visibility("default"))) tubefoot::RankLink* tubefoot_join_ranks() {
  return new tubefoot::MpiLink();
}
