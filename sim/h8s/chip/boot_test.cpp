// Boot mode: bit rate, replies, echo, erase check, start; each unconfirmed property with both options.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/line_rate.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kRam = 0xffe080;
constexpr States kClock = 18'432'000;
constexpr States kBit9600 = kClock / 9600;
// mov.b #0x5a,r0l ; mov.b r0l,@0xffe900:32 ; bra .
const std::vector<std::uint8_t> kProgram = {0xf8, 0x5a, 0x6a, 0xa8, 0x00,
                                            0xff, 0xe9, 0x00, 0x40, 0xfe};

// A host at the other end of the line; waits until its bytes are sent.
struct Host {
  Chip chip;
  States bit = kBit9600;
  std::vector<TransmittedByte> came;
  int channel;

  explicit Host(Options o = {}) : chip(at_boot(o)), channel(o.boot_channel) {
    for (int pin = 0; pin < 3; ++pin) chip.set_input(Port::p4, pin, true);
    chip.on_transmit([this](int sci, const TransmittedByte& byte) {
      EXPECT_EQ(sci, channel);
      came.push_back(byte);
    });
    chip.power_on();
  }
  static Options at_boot(Options o) {
    o.mode = 0;
    return o;
  }
  void run(States states) {
    const Stop stop = chip.run_until(chip.now() + states);
    ASSERT_EQ(stop.reason, Stop::Reason::reached) << stop.report;
  }
  void send(std::uint8_t value) {
    ReceivedByte byte;
    byte.value = value;
    byte.at = chip.now() + 10 * bit;
    byte.bit_states = bit;
    ASSERT_TRUE(chip.receive(channel, byte));
    run(10 * bit);
  }
  // The byte received since the last call, after some time; -1: none.
  int answer(States wait = 25 * kBit9600) {
    run(wait);
    if (came.empty()) return -1;
    const int value = came.front().value;
    came.erase(came.begin());
    return value;
  }
  // Up to where the number of bytes is awaited.
  bool open() {
    for (int k = 0; k < 20; ++k) {
      send(0x00);
      if (!came.empty()) break;
    }
    const int greeting = answer();
    send(0x55);
    const int acknowledged = answer();
    return greeting == 0x00 && acknowledged == 0xaa;
  }
  void load(const std::vector<std::uint8_t>& bytes) {
    const auto count = bytes.size();
    send(static_cast<std::uint8_t>(count >> 8));
    EXPECT_EQ(answer(), static_cast<int>(count >> 8));
    send(static_cast<std::uint8_t>(count));
    EXPECT_EQ(answer(), static_cast<int>(count & 0xff));
    for (const std::uint8_t byte : bytes) {
      send(byte);
      EXPECT_EQ(answer(), byte);
    }
  }
};

TEST(Boot, LoadsEchoesAnswersAndStarts) {
  Host host;
  EXPECT_TRUE(host.chip.in_boot_rom());
  ASSERT_TRUE(host.open());
  host.load(kProgram);
  EXPECT_EQ(host.answer(kClock / 5), 0xaa);
  EXPECT_FALSE(host.chip.in_boot_rom());
  EXPECT_EQ(host.chip.peek(0xffe900), 0x5a);
  EXPECT_EQ(host.chip.registers().pc, kRam + 8);
  EXPECT_EQ(host.chip.registers().ccr & 0x80, 0x80);
  // TE = RE = 0, the rate stays: BRR = 18.432 MHz / (32 * 9600) - 1, and the channel runs.
  EXPECT_EQ(host.chip.peek(0xffffd9), 59);
  EXPECT_EQ(host.chip.peek(0xffffda), 0);
  EXPECT_EQ(host.chip.peek16(0xffff86).value() & 0x80, 0);
  EXPECT_EQ(host.chip.output(Port::p5).driven & 1, 1);
  EXPECT_EQ(host.chip.output(Port::p5).level & 1, 1);
}

TEST(Boot, AnswersAtTheRateThatItMeasures) {
  for (const States baud : {9600, 4800}) {
    Host host;
    host.bit = kClock / baud;
    for (int k = 0; k < 4 && host.came.empty(); ++k) host.send(0x00);
    ASSERT_FALSE(host.came.empty()) << baud;
    EXPECT_EQ(host.came[0].end - host.came[0].start, 10 * host.bit);
  }
}

