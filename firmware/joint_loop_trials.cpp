// Proves the joints' loop in assembler (joint_loop.S) equal to shared/servo/joint_loop.c by random trials.
// SPDX-License-Identifier: Apache-2.0
//
// A trial is one joint computed once by both. For each call of the loop (18 joints) the host draws states
// and codes (joint_states.h), writes them to the RAM of an emulated chip that holds the firmware image,
// starts the routine there and computes the same in C. Whole joints, codes, result, callee-saved registers,
// stack pointer and the RAM around are compared. The routine returns to a SLEEP instead of a breakpoint,
// so that nothing keeps the emulator's translator from running it.
//
// The first calls also run on a chip with an observer: every instruction of the routine must have been
// executed and every conditional branch must have gone both ways.
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/joint_states.h"
#include "shared/base/random.hpp"
#include "shared/image/image.h"
#include "shared/servo/joint_loop.h"
#include "sim/h8s/chip/chip.h"
#include "sim/h8s/chip/observer.h"

namespace kaz::firmware {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Loop = u16 (*)(kz_joint*, const u16*);

constexpr std::uint32_t kRam = 0xffe080, kRamEnd = 0xfff000;
constexpr std::uint32_t kJoints = 0xffe100;  // 18 of 56 bytes, to 0xffe4f0
constexpr std::uint32_t kCodes = 0xffe600;   // 256 words
constexpr std::uint32_t kStack = 0xffef00;   // holds the return address
constexpr std::uint32_t kStackUse = 64;      // below, the routine may leave anything
// In flash that no image uses: enables IRQ0, which never comes, so that SLEEP is not for ever; sleeps.
constexpr std::uint32_t kPrologue = 0x1e000, kSleep = 0x1e004;
constexpr std::uint8_t kProgram[] = {0xf8, 0x01, 0x38, 0xc2, 0x01, 0x80};  // mov.b, mov.b, sleep
constexpr h8s::States kLongestCall = 100'000;
constexpr std::uint32_t kRamEvery = 64;  // calls from one comparison of the whole RAM to the next

constexpr std::size_t kJointSize = 56;
static_assert(sizeof(kz_joint) == kJointSize);

void put(std::uint8_t*& to, std::uint32_t value, std::size_t size) {
  for (std::size_t k = size; k-- > 0;) *to++ = static_cast<std::uint8_t>(value >> (8 * k));
}

// As the H8 has it in memory: big-endian, no padding.
void encode(const kz_joint& joint, std::uint8_t* to) {
#define KZ_PUT(type, name) put(to, static_cast<std::uint32_t>(joint.name), sizeof(type));
  KZ_JOINT_FIELDS(KZ_PUT)
#undef KZ_PUT
}

void print_fields(const std::uint8_t* before, const std::uint8_t* native,
                  const std::uint8_t* chip) {
  std::size_t at = 0;
  const auto number = [&at](const std::uint8_t* from, std::size_t size, bool is_signed) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < size; ++k) value = value << 8 | from[at + k];
    if (is_signed && size == 2) return static_cast<long long>(static_cast<std::int16_t>(value));
    return static_cast<long long>(value);
  };
  std::printf("  %-16s %12s %12s %12s\n", "field", "before", "C", "chip");
  const auto print = [&](const char* name, std::size_t size, bool is_signed) {
    std::printf("  %-16s %12lld %12lld %12lld%s\n", name, number(before, size, is_signed),
                number(native, size, is_signed), number(chip, size, is_signed),
                std::memcmp(native + at, chip + at, size) == 0 ? "" : "  <-- differs");
    at += size;
  };
#define KZ_PRINT(type, name) \
  print(#name, sizeof(type), static_cast<type>(-1) < static_cast<type>(1));
  KZ_JOINT_FIELDS(KZ_PRINT)
#undef KZ_PRINT
}

// Counts instructions and directions of conditional branches in a range of addresses.
class RoutineCoverage final : public h8s::Observer {
 public:
  explicit RoutineCoverage(const h8s::Chip& chip, std::uint32_t start) : start_(start) {
    constexpr std::uint16_t rts = 0x5470;
    std::uint32_t at = start;
    for (std::uint16_t word = 0; word != rts;) {
      int length = 0;
      word = chip.peek16(at).value();
      lines_.push_back(
          {at, chip.disassemble(at, &length), h8s::flow_of(word) == h8s::Flow::branch});
      at += static_cast<std::uint32_t>(length);
    }
    executed_.resize((at - start) / 2);
    taken_.resize(executed_.size());
  }

