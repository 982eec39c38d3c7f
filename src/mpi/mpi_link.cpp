// SPDX-License-Identifier: GPL-3.0-or-later
#include <mpi.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/ranks/rank_link.hpp"

// This file implements RankLink with MPI. A long message travels in several portions, because MPI counts
// bytes in int. All sends and receives are non-blocking.

namespace tubefoot {
namespace {

// The tag of a portion states whether more portions of the message follow.
constexpr int last_tag = 1, more_tag = 2;

/// A message that is being sent in portions.
struct Outgoing {
  std::string bytes;
  std::size_t portions_left = 0;
};

/// Sends and receives without waiting, because two ranks that wait for each other would never continue.
class MpiLink : public RankLink {
 public:
  explicit MpiLink(std::size_t most_at_once) : most_at_once_(most_at_once) {
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

  void send(int to, std::string bytes) override {
    unsent_ += bytes.size();
    const auto message = std::make_shared<Outgoing>(Outgoing{std::move(bytes)});
    std::size_t sent = 0;
    do {
      const std::size_t portion = std::min(message->bytes.size() - sent, most_at_once_);
      const bool last = sent + portion == message->bytes.size();
      requests_.emplace_back();
      leaving_.push_back(message);
      ++message->portions_left;
      MPI_Isend(message->bytes.data() + sent, static_cast<int>(portion), MPI_BYTE, to,
                last ? last_tag : more_tag, MPI_COMM_WORLD, &requests_.back());
      sent += portion;
    } while (sent < message->bytes.size());
  }

  std::optional<RankMessage> receive() override {
    see_off();
    while (true) {
      if (!portion_under_way_ && !begin_portion()) return std::nullopt;
      int arrived = 0;
      MPI_Test(&incoming_request_, &arrived, MPI_STATUS_IGNORE);
      if (!arrived) return std::nullopt;
      portion_under_way_ = false;
      if (more_to_come_) continue;
      RankMessage message = std::move(*incoming_);
      incoming_.reset();
      return message;
    }
  }

  std::size_t unsent() const override { return unsent_; }
  bool moving() const override { return !requests_.empty() || incoming_; }

  void leave() override {
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
    MPI_Finalize();
  }

 private:
  /// Releases messages that have left completely.
  void see_off() {
    if (requests_.empty()) return;
    int count = 0;
    gone_.resize(requests_.size());
    MPI_Testsome(static_cast<int>(requests_.size()), requests_.data(), &count, gone_.data(),
                 MPI_STATUSES_IGNORE);
    if (count <= 0) return;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < requests_.size(); ++k)
      if (requests_[k] != MPI_REQUEST_NULL) {
        requests_[kept] = requests_[k];
        leaving_[kept++] = std::move(leaving_[k]);
      } else if (--leaving_[k]->portions_left == 0) {
        unsent_ -= leaving_[k]->bytes.size();
      }
    requests_.resize(kept);
    leaving_.resize(kept);
  }

  /// Starts to receive the next portion of the incoming message, or the first portion of another message.
  /// Returns false if none has arrived.
  bool begin_portion() {
    MPI_Message portion;
    MPI_Status status;
    int there = 0, count = 0;
    MPI_Improbe(incoming_ ? incoming_->from : MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &portion,
                &status);
    if (!there) return false;
    if (!incoming_) incoming_ = RankMessage{status.MPI_SOURCE, {}};
    MPI_Get_count(&status, MPI_BYTE, &count);
    const std::size_t before = incoming_->bytes.size();
    incoming_->bytes.resize(before + static_cast<std::size_t>(count));
    MPI_Imrecv(incoming_->bytes.data() + before, count, MPI_BYTE, &portion, &incoming_request_);
    portion_under_way_ = true;
    more_to_come_ = status.MPI_TAG == more_tag;
    return true;
  }

  const std::size_t most_at_once_;
  int rank_ = 0, ranks_ = 1, local_ranks_ = 1;
  std::vector<MPI_Request> requests_;               ///< of the outgoing portions
  std::vector<std::shared_ptr<Outgoing>> leaving_;  ///< by request
  std::vector<int> gone_;
  std::size_t unsent_ = 0;
  std::optional<RankMessage> incoming_;  ///< one message at a time; MPI holds the others
  MPI_Request incoming_request_ = MPI_REQUEST_NULL;
  bool portion_under_way_ = false, more_to_come_ = false;
};

}  // namespace
}  // namespace tubefoot

extern "C" __attribute__((visibility("default"))) tubefoot::RankLink* tubefoot_link_ranks(
    std::size_t most_at_once) {
  return new tubefoot::MpiLink(most_at_once);
}
