// The first exchange with a board, and what is wrong when it fails.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/connect.h"

#include <algorithm>
#include <cstdio>

#include "shared/protocol/messages.h"

namespace kaz::host {

namespace {

// Where servos may be at the port instead of a board: what to type for them.
std::string for_servos(const std::string& port) {
  if (port.starts_with("can:") || port.starts_with("tcp:")) return "";
  return "; for a servo bus use `kaz bus status --robot feetech:" + port + "`";
}

// Place of the protocol version in identify_reply, behind the tick. The same in every version, so
// that a program recognises a board of another one.
constexpr std::size_t kVersionAt = 4;

Error no_board(const Exchanger& requester, const LinkStatistics& before, const std::string& port) {
  const LinkStatistics& statistics = requester.statistics();
  const auto bytes_in = statistics.bytes_in - before.bytes_in;
  if (requester.heard_echo()) {
    return {Fault::environment, port +
                                    " echoes the bytes written to it, and no board answers: check "
                                    "for a loop-back plug or a modem in echo mode" +
                                    for_servos(port)};
  }
  if (bytes_in == 0) {
    return {Fault::environment,
            "no board answers on " + port +
                ": check that the robot is powered, the cable is plugged in, no other program has "
                "the port open, and the baud rate is the board's (115200). After an interrupted "
                "update, the board waits in its loader: run `kaz flash write`" +
                for_servos(port)};
  }
  if (statistics.ignored > before.ignored) {
    return {Fault::environment,
            "a Kaz board answers on " + port + ", but no board has the requested address"};
  }
  const auto noise = requester.noise();
  const std::string came = std::to_string(bytes_in) + " bytes came, but no reply";
  const auto zero = [](std::uint8_t byte) { return byte == 0; };
  if (!noise.empty() && std::all_of(noise.begin(), noise.end(), zero)) {
    return {Fault::environment,
            port + ": " + came +
                ", and all bytes are zero; a chip in boot mode answers with zeros, for example "
                "after an interrupted update: run `kaz flash write`"};
  }
  return {Fault::environment, "the device on " + port +
                                  " is not a Kaz board, or its baud rate differs from the "
                                  "port's: " +
                                  came + (noise.empty() ? "" : ": " + hex(noise, 16))};
}

}  // namespace

Result<kz_identify_reply> identify_board(Exchanger& requester) {
  const LinkStatistics before = requester.statistics();
  Request request;
  request.type = KZ_TYPE_identify;
  const auto replies = requester.exchange({&request, 1});
  if (!replies) {
    return tl::unexpected(requester.timed_out()
                              ? no_board(requester, before, requester.failed_name())
                              : replies.error());
  }
  const std::string port = requester.link().name();

  const Reply& reply = replies->front();
  const int version = reply.fields.length > kVersionAt ? reply.fields.bytes[kVersionAt] : -1;
  kz_identify_reply identity{};
  const bool whole =
      kz_unpack_identify_reply(&identity, reply.fields.bytes.data(), reply.fields.length);
  const bool spoken = version >= KZ_PROTOCOL_VERSION_OLDEST && version <= KZ_PROTOCOL_VERSION;
  if (reply.refused || version < 0 || (spoken && !whole)) {
    return fail(Fault::environment,
                "the device on " + port +
                    " sends frames like a Kaz board, but no valid reply to `identify`: " +
                    hex({reply.fields.bytes.data(), reply.fields.length}, 16));
  }
  if (!spoken) {
    return fail(
        Fault::environment,
        "the board on " + port + " speaks protocol version " + std::to_string(version) +
            ", but this program accepts versions " + std::to_string(KZ_PROTOCOL_VERSION_OLDEST) +
            " and " + std::to_string(KZ_PROTOCOL_VERSION) +
            ": flash the firmware of this release, or use the program of the board's release");
  }
  if (identity.joints != KZ_JOINTS) {
    return fail(Fault::environment, "the board on " + port + " drives " +
                                        std::to_string(identity.joints) + " joints, but Kaz has " +
                                        std::to_string(KZ_JOINTS) +
                                        ": this is another robot's board");
  }
  return identity;
}

std::string firmware_version_text(std::uint16_t version) {
  return std::to_string(version >> 8) + "." + std::to_string(version & 0xFF);
}

std::string build_text(std::uint32_t build_id) {
  char text[16];
  std::snprintf(text, sizeof text, "%08x", static_cast<unsigned>(build_id));
  return text;
}

std::string board_text(const kz_identify_reply& identity) {
  return "Kaz servo board, protocol " + std::to_string(identity.protocol_version) + ", firmware " +
         firmware_version_text(identity.firmware_version) + ", build " +
         build_text(identity.build_id);
}

std::string firmware_fault(const kz_identify_reply& identity) {
  constexpr int kStopsAlways = 3;  // protocol version
  if (identity.protocol_version >= kStopsAlways) return "";
  return "the firmware (protocol " + std::to_string(identity.protocol_version) +
         ") can acknowledge a repeated stop request without switching the motors off; flash the "
         "firmware of this release";
}

}  // namespace kaz::host
