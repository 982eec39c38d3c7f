// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/ranks/rank_link.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <tbb/info.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

// MPI counts bytes in int, so that longer messages are sent in portions.
constexpr std::size_t most_at_once = std::size_t{1} << 30;

std::optional<int> number_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr || *text == '\0') return std::nullopt;
  return std::atoi(text);
}

}  // namespace

bool is_later_rank() {
  return number_in("OMPI_COMM_WORLD_RANK").value_or(number_in("PMIX_RANK").value_or(0)) > 0;
}

bool is_one_of_several_ranks() {
  const std::optional<int> size = number_in("OMPI_COMM_WORLD_SIZE");
  return size ? *size > 1 : number_in("PMIX_RANK").has_value();
}

std::unique_ptr<RankLink> join_ranks() {
  const std::optional<int> size = number_in("OMPI_COMM_WORLD_SIZE");
  if (!is_one_of_several_ranks()) {
    if (!size && number_in("PMI_SIZE").value_or(1) > 1)
      throw UsageError(
          "there are several processes, but Open MPI did not start them: use its mpirun, or srun --mpi=pmix "
          "(docs/large-jobs.md)");
    return nullptr;
  }
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  std::string why;
  for (const fs::path& place : {folder / "libtubefoot_mpi.so",
                                (folder / TUBEFOOT_MPI_FOLDER / "libtubefoot_mpi.so").lexically_normal()}) {
    // Global symbols, for the components that Open MPI loads itself.
    if (void* library = dlopen(place.c_str(), RTLD_NOW | RTLD_GLOBAL)) {
      using Join = RankLink* (*)(std::size_t);
      if (const auto join = reinterpret_cast<Join>(dlsym(library, "tubefoot_link_ranks")))
        return std::unique_ptr<RankLink>(join(most_at_once));
    }
    const char* error = dlerror();
    if (why.empty() || fs::exists(place, ignored)) why = error != nullptr ? error : "it has another version";
  }
  throw UsageError(
      fmt::format("mpirun started several processes, but the library by which they share a run cannot be "
                  "loaded ({}): build tubefoot where libopenmpi-dev is installed (docs/large-jobs.md)",
                  why));
}

int threads_of_rank(int local_ranks) {
  const int bound = tbb::info::default_concurrency();
  const int cores = std::max(bound, static_cast<int>(std::thread::hardware_concurrency()));
  return std::min(bound, std::max(1, cores / std::max(1, local_ranks)));
}

}  // namespace tubefoot
