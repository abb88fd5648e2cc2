// VCD recorder: signals by name, sampling, and the output file.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/vcd.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <utility>

#include "sim/h8s/chip/observer.h"
#include "sim/h8s/chip/registers.h"
#include "sim/h8s/debug/vcd_writer.h"

namespace kaz::h8s {
namespace {

struct Signal {
  enum class Kind { pin, cpu, io, memory };
  Kind kind = Kind::pin;
  VcdWriter::Variable variable;
  Pin pin = Pin::p10;
  int cpu = 0;  // 0..7 ER, 8 PC, 9 CCR, 10 EXR
  const RegisterInfo* io = nullptr;
  std::uint32_t address = 0;
};

constexpr std::array<std::string_view, 11> kCpuNames{"er0", "er1", "er2", "er3", "er4", "er5",
                                                     "er6", "er7", "pc",  "ccr", "exr"};

Signal cpu_signal(int n) {
  Signal s;
  s.kind = Signal::Kind::cpu;
  s.cpu = n;
  s.variable = {"cpu", std::string(kCpuNames[static_cast<std::size_t>(n)]),
                n < 8    ? 32
                : n == 8 ? 24
                         : 8};
  return s;
}

Signal pin_signal(const PinInfo& p) {
  Signal s;
  s.pin = p.pin;
  std::string name(p.name());
  // With the pin's function as suffix, so that GTKWave's search finds either name.
  if (p.names.size() > 1) name.append("_").append(p.names[1]);
  s.variable = {"pins", name, 1};
  return s;
}

std::string hex6(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%06x", value & 0xffffff);
  return text;
}

// "symbol:16", "0xffe100".
Result<Signal> memory_signal(const Chip& chip, const std::string& name) {
  const std::size_t colon = name.rfind(':');
  const std::string place = name.substr(0, colon);
  int bits = 8;
  if (colon != std::string::npos) {
    const std::string width = name.substr(colon + 1);
    bits = width == "8" ? 8 : width == "16" ? 16 : width == "32" ? 32 : 0;
    if (bits == 0)
      return fail("signal '" + name + "': the width after ':' must be 8, 16 or 32 bits");
  }
  Signal s;
  s.kind = Signal::Kind::memory;
  if (const auto symbol = chip.symbols().address_of(place)) {
    s.address = *symbol;
  } else if (place.starts_with("0x") && place.size() > 2) {
    const auto end = place.data() + place.size();
    const auto parsed = std::from_chars(place.data() + 2, end, s.address, 16);
    if (parsed.ec != std::errc{} || parsed.ptr != end || s.address > 0xffffff)
      return fail("signal '" + name + "': '" + place + "' is not a 24-bit address");
  } else {
    return fail("signal '" + name +
                "': must be a pin (P50, TxD0), a CPU register (er0, pc, ccr), an I/O register "
                "(FRC, SSR0), a symbol of the image, or an address (0xffe100:16)");
  }
  if (!chip.peek(s.address) || !chip.peek(s.address + static_cast<unsigned>(bits / 8 - 1)))
    return fail("signal '" + name + "': no memory or register at " + hex6(s.address));
  std::string shown = place;
  for (char& c : shown) {
    if (c == ' ' || c == '[' || c == ']') c = '_';
  }
  s.variable = {"memory", shown, bits};
  return s;
}

Result<std::vector<Signal>> find_signals(const Chip& chip, const std::vector<std::string>& names) {
  std::vector<Signal> signals;
  for (const std::string& name : names) {
    if (name == "pins") {
      for (const PinInfo& p : pin_table()) signals.push_back(pin_signal(p));
    } else if (name == "cpu") {
      for (int n = 0; n < 11; ++n) signals.push_back(cpu_signal(n));
    } else if (const auto pin = find_pin(name)) {
      signals.push_back(pin_signal(info(*pin)));
    } else if (const auto cpu = std::find(kCpuNames.begin(), kCpuNames.end(),
                                          name == "sp" ? std::string("er7") : name);
               cpu != kCpuNames.end()) {
      signals.push_back(cpu_signal(static_cast<int>(cpu - kCpuNames.begin())));
    } else if (const RegisterInfo* r = find_register(name)) {
      if (r->write_only)
        return fail("signal '" + name +
                    "' is a write-only register; record the port's pins instead");
      Signal s;
      s.kind = Signal::Kind::io;
      s.io = r;
      s.variable = {std::string(r->unit), std::string(r->name), 8 * r->size};
      signals.push_back(s);
    } else {
      auto s = KAZ_TRY(memory_signal(chip, name));
      signals.push_back(s);
    }
  }
  if (signals.empty()) return fail("a recording needs at least one signal, such as P50 or pc");
  return signals;
}

}  // namespace

std::int64_t picoseconds(States at, std::int64_t hertz) {
  __extension__ using Wide = __int128;
  return static_cast<std::int64_t>((Wide{at} * 1'000'000'000'000 + hertz / 2) / hertz);
}

class VcdRecorder::Impl : public Observer {
 public:
  Impl(Chip& chip, std::vector<Signal> signals, std::int64_t hertz)
      : chip_(chip), signals_(std::move(signals)), hertz_(hertz) {}
  ~Impl() override {
    stop();
    if (!temporary_.empty()) std::remove(temporary_.c_str());
  }

