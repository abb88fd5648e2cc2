// Flashes an H8S/2128: boot mode or resident loader, then erase, write, verify, read, run.
// SPDX-License-Identifier: Apache-2.0
//
// The flasher accesses the board only through a Link, and reads the time only from a Clock. So the flasher
// works with a real port in real time, and also with a simulated board in simulated time. Error texts have
// several lines (diagnostic.h). Success is reported only after verification: three independent checksums of
// the flash are compared with the checksums of the image.
#pragma once

#include <cstdint>
#include <functional>
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
  std::string phase;                  // one of "boot", "erase", "write", "verify"
  std::uint32_t done = 0, total = 0;  // number of bytes; in phase "erase", number of blocks
  // Mean rate since the phase began. The rate is 0 in phase "erase", and as long as no rate is measured.
  double bytes_per_s = 0;
};
// Returns a text such as "write 512 of 33088 bytes, 8.1 KB/s". If the rate is 0, the text ends before the
// rate.
std::string progress_text(const FlashProgress& progress);

struct FlasherOptions {
  BootOptions boot;
  int baud = 115200;  // bit rate while the flash writer runs
  // Address to which enter_loader() sends its requests.
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  // If true, accepts an image for another board, or an image that is not a Kaz application.
  bool force = false;
  // Measures the delays of this process in real time; may be null. If `lateness` is not null, the link and
  // the clock of the flasher must both be `*lateness`. A step is repeated if it failed while this process was
  // delayed.
  LatenessMeter* lateness = nullptr;
  std::function<void(const FlashProgress&)> progress;
  std::function<void(const std::string&)> note;  // called with one line for the user
};

// Times that a chip needs to erase and to program its flash. The chip programs 32 bytes at once. The lower
// bound on the duration of flashing is computed from these times.
struct FlashTimes {
  static constexpr double kErasePulse_s = 0.0051, kEraseSetup_s = 0.00024;
  // Time to program one line. This time is the sum of the waits in the programming algorithm, in us:
  //   10 (SWE) + 50 (PSU) + 150 (P) + 10 (alpha) + 10 (beta) + 4 (PV) + 16 * 2 (words) + 4 (PV off)
  //   + 100 (SWE off)
  static constexpr double kProgramLine_s = 0.00037;
};

struct FlashReport {
  std::uint32_t bytes = 0;        // size of the image, bytes
  std::uint32_t written = 0;      // number of bytes written
  int erased = 0, unchanged = 0;  // numbers of blocks
  int repeated = 0;               // number of requests that were repeated
  bool verified = false;
  // Time from the first byte sent to the board until the end of the verification.
  double seconds = 0;
  // Lower bound of `seconds`, computed from the bit rate and the times of the flash cells
  // (docs/howto/flash.md).
  double min_seconds = 0;
  double efficiency() const { return seconds > 0 ? min_seconds / seconds : 0; }
};

// Checks that `image` is a valid Kaz application. Boot mode erases vectors and loader. So if `through_boot`
// is true, the image of a Kaz application must contain vectors and loader. With `force`, the image need not
// be a Kaz application. Errors (usage): the image is damaged, incomplete or not a Kaz application.
Result<void> check_image(const FlashImage& image, bool through_boot, bool force);

class Flasher {
 public:
  // `program` is the flash writer (firmware's writer.bin). Link, clock and program must outlive the flasher.
  Flasher(Link& link, Clock& clock, std::span<const std::uint8_t> program, FlasherOptions options);

  // Runs check_image() and returns its errors. If the id of the connected board is known, compares the board
  // id in the image with the id of the connected board. Fails (failed) if the two ids differ, unless
  // FlasherOptions::force is true.
  Result<void> check(const FlashImage& image, bool through_boot) const;

  // Starts the board's resident loader, with requests at 115,200 baud. If the loader already runs, changes
  // nothing. After success, found() contains the board's id. Returns false if the board does not answer, for
  // example because it is erased.
  Result<bool> enter_loader();
  // Loads the flash writer through boot mode, which erases the whole flash. Retries after line errors. Keeps
  // the board id from an earlier call of enter_loader(), so that board_id() still returns it.
  Result<void> enter_boot(BoardReset& reset);

  const std::optional<WriterInfo>& found() const { return info_; }
  std::optional<std::uint16_t> board_id() const { return board_id_; }

  // Erases the blocks that differ from the image. Then writes and verifies the image's bytes in these blocks,
  // except the application's header. At the end, writes and verifies the header.
  //
  // A write through the loader does not change the blocks of vectors and loader. If the image is a Kaz
  // application, such a write also keeps calibration and address, even if the image contains data for their
  // blocks.
  Result<FlashReport> write(const FlashImage& image);
  // Compares the flash with the image. Errors (failed): the message names the first range or blocks that
  // differ.
  Result<FlashReport> verify(const FlashImage& image);
  Result<void> erase(const std::vector<int>& blocks);
  Result<std::vector<std::uint8_t>> read(FlashRange range);
  // Starts the program in the flash. If `reset` is not null, uses it to reset the board. Otherwise the flash
  // writer jumps to the reset vector.
  Result<void> run(BoardReset* reset);

  // Describes the state of the board after a failure, and the remedy. The text is empty after success, or if
  // the flash was not changed.
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
  // Returns true if `address` is in a block with the calibration or the board's address, and this block stays
  // unchanged when `image` is written. The block stays unchanged if `image` is a Kaz application and is
  // written through the loader.
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
  bool blank_ = false;  // true: boot mode has erased the flash, and the flash is still blank
  State state_ = State::untouched;
  Time started_{};
  double min_seconds_ = 0;
  std::string phase_;
  Time phase_began_{};
};

}  // namespace kaz::host
