// From bytes to what a hostile host of the flash writer does.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/flash_writer/flash_writer.h"

#include <algorithm>
#include <cstdio>
#include <span>

#include "shared/base/hex_text.hpp"
#include "shared/flash/protocol.h"
#include "tools/fuzz/flash_writer/writer_judge.h"

namespace kaz::fuzz {
namespace {

constexpr auto kMs = WriterBoard::kMillisecond;
constexpr int kMaxEvents = 24;
constexpr h8s::States kLongest = 500 * kMs;  // of a case, without its end
constexpr std::uint32_t kFlash = 0x20000, kLine = 32;

// libFuzzer adds these to its coverage: what the writer does is not seen in the emulator's own code.
// One counter for each kind of start, answer, status, and the answer before it.
__attribute__((section("__libfuzzer_extra_counters"))) std::uint8_t seen[4096];

class Case {
 public:
  Case(std::span<const std::uint8_t> bytes, std::string* text)
      : left_(bytes),
        start_(kWriterStarts[byte() % 3]),
        board_(start_),
        judge_(board_, start_),
        text_(text) {
    judge_.on_answer = [this](std::uint8_t type, std::uint8_t status) { note(type, status); };
  }

  std::optional<std::string> run() {
    const h8s::States end = board_.now() + kLongest;
    for (int k = 0; k < kMaxEvents && !left_.empty() && board_.now() < end; ++k) {
      event();
      if (!judge_.complaint().empty()) return judge_.complaint();
    }
    judge_.finish();
    if (judge_.complaint().empty()) return std::nullopt;
    return judge_.complaint();
  }

 private:
  using Bytes = std::vector<std::uint8_t>;

  // From the front of the case; past its end everything is 0.
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t value = left_.front();
    left_ = left_.subspan(1);
    return value;
  }
  std::uint32_t word() {
    const std::uint32_t high = byte();
    return high << 8 | byte();
  }
  void event();
  Bytes request();
  Bytes write_request();
  std::uint32_t address();
  std::uint8_t data_at(std::uint32_t address, std::uint8_t kind, std::uint8_t salt) const;
  void send(const Bytes& bytes, const char* how);
  void wait();
  void run_on(h8s::States states, bool until_answer);
  void note(std::uint8_t type, std::uint8_t status);

