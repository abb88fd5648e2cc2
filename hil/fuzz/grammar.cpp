// What a hostile host does, decision by decision.
// SPDX-License-Identifier: Apache-2.0
#include "hil/fuzz/grammar.h"

#include <algorithm>

#include "hil/fuzz/requests.h"
#include "shared/base/hex_text.hpp"
#include "shared/board/table.h"
#include "shared/protocol/frame.h"

namespace kaz::hil::fuzz {
namespace {

constexpr std::size_t kMaxEvents = 400;
constexpr double kBytesPerMs = 11.52;
// Choices added later begin here, so that older cases keep their meaning.
constexpr unsigned kLaterChoices = 240;
constexpr unsigned kRepeatedFrames = 8;  // the board remembers 4 requests

class Maker {
 public:
  Maker(std::span<const std::uint8_t> genome, const GrammarOptions& options)
      : choices_(genome), options_(options), types_(request_types(options.flash)) {}

  std::vector<Event> run() {
    while (!choices_.ended() && events_.size() < kMaxEvents && ms_ < options_.longest_ms) next();
    return std::move(events_);
  }

 private:
  void next() {
    const unsigned choice = choices_.byte();
    if (choice >= kLaterChoices) return repeat();
    switch (choice % 20) {
      case 0:
      case 1:
        return wait(static_cast<int>(choices_.below(20)));
      case 2:
        return wait(static_cast<int>(choices_.byte()));
      case 3:
      case 4:
      case 5:
        return request(true);
      case 6:
      case 7:
        return request(false);
      case 8:
        return odd_request();
      case 9:
        return damaged();
      case 10:
        return noise();
      case 11:
        return send(last_, "again");
      case 12:
      case 13:
        return arm();
      case 14:
      case 15:
        return query();
      case 16:
      case 17:
        return exercise();
      case 18:
        return bench_drive();
      default:
        return fault();
    }
  }

  void wait(int ms) {
    ms_ += ms;
    events_.push_back({Event::Kind::wait, {}, ms, {}, "wait " + std::to_string(ms) + " ms"});
  }

  void send(const std::vector<std::uint8_t>& bytes, const std::string& text) {
    if (bytes.empty()) return;
    ms_ += static_cast<double>(bytes.size()) / kBytesPerMs;
    events_.push_back({Event::Kind::send, bytes, 0, {}, "send " + text + ": " + hex_text(bytes)});
    last_ = bytes;
    frames_.push_back(bytes);
  }

  // The same bytes as one of the last frames, whatever the board has done since.
  void repeat() {
    const std::size_t back = 1 + choices_.below(kRepeatedFrames);
    if (back > frames_.size()) return;
    const std::vector<std::uint8_t> earlier = frames_[frames_.size() - back];
    send(earlier, "a repetition of an earlier frame (" + std::to_string(back) + " back)");
  }

  std::uint8_t sequence() {
    // Now and then an old number: a repetition, or another request with the same number.
    if (choices_.below(16) == 0) return static_cast<std::uint8_t>(sequence_ - choices_.below(5));
    return ++sequence_;
  }

  std::uint8_t address() {
    switch (choices_.below(32)) {
      case 0:
        return KZ_ADDRESS_ALL;
      case 1:
        return static_cast<std::uint8_t>(choices_.byte());
      default:
        return options_.address;
    }
  }

  const kz_message_info& type() {
    return *types_[choices_.below(static_cast<unsigned>(types_.size()))];
  }

  void request(bool legal) {
    const kz_message_info& message = type();
    const std::uint8_t to = address();
    const auto made = make_request(message, choices_, legal, to, sequence());
    send(framed(made.body), made.text + " to " + std::to_string(to));
  }

  void known(u8 code, const std::vector<std::uint8_t>& fields) {
    send(framed(options_.address, code, ++sequence_, fields), kz_message_find(code)->name);
  }

  // Unknown type, or too many or too few bytes; the CRC is right.
  void odd_request() {
    auto made = make_request(type(), choices_, true, options_.address, sequence());
    if (choices_.below(2) == 0) {
      made.body[1] = choices_.byte();
    } else {
      made.body.resize(choices_.below(KZ_BODY_MAX + 1), choices_.byte());
    }
    send(framed(made.body), "odd " + made.text);
  }

  // One to four bytes of a valid frame inverted, lost or inserted.
  void damaged() {
    const auto made = make_request(type(), choices_, true, options_.address, sequence());
    auto wire = framed(made.body);
    for (unsigned left = 1 + choices_.below(4); left > 0; --left) {
      const auto at = static_cast<std::ptrdiff_t>(
          choices_.below(static_cast<unsigned>(std::max<std::size_t>(wire.size(), 1))));
      if (wire.empty()) break;
      switch (choices_.below(3)) {
        case 0:
          wire[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1 + choices_.below(255));
          break;
        case 1:
          wire.erase(wire.begin() + at);
          break;
        default:
          wire.insert(wire.begin() + at, choices_.byte());
      }
    }
    send(wire, "damaged " + made.text);
  }

