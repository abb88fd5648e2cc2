// The boot ROM's steps: bit rate, program, erase check, start.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/boot.h"

#include <algorithm>
#include <bit>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

constexpr States kPoll = 32;         // its loops look at the channel so often
constexpr States kCheckPerWord = 8;  // reading the flash: 8 states a word
constexpr std::uint32_t kWords = kFlashSize / 2;
constexpr double kPulseUs = 10'000, kAroundPulseUs = 240, kVerifyWordUs = 3;
// RAM that the boot ROM uses (2148A manual, boot mode): its contents are undefined afterwards.
constexpr std::uint32_t kOwnRam = kBlock + 0x0880, kOwnRamEnd = kBlock + kRam + kRamSize;
constexpr std::uint32_t kOwnShortRam = kBlock + kShortRam,
                        kOwnShortRamEnd = kOwnShortRam + kShortRamSize;
constexpr std::uint32_t kFirstRam = kBlock + kRam;
// A mask: the first bytes of the program, '@' FE "df2128".
constexpr std::uint8_t kId[] = {0x40, 0xfe, 0x64, 0x66, 0x32, 0x31, 0x32, 0x38};

struct Rate {
  std::int64_t baud, min_hz, max_hz;
};
constexpr Rate kRates[] = {
    {9600, 8'000'000, 20'000'000}, {4800, 4'000'000, 20'000'000}, {2400, 2'000'000, 18'000'000}};
constexpr Rate kRatesOfA[] = {
    {19200, 8'000'000, 20'000'000}, {9600, 4'000'000, 20'000'000}, {4800, 2'000'000, 18'000'000}};

unsigned channel(const Machine& m) {
  return m.options.boot_channel == 1 ? 1 : 0;
}

Source source_of(unsigned n) {
  return n == 0 ? Source::sci0 : Source::sci1;
}

States states(const Machine& m, double us) {
  return static_cast<States>(us * static_cast<double>(m.options.clock_hz) / 1e6);
}

// Whether a measured bit rate is within 1/20 of one in the manual's table.
bool allowed(const Machine& m, States bit) {
  const auto fits = [&](const Rate& rate) {
    const States nominal = m.options.clock_hz / rate.baud;
    return std::abs(bit - nominal) * 20 <= nominal && m.options.clock_hz >= rate.min_hz &&
           m.options.clock_hz <= rate.max_hz;
  };
  return m.options.boot_a_mask_rates ? std::ranges::any_of(kRatesOfA, fits)
                                     : std::ranges::any_of(kRates, fits);
}

}  // namespace

void BootRom::enter(Machine& m, States at) {
  *this = {};
  step_ = Step::measure;
  const unsigned n = channel(m);
  m.system.mstpcr =
      static_cast<std::uint16_t>(m.system.mstpcr & ~(1u << (n == 0 ? kStopSci0 : kStopSci1)));
  std::uint32_t mess = 0x2128;
  const auto fill = [&](std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t a = from; a < to; ++a) {
      mess = mess * 1103515245u + 12345u;
      *m.memory_at(a) = static_cast<std::uint8_t>(mess >> 16);
    }
  };
  fill(kOwnRam, kOwnRamEnd);
  fill(kOwnShortRam, kOwnShortRamEnd);
  low_since_ = kNever;
  (void)at;
}

bool BootRom::is_possible() const {
  const bool loads = step_ != Step::load ||
                     (stored_ < expected_ && expected_ <= kBlock + kRam + kRamSize - kFirstRam);
  const unsigned blocks = FlashControl::kBlockCount + (pulse_from_ == kNever ? 1 : 0);
  return loads && block_ < blocks && wake_ >= 0 && sending_ >= -1 && sending_ <= 0xff &&
         answers_ >= 0 && answers_ <= 2;
}

void BootRom::leave(Machine& m, States at) {
  if (step_ == Step::erase && pulse_from_ != kNever && at > pulse_from_) {
    const double done =
        static_cast<double>(at - pulse_from_) / static_cast<double>(states(m, kPulseUs));
    if (done < 1) m.flash_control.erase_block(m, block_, done);
  }
  *this = {};
}

void BootRom::edge(Machine& m, bool level, States at) {
  if (!level) {
    low_since_ = at;
  } else if (low_since_ != kNever) {
    measured(m, at - low_since_, at);
    low_since_ = kNever;
  }
}

// The first low interval of a whole byte: the start bit and the zero bits after it.
void BootRom::heard(Machine& m, const ReceivedByte& byte) {
  if (byte.bit_states <= 0) return;
  const int zeros = byte.value == 0 ? 8 : std::countr_zero(byte.value);
  measured(m, (1 + zeros) * byte.bit_states, byte.at);
}

void BootRom::measured(Machine& m, States low, States at) {
  const States bit = low / 9;
  if (!allowed(m, bit)) {
    m.misuse(io::BRR0, "boot mode: the measured low time matches no allowed bit rate");
    return;
  }
  const unsigned n = channel(m);
  const States unit = 9 * 32;
  const auto brr =
      static_cast<std::uint8_t>(std::clamp<States>((low + unit / 2) / unit, 1, 256) - 1);
  m.sci[n].write(m, n, Sci::kSmr, 0, at);
  m.sci[n].write(m, n, Sci::kBrr, brr, at);
  m.sci[n].write(m, n, Sci::kScr, SCR::TE | SCR::RE, at);
  m.rescheduled(source_of(n));
  step_ = Step::greet;
  sending_ = 0x00;
  wake_ = at + m.sci[n].bit_states();
  m.rescheduled(Source::boot);
}

