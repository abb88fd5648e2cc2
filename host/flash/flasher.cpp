// The sequence: find the board, check, erase, write, verify, the header last.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/flasher.h"

#include <algorithm>
#include <cstdio>

#include "host/flash/diagnostic.h"
#include "host/link/port_address.h"
#include "host/link/requester.h"
#include "host/robot/connect.h"

namespace kaz::host {
namespace {

using std::chrono::milliseconds;

constexpr double kByteAt9600 = 10.0 / 9600, kByteAt115200 = 10.0 / 115200;
constexpr std::uint8_t kBrr115200 = 4;  // 18.432 MHz / (32 * 115200) - 1
constexpr std::uint32_t kRam = 0xffe080;
constexpr int kBootTries = 3;
// Time to erase a block: one pulse and verification of up to 32 KB; up to 230 pulses if it is worn.
constexpr Time kErasePatience = milliseconds(1500);

WriterRequest write_request(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  WriterRequest request{KZ_WRITER_WRITE, {}};
  append(request.payload, address, 4);
  request.payload.insert(request.payload.end(), bytes.begin(), bytes.end());
  return request;
}

// Joins adjacent ranges, up to 8 KB.
std::vector<FlashRange> joined(const std::vector<FlashRange>& ranges) {
  std::vector<FlashRange> result;
  for (const FlashRange& range : ranges) {
    if (!result.empty() && result.back().to == range.from && result.back().size() < 8192)
      result.back().to = range.to;
    else
      result.push_back(range);
  }
  return result;
}

}  // namespace

Flasher::Flasher(Link& link, Clock& clock, std::span<const std::uint8_t> program,
                 FlasherOptions options)
    : link_(link),
      clock_(clock),
      program_(program),
      options_(std::move(options)),
      writer_(link, clock, options_.lateness),
      started_(clock.now()) {}

void Flasher::report_line(const std::string& line) const {
  if (options_.note) options_.note(line);
}

void Flasher::report_progress(const char* phase, std::uint32_t done, std::uint32_t total) {
  if (phase_ != phase) {
    phase_ = phase;
    phase_began_ = clock_.now();
  }
  if (!options_.progress) return;
  const double took = std::chrono::duration<double>(clock_.now() - phase_began_).count();
  const bool measured = took > 0.01 && phase_ != "erase";
  options_.progress({phase, done, total, measured ? done / took : 0});
}

std::string progress_text(const FlashProgress& progress) {
  const std::string unit = progress.phase == "erase" ? "block" : "byte";
  std::string text = progress.phase + " " + std::to_string(progress.done) + " of " +
                     std::to_string(progress.total) + " " + unit + (progress.total == 1 ? "" : "s");
  if (progress.bytes_per_s <= 0) return text;
  char rate[32];
  std::snprintf(rate, sizeof rate, ", %.1f KB/s", progress.bytes_per_s / 1000);
  return text + rate;
}

namespace {

Result<void> check_loader(const FlashImage& image, bool through_boot) {
  if (!image.has_loader()) {
    if (!through_boot) return {};
    return fail(
        Fault::usage,
        Diagnostic{"the image has no vectors and no loader, but boot mode erases the whole flash",
                   "application, vectors (0x000000) and loader (0x00c000)",
                   "only the application",
                   {"the image was made for an update through the resident loader, which does not "
                    "write vectors and loader"},
                   "give the firmware's kaz.mot, or leave out --reset"});
  }
  const std::string damage = image.loader_damage();
  if (damage.empty()) return {};
  return fail(Fault::usage,
              Diagnostic{"the image's vectors or loader are damaged",
                         "vectors (EB0) and loader (EB6) with the CRC in the loader's mark",
                         damage,
                         {"the file was cut off before the end of the loader's block (0x00c000 to "
                          "0x00dfff)",
                          "the image is older than this program"},
                         "build the image again; --force does not write a damaged image"});
}

// Of a program that is none of Kaz: whether anything of it can be written.
Result<void> check_foreign(const FlashImage& image, bool through_boot) {
  std::string kept_blocks;
  for (int block = 0; block < kFlashBlocks; ++block) {
    if (!image.touches(block)) continue;
    if (through_boot || (block != kVectorBlock && block != kLoaderBlock)) return {};
    kept_blocks += (kept_blocks.empty() ? "EB" : ", EB") + std::to_string(block);
  }
  return fail(
      Fault::usage,
      Diagnostic{
          "the resident loader cannot write any part of the image",
          "bytes outside EB0 (vectors) and EB6 (loader); the loader protects these blocks",
          kept_blocks.empty() ? "no bytes" : "only bytes in " + kept_blocks,
          {"the image contains no application, but only vectors or loader",
           "the image was built for another address"},
          "give an image with an application, or write this image through boot mode (--reset HOW), "
          "which erases the whole flash"});
}

}  // namespace

Result<void> check_image(const FlashImage& image, bool through_boot, bool force) {
  const auto identity = image.identity();
  if (!identity) {
    if (force) return check_foreign(image, through_boot);
    return fail(
        Fault::usage,
        Diagnostic{"the image is not an application for a Kaz board",
                   "the id \"KAZA\" at " + hex_address(KZ_APPLICATION_HEADER),
                   hex_of({image.bytes({KZ_APPLICATION_HEADER, KZ_APPLICATION_HEADER + 4}).begin(),
                           image.bytes({KZ_APPLICATION_HEADER, KZ_APPLICATION_HEADER + 4}).end()}),
                   {"it is not Kaz firmware", "it was built for another address"},
                   "give the firmware's kaz.mot, or add --force to write a foreign program"});
  }
  if (const std::string damage = image.damage(); !damage.empty()) {
    return fail(Fault::usage,
                Diagnostic{"the image is damaged",
                           "an application that matches its header",
                           damage,
                           {"the file was cut off or changed",
                            "it was linked but not stamped (tools/repo/gen/stamp_image.py)"},
                           "build the image again; --force does not write a damaged image"});
  }
  return check_loader(image, through_boot);
}

Result<void> Flasher::check(const FlashImage& image, bool through_boot) const {
  KAZ_TRY(check_image(image, through_boot, options_.force));
  const auto identity = image.identity();
  if (identity && board_id_ && *board_id_ != identity->board_id && !options_.force) {
    return fail(Fault::failed,
                Diagnostic{"the image is for another board; nothing was changed",
                           "board id " + hex_word(identity->board_id) + " (image)",
                           hex_word(*board_id_) + " (board on " + link_.name() + ")",
                           {"--robot names another board", "IMAGE was built for another board"},
                           "check --robot and IMAGE; --force overrides this check"});
  }
  return {};
}

Result<bool> Flasher::enter_loader() {
  KAZ_TRY(link_.set_baud(115200));
  writer_.rate_is(115200);
  const auto listening = [&](Time patience, int tries) -> Result<bool> {
    const auto info = writer_.info(patience, tries);
    if (!info) return false;
    info_ = *info;
    if (info->board_id) board_id_ = info->board_id;
    return true;
  };
  // The writer may be running already: started by a loader without an application, or by an earlier try.
  if (auto there = listening(milliseconds(60), 2); !there || *there) return there;
  Requester requester(link_, clock_, {.address = options_.address});
  requester.limit_tries(3);
  const auto board = repeat_if_late(options_.lateness, [&] { return identify_board(requester); });
  if (!board) {
    // The port itself may be gone.
    std::uint8_t byte = 0;
    KAZ_TRY(link_.read(std::span(&byte, 1), clock_.now()));
    return false;
  }
  Request leave{KZ_TYPE_loader, {}};
  const kz_loader key{KZ_KEY};
  leave.fields.length = kz_pack_loader(&key, leave.fields.bytes.data());
  const auto reply = requester.exchange(std::span(&leave, 1));
  if (reply && reply->front().refused) {
    return fail(Fault::failed,
                Diagnostic{"the board does not enter its loader",
                           "the board stops its application",
                           "a refusal",
                           {"its motors are on"},
                           "switch the motors off (`kaz status " + robot_option(link_.name()) +
                               "` shows their state), then try again"});
  }
  // The reply may be lost although the board resets. The watchdog takes 7 ms, the loader 1 ms.
  for (int k = 0; k < 10; ++k) {
    if (auto there = listening(milliseconds(60), 1); !there || *there) return there;
  }
  std::uint8_t byte = 0;
  KAZ_TRY(link_.read(std::span(&byte, 1), clock_.now()));  // interrupted, or the port is gone
  return fail(
      Fault::environment,
      Diagnostic{"the resident loader does not answer",
                 "the flash writer's reply",
                 "nothing",
                 {"the board's loader is older than this program", "the line is noisy"},
                 "give the same command again; otherwise use boot mode, which erases the whole "
                 "flash: kaz flash write IMAGE " +
                     robot_option(link_.name()) + " --reset dtr-rts (or ctl:PATH, or manual)"});
}

Result<void> Flasher::load_writer_rest() {
  const auto boot_size = static_cast<std::uint32_t>(program_[2] << 8 | program_[3]);
  std::uint32_t at = boot_size;
  return writer_.exchange_all(
      [&]() -> std::optional<WriterRequest> {
        if (at >= program_.size()) return std::nullopt;
        const auto size = std::min<std::size_t>(KZ_WRITER_DATA_MAX, program_.size() - at);
        auto request = write_request(kRam + at, program_.subspan(at, size));
        at += static_cast<std::uint32_t>(size);
        return request;
      },
      milliseconds(300),
      [](const WriterRequest&, const WriterReply& reply) -> Result<void> {
        if (reply.status == KZ_WRITER_OK) return {};
        return kaz::fail(Fault::failed, "the flash writer was not loaded completely: " +
                                            status_text(reply.status) +
                                            "; use the writer.bin of this program");
      });
}

Result<void> Flasher::enter_boot(BoardReset& reset) {
  if (program_.size() < 64 || program_.size() % kFlashLine != 0)
    return kaz::fail(Fault::usage, "the flash writer's file is not a writer.bin of this program");
  const auto boot_size = static_cast<std::size_t>(program_[2] << 8 | program_[3]);
  if (boot_size > program_.size() || boot_size > 2048)
    return kaz::fail(Fault::usage, "the flash writer's file is not a writer.bin of this program");
  Result<void> entered;
  int excuses = options_.lateness ? LatenessMeter::kRepetitions : 0;
  for (int k = 0, tries = kBootTries; k < tries; ++k) {
    if (k > 0) report_line("retrying boot mode: " + entered.error().message);
    report_progress("boot", 0, static_cast<std::uint32_t>(program_.size()));
    if (entered = reset.reset(true); !entered) return entered;
    state_ = State::boot_mode;
    if (k == 0) started_ = clock_.now();
    if (options_.lateness) options_.lateness->begin();
    entered = load_through_boot(link_, clock_, program_.first(boot_size), options_.boot);
    writer_.rate_is(options_.boot.baud);
    if (entered) entered = writer_.set_rate(options_.baud, kBrr115200);
    if (entered) entered = load_writer_rest();
    if (entered) {
      const auto info = writer_.info();
      if (info) info_ = *info;
      if (!info) entered = tl::unexpected(info.error());
    }
    if (entered) break;
    if (excuses > 0 && !options_.lateness->excuse().empty() &&
        !options_.lateness->other_end_gone()) {
      --excuses;
      ++tries;
    }
    std::uint8_t byte = 0;
    KAZ_TRY(link_.read(std::span(&byte, 1), clock_.now()));
  }
  if (!entered) return entered;
  blank_ = true;
  min_seconds_ = static_cast<double>(boot_size) * kByteAt9600;
  report_progress("boot", static_cast<std::uint32_t>(program_.size()),
                  static_cast<std::uint32_t>(program_.size()));
  return {};
}

bool Flasher::kept(std::uint32_t address) const {
  const auto in = [&](int block) {
    return address >= kBlockStart[block] && address < kBlockStart[block + 1];
  };
  return info_ && info_->by_loader && (in(kVectorBlock) || in(kLoaderBlock));
}

bool Flasher::is_setting(std::uint32_t address, const FlashImage& image) const {
  if (!info_ || !info_->by_loader || !image.identity()) return false;
  return std::ranges::any_of(kSettingsBlocks, [&](int block) {
    return address >= kBlockStart[block] && address < kBlockStart[block + 1];
  });
}

Result<bool> Flasher::same(FlashRange range, const FlashImage& image) {
  WriterSums wanted;
  for (const std::uint8_t byte : image.bytes(range)) wanted.add(byte);
  const auto is = KAZ_TRY(writer_.sums(range.from, range.size()));
  return is == wanted;
}

Result<void> Flasher::erase_block(int block) {
  if (state_ == State::untouched) state_ = State::loader_erased;
  const auto reply =
      writer_.exchange({KZ_WRITER_ERASE, {static_cast<std::uint8_t>(block)}}, kErasePatience);
  if (!reply) return tl::unexpected(reply.error());
  if (reply->status == KZ_WRITER_OK) return {};
  return fail(Fault::failed,
              Diagnostic{"block EB" + std::to_string(block) + " cannot be erased",
                         "every cell erased",
                         status_text(reply->status),
                         {"the block is worn out: the chip is rated for 100 erasures",
                          "the supply voltage is too low during erasing"},
                         "measure the supply voltage and try again; otherwise replace the chip"});
}

Result<void> Flasher::write_ranges(const std::vector<FlashRange>& ranges, const FlashImage& image,
                                   std::uint32_t& done, std::uint32_t total) {
  std::size_t next = 0;
  return writer_.exchange_all(
      [&]() -> std::optional<WriterRequest> {
        if (next == ranges.size()) return std::nullopt;
        const FlashRange range = ranges[next++];
        return write_request(range.from, image.bytes(range));
      },
      milliseconds(400),
      [&](const WriterRequest& request, const WriterReply& reply) -> Result<void> {
        if (reply.status == KZ_WRITER_OK) {
          const auto size = static_cast<std::uint32_t>(request.payload.size()) - 4;
          done += size;
          min_seconds_ +=
              size / kFlashLine * std::max(kFlashLine * kByteAt115200, FlashTimes::kProgramLine_s);
          report_progress("write", done, total);
          return {};
        }
        std::uint32_t at = 0;
        for (std::size_t k = 0; k < 4; ++k) at = at << 8 | request.payload[k];
        if (reply.data.size() >= 2)
          at = (at & 0xffff0000u) | static_cast<std::uint32_t>(reply.data[0] << 8 | reply.data[1]);
        return fail(Fault::failed,
                    Diagnostic{"the flash line at " + hex_address(at) + " cannot be written",
                               "the image's bytes in the flash",
                               status_text(reply.status),
                               {"the block is worn out: the chip is rated for 100 erasures",
                                "the supply voltage is too low", "the flash was not erased"},
                               "give the same command again; it erases the block first"});
      });
}

Result<void> Flasher::compare(const std::vector<FlashRange>& ranges, const FlashImage& image) {
  std::uint32_t done = 0, total = 0;
  for (const FlashRange& range : ranges) total += range.size();
  for (const FlashRange& range : ranges) {
    const auto equal = KAZ_TRY(same(range, image));
    if (!equal) {
      return fail(Fault::failed,
                  Diagnostic{"the flash differs from the image",
                             "the image's bytes from " + hex_address(range.from) + " to " +
                                 hex_address(range.to - 1),
                             "a different checksum",
                             {"another image was flashed",
                              "flash cells lose their charge: the chip is worn out"},
                             "kaz flash write IMAGE " + robot_option(link_.name()) + " …"});
    }
    report_progress("verify", done += range.size(), total);
  }
  return {};
}

Result<FlashReport> Flasher::write(const FlashImage& image) {
  KAZ_TRY(check(image, info_ && !info_->by_loader));
  FlashReport report;
  report.bytes = image.size();
  const bool application = image.identity().has_value();
  // Everything except the areas that the loader keeps, and the header.
  std::vector<FlashRange> all;
  bool header = false;
  std::vector<bool> wanted(kFlashBlocks, false);
  int skipped = 0;
  for (int block = 0; block < kFlashBlocks; ++block) {
    if (!image.touches(block)) continue;
    if (is_setting(kBlockStart[block], image)) {
      report_line("EB" + std::to_string(block) + " keeps the board's " +
                  (block == 3 ? "address" : "calibration") +
                  ": the image's bytes there are not written");
      continue;
    }
    if (kept(kBlockStart[block])) {
      const auto equal = KAZ_TRY(same(block_range(block), image));
      if (!equal)
        report_line("EB" + std::to_string(block) +
                    " is unchanged: the loader protects it; use boot mode to change it");
      ++skipped;
      continue;
    }
    if (!blank_) {
      const auto equal = KAZ_TRY(same(block_range(block), image));
      if (equal) {
        ++skipped;
        continue;
      }
    }
    wanted[static_cast<std::size_t>(block)] = true;
  }
  report.unchanged = skipped;
  if (!blank_) {
    const auto blocks = static_cast<std::uint32_t>(std::ranges::count(wanted, true));
    // EB4, with the header, first: the application is then invalid, whenever the update is interrupted.
    for (const int block : {4, 0, 1, 2, 3, 5, 6, 7, 8, 9}) {
      if (!wanted[static_cast<std::size_t>(block)]) continue;
      report_progress("erase", static_cast<std::uint32_t>(report.erased), blocks);
      KAZ_TRY(erase_block(block));
      min_seconds_ += FlashTimes::kErasePulse_s + FlashTimes::kEraseSetup_s;
      ++report.erased;
      report_progress("erase", static_cast<std::uint32_t>(report.erased), blocks);
    }
  }
  blank_ = false;
  const FlashRange header_line{KZ_APPLICATION_HEADER, KZ_APPLICATION_HEADER + kFlashLine};
  std::uint32_t total = 0;
  for (const FlashRange& range : image.ranges(KZ_WRITER_DATA_MAX)) {
    int block = 0;
    while (range.from >= kBlockStart[block + 1]) ++block;
    // A range may extend into the next block, which is decided separately.
    for (std::uint32_t at = range.from; at < range.to;) {
      const std::uint32_t bound = std::min(range.to, kBlockStart[block + 1]);
      std::vector<FlashRange> pieces{{at, bound}};
      if (application && at <= header_line.from && header_line.from < bound)
        pieces = {{at, header_line.from}, {header_line.to, bound}};
      for (const FlashRange& piece : pieces) {
        if (piece.from >= piece.to || !wanted[static_cast<std::size_t>(block)]) continue;
        all.push_back(piece);
        total += piece.size();
      }
      if (pieces.size() == 2 && wanted[static_cast<std::size_t>(block)]) header = true;
      at = bound;
      ++block;
    }
  }
  std::uint32_t done = 0, header_done = 0;
  KAZ_TRY(write_ranges(all, image, done, total));
  KAZ_TRY(compare(joined(all), image));
  if (header) {
    if (auto written = write_ranges({header_line}, image, header_done, kFlashLine); !written)
      return tl::unexpected(written.error());
    if (auto right = compare({header_line}, image); !right) return tl::unexpected(right.error());
  }
  state_ = State::untouched;
  report.written = done + header_done;
  report.verified = true;
  report.repeated = writer_.repeated();
  report.seconds = std::chrono::duration<double>(clock_.now() - started_).count();
  report.min_seconds = min_seconds_;
  return report;
}

Result<FlashReport> Flasher::verify(const FlashImage& image) {
  FlashReport report;
  report.bytes = image.size();
  std::vector<FlashRange> written, loaders, settings;
  for (const FlashRange& range : image.all_ranges()) {
    int block = 0;
    for (std::uint32_t at = range.from; at < range.to;) {
      while (at >= kBlockStart[block + 1]) ++block;
      const std::uint32_t end = std::min({range.to, kBlockStart[block + 1], at + 4096});
      auto& to = kept(at) ? loaders : is_setting(at, image) ? settings : written;
      to.push_back({at, end});
      at = end;
    }
  }
  KAZ_TRY(compare(written, image));
  if (auto same = compare(settings, image); !same) {
    if (same.error().fault != Fault::failed) return tl::unexpected(same.error());
    return kaz::fail(
        Fault::failed,
        "the application matches the image, but calibration or address (EB1 to EB3) differ: an "
        "update through the resident loader keeps the board's calibration and address");
  }
  // An update through the loader keeps them, so a difference is no damage.
  if (auto same = compare(loaders, image); !same) {
    if (same.error().fault != Fault::failed) return tl::unexpected(same.error());
    return kaz::fail(Fault::failed,
                     "the application matches the image, but vectors or loader (EB0, EB6) differ: "
                     "an update through the resident loader does not write them. To replace them, "
                     "write the image through boot mode (--reset)");
  }
  report.verified = true;
  report.seconds = std::chrono::duration<double>(clock_.now() - started_).count();
  return report;
}

Result<void> Flasher::erase(const std::vector<int>& blocks) {
  const auto total = static_cast<std::uint32_t>(
      std::ranges::count_if(blocks, [this](int block) { return !kept(kBlockStart[block]); }));
  std::uint32_t done = 0;
  for (const int block : blocks) {
    if (kept(kBlockStart[block])) {
      report_line("EB" + std::to_string(block) + " is unchanged: the loader protects it");
      continue;
    }
    report_progress("erase", done, total);
    if (auto erased = erase_block(block); !erased) return erased;
    report_progress("erase", ++done, total);
  }
  return {};
}

Result<std::vector<std::uint8_t>> Flasher::read(FlashRange range) {
  std::vector<std::uint8_t> bytes;
  std::uint32_t at = range.from;
  const auto next = [&]() -> std::optional<WriterRequest> {
    if (at >= range.to) return std::nullopt;
    const std::uint32_t size = std::min<std::uint32_t>(KZ_WRITER_DATA_MAX, range.to - at);
    WriterRequest request{KZ_WRITER_READ, {}};
    append(request.payload, at, 4);
    append(request.payload, size, 2);
    at += size;
    return request;
  };
  const auto taken = writer_.exchange_all(
      next, milliseconds(400),
      [&](const WriterRequest& request, const WriterReply& reply) -> Result<void> {
        const auto size = static_cast<std::size_t>(request.payload[4] << 8 | request.payload[5]);
        if (reply.status != KZ_WRITER_OK || reply.data.size() != size)
          return kaz::fail(Fault::failed,
                           "the board cannot read its flash: " + status_text(reply.status));
        bytes.insert(bytes.end(), reply.data.begin(), reply.data.end());
        report_progress("read", static_cast<std::uint32_t>(bytes.size()), range.size());
        return {};
      });
  if (!taken) return tl::unexpected(taken.error());
  return bytes;
}

std::string Flasher::left_behind() const {
  switch (state_) {
    case State::boot_mode:
      return "the board is still in boot mode, and its firmware is incomplete. Boot mode has also "
             "erased calibration and address. Give the same command again: boot mode can always be "
             "entered";
    case State::loader_erased:
      return "the flash is only partly written, so the board's loader does not start the "
             "application. Give the same command again: the loader waits for it";
    default:
      return "";
  }
}

Result<void> Flasher::run(BoardReset* reset) {
  info_.reset();
  if (reset != nullptr) {
    if (auto done = reset->reset(false); !done) return done;
    return link_.set_baud(115200);
  }
  const auto reply = writer_.exchange({KZ_WRITER_RUN, {}}, milliseconds(150), 3);
  if (!reply) return tl::unexpected(reply.error());
  if (reply->status != KZ_WRITER_OK)
    return kaz::fail(Fault::failed,
                     "the board has no program to run: " + status_text(reply->status));
  return {};
}

}  // namespace kaz::host
