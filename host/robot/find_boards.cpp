// Searches a line for boards at all 14 addresses.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/find_boards.h"

#include <algorithm>
#include <array>
#include <span>

#include "host/link/port_address.h"
#include "shared/protocol/frame.h"

namespace kaz::host {

namespace {

// Replies are recognised by type and address: with number and length they would be missed where another
// version of the protocol has a longer reply.
class Search {
 public:
  Search(Link& link, Clock& clock) : link_(link), clock_(clock) { kz_receiver_init(&receiver_); }

  Result<void> query(std::uint8_t address) {
    const std::array<std::uint8_t, KZ_HEADER_SIZE> body{address, KZ_TYPE_identify, ++sequence_};
    std::array<std::uint8_t, KZ_FRAME_MAX> frame{};
    const auto length = kz_frame_encode(body.data(), body.size(), frame.data());
    return link_.write(std::span(frame).first(length));
  }

  Result<void> listen(Time until) {
    std::array<std::uint8_t, 256> bytes{};
    while (clock_.now() < until) {
      const auto count = KAZ_TRY(link_.read(bytes, until));
      for (std::size_t i = 0; i < count; ++i) {
        if (kz_receive(&receiver_, bytes[i], 0) == KZ_RECEIVE_FRAME) take();
      }
    }
    return {};
  }

  std::vector<std::uint8_t> found() const {
    std::vector<std::uint8_t> addresses;
    for (std::size_t a = 1; a < there_.size(); ++a) {
      if (there_[a]) addresses.push_back(static_cast<std::uint8_t>(a));
    }
    return addresses;
  }

 private:
  void take() {
    const std::uint8_t address = receiver_.body[0];
    if (receiver_.body[1] == KZ_TYPE_identify_reply && address < there_.size())
      there_[address] = true;
  }

  Link& link_;
  Clock& clock_;
  kz_receiver receiver_{};
  std::uint8_t sequence_ = 0;
  std::array<bool, KZ_ADDRESS_LAST + 1> there_{};
};

}  // namespace

Result<std::vector<std::uint8_t>> find_boards(Link& link, Clock& clock,
                                              const FindOptions& options) {
  Search search(link, clock);
  for (int round = 0; round < options.rounds && search.found().empty(); ++round) {
    for (std::uint8_t address = 1; address <= KZ_ADDRESS_LAST; ++address) {
      KAZ_TRY(search.query(address));
      KAZ_TRY(search.listen(clock.now() + options.each));
    }
    KAZ_TRY(search.listen(clock.now() + options.last));
  }
  return search.found();
}

std::string addresses_text(const std::vector<std::uint8_t>& addresses) {
  std::string text = addresses.size() == 1 ? "address " : "addresses ";
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    if (i > 0) text += i + 1 == addresses.size() ? " and " : ", ";
    text += std::to_string(addresses[i]);
  }
  return text;
}

Error explain_silence(Link& link, Clock& clock, std::uint8_t address, Error error,
                      const std::string& advice) {
  const auto found = find_boards(link, clock);
  if (!found || found->empty()) return error;
  const std::string first = std::to_string(found->front());
  const bool one = found->size() == 1;
  // A late reply.
  if (std::ranges::find(*found, address) != found->end()) return error;
  return {Fault::environment,
          "no board answers at address " + std::to_string(address) + " on " + link.name() +
              ", but " + (one ? "a board answers at " : "boards answer at ") +
              addresses_text(*found) + ": " + advice + first +
              ", or move that board with `kaz recover " + robot_option(link.name()) +
              (one ? "" : " --found-at " + first) +
              (address == KZ_ADDRESS_DEFAULT ? "" : " --address " + std::to_string(address)) + "`"};
}

}  // namespace kaz::host
