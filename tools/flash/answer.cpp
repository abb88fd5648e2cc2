// Lines and JSON of `kaz flash`.
// SPDX-License-Identifier: Apache-2.0
#include "tools/flash/answer.h"

#include <cstdio>

#include "host/flash/diagnostic.h"
#include "host/robot/connect.h"
#include "shared/base/counted.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

nlohmann::ordered_json json_of(const host::ImageIdentity& identity) {
  return {{"board_id", host::hex_word(identity.board_id)},
          {"firmware", host::firmware_version_text(identity.version)},
          {"build", host::build_text(identity.build_id)},
          {"length", identity.length},
          {"crc", host::hex_word(identity.crc)}};
}

std::string line_of(const host::ImageIdentity& identity) {
  return "board id " + host::hex_word(identity.board_id) + ", version " +
         host::firmware_version_text(identity.version) + ", build " +
         host::build_text(identity.build_id) + ", " + std::to_string(identity.length) +
         " bytes, CRC " + host::hex_word(identity.crc);
}

}  // namespace

void Answer::say(const std::string& line) const {
  if (!json_) print_lines("%s\n", line.c_str());
}

void Answer::image(const host::FlashImage& image) {
  std::string blocks;
  std::vector<int> numbers;
  for (int block = 0; block < host::kFlashBlocks; ++block) {
    if (!image.touches(block)) continue;
    blocks += " EB" + std::to_string(block);
    numbers.push_back(block);
  }
  put("bytes", image.size());
  put("blocks", numbers);
  std::string line = std::to_string(image.size()) + " bytes in" + blocks;
  if (const auto identity = image.identity()) {
    put("application", json_of(*identity));
    line += "; Kaz application, " + line_of(*identity);
  }
  say(line);
}

void Answer::written(const host::FlashReport& report, bool by_boot_mode) {
  has_written_ = true;
  if (by_boot_mode) put("erased", "all");
  put("bytes", report.bytes);
  put("written", report.written);
  put("blocks_erased", report.erased);
  put("blocks_unchanged", report.unchanged);
  put("repeated", report.repeated);
  put("verified", report.verified);
  put("seconds", report.seconds);
  put("min_seconds", report.min_seconds);
  if (report.written > 0) put("efficiency", report.efficiency());
  if (report.written == 0 && report.erased == 0)
    return say("no write needed: the flash already contains these " + std::to_string(report.bytes) +
               " bytes, " + counted(report.unchanged, "block") + " compared");
  say("written and verified: " + std::to_string(report.written) + " bytes, " +
      (by_boot_mode ? "the whole flash erased"
                    : counted(report.erased, "block") + " erased, " +
                          std::to_string(report.unchanged) + " unchanged") +
      ", " + counted(report.repeated, "request") + " repeated");
  if (by_boot_mode)
    say("boot mode has erased the stored calibration and the board's address: the address is now "
        "1, and `kaz calibrate joints` makes a new calibration");
  char times[96];
  std::snprintf(times, sizeof times,
                "%.2f s; line and flash cells need at least %.2f s: efficiency %.1f %%",
                report.seconds, report.min_seconds, 100 * report.efficiency());
  say(times);
}

void Answer::application(const std::optional<host::ImageIdentity>& identity) {
  put("application", identity ? json_of(*identity) : nlohmann::ordered_json());
  say("application: " + (identity ? line_of(*identity) : "none"));
}

void Answer::runs(const kz_identify_reply& board) {
  put("runs",
      nlohmann::ordered_json{{"firmware", host::firmware_version_text(board.firmware_version)},
                             {"build", host::build_text(board.build_id)},
                             {"crc", host::hex_word(board.image_crc)}});
  say("runs: firmware " + host::firmware_version_text(board.firmware_version) + ", build " +
      host::build_text(board.build_id) + ", CRC " + host::hex_word(board.image_crc));
}

void Answer::finish(const std::string& verb, const Result<void>& done) {
  if (!json_) return;
  nlohmann::ordered_json all{{"ok", done.has_value()}, {"verb", verb}};
  if (!done) {
    all["error"] = full_text(done.error());
    all["exit_code"] = exit_status(done.error());
    if (done.error().fault == Fault::interrupted) mark_interrupted(all);
  }
  all.update(object_);
  all["provenance"] = provenance_json();
  print_json(all);
}

}  // namespace kaz::tools
