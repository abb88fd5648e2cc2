// Flashes an H8S/2128: boot mode or resident loader, then erase, write, verify, read, run.
// SPDX-License-Identifier: Apache-2.0
//
// Uses Link and Clock, so that it runs against a port and in simulated time. All errors have a text of
// several lines (diagnostic.h). Success is reported only after verification: three independent checksums of
// the flash are compared with those of the image.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/flash/board_reset.h"
#include "host/flash/boot_mode.h"
#include "host/flash/flash_image.h"
#include "host/flash/writer_link.h"
#include "host/link/link.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

struct FlashProgress {
  std::string phase;                  // "boot", "erase", "write", "verify"
  std::uint32_t done = 0, total = 0;  // bytes; blocks while erasing
  double bytes_per_s = 0;  // since the phase began; 0: not measured, or none while erasing
};
// "write 512 of 33088 bytes, 8.1 KB/s"; the rate only where it was measured
std::string progress_text(const FlashProgress& progress);

struct FlasherOptions {
  BootOptions boot;
  int baud = 115200;                          // of the writer
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // of the board whose firmware is to start its loader
  bool force = false;  // the image may be for another board, or no Kaz application
  // Link and clock of the flasher where they are real: what fails while this machine is late is
  // repeated. May be null.
  LatenessMeter* lateness = nullptr;
  std::function<void(const FlashProgress&)> progress;
  std::function<void(const std::string&)> note;  // one line for the user
};

// Times of the part (32-byte generation), for the minimum duration of flashing.
struct FlashTimes {
  static constexpr double erase_pulse_s = 0.0051, erase_setup_s = 0.00024;
  // SWE 10, PSU 50, P 150, alpha 10, beta 10, PV 4, 16 words of 2, 4 and SWE off 100 us.
  static constexpr double program_line_s = 0.00037;
};

struct FlashReport {
  std::uint32_t bytes = 0;        // of the image
  std::uint32_t written = 0;      // bytes
  int erased = 0, unchanged = 0;  // blocks
  int repeated = 0;               // requests
  bool verified = false;
  double seconds = 0;      // from the first byte to the board until everything is verified
  double min_seconds = 0;  // lower bound by wire and flash cells: docs/howto/flash.md
  double efficiency() const { return seconds > 0 ? min_seconds / seconds : 0; }
};

// Checks that `image` is valid. Through boot mode it needs vectors and loader too, which are erased there.
// `force`: it may be no Kaz application. Error (usage): it is damaged, not enough or foreign.
Result<void> check_image(const FlashImage& image, bool through_boot, bool force);

class Flasher {
 public:
  // `program` is the flash writer (firmware's writer.bin). All must outlive it.
  Flasher(Link& link, Clock& clock, std::span<const std::uint8_t> program, FlasherOptions options);

  // check_image(), and that it is for the board that was found. Error (failed): it is for another.
  Result<void> check(const FlashImage& image, bool through_boot) const;

  // Starts the loader of a board whose firmware or loader answers at 115,200 baud; `found` then contains
  // its id. False: no answer, as from an erased board.
  Result<bool> enter_loader();
  // Through boot mode: erases the whole flash. Retries after line errors. A board id known from
  // enter_loader() is kept.
  Result<void> enter_boot(BoardReset& reset);

  const std::optional<WriterInfo>& found() const { return info_; }
  std::optional<std::uint16_t> board_id() const { return board_id_; }

  // Erases the blocks that differ, writes everything except the application's header, verifies it, then
  // writes and verifies the header. Through the loader the blocks of vectors and loader are unchanged, and of
  // a Kaz application, such as a copy of a board's flash, those of calibration and address, too.
  Result<FlashReport> write(const FlashImage& image);
  // Errors (failed): which block differs.
  Result<FlashReport> verify(const FlashImage& image);
  Result<void> erase(const std::vector<int>& blocks);
  Result<std::vector<std::uint8_t>> read(FlashRange range);
  // Leaves the writer through the reset vector, or by a reset.
  Result<void> run(BoardReset* reset);

  // State of the board after a failure, and the remedy; empty while nothing was changed.
  std::string left_behind() const;

 private:
  enum class State { untouched, boot_mode, loader_erased };

  Result<void> load_writer_rest();
  Result<void> write_ranges(const std::vector<FlashRange>& ranges, const FlashImage& image,
                            std::uint32_t& done, std::uint32_t total);
  Result<bool> same(FlashRange range, const FlashImage& image);
  Result<void> erase_block(int block);
  Result<void> compare(const std::vector<FlashRange>& ranges, const FlashImage& image);
  bool kept(std::uint32_t address) const;
  // Calibration or address, which no image of a Kaz application changes through the loader.
  bool is_setting(std::uint32_t address, const FlashImage& image) const;
  void report_line(const std::string& line) const;
  void report_progress(const char* phase, std::uint32_t done, std::uint32_t total);

  Link& link_;
  Clock& clock_;
  std::span<const std::uint8_t> program_;
  FlasherOptions options_;
  WriterLink writer_;
  std::optional<WriterInfo> info_;
  std::optional<std::uint16_t> board_id_;
  bool blank_ = false;  // boot mode has just erased everything
  State state_ = State::untouched;
  Time started_{};
  double min_seconds_ = 0;
  std::string phase_;
  Time phase_began_{};
};

}  // namespace kaz::host