  std::span<const std::uint8_t> left_;
  WriterStart start_;
  WriterBoard board_;
  WriterJudge judge_;
  std::string* text_;
  std::uint8_t number_ = 0;
  unsigned before_ = 0;
  Bytes last_;
};

void Case::note(std::uint8_t type, std::uint8_t status) {
  const unsigned kind =
      std::min<unsigned>(type & ~KZ_WRITER_REPLY, 8) * 11 + std::min<int>(status, 10);
  const unsigned at =
      (static_cast<unsigned>(start_) * 1201u + kind * 97u + before_ * 13u) % sizeof seen;
  seen[at] = 1;
  before_ = kind;
  if (text_ == nullptr) return;
  char line[64];
  std::snprintf(line, sizeof line, "%9.3f ms   answer %02x status %u\n",
                static_cast<double>(board_.now()) / static_cast<double>(kMs), type, status);
  *text_ += line;
}

std::uint32_t Case::address() {
  std::uint32_t at = 0;
  switch (byte() % 10) {
    case 0:
      at = word() * kLine;  // all of the flash, and as much behind it
      break;
    case 1: {
      static constexpr std::uint32_t kBounds[] = {0x400, 0x1000, 0x8000, 0xc000, 0xe000, 0x10000};
      at = kBounds[byte() % 6] - kLine * (byte() % 16);
      break;
    }
    case 2:
      at = kFlash - kLine * (byte() % 17);
      break;
    case 3:
      at = kWriterRam + kLine * (byte() % 128);
      break;
    case 4:
      at = writer_second_stage() + kLine * (byte() % 4) - 2 * kLine;
      break;
    case 5:
      at = writer_program_end() - kLine * (byte() % 18) + kLine;
      break;
    case 6:
      at = judge_.filled();
      break;
    case 7:
      at = 0xff0000 | word();
      break;
    case 8:  // addresses that a chip with 24 address lines would take for others
      at = std::uint32_t{byte()} << 24 | (byte() % 2 ? 0xff0000 : 0) | word();
      break;
    default:
      at = word() << 16;
      at |= word();
  }
  if (byte() % 8 != 0) at &= ~(kLine - 1);
  return at;
}

// The second stage that would be stored is the true one: what another one does is its sender's own.
std::uint8_t Case::data_at(std::uint32_t at, std::uint8_t kind, std::uint8_t salt) const {
  if (at >= judge_.filled() && at < writer_program_end()) return writer_program()[at - kWriterRam];
  switch (kind % 5) {
    case 0:
      return 0xff;
    case 1:
      return 0x00;
    case 2:
      if (at >= kWriterRam && at < writer_program_end()) return writer_program()[at - kWriterRam];
      [[fallthrough]];
    case 3:
      return static_cast<std::uint8_t>(at * 7 + salt);
    default:
      return at % kLine == 0 ? salt : 0xff;
  }
}

Case::Bytes Case::write_request() {
  const std::uint32_t at = address();
  static constexpr std::uint32_t kSizes[] = {32, 64, 512, 480, 256, 0};
  const std::uint8_t choice = byte();
  std::uint32_t size = choice < 240 ? kSizes[choice % 6] : word() % (KZ_WRITER_DATA_MAX + 1);
  const std::uint8_t kind = byte(), salt = byte();
  if (at >= judge_.filled() - KZ_WRITER_DATA_MAX && at < writer_program_end() && choice % 2 == 0)
    size = std::min(size, writer_program_end() - at);
  Bytes payload;
  put_number(payload, at, 4);
  for (std::uint32_t k = 0; k < size; ++k) payload.push_back(data_at(at + k, kind, salt));
  // The reset vector of a board that was started by boot mode stays blank: RUN would go there.
  if (start_ != WriterStart::loader) {
    for (std::uint32_t k = 0; k < size && at + k < 4; ++k) payload[4 + k] = 0xff;
  }
  return payload;
}

Case::Bytes Case::request() {
  static constexpr std::uint8_t kTypes[] = {
      KZ_WRITER_WRITE, KZ_WRITER_WRITE, KZ_WRITER_WRITE, KZ_WRITER_WRITE, KZ_WRITER_WRITE,
      KZ_WRITER_INFO,  KZ_WRITER_ERASE, KZ_WRITER_ERASE, KZ_WRITER_SUM,   KZ_WRITER_READ,
      KZ_WRITER_READ,  KZ_WRITER_RUN,   KZ_WRITER_RATE};
  const std::uint8_t choice = byte();
  std::uint8_t type = choice < 240 ? kTypes[choice % 13] : byte();
  Bytes payload;
  switch (type) {
    case KZ_WRITER_WRITE:
      payload = write_request();
      break;
    case KZ_WRITER_ERASE:
      payload = {static_cast<std::uint8_t>(byte() % 11)};
      break;
    case KZ_WRITER_SUM:
      put_number(payload, address(), 4);
      put_number(payload, byte() % 8 ? word() % 0x2000 : 0xffffff00u | byte(), 4);
      break;
    case KZ_WRITER_READ:
      put_number(payload, address(), 4);
      put_number(payload, byte() % 2 ? word() : 4u * byte(), 2);
      break;
    case KZ_WRITER_RATE: {
      static constexpr std::uint8_t kRates[] = {4, 119, 9, 59, 3, 120, 0, 255};
      payload = {kRates[byte() % 8]};
      break;
    }
    default:
      break;
  }
  const std::uint8_t other_length = byte();
  if (other_length >= 240) payload.resize(byte() % 12, other_length);
  number_ = byte() % 16 == 0 ? byte() : static_cast<std::uint8_t>(number_ + 1);
  return writer_frame(type, number_, payload);
}

void Case::send(const Bytes& bytes, const char* how) {
  if (text_ != nullptr) {
    char line[160];
    const std::string start =
        hex_text(std::span(bytes).first(std::min<std::size_t>(bytes.size(), 14)), " ");
    std::snprintf(line, sizeof line, "%9.3f ms %s: %zu bytes: %s\n",
                  static_cast<double>(board_.now()) / static_cast<double>(kMs), how, bytes.size(),
                  start.c_str());
    *text_ += line;
  }
  const h8s::States end = board_.send(bytes);
  judge_.sent(bytes);
  last_ = bytes;
  // While the bytes are on the line.
  run_on(end - board_.now(), false);
}

void Case::run_on(h8s::States states, bool until_answer) {
  const std::size_t before = judge_.answers();
  board_.run(states, [&] {
    judge_.look();
    return !judge_.complaint().empty() || (until_answer && judge_.answers() != before);
  });
}

void Case::wait() {
  switch (const std::uint8_t choice = byte(); choice % 6) {
    case 0:  // not at all: the next comes while this one is worked on
      break;
    case 1:
      board_.pause((choice / 6) * kMs / 8);
      run_on((choice / 6) * kMs / 8, false);
      break;
    case 2:
      board_.pause(25 * kMs);
      run_on(25 * kMs, false);
      break;
    default:
      run_on(120 * kMs, true);
  }
}

void Case::event() {
  const std::uint8_t what = byte() % 16;
  if (what == 10) {
    Bytes raw;
    for (unsigned count = byte() % 40; count > 0; --count) raw.push_back(byte());
    send(raw, "raw");
  } else if (what == 11) {
    send(Bytes(static_cast<std::size_t>(word() % 600), byte()), "bytes of one value");
  } else if (what == 12 && !last_.empty()) {
    send(Bytes(last_), "again");
  } else {
    Bytes whole = request();
    if (what == 13) {
      for (unsigned flips = 1 + byte() % 2; flips > 0; --flips)
        whole[word() % whole.size()] ^= static_cast<std::uint8_t>(1u << byte() % 8);
      send(whole, "damaged");
    } else if (what == 14) {
      whole.resize(word() % whole.size());
      send(whole, "cut short");
    } else if (what == 15) {
      Bytes two = whole;
      const Bytes next = request();
      two.insert(two.end(), next.begin(), next.end());
      send(two, "two");
    } else {
      send(whole, "request");
    }
  }
  wait();
}

}  // namespace

std::optional<std::string> try_flash_writer(std::span<const std::uint8_t> bytes) {
  return Case(bytes, nullptr).run();
}

std::string flash_writer_text(std::span<const std::uint8_t> bytes) {
  std::string text;
  const auto complaint = Case(bytes, &text).run();
  return text + (complaint ? *complaint : "no fault found") + "\n";
}

}  // namespace kaz::fuzz
