// The fields of a frame by the names of messages.def.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/frame_fields.h"

#include <bit>
#include <map>
#include <string>
#include <string_view>

#include "shared/protocol/message_info.h"
#include "sim/mcu/h8_layout.h"

namespace kaz::sim {
namespace {

// In the order on the wire.
using Numbers = std::vector<std::pair<std::string, std::int64_t>>;

std::int64_t number_of(const kz_field_info& field, std::uint32_t bits) {
  return field.type[0] == 's' ? static_cast<std::int16_t>(bits) : std::int64_t{bits};
}

// Of a masked field the elements are those of the mask's bits, the lowest first.
Numbers numbers_of(std::span<const std::uint8_t> body, const kz_message_info& message) {
  const std::string name = message.name;
  // calibration_reply has a field `sequence` of its own.
  Numbers numbers{{name + ".header.address", body[KZ_BODY_ADDRESS]},
                  {name + ".header.sequence", body[KZ_BODY_SEQUENCE]}};
  std::map<std::string_view, std::uint32_t> masks;
  std::size_t at = KZ_HEADER_SIZE;
  for (int f = 0; f < message.field_count; ++f) {
    const kz_field_info& field = message.fields[f];
    std::uint32_t present = field.mask != nullptr ? masks[field.mask] : (1ULL << field.count) - 1;
    for (int taken = 0; present != 0 && taken < field.count; ++taken) {
      if (at + field.size > body.size()) return numbers;
      const int element = std::countr_zero(present);
      present &= present - 1;
      const std::uint32_t bits = h8_layout::number(body, at, field.size);
      if (field.count == 1) masks[field.name] = bits;
      std::string one = name + "." + field.name;
      if (field.count > 1) one.append("[").append(std::to_string(element)).append("]");
      numbers.emplace_back(std::move(one), number_of(field, bits));
      at += field.size;
    }
  }
  return numbers;
}

}  // namespace

std::vector<std::uint8_t> sent_body(const kz_sender& sender) {
  std::vector<std::uint8_t> body;
  if (sender.length > KZ_BODY_MAX) return body;
  body.assign(sender.body, sender.body + sender.length);
  // Each zero was replaced by the distance to the next one; `first` is that to the first of them.
  std::size_t zero = sender.first;
  while (zero != 0 && zero <= body.size()) {
    const std::uint8_t distance = body[zero - 1];
    if (distance == 0) return {};
    body[zero - 1] = 0;
    zero += distance;
  }
  return body;
}

std::vector<CompareDifference> frame_differences(std::span<const std::uint8_t> native,
                                                 std::span<const std::uint8_t> h8) {
  std::vector<CompareDifference> differences;
  if (native.size() < KZ_HEADER_SIZE || h8.size() < KZ_HEADER_SIZE) return differences;
  const kz_message_info* message = kz_message_find(native[KZ_BODY_TYPE]);
  const kz_message_info* other = kz_message_find(h8[KZ_BODY_TYPE]);
  if (message == nullptr || other == nullptr) return differences;
  if (message != other)
    return {{std::string("type (") + message->name + ", " + other->name + ")", message->code,
             other->code}};
  const Numbers theirs = numbers_of(h8, *other);
  const std::map<std::string, std::int64_t> by_name(theirs.begin(), theirs.end());
  for (const auto& [name, ours] : numbers_of(native, *message)) {
    const auto found = by_name.find(name);
    if (found != by_name.end() && found->second != ours)
      differences.push_back({name, ours, found->second});
  }
  return differences;
}

}  // namespace kaz::sim
