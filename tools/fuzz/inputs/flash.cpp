// What kaz flash reads: images, and a hostile board in boot mode or in its flash writer.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <vector>

#include "hil/fuzz/choices.h"
#include "host/flash/boot_mode.h"
#include "host/flash/flash_image.h"
#include "host/flash/flasher.h"
#include "shared/protocol/crc16.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

using hil::fuzz::Choices;

// Simulated time and a board whose every answer the input chooses: raw bytes, echoes, and frames with
// right check sums. Behind the input's end it is silent.
class HostileBoard final : public host::Link, public host::Clock {
 public:
  explicit HostileBoard(Choices& choices) : choices_(choices) {}

  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    now_ = std::max(now_, t);
    return {};
  }
  std::string name() const override { return "case"; }
  Result<void> set_baud(int) override { return {}; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    if (++writes_ > kMostWrites)
      return fail(Fault::environment, "case: the port is gone, perhaps unplugged");
    if (choices_.ended()) return {};
    switch (choices_.below(7)) {
      case 0:
      case 1:
        answer_frame(bytes);
        break;
      case 2:  // an echo, as boot mode has it
        to_host_.insert(to_host_.end(), bytes.begin(), bytes.end());
        break;
      case 3:
        for (unsigned k = choices_.below(16); k > 0; --k) to_host_.push_back(choices_.byte());
        break;
      case 4:
        to_host_.push_back(0x00);
        break;
      case 5:  // the last echo of boot mode, and that the flash is erased
        to_host_.insert(to_host_.end(), bytes.begin(), bytes.end());
        to_host_.push_back(0xaa);
        break;
      default:
        break;
    }
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    if (to_host_.empty()) {
      now_ = std::max(now_ + std::chrono::microseconds(10), deadline);
      return 0;
    }
    now_ += std::chrono::microseconds(87);
    const std::size_t count = std::min(bytes.size(), to_host_.size());
    std::copy_n(to_host_.begin(), count, bytes.begin());
    to_host_.erase(to_host_.begin(), to_host_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }

 private:
  static constexpr int kMostWrites = 20'000;

  void answer_frame(std::span<const std::uint8_t> request) {
    if (request.size() < KZ_WRITER_OVERHEAD) return;
    std::vector<std::uint8_t> frame{KZ_WRITER_SYNC,
                                    static_cast<std::uint8_t>(request[1] | KZ_WRITER_REPLY)};
    const unsigned length = 2 + choices_.below(16);
    frame.push_back(0);
    frame.push_back(static_cast<std::uint8_t>(length));
    frame.push_back(request[4]);
    unsigned sum = 0;
    for (std::size_t k = 1; k < 5; ++k) sum += frame[k];
    frame.push_back(static_cast<std::uint8_t>(~sum));
    frame.push_back(choices_.below(4) == 3 ? choices_.byte() : KZ_WRITER_OK);
    for (unsigned k = 1; k < length; ++k) frame.push_back(choices_.byte());
    std::uint16_t crc = 0xffff;
    for (std::size_t k = 1; k < frame.size(); ++k) crc = kz_crc16_step(crc, frame[k]);
    frame.push_back(static_cast<std::uint8_t>(crc >> 8));
    frame.push_back(static_cast<std::uint8_t>(crc));
    to_host_.insert(to_host_.end(), frame.begin(), frame.end());
  }

  Choices& choices_;
  Time now_{};
  int writes_ = 0;
  std::deque<std::uint8_t> to_host_;
};

class NoReset final : public host::BoardReset {
 public:
  Result<void> reset(bool) override { return {}; }
  std::string name() const override { return "case"; }
};

template <class T>
Complaint judge_failure(const Result<T>& result) {
  if (result || !result.error().message.empty()) return std::nullopt;
  return "an error without a message";
}

}  // namespace

Complaint try_flash_image(Bytes bytes) {
  const std::string path = input_file(bytes, "image");
  const auto image = host::FlashImage::load(path);
  if (!image) return judge_error(image.error(), path);
  std::uint32_t sum = 0;
  for (const host::FlashRange& range : image->ranges(512)) {
    if (range.to <= range.from || range.to > host::kFlashBytes || range.size() > 512)
      return "an invalid range";
    sum += static_cast<std::uint32_t>(image->bytes(range).size());
  }
  if (sum != image->size()) return "the ranges do not add up to the image";
  (void)image->identity();
  (void)image->damage();
  (void)image->loader_damage();
  return std::nullopt;
}

Complaint try_flash_replies(Bytes bytes) {
  Choices choices(bytes);
  HostileBoard board(choices);
  // As writer.bin: 64 bytes of it go through boot mode.
  std::vector<std::uint8_t> program(640, 0x5a);
  program[2] = 0;
  program[3] = 64;
  host::FlasherOptions options;
  options.force = choices.below(2) == 0;
  options.boot.tries = 5;
  host::Flasher flasher(board, board, program, options);
  NoReset reset;
  host::FlashImage image;
  image.put(0x1000, std::vector<std::uint8_t>(64, 0x12));
  image.put(0x10000, std::vector<std::uint8_t>(1000, 0x34));
  const bool through_boot = choices.below(2) == 0;
  if (through_boot) {
    const auto entered = flasher.enter_boot(reset);
    if (!entered) return judge_failure(entered);
  } else {
    const auto entered = flasher.enter_loader();
    if (!entered) return judge_failure(entered);
  }
  if (auto wrong = judge_failure(flasher.check(image, through_boot))) return wrong;
  const auto written = flasher.write(image);
  if (auto wrong = judge_failure(written)) return wrong;
  if (written && !written->verified) return "a write succeeded without verification";
  if (auto wrong = judge_failure(flasher.read({0x1000, 0x1400}))) return wrong;
  if (auto wrong = judge_failure(flasher.erase({1, 2}))) return wrong;
  if (auto wrong = judge_failure(flasher.run(&reset))) return wrong;
  (void)flasher.left_behind();
  return std::nullopt;
}

}  // namespace kaz::fuzz