  void executed(const h8s::Executed& e) override {
    const std::size_t index = (e.pc - start_) / 2;
    if (e.pc < start_ || index >= executed_.size()) return;
    ++executed_[index];
    taken_[index] += e.taken();
  }

  // What was never executed or never went one of its ways; prints it and the totals.
  int missing() const {
    int missing = 0, branches = 0;
    for (const Line& line : lines_) {
      const std::size_t index = (line.address - start_) / 2;
      const char* fault = nullptr;
      branches += line.branch;
      if (executed_[index] == 0) {
        fault = "never executed";
      } else if (line.branch && taken_[index] == 0) {
        fault = "never taken";
      } else if (line.branch && taken_[index] == executed_[index]) {
        fault = "always taken";
      } else {
        continue;
      }
      std::printf("  %06x  %-28s %s\n", line.address, line.text.c_str(), fault);
      ++missing;
    }
    std::printf(
        "coverage: all %zu instructions ran, and all %d conditional branches went both ways%s\n",
        lines_.size(), branches, missing ? ", except those above" : "");
    return missing;
  }
  // The rarest direction of all branches: how much chance the trials leave to it.
  std::int64_t rarest() const {
    std::int64_t rarest = executed_.empty() ? 0 : executed_[0];
    for (const Line& line : lines_) {
      const std::size_t index = (line.address - start_) / 2;
      rarest = std::min(rarest, executed_[index]);
      if (line.branch) rarest = std::min({rarest, taken_[index], executed_[index] - taken_[index]});
    }
    return rarest;
  }

 private:
  struct Line {
    std::uint32_t address;
    std::string text;
    bool branch;
  };
  std::uint32_t start_;
  std::vector<Line> lines_;
  std::vector<std::int64_t> executed_, taken_;
};

// A chip with the image, standing in the SLEEP that the routine returns to.
class Bench {
 public:
  static std::optional<Bench> make(const h8s::Image& image, std::string& error) {
    Bench bench;
    if (const auto loaded = bench.chip_.load(image); !loaded) {
      error = loaded.error().message;
      return std::nullopt;
    }
    bench.chip_.set_symbols(image.symbols);
    const auto loop = bench.chip_.symbols().address_of("kz_joint_loop");
    if (!loop) {
      error = "has no symbol kz_joint_loop: give the .coff file of the servo firmware";
      return std::nullopt;
    }
    bench.loop_ = *loop;
    bench.chip_.power_on();
    for (int bit = 0; bit < 8; ++bit) bench.chip_.set_input(h8s::Port::p4, bit, true);
    bench.chip_.poke(kPrologue, kProgram);
    h8s::Registers registers;
    registers.pc = kPrologue;
    registers.er[7] = kStack;
    bench.chip_.set_registers(registers);
    const h8s::Stop stop = bench.chip_.run_until(bench.chip_.now() + 100);
    if (stop.reason != h8s::Stop::Reason::reached || !bench.chip_.asleep()) {
      error = "the chip did not reach its SLEEP instruction: " + stop.report;
      return std::nullopt;
    }
    std::array<std::uint8_t, 4> back{0, kSleep >> 16 & 0xff, kSleep >> 8 & 0xff, kSleep & 0xff};
    bench.chip_.poke(kStack, back);
    bench.ram_.resize(kRamEnd - kRam);
    bench.chip_.peek(kRam, bench.ram_);
    return bench;
  }

  h8s::Chip& chip() { return chip_; }
  std::uint32_t loop() const { return loop_; }

