// Opens and closes what is attached to the chip.
// SPDX-License-Identifier: Apache-2.0
#include "tools/mcu/attached.h"

#include <cmath>
#include <cstdio>

namespace kaz::tools {

Result<void> Attached::open(h8s::Chip& chip, const std::string& netlist, const std::string& vcd,
                            const std::vector<std::string>& signals, double crystal_hz) {
  const auto hertz = static_cast<std::int64_t>(std::llround(crystal_hz));
  if (!netlist.empty()) {
    h8s::Netlist::Settings settings;
    settings.hertz = hertz;
    netlist_ = std::make_unique<h8s::Netlist>(chip, settings);
    if (const auto read = h8s::load_netlist(*netlist_, netlist); !read)
      return fail(Fault::usage, read.error().message);
  }
  if (!vcd.empty()) {
    vcd_ = KAZ_TRY(OutputFile::open(vcd, "--vcd"));
    vcd_stream_.open(vcd_->part(), std::ios::binary | std::ios::trunc);
    auto recorder = h8s::VcdRecorder::open(chip, signals, vcd_stream_, hertz);
    if (!recorder) return fail(Fault::usage, "--vcd: " + recorder.error().message);
    recorder_ = std::move(*recorder);
  }
  return {};
}

Result<void> Attached::close() {
  if (netlist_) {
    for (const h8s::Conflict& conflict : netlist_->conflicts())
      std::fprintf(stderr, "%s\n", conflict.text().c_str());
  }
  if (!recorder_) return {};
  const auto closed = recorder_->close();
  vcd_stream_.close();
  if (!closed || !vcd_stream_) return tl::unexpected(vcd_->failure());
  return vcd_->commit();
}

}  // namespace kaz::tools
