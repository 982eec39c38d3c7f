// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/library_settings.hpp"

#include <hdf5.h>

#include <cstdlib>
#include <mutex>

namespace tubefoot {

namespace fs = std::filesystem;

void keep_libraries_to_themselves() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("NCRCENV_IGNORE", "1", 1);
    H5PLset_loading_state(0);
  });
}

fs::path plain_name(const fs::path& file) {
  std::error_code error;
  const fs::path absolute = fs::absolute(file, error),
                 folder = fs::weakly_canonical(absolute.parent_path(), error);
  return error ? absolute.lexically_normal() : folder / absolute.filename();
}

}  // namespace tubefoot
