// Random fields within and outside the table's bounds, and sequences of requests.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/random_request.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>

#include "shared/board/table.h"
#include "shared/protocol/messages.h"

namespace kaz::sim {
namespace {

void put(std::vector<std::uint8_t>& body, long long value, std::size_t size) {
  for (std::size_t i = size; i-- > 0;) body.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

// How often a request comes among others that come once.
int weight(std::uint8_t type) {
  // It takes the board away for a while: only where it is planned.
  if (kz_interrupts_service(type)) return 0;
  switch (type) {
    case KZ_TYPE_targets:
      return 20;
    case KZ_TYPE_state:
    case KZ_TYPE_enable:
    case KZ_TYPE_clear:
      return 5;
    default:
      return 1;
  }
}

bool is_request(const kz_message_info& info) {
  return (info.code & KZ_REPLY) == 0;
}

}  // namespace

std::vector<std::uint8_t> RandomRequest::next() {
  if (planned_.empty() && random_.chance(0.01)) plan();
  if (!planned_.empty()) {
    auto body = std::move(planned_.front());
    planned_.pop_front();
    return body;
  }
  auto body = make(choose(), random_.chance(0.9));
  if (random_.chance(0.01)) body.resize(1 + random_.below(static_cast<std::uint32_t>(body.size())));
  if (random_.chance(0.01) && body.size() < KZ_PAYLOAD_MAX) body.push_back(0);
  return body;
}

const kz_message_info& RandomRequest::choose() {
  int total = 0;
  for (int i = 0; i < kz_message_count; ++i)
    if (is_request(kz_messages[i])) total += weight(kz_messages[i].code);
  int at = static_cast<int>(random_.below(static_cast<std::uint32_t>(total)));
  for (int i = 0; i < kz_message_count; ++i) {
    if (!is_request(kz_messages[i])) continue;
    at -= weight(kz_messages[i].code);
    if (at < 0) return kz_messages[i];
  }
  return kz_messages[0];
}

std::vector<std::uint8_t> RandomRequest::make(const kz_message_info& request, bool legal) {
  std::vector<std::uint8_t> body{request.code};
  std::uint32_t bits = 0;
  for (int f = 0; f < request.field_count; ++f) {
    const kz_field_info& field = request.fields[f];
    if (field.mask == nullptr) {
      const long long value = number(request, field, legal);
      if (std::string_view(field.name) == "mask") bits = static_cast<std::uint32_t>(value);
      put(body, value, field.size);
      continue;
    }
    for (int joint = 0; joint < KZ_JOINTS; ++joint)
      if (bits >> joint & 1) put(body, element(field, joint, legal), field.size);
  }
  return body;
}

long long RandomRequest::number(const kz_message_info& request, const kz_field_info& field,
                                bool legal) {
  const std::string_view name = field.name;
  if (name == "mask") {
    std::uint32_t bits = mask(legal);
    // `joints` takes nine of them.
    while (request.code == KZ_TYPE_joints && legal && std::popcount(bits) > 9) bits &= bits - 1;
    return bits;
  }
  if (!legal && random_.chance(0.3)) {
    const std::array<long long, 4> wrong{field.low - 1, field.high + 1, 0,
                                         static_cast<long long>(random_.next() & 0xFFFFFFFF)};
    return wrong[random_.below(wrong.size())];
  }
  if (random_.chance(0.1)) return random_.chance(0.5) ? field.low : field.high;
  if (name == "duration_ms") return 1 + random_.below(request.code == KZ_TYPE_targets ? 1000 : 300);
  if (name == "period_ms") return random_.chance(0.5) ? 0 : 5 + random_.below(100);
  if (name == "watchdog_10ms") return random_.chance(0.5) ? 0 : 5 + random_.below(96);
  if (name == "lower") return -20000 + static_cast<int>(random_.below(20000));
  if (name == "upper") return random_.below(20000);
  return field.low + random_.below(static_cast<std::uint32_t>(field.high - field.low + 1));
}

std::uint32_t RandomRequest::mask(bool legal) {
  constexpr std::uint32_t all = KZ_ALL_JOINTS;
  switch (random_.below(8)) {
    case 0:
      return static_cast<std::uint32_t>(random_.next()) & (legal ? all : ~0u);
    case 1:
      return 0;
    case 2:
      return static_cast<std::uint32_t>(random_.next()) & all;
    case 3:
      return 1u << random_.below(KZ_JOINTS);
    default:
      return all;
  }
}

long long RandomRequest::angle(int joint, bool legal) {
  const kz_board_joint& board = kz_board_joints[joint];
  if (!legal && random_.chance(0.1)) return static_cast<std::int16_t>(random_.next());
  const int range = board.upper - board.lower + 1;
  // Mostly in the middle half, which soft limits rarely clip.
  const int from = random_.chance(0.1) ? 0 : range / 4;
  const int span = random_.chance(0.1) ? range - from : range / 2;
  return board.lower + from + static_cast<int>(random_.below(static_cast<std::uint32_t>(span)));
}

long long RandomRequest::element(const kz_field_info& field, int joint, bool legal) {
  const kz_board_joint& board = kz_board_joints[joint];
  const std::string_view name = field.name;
  const auto around = [this](int middle, int max_offset) {
    return middle - max_offset +
           static_cast<int>(random_.below(static_cast<std::uint32_t>(2 * max_offset)));
  };
  if (!legal && random_.chance(0.1)) return static_cast<std::int16_t>(random_.next());
  if (name == "centre") return std::clamp(around(board.pot_centre, 300), -32768, 32767);
  if (name == "scale") return around(board.pot_scale, 300);
  return angle(joint, legal);
}

// Bodies of requests that are done one after the other, if nothing comes between.
void RandomRequest::plan() {
  const auto legal = [this](std::uint8_t type) { return make(*kz_message_find(type), true); };
  const std::vector<std::uint8_t> off{KZ_TYPE_enable, 0, 0, 0, 0}, clear{KZ_TYPE_clear};
  const std::vector<std::uint8_t> unlock{KZ_TYPE_unlock, KZ_KEY >> 8, KZ_KEY & 0xFF, 60};
  planned_ = {off, clear};
  switch (random_.below(16)) {
    case 0:
      planned_.insert(planned_.end(), {legal(KZ_TYPE_calibrate), {KZ_TYPE_store_calibration}});
      break;
    case 1:
      planned_.insert(planned_.end(), {unlock, {KZ_TYPE_set_address, KZ_ADDRESS_DEFAULT, 0}});
      break;
    case 2:
      planned_.push_back({KZ_TYPE_reset, KZ_KEY >> 8, KZ_KEY & 0xFF});
      break;
    case 3:
      if (random_.chance(0.2)) planned_.push_back({KZ_TYPE_loader, KZ_KEY >> 8, KZ_KEY & 0xFF});
      break;
    case 4:
    case 5:
    case 6:
    case 7:
    case 8:
      planned_.push_back(unlock);
      for (auto i = random_.below(6); i > 0; --i) planned_.push_back(legal(KZ_TYPE_raw_drive));
      break;
    case 9:
      planned_.push_back(legal(KZ_TYPE_calibrate));
      break;
    default: {
      // All on, and a few moves.
      const std::uint32_t all = KZ_ALL_JOINTS;
      std::vector<std::uint8_t> on{KZ_TYPE_enable};
      put(on, all, 4);
      planned_.push_back(on);
      for (auto i = random_.below(8); i > 0; --i) planned_.push_back(legal(KZ_TYPE_targets));
      break;
    }
  }
}

bool damage_frame(Random& random, std::vector<std::uint8_t>& frame, std::uint32_t min_length,
                  std::uint32_t max_noise) {
  const auto place = [&] {
    return frame.begin() + random.below(static_cast<std::uint32_t>(frame.size()));
  };
  switch (random.below(6)) {
    case 0:
      *place() ^= static_cast<std::uint8_t>(1u << random.below(8));
      return true;
    case 1:
      frame.erase(place());
      return true;
    case 2:
      frame.insert(place(), static_cast<std::uint8_t>(random.next()));
      return true;
    case 3:
      frame.resize(min_length + random.below(static_cast<std::uint32_t>(frame.size())));
      return true;
    case 4:
      frame.resize(min_length + random.below(max_noise));
      for (std::uint8_t& byte : frame) byte = static_cast<std::uint8_t>(random.next());
      return true;
    default:
      return false;
  }
}

}  // namespace kaz::sim
