// The emulated chip behind the pins of the servo board.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/h8_mcu.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "sim/mcu/h8_layout.h"

namespace kaz::sim {
namespace {

// Levels of the board's pull resistors at pins that the chip does not drive (mcu.h).
constexpr PinLevels kPulled{};

constexpr std::uint32_t kMemoryAt = 0x400;    // EB1
constexpr States kMaxTime = States{1} << 50;  // of a saved state: two years

std::uint8_t level_of(h8s::PortOutput out, std::uint8_t pull) {
  return static_cast<std::uint8_t>((out.level & out.driven) | (pull & ~out.driven));
}

}  // namespace

Result<std::unique_ptr<H8Mcu>> H8Mcu::load(const std::string& image_path,
                                           const h8s::Options& options) {
  auto image = h8s::load_image(image_path);
  if (!image) return fail(Fault::usage, image.error().message);

  h8s::Chip chip(options);
  if (auto loaded = chip.load(*image); !loaded) return fail(Fault::usage, loaded.error().message);
  if (image->symbols.symbols().empty()) {
    const auto beside = std::filesystem::path(image_path).replace_extension(".coff");
    if (std::filesystem::exists(beside)) {
      auto with_symbols = h8s::load_image(beside.string());
      if (!with_symbols) return fail(Fault::usage, with_symbols.error().message);
      chip.set_symbols(with_symbols->symbols);
    }
  }
  return std::unique_ptr<H8Mcu>(new H8Mcu(std::move(chip)));
}

std::unique_ptr<H8Mcu> H8Mcu::erased(const h8s::Options& options) {
  return std::unique_ptr<H8Mcu>(new H8Mcu(h8s::Chip(options)));
}

H8Mcu::H8Mcu(h8s::Chip chip) : chip_(std::move(chip)) {
  const auto& names = chip_.symbols();
  const auto input = names.address_of("kz_input");
  const auto output = names.address_of("kz_output");
  const auto end = names.address_of("kz_tick_end");
  if (input && output && end) symbols_ = TickSymbols{*input, *output, *end};
  connect();
  chip_.power_on();
  read_all_pins();
}

void H8Mcu::connect() {
  using h8s::Port;
  // Pull-ups of the multiplexer selects, pull-downs of everything that could start a motor.
  for (int bit = 0; bit < 8; ++bit) {
    chip_.set_input(Port::p3, bit, (kPulled.p3 >> bit & 1) != 0);
    chip_.set_input(Port::p4, bit, (kPulled.p4 >> bit & 1) != 0);
    chip_.set_input(Port::p6, bit, (kPulled.p6 >> bit & 1) != 0);
  }
  chip_.on_output([this](const h8s::OutputChange& change) { output_changed(change); });
  chip_.on_transmit([this](int sci, const h8s::TransmittedByte& byte) {
    if (sci == 0)
      transmitted_.push_back({byte.value, base_ + byte.end, false, (byte.end - byte.start) / 10});
  });
  chip_.on_watchdog_reset([this](h8s::States at) {
    read_all_pins();
    if (on_pins_) on_pins_(base_ + at, pins_);
    if (on_reset_) on_reset_(base_ + at);
  });
}

Result<void> H8Mcu::run_until(States until) {
  if (wiring_error_) return tl::unexpected(*wiring_error_);
  if (hung_) {
    hung_at_ = std::max(hung_at_, until);
    return {};
  }
  const h8s::Stop stop = chip_.run_until(until - base_);
  if (stop.reason == h8s::Stop::Reason::reached) return {};
  if (on_hang_) {
    hung_at_ = std::max(now(), until);
    hung_ = true;
    on_hang_(stop.report);
    return {};
  }
  return fail(Fault::failed, "the firmware stopped the emulated H8S/2128 at state " +
                                 std::to_string(now()) + ": " + stop.report);
}

// The chip's time did not advance while it was suspended.
void H8Mcu::wake() {
  if (hung_) base_ = hung_at_ - chip_.now();
  hung_ = false;
}

Result<void> H8Mcu::set_boot_pins(bool boot) {
  chip_.set_mode_pins(boot ? 0 : 2);
  return {};
}

void H8Mcu::reset() {
  wake();
  wiring_error_.reset();
  chip_.reset();
  read_all_pins();
  if (on_pins_) on_pins_(now(), pins_);
}

void H8Mcu::power_cycle() {
  wake();
  wiring_error_.reset();
  transmitted_.clear();
  base_ += chip_.now();
  chip_.power_on();
  read_all_pins();
  if (on_pins_) on_pins_(now(), pins_);
}

std::array<std::uint8_t, Mcu::kMemorySize> H8Mcu::memory() const {
  std::array<std::uint8_t, kMemorySize> bytes{};
  chip_.peek(kMemoryAt, bytes);  // cannot fail: it is flash
  return bytes;
}

void H8Mcu::set_memory(std::span<const std::uint8_t, kMemorySize> bytes) {
  chip_.poke(kMemoryAt, bytes);
}

void H8Mcu::save(StateWriter& to) {
  if (wiring_error_) return to.refuse("the chip has stopped: " + wiring_error_->message);
  to(base_, transmitted_, pins_, hung_, hung_at_);
  chip_.write_state(to);
}

void H8Mcu::restore(StateReader& from) {
  wiring_error_.reset();
  from(base_, transmitted_, pins_, hung_, hung_at_);
  chip_.read_state(from);
  from.require(base_ >= 0 && base_ <= kMaxTime && hung_at_ >= 0 && hung_at_ <= kMaxTime, "time");
  if (from.good()) return;
  base_ = 0;
  hung_ = false;
  transmitted_.clear();
  chip_.power_on();
  read_all_pins();
}

namespace {

struct KeptChip final : Mcu::Kept {
  explicit KeptChip(std::shared_ptr<const h8s::Chip> saved) : chip(std::move(saved)) {}
  std::shared_ptr<const h8s::Chip> chip;
};

}  // namespace

std::unique_ptr<const Mcu::Kept> H8Mcu::keep(StateWriter& to) {
  if (wiring_error_) {
    to.refuse("the chip has stopped: " + wiring_error_->message);
    return nullptr;
  }
  to(base_, transmitted_, pins_, hung_, hung_at_);
  return std::make_unique<KeptChip>(chip_.save());
}

void H8Mcu::take(StateReader& from, const Kept* kept) {
  const auto* const chip = dynamic_cast<const KeptChip*>(kept);
  if (chip == nullptr) return from.refuse("it belongs to another engine");
  wiring_error_.reset();
  from(base_, transmitted_, pins_, hung_, hung_at_);
  chip_.restore(*chip->chip);
}

void H8Mcu::on_pins(std::function<void(States, const PinLevels&)> listener) {
  on_pins_ = std::move(listener);
}

void H8Mcu::set_analog(AnalogSource source) {
  chip_.set_analog(
      [this, source = std::move(source)](int channel, h8s::States at) {
        return channel < 8 ? source(channel, pins_, base_ + at) : 0.0;
      },
      true);
}

void H8Mcu::receive(const SerialByte& byte) {
  if (hung_) return;
  h8s::ReceivedByte received;
  received.value = byte.value;
  received.at = byte.at - base_;
  received.framing_error = byte.framing_error;
  received.bit_states = byte.bit_states;
  if (auto taken = chip_.receive(0, received); !taken && !wiring_error_)
    wiring_error_ = Error{Fault::failed, taken.error().message};
}

std::vector<SerialByte> H8Mcu::take_transmitted() {
  std::vector<SerialByte> taken = std::exchange(transmitted_, {});
  transmitted_.reserve(taken.size());  // as many come again, mostly
  return taken;
}

void H8Mcu::on_tick(std::function<void(const TickRecord&)> listener) {
  on_tick_ = std::move(listener);
  if (!symbols_) return;
  if (!on_tick_) return chip_.clear_hook(symbols_->end);
  chip_.set_hook(symbols_->end, [this](h8s::Chip&) {
    tick_ended();
    return h8s::HookAction::go_on;
  });
}

void H8Mcu::tick_ended() {
  std::array<std::uint8_t, h8_layout::kInputSize> input{};
  std::array<std::uint8_t, h8_layout::kOutputSize> output{};
  if (!chip_.peek(symbols_->input, input) || !chip_.peek(symbols_->output, output)) return;
  on_tick_({h8_layout::decode_input(input), h8_layout::decode_output(output)});
}

std::vector<std::uint8_t> H8Mcu::global(std::string_view symbol, std::size_t size) const {
  const auto address = chip_.symbols().address_of(symbol);
  std::vector<std::uint8_t> bytes(size);
  if (!address || !chip_.peek(*address, bytes)) bytes.clear();
  return bytes;
}

void H8Mcu::output_changed(const h8s::OutputChange& change) {
  std::optional<PinLevels> before;
  if (on_pins_) before = pins_;
  switch (change.unit) {
    case h8s::OutputChange::Unit::port:
      read_port(static_cast<h8s::Port>(change.index));
      break;
    case h8s::OutputChange::Unit::pwm:
      if (change.index >= 0) {
        read_pwm(change.index);
      } else {
        for (int channel = 0; channel < 16; ++channel) read_pwm(channel);
      }
      break;
    case h8s::OutputChange::Unit::timer:
      read_timer(change.index);
      break;
    case h8s::OutputChange::Unit::serial:  // bytes are reported when they end
      return;
  }
  if (before && pins_ != *before) on_pins_(base_ + change.at, pins_);
}

void H8Mcu::read_all_pins() {
  using h8s::Port;
  for (const Port port : {Port::p3, Port::p4, Port::p5, Port::p6}) read_port(port);
  for (int channel = 0; channel < 16; ++channel) read_pwm(channel);
  for (int timer = 0; timer < 2; ++timer) read_timer(timer);
}

void H8Mcu::read_port(h8s::Port port) {
  const auto out = chip_.output(port);
  switch (port) {
    case h8s::Port::p1:
    case h8s::Port::p2:
      // A PWM pin may also be driven as a plain port.
      for (int bit = 0; bit < 8; ++bit) read_pwm(port == h8s::Port::p1 ? bit : 8 + bit);
      break;
    case h8s::Port::p3:
      pins_.p3 = level_of(out, kPulled.p3);
      break;
    case h8s::Port::p4:
      pins_.p4 = level_of(out, kPulled.p4);
      break;
    case h8s::Port::p5:
      // P50 and P51 are the serial line, which mcu.h gives its own functions.
      pins_.p5 = static_cast<std::uint8_t>(level_of(out, kPulled.p5) & ~0x03);
      break;
    case h8s::Port::p6:
      // P64 and P67 are TMO0 and TMO1.
      pins_.p6 = static_cast<std::uint8_t>(level_of(out, kPulled.p6) & ~0x90);
      for (int timer = 0; timer < 2; ++timer) read_timer(timer);
      break;
    case h8s::Port::p7:
      break;
  }
}

void H8Mcu::read_pwm(int channel) {
  pins_.pw[static_cast<std::size_t>(channel)] =
      static_cast<std::uint16_t>(chip_.pw_high_counts(channel));  // 0 where it is not driven
}

void H8Mcu::read_timer(int timer) {
  pins_.tmo[static_cast<std::size_t>(timer)] =
      chip_.tmo_driven(timer)
          ? static_cast<std::uint16_t>(std::lround(256.0 * chip_.tmo_high_share(timer)))
          : 0;
}

Result<std::unique_ptr<Mcu>> make_h8(const std::string& image_path) {
  auto mcu = KAZ_TRY(H8Mcu::load(image_path));
  return std::unique_ptr<Mcu>(std::move(mcu));
}

std::unique_ptr<Mcu> make_erased_h8() {
  return H8Mcu::erased();
}

}  // namespace kaz::sim
