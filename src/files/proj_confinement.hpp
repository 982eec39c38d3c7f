// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace tubefoot {

/// While one exists, PROJ opens on this thread regular files of its own data folders, to read them, and
/// nothing else: no file that the text of a coordinate reference system names, no file of the working folder,
/// no address on a network. It does not matter how the text is spelled, because PROJ itself asks before it
/// opens a file. What a program around this library does with PROJ outside of it stays as it is.
///
/// Throws std::runtime_error if GDAL on this thread uses a PROJ that does not ask.
class ProjConfinement {
 public:
  ProjConfinement();
  ~ProjConfinement();
  ProjConfinement(const ProjConfinement&) = delete;
  ProjConfinement& operator=(const ProjConfinement&) = delete;

  /// The first existing file that PROJ was not allowed to open; empty: there was none.
  const std::string& rejected() const { return rejected_; }

 private:
  friend struct ProjFiles;
  ProjConfinement* outer_;
  std::string rejected_;
};

}  // namespace tubefoot