void BootRom::halt(std::uint8_t answer) {
  sending_ = answer;
  step_ = Step::halted;
}

void BootRom::take(Machine& m, std::uint8_t byte, States) {
  const Options& o = m.options;
  switch (step_) {
    case Step::match:
      // The host may still be sending its H'00.
      if (byte != 0x55) return;
      step_ = Step::count_high;
      if (o.boot_acknowledges) sending_ = 0xaa;
      return;
    case Step::count_high:
      expected_ = static_cast<std::uint32_t>(byte) << 8;
      sending_ = byte;
      step_ = Step::count_low;
      return;
    case Step::count_low:
      expected_ |= byte;
      sending_ = byte;
      stored_ = 0;
      step_ = Step::load;
      if (expected_ == 0 || expected_ > static_cast<std::uint32_t>(o.boot_program_bytes))
        halt(0xff);
      return;
    case Step::load: {
      const std::uint32_t at = kFirstRam + stored_++;
      *m.memory_at(at) = byte;
      m.forget_code_at(at);
      sending_ = byte;
      if (stored_ == expected_) step_ = Step::check;
      return;
    }
    default:
      return;
  }
}

// Polls the channel once.
void BootRom::poll(Machine& m, States at) {
  const unsigned n = channel(m);
  Sci& sci = m.sci[n];
  const std::uint8_t flags = sci.read(m, n, Sci::kSsr, at);
  wake_ = at + kPoll;
  if (sending_ >= 0) {
    if (!(flags & SSR::TDRE)) return;
    sci.write(m, n, Sci::kTdr, static_cast<std::uint8_t>(sending_), at);
    sci.write(m, n, Sci::kSsr, flags & ~SSR::TDRE, at);
    sending_ = -1;
    if (step_ == Step::greet) step_ = Step::match;
    return;
  }
  const bool quiet = (flags & SSR::TEND) != 0;
  switch (step_) {
    case Step::match:
      // Listening began in the middle of a byte.
      if (flags & Sci::kErrors) sci.write(m, n, Sci::kSsr, flags & ~(Sci::kErrors | SSR::RDRF), at);
      [[fallthrough]];
    case Step::count_high:
    case Step::count_low:
    case Step::load:
      if (!(flags & SSR::RDRF)) return;
      sci.write(m, n, Sci::kSsr, flags & ~SSR::RDRF, at);
      return take(m, sci.read(m, n, Sci::kRdr, at), at);
    case Step::check:
      if (!quiet) return;
      block_ = 0;
      step_ = Step::erase;
      pulse_from_ = kNever;
      wake_ = at + kWords * kCheckPerWord;
      return;
    case Step::answer:
      if (!quiet) return;
      if (answers_ == 0) return start_program(m, at);
      --answers_;
      sending_ = 0xaa;
      return;
    case Step::halted:
      wake_ = kNever;
      return;
    default:
      return;
  }
}

// A block is not blank: erases it and checks it again.
void BootRom::next_block(Machine& m, States at) {
  if (pulse_from_ != kNever) {
    m.flash_control.erase_block(m, block_, 1);
    pulse_from_ = kNever;
    if (!m.flash_control.blank(m, block_)) {
      halt(0xff);
      wake_ = at + kPoll;
      return;
    }
    ++block_;
  }
  // Any byte that is not 0xff starts the erasure of all blocks.
  bool blank = true;
  for (unsigned n = 0; n < FlashControl::kBlockCount; ++n) blank &= m.flash_control.blank(m, n);
  while (block_ < FlashControl::kBlockCount && m.flash_control.blank(m, block_)) ++block_;
  if (blank || block_ == FlashControl::kBlockCount) return finish(m, at);
  const double verify = kVerifyWordUs * static_cast<double>(FlashControl::size_of(block_)) / 2;
  pulse_from_ = at + states(m, kAroundPulseUs);
  wake_ = pulse_from_ + states(m, kPulseUs + verify);
}

void BootRom::finish(Machine& m, States at) {
  wake_ = at + kPoll;
  if (m.options.boot_checks_id) {
    for (std::uint32_t k = 0; k < sizeof kId; ++k)
      if (*m.memory_at(kFirstRam + k) != kId[k]) return halt(0xff);
  }
  step_ = Step::answer;
  answers_ = m.options.boot_answers_twice ? 2 : 1;
}

void BootRom::start_program(Machine& m, States at) {
  const unsigned n = channel(m);
  m.sci[n].write(m, n, Sci::kScr, 0, at);
  const unsigned port = n == 0 ? 5 : 2;
  const auto txd = static_cast<std::uint8_t>(n == 0 ? 0x01 : 0x20);
  m.ports.write(m, port == 5 ? io::P5DR : io::P2DR, txd, at);
  m.ports.write(m, port == 5 ? io::P5DDR : io::P2DDR, txd, at);
  for (unsigned k = 0; k < 8; ++k) m.cpu.er[k] = 0xdead0000u + k;
  step_ = Step::off;
  wake_ = kNever;
  m.set_pc(kFirstRam + (m.options.boot_checks_id ? sizeof kId : 0));
}

void BootRom::advance(Machine& m, States to) {
  while (wake_ <= to) {
    const States at = wake_;
    if (step_ == Step::erase)
      next_block(m, at);
    else
      poll(m, at);
    m.rescheduled(source_of(channel(m)));
    if (step_ == Step::off) m.reschedule_all();
  }
}

}  // namespace kaz::h8s
