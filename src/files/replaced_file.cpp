// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/replaced_file.hpp"

#include <stdexcept>
#include <string>

namespace tubefoot {

namespace fs = std::filesystem;

void replace_file(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  std::error_code ignored;
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) return write(file);
  fs::path partial = file;
  partial.replace_filename(".partial-" + file.filename().string());
  try {
    write(partial);
    fs::rename(partial, file);
  } catch (const std::runtime_error& error) {
    fs::remove(partial, ignored);
    std::string message = error.what();
    if (const std::size_t at = message.find(partial.string()); at != std::string::npos)
      message.replace(at, partial.string().size(), file.string());
    throw std::runtime_error(message);
  } catch (...) {
    fs::remove(partial, ignored);
    throw;
  }
}

}  // namespace tubefoot