  // Runs the routine on `input` and compares with the C. False: they differ, which has been printed.
  bool call(std::uint64_t seed, std::uint64_t number, const LoopInput& input, Loop native) {
    std::array<std::uint8_t, KZ_JOINTS * kJointSize> before, expected, found;
    for (std::size_t i = 0; i < KZ_JOINTS; ++i) encode(input.joint[i], &before[i * kJointSize]);
    chip_.poke(kJoints, before);
    for (const kz_joint& joint : input.joint) {
      const u16 code = input.analog[joint.pot_input];
      const std::uint8_t bytes[2] = {static_cast<std::uint8_t>(code >> 8),
                                     static_cast<std::uint8_t>(code)};
      chip_.poke(kCodes + 2u * joint.pot_input, bytes);
      std::memcpy(&ram_[kCodes - kRam + 2u * joint.pot_input], bytes, 2);
    }
    h8s::Registers given;
    Random noise(mix64(seed + 1) ^ number);
    for (std::uint32_t& er : given.er) er = static_cast<std::uint32_t>(noise.next());
    given.er[0] = kJoints;
    given.er[1] = kCodes;
    given.er[7] = kStack;
    given.pc = loop_;
    given.ccr = static_cast<std::uint8_t>(noise.below(0x40));
    chip_.set_registers(given);
    const h8s::Stop stop = chip_.run_until(chip_.now() + kLongestCall);

    std::array<kz_joint, KZ_JOINTS> joints = input.joint;
    const u16 result = native(joints.data(), input.analog.data());
    for (std::size_t i = 0; i < KZ_JOINTS; ++i) encode(joints[i], &expected[i * kJointSize]);

    const auto differs = [&](const std::string& what) {
      std::printf("difference in call %llu, seed %llu: %s\n",
                  static_cast<unsigned long long>(number), static_cast<unsigned long long>(seed),
                  what.c_str());
      return false;
    };
    const h8s::Registers left = chip_.registers();
    if (stop.reason != h8s::Stop::Reason::reached)
      return differs("the chip stopped: " + stop.report);
    if (!chip_.asleep() || left.pc != kSleep + 2) return differs("the routine does not return");
    chip_.peek(kJoints, found);
    for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
      const std::size_t at = i * kJointSize;
      if (std::equal(&expected[at], &expected[at] + kJointSize, &found[at])) continue;
      differs("joint " + std::to_string(i) + ", code " +
              std::to_string(input.analog[input.joint[i].pot_input]));
      print_fields(&before[at], &expected[at], &found[at]);
      return false;
    }
    if ((left.er[0] & 0xffff) != result) {
      char text[64];
      std::snprintf(text, sizeof text, "result 0x%04x in C, 0x%04x on the chip", result,
                    static_cast<unsigned>(left.er[0] & 0xffff));
      return differs(text);
    }
    for (std::size_t r : {4u, 5u, 6u}) {
      if (left.er[r] != given.er[r]) return differs("ER" + std::to_string(r) + " is not preserved");
    }
    if (left.er[7] != kStack + 4) return differs("the routine changed the stack pointer");
    if (number % kRamEvery == 0) return compare_ram(found, differs);
    return true;
  }

 private:
  template <class Differs>
  bool compare_ram(std::span<const std::uint8_t> joints, const Differs& differs) {
    Bytes now(ram_.size());
    chip_.peek(kRam, now);
    std::copy(joints.begin(), joints.end(), &ram_[kJoints - kRam]);
    std::copy_n(&now[kStack - kStackUse - kRam], kStackUse, &ram_[kStack - kStackUse - kRam]);
    const auto where = std::mismatch(now.begin(), now.end(), ram_.begin()).first;
    if (where == now.end()) return true;
    char text[64];
    std::snprintf(text, sizeof text, "the routine wrote outside the joints' RAM, at 0x%06x",
                  kRam + static_cast<unsigned>(where - now.begin()));
    return differs(text);
  }

  h8s::Chip chip_;
  std::uint32_t loop_ = 0;
  Bytes ram_;  // as it must be
};

struct Options {
  std::uint64_t trials = 100'000'000, seed = 1;
  std::optional<std::uint64_t> call;
  std::string image = KAZ_FIRMWARE_IMAGE;
  std::string native;  // a shared object with another kz_joint_loop
  bool coverage = true;
};

constexpr const char* kUsage =
    "usage: joint_loop_trials [--trials N] [--seed N] [--call N] [--image FILE.coff] [--native "
    "FILE.so]\n"
    "                         [--no-coverage]\n"
    "  --call N         run only call N of the sequence from --seed, to reproduce a difference\n"
    "  --image FILE     firmware image with symbols, for the loop on the chip\n"
    "  --native FILE    shared object with kz_joint_loop, for the loop in C\n"
    "  --no-coverage    do not check coverage; necessary if the image's loop is not joint_loop.S\n";

std::optional<Options> parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name == "--no-coverage") {
      options.coverage = false;
      continue;
    }
    if (i + 1 == argc) return std::nullopt;
    const char* value = argv[++i];
    char* end = nullptr;
    const std::uint64_t number = std::strtoull(value, &end, 10);
    const bool is_number = *value >= '0' && *value <= '9' && *end == 0;
    if (name == "--image") {
      options.image = value;
    } else if (name == "--native") {
      options.native = value;
    } else if (name == "--trials" && is_number && number > 0) {
      options.trials = number;
    } else if (name == "--seed" && is_number) {
      options.seed = number;
    } else if (name == "--call" && is_number) {
      options.call = number;
    } else {
      return std::nullopt;
    }
  }
  return options;
}

