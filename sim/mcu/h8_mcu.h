// The `h8` engine executes the firmware image in the emulator and gives tests and tools access to the chip.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/h8s/chip/chip.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

class H8Mcu final : public Mcu {
 public:
  // Like make_h8(), but with options of the emulator.
  static Result<std::unique_ptr<H8Mcu>> load(const std::string& image_path,
                                             const h8s::Options& options = {});

  // Like make_erased_h8(), but with options of the emulator.
  static std::unique_ptr<H8Mcu> erased(const h8s::Options& options = {});

  std::string name() const override { return to_string(McuKind::h8); }
  std::string emulator_engine() const override { return h8s::name_of(chip_.engine()); }
  States now() const override { return hung_ ? hung_at_ : base_ + chip_.now(); }
  Result<void> run_until(States until) override;
  void reset() override;
  void power_cycle() override;
  Result<void> set_boot_pins(bool boot) override;
  bool in_boot_rom() const override { return chip_.in_boot_rom(); }
  void on_hang(std::function<void(const std::string&)> listener) override {
    on_hang_ = std::move(listener);
  }
  std::array<std::uint8_t, kMemorySize> memory() const override;
  void set_memory(std::span<const std::uint8_t, kMemorySize> bytes) override;
  const PinLevels& pins() const override { return pins_; }
  void on_pins(std::function<void(States, const PinLevels&)> listener) override;
  void set_analog(AnalogSource source) override;
  void receive(const SerialByte& byte) override;
  std::vector<SerialByte> take_transmitted() override;
  void on_tick(std::function<void(const TickRecord&)> listener) override;
  void on_watchdog_reset(std::function<void(States)> listener) override {
    on_reset_ = std::move(listener);
  }

  void save(StateWriter& to) override;
  void restore(StateReader& from) override;
  std::unique_ptr<const Kept> keep(StateWriter& to) override;
  void take(StateReader& from, const Kept* kept) override;

  h8s::Chip& chip() { return chip_; }
  const h8s::Chip& chip() const { return chip_; }

  // Returns whether the image has the symbols that on_tick() needs: kz_input, kz_output, kz_tick_end.
  bool has_tick_symbols() const { return symbols_.has_value(); }
  // Returns the first `size` bytes of the image's global variable `symbol`; empty if the symbol is unknown.
  std::vector<std::uint8_t> global(std::string_view symbol, std::size_t size) const;

 private:
  struct TickSymbols {
    std::uint32_t input, output, end;
  };

  explicit H8Mcu(h8s::Chip chip);
  void connect();
  void wake();
  void output_changed(const h8s::OutputChange& change);
  void read_all_pins();
  void read_port(h8s::Port port);
  void read_pwm(int channel);
  void read_timer(int timer);
  void tick_ended();

  h8s::Chip chip_;
  States base_ = 0;  // board time minus chip time; the chip time is 0 at power-on
  bool hung_ = false;
  States hung_at_ = 0;
  PinLevels pins_;
  std::optional<TickSymbols> symbols_;
  std::vector<SerialByte> transmitted_;
  std::optional<Error> wiring_error_;
  std::function<void(States, const PinLevels&)> on_pins_;
  std::function<void(const TickRecord&)> on_tick_;
  std::function<void(States)> on_reset_;
  std::function<void(const std::string&)> on_hang_;
};

}  // namespace kaz::sim
