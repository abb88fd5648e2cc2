// Randomly damaged frames through the receiver and the servo tick.
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/damage/damage.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "shared/board/table.h"
#include "shared/protocol/message_info.h"
#include "shared/servo/tick.h"

namespace kaz::test {
namespace {

using Bytes = std::vector<u8>;
using Random = std::mt19937_64;

int between(Random& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

Bytes frame_of(const Bytes& body) {
  Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

void append(Bytes& bytes, int size, unsigned long long value) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
    bytes.push_back(static_cast<u8>(value >> shift));
}

// A request with every field within its bounds.
Bytes random_request(Random& random, u8 sequence) {
  const kz_message_info* message;
  do {
    message = &kz_messages[random() % kz_message_count];
  } while (message->code & KZ_REPLY);
  Bytes body = {KZ_ADDRESS_DEFAULT, message->code, sequence};
  unsigned mask = 0;
  for (int f = 0; f < message->field_count; ++f) {
    const kz_field_info& field = message->fields[f];
    const auto range = static_cast<unsigned long long>(field.high - field.low) + 1;
    int count = field.count;
    if (field.mask) count = std::min(count, __builtin_popcount(mask));
    for (int i = 0; i < count; ++i) {
      const auto value = static_cast<long long>(random() % range) + field.low;
      if (field.size == 4) mask = static_cast<unsigned>(value);
      append(body, field.size, static_cast<unsigned long long>(value));
    }
  }
  return body;
}

u8 other_than_zero(Random& random) {
  return static_cast<u8>(between(random, 1, 255));
}

// Damages the stuffed body; its zeros at both ends stay, and so does the check, so that nothing but
// the CRC detects. Returns false if the frame came out as it was.
bool damage(Random& random, std::size_t kind, Bytes& wire) {
  const Bytes before = wire;
  const int last = static_cast<int>(wire.size()) - 5;  // of the stuffed body, which begins at 1
  const int length = std::min(between(random, kind == 1 ? 3 : 1, 20), last - 1);
  const int place = between(random, 1, last + 1 - (kind == 0 ? 1 : length));
  const auto at = wire.begin() + place;
  switch (kind) {
    case 0:
      *at = other_than_zero(random);
      break;
    case 1:
      for (int i = 0; i < length; ++i) at[i] = other_than_zero(random);
      break;
    case 2:
      wire.erase(at, at + length);
      break;
    default:
      for (int i = 0; i < length; ++i) wire.insert(wire.begin() + place, other_than_zero(random));
      break;
  }
  return wire != before && wire.size() <= KZ_BODY_MAX + 6;
}

// The native board, with motors that turn at the commanded speed, without inertia.
class Board {
 public:
  explicit Board(DamageReport& report) : report_(report) {
    kz_startup startup;
    kz_startup_nominal(&startup);
    kz_servo_init(&servo_, &startup, &output_);
    input_.analog[KZ_ANALOG_SUPPLY] = 667;  // 10 V
    input_.analog[KZ_ANALOG_REFERENCE] = KZ_REFERENCE_CODE;
    input_.analog[KZ_ANALOG_TEMPERATURE] = 250;
    input_.tx_room = KZ_TX_BUFFER;
    for (int j = 0; j < KZ_JOINTS; ++j)
      angle_[j] = (servo_.joint[j].lower + servo_.joint[j].upper) / 2.0;
    hear({});
  }

  // The bytes, and as many ticks as they take, at least one.
  void hear(const Bytes& bytes) {
    std::size_t next = 0;
    do {
      input_.rx_count = 0;
      while (input_.rx_count < KZ_RX_PER_TICK && next < bytes.size())
        input_.rx[input_.rx_count++] = bytes[next++];
      tick();
    } while (next < bytes.size());
  }

  // Motors on, and somewhere to go.
  void keep_moving(Random& random) {
    request(KZ_TYPE_clear, {});
    Bytes everything;
    append(everything, 4, KZ_ALL_JOINTS);
    request(KZ_TYPE_enable, everything);
    kz_targets targets = {};
    targets.mask = KZ_ALL_JOINTS;
    targets.duration_ms = static_cast<u16>(between(random, 0, 300));
    for (int j = 0; j < KZ_JOINTS; ++j) {  // every other one a limit
      const int lower = servo_.joint[j].lower, upper = servo_.joint[j].upper;
      const int ends[] = {lower, upper, between(random, lower, upper),
                          between(random, lower, upper)};
      targets.angle[j] = static_cast<s16>(ends[random() % 4]);
    }
    Bytes fields(KZ_SIZE_targets);
    fields.resize(kz_pack_targets(&targets, fields.data()));
    request(KZ_TYPE_targets, fields);
  }

 private:
  void request(u8 type, const Bytes& fields) {
    Bytes body = {KZ_ADDRESS_DEFAULT, type, ++sequence_};
    body.insert(body.end(), fields.begin(), fields.end());
    hear(frame_of(body));
    hear({});
    hear({});
  }

  void tick() {
    constexpr double fastest = 100;  // 100 urad a millisecond at full duty: 10 rad/s
    input_.result = output_.action == KZ_ACTION_NONE ? KZ_RESULT_NONE : KZ_RESULT_DONE;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const kz_joint& joint = servo_.joint[j];
      if (joint.on) {
        const double moved = joint.duty / 255.0 * fastest;
        angle_[j] += joint.forward == joint.mirrored ? -moved : moved;
        report_.furthest_moved += moved * 1e-4;
      }
      const double code = 512 + (angle_[j] - joint.pot_centre) * 512 / joint.pot_scale;
      input_.analog[kz_board_joints[j].analog] =
          static_cast<u16>(std::clamp(std::lround(code), 0L, 1023L));
    }
    kz_tick(&servo_, &input_, &output_);
    ++input_.tick;
    ++report_.ticks;
    report_.ticks_on += servo_.enabled != 0;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const kz_joint& joint = servo_.joint[j];
      const kz_board_joint& table = kz_board_joints[j];
      const double outside = std::max(angle_[j] - table.upper, table.lower - angle_[j]);
      report_.furthest_outside =
          std::max(report_.furthest_outside, static_cast<int>(std::lround(outside)));
      // A joint that stands outside when it is switched on starts there and only moves inward.
      if (joint.on && was_on_[j])
        report_.commands_outside += joint.command < lowest_[j] || joint.command > highest_[j];
      lowest_[j] = std::min(table.lower, joint.command);
      highest_[j] = std::max(table.upper, joint.command);
      was_on_[j] = joint.on;
    }
  }