  void noise() {
    std::vector<std::uint8_t> bytes(1 + choices_.below(200));
    for (std::uint8_t& byte : bytes) byte = choices_.byte();
    if (choices_.below(2) == 0) bytes.push_back(0);
    send(bytes, "noise");
  }

  void clear() {
    known(KZ_TYPE_clear, {});
    wait(8);
  }

  void arm() {
    clear();
    const std::uint32_t mask =
        choices_.below(2) == 0 ? KZ_ALL_JOINTS : choices_.word() & KZ_ALL_JOINTS;
    known(KZ_TYPE_enable, {0, static_cast<std::uint8_t>(mask >> 16),
                           static_cast<std::uint8_t>(mask >> 8), static_cast<std::uint8_t>(mask)});
    wait(12);
  }

  void query() {
    const auto made = make_request(type(), choices_, true, options_.address, ++sequence_);
    ms_ += 100;
    events_.push_back({Event::Kind::query,
                       framed(made.body),
                       0,
                       {},
                       "query " + made.text + ": " + hex_text(framed(made.body))});
    last_.clear();
    frames_.push_back(events_.back().bytes);
  }

  // Targets to and fro, at the limits and between, while the link watchdog is kept content.
  void exercise() {
    const int joint = static_cast<int>(choices_.below(KZ_JOINTS + 4));
    for (unsigned left = 1 + choices_.below(6); left > 0; --left) {
      kz_targets targets{};
      targets.mask = joint < KZ_JOINTS ? 1u << joint : KZ_ALL_JOINTS;
      for (int j = 0; j < KZ_JOINTS; ++j) {
        const kz_board_joint& wiring = kz_board_joints[j];
        const unsigned where = choices_.below(6);
        targets.angle[j] = where == 0 ? wiring.lower
                           : where == 1
                               ? wiring.upper
                               : static_cast<s16>(choices_.between(wiring.lower, wiring.upper));
      }
      std::vector<std::uint8_t> fields(KZ_PAYLOAD_MAX);
      fields.resize(kz_pack_targets(&targets, fields.data()));
      known(KZ_TYPE_targets, fields);
      wait(30 + static_cast<int>(choices_.below(50)));
    }
  }

  void bench_drive() {
    clear();
    known(KZ_TYPE_enable, {0, 0, 0, 0});
    wait(8);
    known(KZ_TYPE_unlock, {KZ_KEY >> 8, KZ_KEY & 0xFF, 10});
    wait(8);
    kz_raw_drive drive{};
    drive.joint = static_cast<u8>(choices_.below(KZ_JOINTS));
    drive.duty = static_cast<s16>(choices_.between(-255, 255));
    drive.duration_ms = static_cast<u16>(choices_.between(1, 2000));
    std::vector<std::uint8_t> fields(KZ_PAYLOAD_MAX);
    fields.resize(kz_pack_raw_drive(&drive, fields.data()));
    known(KZ_TYPE_raw_drive, fields);
    wait(static_cast<int>(choices_.below(80)));
  }

  void fault() {
    const auto kinds = faults::kinds();
    const faults::Kind& kind = kinds[choices_.below(static_cast<unsigned>(kinds.size()))];
    const bool line = kind.target == faults::Target::line;
    faults::Fault fault;
    fault.name = kind.id;
    fault.length = std::chrono::milliseconds(1 + choices_.byte());
    if (kind.target == faults::Target::joint)
      fault.joint = static_cast<int>(choices_.below(KZ_JOINTS));
    if (line) fault.way = static_cast<faults::Way>(choices_.below(3));
    const double share = choices_.byte() / 255.0;
    fault.value = choices_.below(2) == 0 ? kind.initial : kind.low + share * (kind.high - kind.low);
    if (line ? !options_.line_faults : !options_.faults) return;
    events_.push_back({Event::Kind::fault, {}, 0, fault, "fault " + faults::text_of(fault)});
  }

  Choices choices_;
  const GrammarOptions& options_;
  std::vector<const kz_message_info*> types_;
  std::vector<Event> events_;
  double ms_ = 0;
  std::uint8_t sequence_ = 0;
  std::vector<std::uint8_t> last_;
  std::vector<std::vector<std::uint8_t>> frames_;  // sent until now
};

}  // namespace

std::vector<Event> events_of(std::span<const std::uint8_t> genome, const GrammarOptions& options) {
  return Maker(genome, options).run();
}

std::string text_of(std::span<const Event> events) {
  std::string text;
  for (const Event& event : events) text.append(event.text).append("\n");
  return text;
}

}  // namespace kaz::hil::fuzz
