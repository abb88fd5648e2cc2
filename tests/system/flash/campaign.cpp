// The campaign's run: what goes wrong, when, and the three judgements.
// SPDX-License-Identifier: Apache-2.0
//
// After every run: a success that was reported has to be one, byte by byte; a firmware that answers has
// to be a whole image; and the board, with line and power restored, has to take the image by the same
// method, the loader's without mode pins.
#include "tests/system/flash/campaign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <random>

#include "host/flash/flasher.h"
#include "tests/system/flash/variant_testing.h"
#include "tools/lockstep/flash_bench_testing.h"

namespace kaz::flash_test {
namespace {

using host::Flasher;
using host::FlashImage;
using lockstep::FlashBench;
using std::chrono::milliseconds;

enum class Kind { power, flips, drops, wrong_board, truncated, foreign, unplugged, killed };
constexpr const char* kKinds[] = {"power cut",   "line noise",      "bytes dropped",
                                  "wrong board", "truncated image", "foreign image",
                                  "unplugged",   "killed"};
enum class Way { boot_erased, boot_running, loader };
constexpr const char* kWays[] = {"boot mode, erased board", "boot mode, running board", "loader"};
bool holds(FlashBench& bench, const FlashImage& image, bool application_only) {
  for (const host::FlashRange& range : image.ranges(host::kFlashLine)) {
    const bool inside =
        range.from >= KZ_APPLICATION && range.from < KZ_APPLICATION + KZ_APPLICATION_MAX;
    if (application_only && !inside) continue;
    std::vector<std::uint8_t> is(range.size());
    bench.chip().peek(range.from, is);
    if (!std::ranges::equal(is, image.bytes(range))) return false;
  }
  return true;
}

// One of the two applications, to the last bit, or none.
Stands standing(FlashBench& bench, const FlashImage& before, const FlashImage& next) {
  if (holds(bench, before, true)) return Stands::before;
  return holds(bench, next, true) ? Stands::fresh : Stands::none;
}

// Without what is behind some byte of the application, or of the loader behind it.
FlashImage truncated(const FlashImage& whole, bool in_loader, double share) {
  host::FlashRange part{KZ_LOADER, KZ_LOADER_MARK + host::kFlashLine};
  if (!in_loader) {
    part.from = KZ_APPLICATION_CODE;
    part.to = KZ_APPLICATION + whole.identity()->length;
  }
  const std::uint32_t end = part.from + static_cast<std::uint32_t>(share * (part.size() - 1));
  FlashImage cut;
  for (const host::FlashRange& range : whole.ranges(host::kFlashLine))
    if (range.from < end) cut.put(range.from, whole.bytes({range.from, std::min(range.to, end)}));
  return cut;
}

// What `kaz flash write` does, without its terminal.
Result<void> flash(FlashBench& bench, Way way, const FlashImage& image,
                   std::span<const std::uint8_t> writer) {
  Flasher flasher(bench, bench, writer, {});
  if (way != Way::boot_erased) {
    const auto there = flasher.enter_loader();
    if (!there && way == Way::loader) return tl::unexpected(there.error());
    if (there && !*there && way == Way::loader)
      return fail(Fault::environment, "no loader answers");
  }
  if (auto allowed = flasher.check(image, way != Way::loader); !allowed) return allowed;
  if (way != Way::loader) {
    if (auto entered = flasher.enter_boot(bench); !entered) return entered;
  }
  const auto report = KAZ_TRY(flasher.write(image));
  if (!report.verified) return fail(Fault::failed, "not verified");
  return flasher.run(way == Way::loader ? nullptr : &bench);
}

struct Plan {
  Kind kind;
  Way way;
  double share;         // of the run's length, at which it happens
  double length, rate;  // s; of bytes
  bool in_loader;       // what is truncated
};

// A board on which a run starts.
std::unique_ptr<FlashBench> bench_of(Way way, const std::string& image_path, std::uint64_t seed) {
  h8s::Options options;
  options.flash_seed = seed;
  auto bench =
      std::make_unique<FlashBench>(way == Way::boot_erased ? "" : image_path, options, seed);
  (void)bench->sleep_until(milliseconds(150));
  return bench;
}

// How long each method takes undisturbed, s; tried once.
double lasts(Way way, const std::string& image_path, const FlashImage& next,
             std::span<const std::uint8_t> writer) {
  static std::map<Way, double> known;
  if (known.contains(way)) return known[way];
  const auto bench = bench_of(way, image_path, 1);
  const Time begin = bench->now();
  if (!flash(*bench, way, next, writer)) std::abort();  // nothing disturbed it
  return known[way] = std::chrono::duration<double>(bench->now() - begin).count();
}

Plan plan_of(std::uint64_t seed) {
  std::mt19937_64 random(seed * 7919 + 17);
  const auto share = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  Plan plan{};
  plan.kind = static_cast<Kind>(seed % 8);
  plan.way = static_cast<Way>(random() % 3);
  plan.share = share();
  plan.length = 0.05 + share();
  plan.rate = 0.0001 * std::exp(share() * 5);
  plan.in_loader = random() % 2 != 0;
  // An erased board knows no id that could be the wrong one.
  if (plan.kind == Kind::wrong_board && plan.way == Way::boot_erased) plan.way = Way::loader;
  return plan;
}

// Flashes the board once more, with `image`. Returns the fault; empty: the board runs the image.
std::string reflash_fault(FlashBench& bench, Way way, const FlashImage& image,
                          const std::vector<std::uint8_t>& writer) {
  const auto again = flash(bench, way, image, writer);
  if (!again) return "it cannot be flashed again: " + full_text(again.error());
  if (bench.running_image() != image.identity()->crc) return "flashed again, it does not run";
  return "";
}

}  // namespace

CampaignRun campaign_run(std::uint64_t seed, const std::string& image_path,
                         const std::string& writer_path) {
  CampaignRun run;
  const Plan plan = plan_of(seed);
  std::ifstream file(writer_path, std::ios::binary);
  const std::vector<std::uint8_t> writer{std::istreambuf_iterator<char>(file), {}};
  const auto loaded = FlashImage::load(image_path);
  if (!loaded) {
    run.fault = full_text(loaded.error());
    return run;
  }
  const FlashImage& before = *loaded;
  const FlashImage next = variant(before, kBuildId, static_cast<std::uint8_t>(1 + seed % 255));
  // The first fault is the one that is reported.
  const auto blame = [&run](const std::string& fault) {
    if (run.fault.empty()) run.fault = fault;
  };
  const auto the_bench = bench_of(plan.way, image_path, seed);
  FlashBench& bench = *the_bench;
  const double at_s = plan.share * lasts(plan.way, image_path, next, writer);
  const Time at = bench.now() + Time(static_cast<std::int64_t>(at_s * 1e9));
  bench.on_application([&] {
    if (standing(bench, before, next) == Stands::none)
      blame("an image was started that is not whole");
  });
  FlashImage sent = next;
  faults::Schedule faults;
  const auto line_fault = [&](faults::Name name) {
    faults::Fault fault;
    fault.name = name;
    fault.at = at;
    fault.length = Time(static_cast<std::int64_t>(plan.length * 1e9));
    fault.value = plan.rate * 10;
    faults.add(fault);
    bench.set_faults(&faults);
  };
  switch (plan.kind) {
    case Kind::power:
      bench.cut_power_at(at, Time(static_cast<std::int64_t>(plan.length * 1e9)));
      break;
    case Kind::flips:
      line_fault(faults::Name::link_flip);
      break;
    case Kind::drops:
      line_fault(faults::Name::link_drop);
      break;
    case Kind::wrong_board:
      sent = variant(next, kBoardId, 0x44);
      break;
    case Kind::truncated:
      sent = truncated(next, plan.in_loader, plan.share);
      break;
    case Kind::foreign:
      sent = FlashImage();
      sent.put(0, std::array<std::uint8_t, 4>{0, 0, 1, 0});
      break;
    case Kind::unplugged:
    case Kind::killed:
      bench.unplug_at(at);
      break;
  }
  const auto done = flash(bench, plan.way, sent, writer);
  run.kind = kKinds[static_cast<int>(plan.kind)];
  run.reported_success = done.has_value();
  run.stands = standing(bench, before, next);
  char text[160];
  std::snprintf(text, sizeof text, "seed %llu: %s, %s at %.3f s: %s",
                static_cast<unsigned long long>(seed), kWays[static_cast<int>(plan.way)],
                kKinds[static_cast<int>(plan.kind)], at_s,
                done ? "done" : done.error().message.c_str());
  run.text = text;
  const bool guarded =
      plan.kind == Kind::wrong_board || plan.kind == Kind::truncated || plan.kind == Kind::foreign;
  if (guarded && done) blame("an image that must be refused was written");
  if (guarded && plan.way != Way::boot_erased && !holds(bench, before, false))
    blame("a refused image has changed the flash");
  if (!guarded && done && !holds(bench, sent, plan.way == Way::loader))
    blame("success was reported, and the flash does not hold the image");

  // What runs is whole: the image before, or the one that was sent.
  bench.repair();
  // A killed program is started again at once: the board is where it was left.
  const bool at_once = plan.kind == Kind::killed;
  (void)bench.mcu().set_boot_pins(false);
  if (!at_once) bench.mcu().power_cycle();
  const auto crc = at_once ? std::nullopt : bench.running_image();
  if (crc) {
    const Stands stands = standing(bench, before, next);
    const bool old = *crc == before.identity()->crc && stands == Stands::before;
    const bool fresh = *crc == next.identity()->crc && stands == Stands::fresh;
    if (!old && !fresh) blame("an image runs that is none");
  } else if (done && !guarded && !at_once) {
    blame("success was reported, and the firmware does not run");
  }
  blame(reflash_fault(bench, plan.way, next, writer));
  return run;
}

}  // namespace kaz::flash_test
