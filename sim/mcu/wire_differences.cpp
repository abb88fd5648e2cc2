// Differences by design between the native board and the emulated one.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/wire_differences.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "shared/protocol/frame.h"
#include "shared/protocol/message_info.h"

namespace kaz::sim {
namespace {

constexpr const char* kNoCpu = "the native board models no CPU time";
constexpr const char* kNoImage = "no image";

constexpr WireException kExceptions[] = {
    {"`statistics_reply.busy_8states`", "measured", "0", kNoCpu, KZ_TYPE_statistics_reply,
     "busy_8states"},
    {"`statistics_reply.worst_8states`", "measured", "0", kNoCpu, KZ_TYPE_statistics_reply,
     "worst_8states"},
    {"`telemetry_health.busy_8states`", "measured", "0", kNoCpu, KZ_TYPE_telemetry_health,
     "busy_8states"},
    {"`telemetry_health.worst_8states`", "measured", "0", kNoCpu, KZ_TYPE_telemetry_health,
     "worst_8states"},
    {"`identify_reply.image_crc`", "the image's CRC", "0", kNoImage, KZ_TYPE_identify_reply,
     "image_crc"},
    {"`self_test_reply.image_crc`", "the image's CRC", "0", kNoImage, KZ_TYPE_self_test_reply,
     "image_crc"},
    {"`self_test_reply.start_8states`", "measured", "a constant near the measured value",
     "the image determines the start-up time", KZ_TYPE_self_test_reply, "start_8states"},
    {"a byte that ends 300 to 1,000 states after a tick's due time",
     "received in this tick or the next one", "received in this tick if it ends within 650 states",
     "450 to 850 states after its due time, a tick reads the receive ring; near this time, `kaz mcu "
     "compare` sends no byte"},
    {"a byte that ends between 47,600 and 18,000 states before the first tick",
     "delays the start by 65 states, or is lost",
     "received if it ends in the last 46,940 states before the tick; no delay",
     "the native board models no CPU time; the comparison sends no bytes in this interval"},
    {"first byte of a reply", "320 to 700 states after its tick", "445 states after its tick",
     kNoCpu},
    {"a request that waits for room in the transmit ring",
     "the check for room comes at most 1,100 states after the tick's due time",
     "the check for room comes 665 states after the tick's due time",
     "if a reply of one board comes one tick after the same reply of the other board, the "
     "comparison ends the conversation early"},
    {"start of a requested store or reset",
     "after the computation of the tick that handles the request",
     "5,900 states after the tick's due time",
     "the comparison sends nothing during stores and resets; after a reset, times count from "
     "each board's restart"},
    {"input voltages",
     "`AN4` and `AN5` are sampled at any time; the other inputs are sampled 800 to 7,300 states "
     "after a tick's due time",
     "each input is sampled at most 200 states earlier or later than on `h8`; the order of the "
     "inputs is the order on `h8`",
     "the comparison changes voltages at least 15,000 states after a tick's due time"},
    {"3 s of the loader", "the flash writer receives its own frames", "no receiver",
     "no flash to write"},
    {"a byte that a reset or a power cut interrupts", "the pin shows the byte's first bits",
     "the pin shows no bit", "the comparison ignores this byte"},
};

}  // namespace

std::span<const WireException> wire_differences() {
  return kExceptions;
}

bool mask_wire_differences(std::span<std::uint8_t> body) {
  if (body.size() < KZ_HEADER_SIZE) return false;
  bool masked = false;
  for (const WireException& row : kExceptions) {
    if (row.type == 0 || row.type != body[1]) continue;
    const kz_message_info* info = kz_message_find(row.type);
    std::size_t at = KZ_HEADER_SIZE;
    for (int f = 0; info != nullptr && f < info->field_count; ++f) {
      const kz_field_info& field = info->fields[f];
      const std::size_t size = std::size_t{field.size} * field.count;
      if (std::string_view(field.name) == row.field && at < body.size()) {
        std::fill_n(body.begin() + static_cast<std::ptrdiff_t>(at),
                    std::min(size, body.size() - at), std::uint8_t{0});
        masked = true;
      }
      at += size;
    }
  }
  return masked;
}

}  // namespace kaz::sim