  DamageReport& report_;
  kz_servo servo_;
  kz_tick_input input_ = {};
  kz_tick_output output_ = {};
  double angle_[KZ_JOINTS] = {};
  s16 lowest_[KZ_JOINTS] = {}, highest_[KZ_JOINTS] = {};  // of commands in the next tick
  bool was_on_[KZ_JOINTS] = {};
  u8 sequence_ = 0;
};

}  // namespace

std::uint64_t DamageReport::frames() const {
  return kinds[1].frames + kinds[2].frames + kinds[3].frames;
}

std::uint64_t DamageReport::passed() const {
  return kinds[1].passed + kinds[2].passed + kinds[3].passed;
}

DamageReport measure_damage(std::uint64_t frames, std::uint64_t seed) {
  DamageReport report;
  report.furthest_outside = -32768;
  Random random(seed);
  Board board(report);
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  for (std::uint64_t done = 0; done < frames;) {
    const std::size_t kind = random() % report.kinds.size();
    Bytes wire = frame_of(random_request(random, static_cast<u8>(random())));
    if (!damage(random, kind, wire)) continue;
    if (done++ % 64 == 0) board.keep_moving(random);
    Damage& counts = report.kinds[kind];
    ++counts.frames;
    for (const u8 byte : wire) {
      const u8 result = kz_receive(&receiver, byte, 0);
      counts.accepted += result == KZ_RECEIVE_FRAME;
      // What has the right check and is no frame has impossible stuffing.
      counts.passed += result == KZ_RECEIVE_FRAME || result == KZ_RECEIVE_BAD_STUFFING;
    }
    board.hear(wire);
  }
  return report;
}

}  // namespace kaz::test