int fail(int status, const std::string& text) {
  std::fprintf(stderr, "joint_loop_trials: %s\n", text.c_str());
  return status;
}

// After so many calls everything that runs often is translated.
constexpr std::uint64_t kWarmUpCalls = 5000;
constexpr double kMinTranslated = 0.9;

// The first calls run under an observer; while one is attached the chip interprets, not translates.
constexpr std::uint64_t kObservedCalls = 4000;
int observed_calls(const Options& options, Bench& bench, Loop native, std::uint64_t calls) {
  RoutineCoverage coverage(bench.chip(), bench.loop());
  bench.chip().attach(coverage);
  LoopInput input;
  for (std::uint64_t call = 0; call < calls; ++call) {
    draw_loop_input(options.seed, call, input);
    if (!bench.call(options.seed, call, input, native)) return 1;
  }
  bench.chip().detach(coverage);
  if (coverage.missing() != 0) return 1;
  std::printf("  the rarest branch direction occurred %lld times in %llu trials\n",
              static_cast<long long>(coverage.rarest()),
              static_cast<unsigned long long>(calls * KZ_JOINTS));
  return 0;
}

int run(const Options& options) {
  Loop native = kz_joint_loop;
  if (!options.native.empty()) {
    void* library = dlopen(options.native.c_str(), RTLD_NOW | RTLD_LOCAL);
    native = library ? reinterpret_cast<Loop>(dlsym(library, "kz_joint_loop")) : nullptr;
    if (!native)
      return fail(2, options.native + " has no kz_joint_loop that can be loaded: " + dlerror());
  }
  const auto image = h8s::load_image(options.image);
  if (!image) return fail(2, image.error().message);
  std::string error;
  auto bench = Bench::make(*image, error);
  if (!bench) return fail(2, options.image + ": " + error);

  const std::uint64_t from = options.call.value_or(0);
  const std::uint64_t calls =
      options.call ? from + 1 : (options.trials + KZ_JOINTS - 1) / KZ_JOINTS;
  if (options.coverage && !options.call) {
    const int status = observed_calls(options, *bench, native, std::min(calls, kObservedCalls));
    if (status != 0) return status;
  }
  const h8s::Chip& chip = bench->chip();
  const std::int64_t instructions_before = chip.instructions();
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  auto last_report = began;
  LoopInput input;
  for (std::uint64_t call = from; call < calls; ++call) {
    draw_loop_input(options.seed, call, input);
    if (!bench->call(options.seed, call, input, native)) {
      std::printf("repeat this call with --seed %llu --call %llu\n",
                  static_cast<unsigned long long>(options.seed),
                  static_cast<unsigned long long>(call));
      return 1;
    }
    if (call % 1024 == 0 && Clock::now() - last_report > std::chrono::seconds(10)) {
      last_report = Clock::now();
      std::fprintf(stderr, "joint loop: %llu of %llu trials\n",
                   static_cast<unsigned long long>(call * KZ_JOINTS),
                   static_cast<unsigned long long>(calls * KZ_JOINTS));
    }
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  std::printf("joint loop: no difference in %llu trials, seed %llu, %.1f s\n",
              static_cast<unsigned long long>((calls - from) * KZ_JOINTS),
              static_cast<unsigned long long>(options.seed), seconds);
  const std::int64_t instructions = chip.instructions() - instructions_before;
  const double share =
      static_cast<double>(chip.translated_instructions()) / static_cast<double>(instructions);
  std::printf("engine: %s, %.2f %% of %lld instructions ran as translated code\n",
              h8s::name_of(chip.engine()), 100 * share, static_cast<long long>(instructions));
  if (h8s::translator_available() && calls - from > kWarmUpCalls && share < kMinTranslated)
    return fail(
        1,
        "these trials hardly test the translator, because too few instructions ran as translated "
        "code");
  return 0;
}

}  // namespace
}  // namespace kaz::firmware

int main(int argc, char** argv) {
  const auto options = kaz::firmware::parse(argc, argv);
  if (!options) {
    std::fputs(kaz::firmware::kUsage, stderr);
    return 2;
  }
  return kaz::firmware::run(*options);
}
