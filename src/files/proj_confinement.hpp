// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace tubefoot {

/// While an object exists, PROJ can open only regular files of its own data folders on this thread, for
/// reading. The text of a coordinate reference system cannot make PROJ open another file, a file of the
/// working folder or a network address. The spelling of the text does not matter, because PROJ itself calls
/// the check before it opens a file. Use of PROJ by other parts of the program is not affected.
///
/// Throws std::runtime_error if GDAL on this thread uses a PROJ that does not call the check.
class ProjConfinement {
 public:
  ProjConfinement();
  ~ProjConfinement();
  ProjConfinement(const ProjConfinement&) = delete;
  ProjConfinement& operator=(const ProjConfinement&) = delete;

  /// Returns the first existing file that PROJ was not allowed to open; empty if there is none.
  const std::string& rejected() const { return rejected_; }

 private:
  friend struct ProjFiles;
  ProjConfinement* outer_;
  std::string rejected_;
};

}  // namespace tubefoot
