// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes recordings of ROS 2: MCAP files, serialized messages, printed messages, and metadata. (SQLite
// itself reads SQLite files.)
#include <cmath>

#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "fuzz.hpp"
#include "import/bags/bag.hpp"

namespace tubefoot::fuzz {
namespace {

void check(const ForeignData& data) {
  if (data.frames.empty()) finding("a recording without pictures");
  for (const ForeignFrame& frame : data.frames) {
    if (frame.values.empty() || frame.values.size() != frame.rows * frame.columns) finding("no matrix");
    for (const auto* axis : {&frame.range_m, &frame.azimuth_rad}) {
      if (!axis->empty() && axis->size() != frame.rows && axis->size() != frame.columns)
        finding("an axis of nothing");
      for (const double each : *axis)
        if (!std::isfinite(each)) finding("an axis that is no number");
    }
    if (frame.time_s && !std::isfinite(*frame.time_s)) finding("a time that is none");
    if (frame.eight_bits)
      for (const double value : frame.values)
        if (!(value >= 0 && value <= 255)) finding("more than eight bits");
  }
  for (const std::string& each : data.noticed) {
    check_message(each);
    if (shown(each) != each) finding("a notice that is not shown as it is");
  }
}

}  // namespace
}  // namespace tubefoot::fuzz

/// A byte for the kind of file, then the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  fuzz::Bytes bytes(data, size);
  const std::uint32_t kind = bytes.below(5);
  constexpr const char* names[] = {"r.mcap", "m.cdr", "m.yaml", "metadata.yaml", "r.mcap.zstd"};
  const auto file = fuzz::scratch_file(names[kind], bytes.rest());
  fuzz::may_refuse([&] {
    try {
      fuzz::check(read_bag(kind == 3 ? file.parent_path() : file));
    } catch (const UsageError& error) {  // a topic must be chosen
      fuzz::check_message(shown(error.what()));
    }
  });
  return 0;
}
