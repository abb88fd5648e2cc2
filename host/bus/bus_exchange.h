// Sends requests on a half-duplex bus and receives the answers, one at a time.
// SPDX-License-Identifier: Apache-2.0
//
// The template parameter Wire defines the packets. Its members are the types Packet and Reader, and the
// functions wire_of(packet), answers(packet, parameters) and is_to_all(packet). A Packet has the members `id`
// and `parameters` and can be compared. The function answers() returns whether a packet is a valid answer.
// `parameters` is the number of parameters in an answer without an error. The function is_to_all() returns
// whether a packet is a request to all servos.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/bus/bus_driver.h"
#include "host/link/drain.h"

namespace kaz::host {

template <class Wire>
class BusExchange {
 public:
  using Packet = typename Wire::Packet;
  using Answer = std::optional<Packet>;
  // Timeout of an answer. The timeout is longer than the delay of an adapter without low-latency mode.
  static constexpr Time kAnswerWithin = std::chrono::milliseconds(30);
  // Maximum number of transmissions of a request in query().
  static constexpr int kTries = 2;

  BusExchange(Link& link, Clock& clock) : link_(link), clock_(clock) {}

  // Discards bytes that arrived earlier, and sends a request. If the link cannot be read or does not become
  // silent, still sends the request, and then returns the error. Reason: the request may switch torque off.
  Result<void> send(const Packet& request) {
    const auto drained = drain(link_, clock_);
    come_.clear();
    reader_.reset();
    ++counts_.requests;
    KAZ_TRY(link_.write(Wire::wire_of(request)));
    return drained;
  }

  // Returns nullopt if the answer is late, damaged, or from another servo. Some adapters echo requests: skips
  // the request itself, and earlier requests to all servos.
  Result<Answer> receive(std::uint8_t id, std::size_t parameters, const Packet& request) {
    const Time deadline = clock_.now() + kAnswerWithin;
    std::array<std::uint8_t, 256> bytes{};
    while (true) {
      for (std::size_t i = 0; i < come_.size(); ++i) {
        const auto event = reader_.take(come_[i]);
        if (event == Wire::Reader::Event::none) continue;
        if (event != Wire::Reader::Event::packet) {
          come_.clear();
          ++counts_.damaged;
          return Answer();
        }
        const Packet packet = reader_.packet();
        if (packet == request || Wire::is_to_all(packet)) continue;
        come_.erase(come_.begin(), come_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        if (packet.id == id && Wire::answers(packet, parameters)) return Answer(packet);
        ++counts_.damaged;
        return Answer();
      }
      come_.clear();
      if (clock_.now() >= deadline) return Answer();
      const std::size_t count = KAZ_TRY(link_.read(bytes, deadline));
      come_.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    }
  }

  // Sends a request and receives its answer, with retries. Returns nullopt if no try succeeds.
  Result<Answer> query(const Packet& request, std::size_t parameters) {
    for (int i = 0; i < kTries; ++i) {
      KAZ_TRY(send(request));
      auto answer = KAZ_TRY(receive(request.id, parameters, request));
      if (answer) return answer;
    }
    ++counts_.missing;
    return Answer();
  }

  // If `together` is not empty, first sends `together` as a single request to all servos. Then sends a
  // separate request to each servo that has not answered yet. The function `read_one` returns the separate
  // request for a servo.
  template <class ReadOne>
  Result<std::vector<Answer>> query_all(BusDriver::Servos servos, const Answer& together,
                                        std::size_t parameters, ReadOne read_one) {
    std::vector<Answer> answers(servos.size());
    if (together && !servos.empty()) {
      KAZ_TRY(send(*together));
      for (std::size_t i = 0; i < servos.size(); ++i) {
        answers[i] =
            KAZ_TRY(receive(static_cast<std::uint8_t>(servos[i]->id), parameters, *together));
        // After one missing answer, the next answers may be missing, too. So the remaining servos are queried
        // one by one.
        if (!answers[i]) break;
      }
    }
    for (std::size_t i = 0; i < servos.size(); ++i) {
      if (!answers[i]) answers[i] = KAZ_TRY(query(read_one(*servos[i]), parameters));
    }
    return answers;
  }

  const BusDriver::Counts& counts() const { return counts_; }

 private:
  Link& link_;
  Clock& clock_;
  typename Wire::Reader reader_;
  std::vector<std::uint8_t> come_;  // bytes that were received, but not parsed yet
  BusDriver::Counts counts_;
};

}  // namespace kaz::host
