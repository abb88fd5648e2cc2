// Events, one after the other, with a judge at the line.
// SPDX-License-Identifier: Apache-2.0
#include "hil/fuzz/runner.h"

#include <algorithm>
#include <array>

#include "hil/fuzz/requests.h"
#include "shared/board/board.h"

namespace kaz::hil::fuzz {
namespace {

using std::chrono::milliseconds;

constexpr Time kByte = std::chrono::nanoseconds(10'000'000'000 / KZ_BAUD);  // 8N1

class Run {
 public:
  Run(host::Link& link, host::Clock& clock, const RunnerOptions& options)
      : link_(link), clock_(clock), options_(options), conversation_(options.address) {}

  Result<CaseVerdict> go(std::span<const Event> events) {
    const Time began = clock_.now();
    const auto ran = run(events);
    CaseVerdict verdict{violation(), conversation_.features(), conversation_.counts(),
                        seconds(clock_.now() - began)};
    if (ran) return verdict;
    verdict.violation.reset();
    if (options_.broken_off != nullptr) *options_.broken_off = verdict;
    return tl::unexpected(ran.error());
  }

 private:
  Result<void> run(std::span<const Event> events) {
    KAZ_TRY(wake());
    for (const Event& event : events) {
      KAZ_TRY(act(event));
      if (violation()) break;
    }
    return violation() ? Result<void>() : end();
  }

  std::optional<std::string> violation() const {
    if (violation_) return violation_;
    if (conversation_.violation()) return conversation_.violation();
    return options_.judge ? options_.judge() : std::nullopt;
  }

  Result<void> send(std::span<const std::uint8_t> bytes) {
    conversation_.sent(bytes);
    const Time length = kByte * static_cast<Time::rep>(bytes.size());
    line_busy_until_ = std::max(line_busy_until_, clock_.now()) + length;
    if (conversation_.take_deafening()) deaf_until_ = line_busy_until_ + std::chrono::seconds(4);
    return link_.write(bytes);
  }

  // Listens until `until`, or until the request has its reply.
  Result<void> listen(Time until, int type = -1, std::uint8_t sequence = 0) {
    std::array<std::uint8_t, 256> bytes{};
    while (clock_.now() < until) {
      const auto got = KAZ_TRY(link_.read(bytes, until));
      conversation_.received(std::span(bytes).first(got));
      if (type >= 0 && conversation_.replies_to(static_cast<std::uint8_t>(type), sequence) > 0)
        return {};
    }
    return {};
  }

  // True once the board has answered.
  Result<bool> query(u8 type, std::uint8_t sequence, const std::vector<std::uint8_t>& wire) {
    KAZ_TRY(send(wire));
    KAZ_TRY(listen(clock_.now() + options_.patience, type, sequence));
    return conversation_.replies_to(type, sequence) > 0;
  }

  Result<bool> known(u8 type, const std::vector<std::uint8_t>& fields = {}) {
    --own_sequence_;
    return query(type, own_sequence_, framed(options_.address, type, own_sequence_, fields));
  }

  // `identify` until it is answered.
  Result<bool> alive(Time within) {
    const Time until = clock_.now() + within;
    while (clock_.now() < until) {
      auto answered = known(KZ_TYPE_identify);
      if (!answered || *answered || violation()) return answered;
    }
    return false;
  }

  Result<void> wake() {
    const auto awake = KAZ_TRY(alive(options_.longest_start));
    if (!awake && !violation())
      return fail(Fault::environment,
                  "no board answers on " + link_.name() +
                      ": check that the board is connected and powered, and that no other "
                      "program uses the port");
    return {};
  }

  Result<void> act(const Event& event) {
    switch (event.kind) {
      case Event::Kind::send:
        return send(event.bytes);
      case Event::Kind::wait:
        return listen(clock_.now() + milliseconds(event.ms));
      case Event::Kind::fault:
        return begin_fault(event.fault);
      case Event::Kind::query:
        return lonely(event);
    }
    return {};
  }

  Result<void> begin_fault(faults::Fault fault) {
    if (faults::kind_of(fault.name).target == faults::Target::line) {
      faulty_ = true;
      conversation_.line_is_faulty();
    }
    if (fault.name == faults::Name::power_reset || fault.name == faults::Name::power_brown_out) {
      conversation_.board_restarted();
      const Time length = fault.length == faults::kForEver ? Time::zero() : fault.length;
      deaf_until_ = std::max(deaf_until_, clock_.now() + length + std::chrono::seconds(1));
    }
    fault.at = clock_.now();
    if (options_.fault) options_.fault(fault);
    return {};
  }

  // When earlier requests have arrived and been answered: two replies of 10 ms, and telemetry between.
  Time quiet() const { return std::max(line_busy_until_, clock_.now()) + milliseconds(60); }

  Result<void> lonely(const Event& event) {
    if (auto done = listen(quiet()); !done) return done;
    const std::uint8_t type = type_of(event.bytes), sequence = sequence_of(event.bytes);
    const bool due = !faulty_ && clock_.now() >= deaf_until_;
    const auto answered = KAZ_TRY(query(type, sequence, event.bytes));
    if (due && !answered && clock_.now() >= deaf_until_ && !violation())
      violation_ = std::string("no reply to a request sent alone: ").append(event.text);
    return {};
  }

  // The header, out of a frame whose stuffing is undone by the receiver.
  static std::array<std::uint8_t, 3> header(std::span<const std::uint8_t> wire) {
    kz_receiver receiver;
    kz_receiver_init(&receiver);
    std::array<std::uint8_t, 3> found{};
    for (const std::uint8_t byte : wire) {
      if (kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME)
        std::copy_n(receiver.body, 3, found.begin());
    }
    return found;
  }
  static std::uint8_t type_of(std::span<const std::uint8_t> wire) { return header(wire)[1]; }
  static std::uint8_t sequence_of(std::span<const std::uint8_t> wire) { return header(wire)[2]; }

  // Whatever happened, the board answers again, and `stop` switches its motors off. A board at a port
  // goes on to the next case, whose judge knows nothing of telemetry subscribed in this one.
  Result<void> end() {
    if (auto done = listen(quiet()); !done) return done;
    const auto back = KAZ_TRY(
        alive(std::max(deaf_until_ - clock_.now(), Time::zero()) + std::chrono::seconds(1)));
    // With a new address it would be silent, and on a faulty line nothing is certain.
    if (!back && !faulty_ && deaf_until_ == Time{} && !violation())
      violation_ = "the board does not answer any more";
    if (back && !violation()) {
      const auto stopped = KAZ_TRY(known(KZ_TYPE_stop));
      if (!stopped && !faulty_ && !violation()) violation_ = "`stop` is not answered";
      if (auto quiet = known(KZ_TYPE_telemetry, {0, 0, 0}); !quiet)
        return tl::unexpected(quiet.error());
    }
    return {};
  }

  host::Link& link_;
  host::Clock& clock_;
  const RunnerOptions& options_;
  Conversation conversation_;
  std::optional<std::string> violation_;
  Time deaf_until_{};
  Time line_busy_until_{};  // bytes written before have passed the line by then
  bool faulty_ = false;
  std::uint8_t own_sequence_ = 0;  // counts down, the grammar's up
};

}  // namespace

Result<CaseVerdict> run_case(host::Link& link, host::Clock& clock, std::span<const Event> events,
                             const RunnerOptions& options) {
  return Run(link, clock, options).go(events);
}

}  // namespace kaz::hil::fuzz