TEST(Boot, MeasuresLevelsAtThePinToo) {
  Host host;
  host.chip.set_input(Port::p5, 1, true);
  host.run(kBit9600);
  host.chip.set_input(Port::p5, 1, false);
  host.run(9 * kBit9600);
  host.chip.set_input(Port::p5, 1, true);
  EXPECT_EQ(host.answer(), 0x00);
  EXPECT_EQ(host.chip.peek(0xffffd9), 59);
}

TEST(Boot, RatesAreThoseOfTheManual) {
  struct Case {
    bool a_mask;
    States baud, clock;
    bool answered;
  };
  const Case cases[] = {{false, 19200, kClock, false},   {true, 19200, kClock, true},
                        {false, 2400, kClock, false},    {false, 2400, 16'000'000, true},
                        {false, 9600, 7'372'800, false}, {true, 9600, 7'372'800, true},
                        {false, 115200, kClock, false},  {true, 2400, 16'000'000, false}};
  for (const Case& c : cases) {
    Options options;
    options.boot_a_mask_rates = c.a_mask;
    options.clock_hz = c.clock;
    Host host(options);
    host.bit = c.clock / c.baud;
    for (int k = 0; k < 5; ++k) host.send(0x00);
    EXPECT_EQ(!host.came.empty(), c.answered) << c.baud << " at " << c.clock;
  }
}

TEST(Boot, AcknowledgesOnlyAsTheOptionSays) {
  Options options;
  options.boot_acknowledges = false;
  Host host(options);
  for (int k = 0; k < 5 && host.came.empty(); ++k) host.send(0x00);
  EXPECT_EQ(host.answer(), 0x00);
  host.send(0x55);
  EXPECT_EQ(host.answer(), -1);
  host.load(kProgram);
  EXPECT_EQ(host.answer(kClock / 5), 0xaa);
}

TEST(Boot, AnswersOnceOrTwice) {
  for (const bool twice : {false, true}) {
    Options options;
    options.boot_answers_twice = twice;
    Host host(options);
    ASSERT_TRUE(host.open());
    host.load(kProgram);
    EXPECT_EQ(host.answer(kClock / 5), 0xaa);
    EXPECT_EQ(host.answer(), twice ? 0xaa : -1);
    EXPECT_FALSE(host.chip.in_boot_rom());
  }
}

TEST(Boot, ChecksTheIdentificationOfAMaskParts) {
  for (const bool right : {false, true}) {
    Options options;
    options.boot_checks_id = true;
    Host host(options);
    ASSERT_TRUE(host.open());
    std::vector<std::uint8_t> program = {0x40, 0xfe, 'd', 'f', '2', '1', '2', '4'};
    if (right) program.back() = '8';
    program.insert(program.end(), kProgram.begin(), kProgram.end());
    host.load(program);
    EXPECT_EQ(host.answer(kClock / 5), right ? 0xaa : 0xff);
    EXPECT_EQ(host.chip.in_boot_rom(), !right);
    if (right) {
      EXPECT_EQ(host.chip.registers().pc, kRam + 16);
    }
  }
}

TEST(Boot, TalksOnTheOtherChannel) {
  Options options;
  options.boot_channel = 1;
  Host host(options);
  ASSERT_TRUE(host.open());
  host.load(kProgram);
  EXPECT_EQ(host.answer(kClock / 5), 0xaa);
}

TEST(Boot, ErasesWhatIsNotBlank) {
  Host host;
  host.chip.poke(0x1fff0, 0x12);
  host.chip.poke(0x20, 0x34);
  ASSERT_TRUE(host.open());
  host.load(kProgram);
  // One H'AA, after two pulses of 10 ms and their verification.
  const States from = host.chip.now();
  EXPECT_EQ(host.answer(kClock / 2), 0xaa);
  EXPECT_GT(host.chip.now() - from, kClock / 50);
  EXPECT_EQ(host.chip.peek(0x1fff0), 0xff);
  EXPECT_EQ(host.chip.peek(0x20), 0xff);
  EXPECT_EQ(host.chip.flash_statistics().blocks[9].erasures, 1);
  EXPECT_EQ(host.chip.flash_statistics().blocks[0].erasures, 1);
  EXPECT_EQ(host.chip.flash_statistics().blocks[4].erasures, 0);
}