  Result<void> open_file(const std::string& path) {
    path_ = path;
    // A new file (O_EXCL), so that a symbolic link planted under that name is not followed.
    int fd = -1;
    for (int n = 0; fd < 0 && n < 100; ++n) {
      temporary_ = path + ".part" + (n > 0 ? std::to_string(n) : "");
      fd = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd < 0 && errno != EEXIST) break;
    }
    if (fd >= 0) {
      ::close(fd);
      file_.open(temporary_, std::ios::binary | std::ios::trunc);
      if (file_) return {};
      std::remove(temporary_.c_str());
    }
    const std::string name = std::exchange(temporary_, {});
    return fail("cannot write " + name + ": check that the folder exists and is writable");
  }
  std::ostream& file() { return file_; }

  void start(std::ostream& to) {
    to_ = &to;
    std::vector<VcdWriter::Variable> variables;
    std::vector<std::string> values;
    for (const Signal& s : signals_) {
      variables.push_back(s.variable);
      values.push_back(s.kind == Signal::Kind::pin ? pin_value(s.pin) : sampled(s));
      if (values.back().empty())
        values.back() = std::string(static_cast<std::size_t>(s.variable.bits), 'x');
    }
    writer_ = std::make_unique<VcdWriter>(to, variables);
    writer_->begin(picoseconds(chip_.now(), hertz_), values);
    bool samples = false;
    for (std::size_t k = 0; k < signals_.size(); ++k) {
      if (signals_[k].kind != Signal::Kind::pin) {
        samples = true;
        continue;
      }
      watches_.push_back(chip_.watch(
          signals_[k].pin,
          [this, k](const PinEdge& e) {
            writer_->change(k, picoseconds(e.at, hertz_), pin_value(e.pin));
          },
          true));
    }
    if (samples) chip_.attach(*this);
    attached_ = samples;
  }

  // Everything up to `at` has happened when this is called.
  void before(std::uint32_t, States at) override { sample(at); }

  Result<void> close() {
    if (to_) sample(chip_.now());
    stop();
    if (!to_) return {};
    writer_->end(picoseconds(chip_.now(), hertz_));
    const bool good = to_->good();
    to_ = nullptr;
    if (temporary_.empty()) {
      if (!good) return fail("the recording cannot be written: its stream reports an error");
      return {};
    }
    file_.close();
    const std::string name = std::exchange(temporary_, {});
    if (!good || !file_ || std::rename(name.c_str(), path_.c_str()) != 0) {
      std::remove(name.c_str());
      return fail("writing the recording " + path_ + " failed: is the disk full?");
    }
    return {};
  }

 private:
  void stop() {
    for (const int id : watches_) chip_.unwatch(id);
    watches_.clear();
    if (attached_) chip_.detach(*this);
    attached_ = false;
  }

  void sample(States at) {
    for (std::size_t k = 0; k < signals_.size(); ++k) {
      if (signals_[k].kind == Signal::Kind::pin) continue;
      const std::string value = sampled(signals_[k]);
      if (!value.empty()) writer_->change(k, picoseconds(at, hertz_), value);
    }
  }

  std::string pin_value(Pin pin) const {
    const PinState s = chip_.state(pin);
    if (s.driver == Driver::clock) return "x";
    if (s.driver == Driver::nobody) return "z";
    return s.level ? "1" : "0";
  }

  // Empty: another register is selected at its address.
  std::string sampled(const Signal& s) const {
    const int bits = s.variable.bits;
    if (s.kind == Signal::Kind::cpu) {
      const Registers r = chip_.registers();
      const std::uint32_t value = s.cpu < 8    ? r.er[static_cast<std::size_t>(s.cpu)]
                                  : s.cpu == 8 ? r.pc
                                  : s.cpu == 9 ? r.ccr
                                               : r.exr;
      return binary(value, bits);
    }
    const auto peek = [this](std::uint32_t a) { return chip_.peek(a); };
    if (s.io && !selected(*s.io, peek)) return {};
    const std::uint32_t first = s.io ? s.io->full_address() : s.address;
    std::uint32_t value = 0;
    for (int k = 0; k < bits / 8; ++k)
      value = value << 8 | chip_.peek(first + static_cast<std::uint32_t>(k)).value_or(0xff);
    return binary(value, bits);
  }

  Chip& chip_;
  std::vector<Signal> signals_;
  std::int64_t hertz_;
  std::string path_, temporary_;
  std::ofstream file_;
  std::ostream* to_ = nullptr;
  std::unique_ptr<VcdWriter> writer_;
  std::vector<int> watches_;
  bool attached_ = false;
};

VcdRecorder::VcdRecorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VcdRecorder::~VcdRecorder() = default;

Result<std::unique_ptr<VcdRecorder>> VcdRecorder::open(Chip& chip,
                                                       const std::vector<std::string>& names,
                                                       const std::string& path,
                                                       std::int64_t hertz) {
  auto signals = KAZ_TRY(find_signals(chip, names));
  auto impl = std::make_unique<Impl>(chip, std::move(signals), hertz);
  KAZ_TRY(impl->open_file(path));
  impl->start(impl->file());
  return std::unique_ptr<VcdRecorder>(new VcdRecorder(std::move(impl)));
}

Result<std::unique_ptr<VcdRecorder>> VcdRecorder::open(Chip& chip,
                                                       const std::vector<std::string>& names,
                                                       std::ostream& to, std::int64_t hertz) {
  auto signals = KAZ_TRY(find_signals(chip, names));
  auto impl = std::make_unique<Impl>(chip, std::move(signals), hertz);
  impl->start(to);
  return std::unique_ptr<VcdRecorder>(new VcdRecorder(std::move(impl)));
}

Result<void> VcdRecorder::close() {
  return impl_->close();
}

}  // namespace kaz::h8s
