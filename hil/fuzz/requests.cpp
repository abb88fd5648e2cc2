// Fields of requests.
// SPDX-License-Identifier: Apache-2.0
#include "hil/fuzz/requests.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "shared/board/table.h"
#include "shared/protocol/frame.h"

namespace kaz::hil::fuzz {
namespace {

struct Range {
  long long low, high;
};

Range type_range(const kz_field_info& field) {
  if (field.type[0] == 's') return {-32768, 32767};
  return {0, (1LL << (8 * field.size)) - 1};
}

// What makes sense for one number; the table's bounds where it has them.
Range sense(const kz_message_info& message, const kz_field_info& field, int joint) {
  const kz_board_joint& wiring = kz_board_joints[joint];
  if (std::strcmp(field.name, "angle") == 0) return {wiring.lower, wiring.upper};
  if (std::strcmp(field.name, "centre") == 0)
    return {wiring.pot_centre - KZ_CENTRE_TOLERANCE, wiring.pot_centre + KZ_CENTRE_TOLERANCE};
  if (std::strcmp(field.name, "scale") == 0) {
    const int quarter = std::abs(wiring.pot_scale) / 4;
    return {wiring.pot_scale - quarter, wiring.pot_scale + quarter};
  }
  if (message.code == KZ_TYPE_limits && std::strcmp(field.name, "lower") == 0) return {-24000, 0};
  if (message.code == KZ_TYPE_limits && std::strcmp(field.name, "upper") == 0) return {0, 24000};
  if (message.code == KZ_TYPE_telemetry && std::strcmp(field.name, "period_ms") == 0)
    return {0, 100};
  if (std::strcmp(field.name, "duration_ms") == 0) return {field.low, 1000};
  return {field.low, field.high};
}

long long pick(Choices& choices, Range usual, Range type, bool legal) {
  switch (choices.below(legal ? 4 : 8)) {
    case 0:
    case 1:
      return choices.between(usual.low, usual.high);
    case 2:
      return usual.low;
    case 3:
      return usual.high;
    case 4:
      return usual.low - 1;
    case 5:
      return usual.high + 1;
    case 6:
      return choices.below(2) == 0 ? type.low : type.high;
    default:
      return choices.between(type.low, type.high);
  }
}

std::uint32_t pick_mask(Choices& choices, Range usual, bool legal) {
  switch (choices.below(legal ? 4 : 6)) {
    case 0:
    case 1:
      return static_cast<std::uint32_t>(usual.high);
    case 2:
      return 1u << choices.below(KZ_JOINTS);
    case 3:
      return choices.word() & static_cast<std::uint32_t>(usual.high);
    case 4:
      return 0;
    default:
      return choices.word();
  }
}

// The highest joints go until at most `max_joints` are left.
std::uint32_t thinned(std::uint32_t mask, int max_joints) {
  while (std::popcount(mask) > max_joints) mask &= ~std::bit_floor(mask);
  return mask;
}

void put(std::vector<std::uint8_t>& body, long long value, int size) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
    body.push_back(static_cast<std::uint8_t>(value >> shift));
}

}  // namespace

std::vector<const kz_message_info*> request_types(bool flash) {
  std::vector<const kz_message_info*> types;
  for (int i = 0; i < kz_message_count; ++i) {
    const kz_message_info& message = kz_messages[i];
    if (message.code & KZ_REPLY) continue;
    if (flash || message.kind != KZ_KIND_FLASH_COMMAND) types.push_back(&message);
  }
  return types;
}

RequestBytes make_request(const kz_message_info& message, Choices& choices, bool legal,
                          std::uint8_t address, std::uint8_t sequence) {
  RequestBytes request{{address, message.code, sequence}, message.name};
  std::uint32_t mask = 0;
  int max_joints = KZ_JOINTS;
  for (int f = 0; f < message.field_count; ++f) {
    if (message.fields[f].mask != nullptr)
      max_joints = std::min<int>(max_joints, message.fields[f].count);
  }
  if (message.code == KZ_TYPE_joints) max_joints = KZ_JOINTS_PER_REPLY;
  for (int f = 0; f < message.field_count; ++f) {
    const kz_field_info& field = message.fields[f];
    const Range type = type_range(field);
    request.text.append(" ").append(field.name).append("=");
    if (std::strcmp(field.name, "mask") == 0) {
      mask = pick_mask(choices, {field.low, field.high}, legal);
      if (legal) mask = thinned(mask, max_joints);
      put(request.body, mask, field.size);
      request.text.append(std::to_string(mask));
      continue;
    }
    for (int n = 0, joint = -1; n < field.count; ++n) {
      ++joint;
      if (field.mask != nullptr) {
        while (joint < KZ_JOINTS && (mask >> joint & 1) == 0) ++joint;
        if (joint >= KZ_JOINTS) break;
      }
      const long long value =
          pick(choices, sense(message, field, std::min(joint, KZ_JOINTS - 1)), type, legal);
      put(request.body, value, field.size);
      if (n > 0) request.text.append(",");
      request.text.append(std::to_string(value));
    }
  }
  if (request.body.size() > KZ_BODY_MAX) request.body.resize(KZ_BODY_MAX);
  return request;
}

std::vector<std::uint8_t> framed(const std::vector<std::uint8_t>& body) {
  std::vector<std::uint8_t> wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

std::vector<std::uint8_t> framed(std::uint8_t address, std::uint8_t type, std::uint8_t sequence,
                                 const std::vector<std::uint8_t>& fields) {
  std::vector<std::uint8_t> body(KZ_HEADER_SIZE + fields.size());
  body[0] = address;
  body[1] = type;
  body[2] = sequence;
  std::copy(fields.begin(), fields.end(), body.begin() + KZ_HEADER_SIZE);
  return framed(body);
}

}  // namespace kaz::hil::fuzz