TEST(Boot, WornFlashIsAnsweredWithFf) {
  Options options;
  options.flash_worn_block = 4;
  Host host(options);
  host.chip.poke(0x1234, 0);
  ASSERT_TRUE(host.open());
  host.load(kProgram);
  EXPECT_EQ(host.answer(kClock / 2), 0xff);
  EXPECT_TRUE(host.chip.in_boot_rom());
}

TEST(Boot, ProgramsThatAreTooLongAreRefused) {
  Options options;
  options.boot_program_bytes = 1920;
  for (const int length : {0, 1920, 1921}) {
    Host host(options);
    ASSERT_TRUE(host.open());
    host.send(static_cast<std::uint8_t>(length >> 8));
    EXPECT_EQ(host.answer(), length >> 8);
    host.send(static_cast<std::uint8_t>(length));
    const int last = length == 1920 ? length & 0xff : 0xff;
    EXPECT_EQ(host.answer(), last) << length;
  }
}

TEST(Boot, PowerCutUnderTheErasePulseLeavesPart) {
  Host host;
  for (std::uint32_t a = 0x8000; a < 0xc000; ++a) host.chip.poke(a, 0);
  ASSERT_TRUE(host.open());
  host.load(kProgram);
  // The check takes 28 ms, then the pulse begins; its first half is over after 33 ms or so.
  host.run(kClock / 1000 * 31);
  host.chip.power_on();
  int changed = 0, left = 0;
  for (std::uint32_t a = 0x8000; a < 0xc000; ++a) (*host.chip.peek(a) == 0 ? left : changed)++;
  EXPECT_GT(changed, 100);
  EXPECT_GT(left + changed, 0x3fff);
  // The mode pins still select boot mode: it starts again.
  host.came.clear();
  ASSERT_TRUE(host.open());
  host.load(kProgram);
  EXPECT_EQ(host.answer(kClock / 2), 0xaa);
  EXPECT_EQ(host.chip.peek(0x9000), 0xff);
}

TEST(Boot, ModePinsCountAtResetAlone) {
  Host host;
  host.chip.set_mode_pins(2);
  EXPECT_TRUE(host.chip.in_boot_rom());
  host.chip.poke(0, std::vector<std::uint8_t>{0, 0, 0x10, 0});
  host.chip.poke(0x1000, std::vector<std::uint8_t>{0x40, 0xfe});
  host.chip.reset();
  EXPECT_FALSE(host.chip.in_boot_rom());
  EXPECT_EQ(host.chip.registers().pc, 0x1000u);
  host.chip.set_mode_pins(0);
  host.chip.set_input(Port::p4, 1, false);
  host.chip.reset();
  EXPECT_FALSE(host.chip.in_boot_rom());
  host.chip.set_input(Port::p4, 1, true);
  host.chip.reset();
  EXPECT_TRUE(host.chip.in_boot_rom());
}

TEST(Boot, SavedStateGoesOn) {
  Host host;
  ASSERT_TRUE(host.open());
  host.send(0);
  EXPECT_EQ(host.answer(), 0);
  const auto saved = host.chip.save();
  host.send(10);
  EXPECT_EQ(host.answer(), 10);
  host.chip.restore(*saved);
  host.send(10);
  EXPECT_EQ(host.answer(), 10);
  for (const std::uint8_t byte : kProgram) host.send(byte);
  host.run(kClock / 5);
  EXPECT_FALSE(host.chip.in_boot_rom());
}

TEST(LineRate, OtherRatesGiveOtherBytes) {
  for (int value = 0; value < 256; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    // Up to 4 % off every byte arrives.
    for (const int off : {-4, 0, 4}) {
      const HeardByte heard = heard_at(byte, 1000, 1000 + 10 * off);
      EXPECT_TRUE(heard.heard && !heard.framing_error && heard.value == byte)
          << value << " " << off;
    }
  }
  // A fast receiver samples only the slow start bit: a break.
  EXPECT_TRUE(heard_at(0xff, 1920, 160).framing_error);
  EXPECT_EQ(heard_at(0xff, 1920, 160).value, 0);
  // A slow receiver detects the fast frame as part of its start bit, if at all.
  EXPECT_FALSE(heard_at(0xff, 160, 1920).heard);
}

}  // namespace
}  // namespace kaz::h8s::testing
