// A link that modifies frames from the board: decodes them, changes them, and encodes them with a valid CRC.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "host/link/link.h"
#include "shared/protocol/messages.h"

namespace kaz::hil {

class RewritingLink final : public host::Link {
 public:
  // Address, type, sequence number, fields. An empty body drops the frame.
  using Body = std::vector<std::uint8_t>;
  using Change = std::function<void(Body&)>;
  // `link` must outlive this object.
  RewritingLink(host::Link& link, Change change);

  std::string name() const override { return link_.name(); }
  Time byte_time() const override { return link_.byte_time(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override { return link_.write(bytes); }
  // Returns a frame as a whole, after its last byte has arrived. Drops invalid frames.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

 private:
  void take(std::uint8_t byte);

  host::Link& link_;
  Change change_;
  kz_receiver receiver_{};
  std::deque<std::uint8_t> changed_;
};

// Returns a change of the fields of one message type.
template <class Message>
RewritingLink::Change change_of(std::uint8_t type, u8 (*unpack)(Message*, const u8*, u8),
                                u8 (*pack)(const Message*, u8*),
                                std::function<void(Message&)> change) {
  return [=](RewritingLink::Body& body) {
    if (body[1] != type) return;
    Message message{};
    if (!unpack(&message, body.data() + KZ_HEADER_SIZE,
                static_cast<u8>(body.size() - KZ_HEADER_SIZE))) {
      return;
    }
    change(message);
    pack(&message, body.data() + KZ_HEADER_SIZE);
  };
}

}  // namespace kaz::hil
