// A board is flashed in simulated time: boot mode, loader, guards, and what each failure says.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "host/flash/flasher.h"
#include "host/link/stalling_testing.h"
#include "tests/system/flash/variant_testing.h"
#include "tools/lockstep/flash_bench_testing.h"

namespace kaz::flash_test {
namespace {

using host::Flasher;
using host::FlasherOptions;
using host::FlashImage;
using lockstep::FlashBench;
using std::chrono::milliseconds;

const std::vector<std::uint8_t>& writer() {
  static const std::vector<std::uint8_t> bytes = [] {
    std::ifstream file(KAZ_WRITER, std::ios::binary);
    return std::vector<std::uint8_t>(std::istreambuf_iterator<char>(file), {});
  }();
  return bytes;
}

FlashImage firmware() {
  auto image = FlashImage::load(KAZ_FIRMWARE_IMAGE);
  EXPECT_TRUE(image) << image.error().message;
  return *image;
}

FlashImage changed(std::uint32_t offset, std::uint8_t flip) {
  FlashImage image = variant(firmware(), offset, flip);
  EXPECT_EQ(image.damage(), "");
  return image;
}

bool holds(FlashBench& bench, const FlashImage& image) {
  for (const host::FlashRange& range : image.ranges()) {
    std::vector<std::uint8_t> is(range.size());
    bench.chip().peek(range.from, is);
    if (!std::ranges::equal(is, image.bytes(range))) return false;
  }
  return true;
}

void expect_no_misuse(FlashBench& bench) {
  for (const h8s::Misuse& misuse : bench.chip().misuse())
    ADD_FAILURE() << misuse.text << " at " << std::hex << misuse.pc;
}

TEST(Flash, BootModeWritesAnErasedBoardWhichThenRuns) {
  FlashBench bench;
  bench.set_latency(milliseconds(1));
  Flasher flasher(bench, bench, writer(), {});
  const auto entered = flasher.enter_boot(bench);
  ASSERT_TRUE(entered) << entered.error().message;
  EXPECT_FALSE(flasher.found()->by_loader);
  EXPECT_FALSE(flasher.board_id());
  const FlashImage image = firmware();
  const auto report = flasher.write(image);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->verified);
  EXPECT_EQ(report->repeated, 0);
  EXPECT_TRUE(holds(bench, image));
  std::printf("flashed %u bytes in %.3f s, at least %.3f s: efficiency %.1f %%\n", report->written,
              report->seconds, report->min_seconds, 100 * report->efficiency());
  // Design, section 10.
  EXPECT_GE(report->efficiency(), 0.85);
  expect_no_misuse(bench);
  ASSERT_TRUE(flasher.run(&bench));
  EXPECT_EQ(bench.running_image(), image.identity()->crc);
}

TEST(Flash, ARateIsPrintedOnlyWhereItWasMeasured) {
  EXPECT_EQ(host::progress_text({"write", 512, 33088, 8120}), "write 512 of 33088 bytes, 8.1 KB/s");
  EXPECT_EQ(host::progress_text({"read", 32, 32, 0}), "read 32 of 32 bytes");
  EXPECT_EQ(host::progress_text({"erase", 1, 2, 0}), "erase 1 of 2 blocks");
}

TEST(Flash, UnconfirmedPointsOfBootModeAreTakenAsTheyCome) {
  for (int k = 0; k < 4; ++k) {
    h8s::Options options;
    options.boot_acknowledges = (k & 1) != 0;
    options.boot_answers_twice = (k & 2) != 0;
    FlashBench bench("", options);
    Flasher flasher(bench, bench, writer(), {});
    const auto entered = flasher.enter_boot(bench);
    EXPECT_TRUE(entered) << k << ": " << entered.error().message;
  }
}

TEST(Flash, LeavesThroughTheResetVectorToo) {
  FlashBench bench;
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_boot(bench));
  EXPECT_FALSE(flasher.run(nullptr));  // blank
  ASSERT_TRUE(flasher.write(firmware()));
  ASSERT_TRUE(flasher.run(nullptr));
  EXPECT_EQ(bench.running_image(), firmware().identity()->crc);
}

TEST(Flash, LoaderUpdatesARunningBoard) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  const FlashImage next = changed(kBuildId, 0x55);
  // Each phase is shown to its end, also where another follows.
  std::vector<host::FlashProgress> shown;
  FlasherOptions options;
  options.progress = [&](const host::FlashProgress& now) {
    if (!shown.empty() && shown.back().phase != now.phase) {
      EXPECT_EQ(shown.back().done, shown.back().total) << host::progress_text(shown.back());
    }
    shown.push_back(now);
  };
  Flasher flasher(bench, bench, writer(), options);
  const auto entered = flasher.enter_loader();
  ASSERT_TRUE(entered) << entered.error().message;
  ASSERT_TRUE(*entered);
  EXPECT_TRUE(flasher.found()->by_loader);
  EXPECT_EQ(flasher.board_id(), KZ_BOARD_ID);
  const auto report = flasher.write(next);
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_FALSE(shown.empty());
  EXPECT_EQ(shown.back().phase, "verify");
  EXPECT_EQ(shown.back().done, shown.back().total);
  ASSERT_TRUE(flasher.erase({7, 8}));
  EXPECT_EQ(host::progress_text(shown.back()), "erase 2 of 2 blocks");
  // EB4 has the header; vectors and loader are the same.
  EXPECT_EQ(report->erased, 1);
  EXPECT_GE(report->unchanged, 2);
  ASSERT_TRUE(flasher.run(nullptr));
  EXPECT_EQ(bench.running_image(), next.identity()->crc);
  expect_no_misuse(bench);
}

TEST(Flash, UnchangedBlocksAreLeftAlone) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_loader());
  const auto report = flasher.write(firmware());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->erased, 0);
  EXPECT_EQ(report->written, 0u);
  for (const auto& block : bench.chip().flash_statistics().blocks) EXPECT_EQ(block.erase_pulses, 0);
}

TEST(Flash, LoaderWithoutAnApplicationWaitsForOne) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  bench.chip().poke(KZ_APPLICATION_HEADER, 0);
  ASSERT_TRUE(bench.sleep_until(std::chrono::seconds(20)));
  Flasher flasher(bench, bench, writer(), {});
  const auto entered = flasher.enter_loader();
  ASSERT_TRUE(entered) << entered.error().message;
  EXPECT_TRUE(*entered);
  ASSERT_TRUE(flasher.write(firmware()));
  ASSERT_TRUE(flasher.run(nullptr));
  EXPECT_EQ(bench.running_image(), firmware().identity()->crc);
}

// The host goes away in the middle: the loader starts the application again, which is whole.
TEST(Flash, LoaderLeavesWhereNobodyTalks) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_loader());
  ASSERT_TRUE(bench.sleep_until(bench.now() + std::chrono::seconds(11)));
  EXPECT_EQ(bench.running_image(), firmware().identity()->crc);
}

TEST(Flash, AnImageForAnotherBoardChangesNothing) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  const FlashImage other = changed(kBoardId, 0x0f);
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_loader());
  const auto report = flasher.write(other);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().fault, Fault::failed);
  for (const char* part : {"another board", "expected:", "found:", "1. ", "next:", "2128"})
    EXPECT_NE(full_text(report.error()).find(part), std::string::npos) << report.error().message;
  EXPECT_TRUE(holds(bench, firmware()));
  FlasherOptions force;
  force.force = true;
  Flasher again(bench, bench, writer(), force);
  ASSERT_TRUE(again.enter_loader());
  EXPECT_TRUE(again.write(other));
}

TEST(Flash, DamagedAndForeignImagesAreRefused) {
  FlashBench bench;
  FlasherOptions force;
  force.force = true;
  Flasher plain(bench, bench, writer(), {}), forced(bench, bench, writer(), force);
  FlashImage damaged = firmware();
  damaged.put(0x1300, std::array<std::uint8_t, 2>{1, 2});
  EXPECT_FALSE(plain.check(damaged, false));
  EXPECT_FALSE(forced.check(damaged, true));
  FlashImage foreign;
  foreign.put(0, std::array<std::uint8_t, 4>{0, 0, 1, 0});
  EXPECT_FALSE(plain.check(foreign, true));
  EXPECT_TRUE(forced.check(foreign, true));
  EXPECT_TRUE(plain.check(firmware(), true));
}

// A raw file of the firmware up to `end`, as a user would give it.
FlashImage raw_up_to(std::uint32_t end) {
  const std::string path = testing::TempDir() + "kaz-flash-" + std::to_string(getpid()) + ".bin";
  const FlashImage whole = firmware();
  const auto bytes = whole.bytes({0, end});
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(end));
  h8s::LoadOptions options;
  options.format = h8s::Format::raw;
  options.address = 0;
  auto image = FlashImage::load(path, options);
  std::remove(path.c_str());
  EXPECT_TRUE(image) << image.error().message;
  return *image;
}

TEST(Flash, AnImageCutOffWithinTheLoaderIsRefused) {
  FlashBench bench;
  FlasherOptions force;
  force.force = true;
  Flasher flasher(bench, bench, writer(), force);
  ASSERT_TRUE(flasher.check(raw_up_to(0xe000), true));
  for (const std::uint32_t end : {0xa000u, 0xc000u, 0xc800u, 0xdfe0u, 0xdfffu}) {
    const auto checked = flasher.check(raw_up_to(end), false);
    ASSERT_FALSE(checked) << end;
    EXPECT_EQ(checked.error().fault, Fault::usage);
    for (const char* part : {"loader", "cut off", "found:"})
      EXPECT_NE(full_text(checked.error()).find(part), std::string::npos)
          << checked.error().message;
  }
  // A byte of the loader, and a vector.
  for (const std::uint32_t at : {0xc100u, 0x0u, 0x3ffu}) {
    FlashImage damaged = firmware();
    damaged.put(at, std::array{static_cast<std::uint8_t>(~damaged.bytes({at, at + 1})[0])});
    EXPECT_FALSE(flasher.check(damaged, false)) << at;
  }
}

// It suits the resident loader, which keeps its own block; boot mode would erase that.
TEST(Flash, AnApplicationAloneGoesThroughTheLoaderOnly) {
  const FlashImage whole = changed(kBuildId, 0x21);
  FlashImage alone;
  const host::FlashRange part{
      KZ_APPLICATION, static_cast<std::uint32_t>(KZ_APPLICATION + whole.identity()->length)};
  alone.put(part.from, whole.bytes(part));
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  Flasher flasher(bench, bench, writer(), {});
  EXPECT_FALSE(flasher.check(alone, true));
  ASSERT_TRUE(flasher.enter_loader());
  const auto report = flasher.write(alone);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(flasher.left_behind(), "");
  ASSERT_TRUE(flasher.run(nullptr));
  EXPECT_EQ(bench.running_image(), whole.identity()->crc);

  FlashBench erased;
  Flasher boot(erased, erased, writer(), {});
  ASSERT_TRUE(boot.enter_boot(erased));
  EXPECT_FALSE(boot.write(alone));
}

TEST(Flash, AFailureSaysWhatItLeaves) {
  FlashBench bench;
  Flasher flasher(bench, bench, writer(), {});
  EXPECT_EQ(flasher.left_behind(), "");
  ASSERT_TRUE(flasher.enter_boot(bench));
  bench.unplug_at(bench.now() + milliseconds(500));
  EXPECT_FALSE(flasher.write(firmware()));
  for (const char* part : {"still in boot mode", "same command again"})
    EXPECT_NE(flasher.left_behind().find(part), std::string::npos) << flasher.left_behind();

  FlashBench running(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(running.sleep_until(milliseconds(200)));
  Flasher loader(running, running, writer(), {});
  ASSERT_TRUE(loader.enter_loader());
  EXPECT_EQ(loader.left_behind(), "");
  running.unplug_at(running.now() + milliseconds(500));
  EXPECT_FALSE(loader.write(changed(kBuildId, 3)));
  EXPECT_NE(loader.left_behind().find("loader waits"), std::string::npos) << loader.left_behind();
}

TEST(Flash, NobodyThereSaysWhatToLookAt) {
  FlashBench bench;
  bench.set_faults(nullptr);
  bench.cut_power_at(Time::zero(), std::chrono::hours(1));
  Flasher flasher(bench, bench, writer(), {});
  const auto none = flasher.enter_loader();
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
  const auto entered = flasher.enter_boot(bench);
  ASSERT_FALSE(entered);
  EXPECT_NE(full_text(entered.error()).find("not in boot mode"), std::string::npos);
  EXPECT_NE(full_text(entered.error()).find("found:    nothing"), std::string::npos);
}

TEST(Flash, WornBlockIsNamed) {
  h8s::Options options;
  options.flash_worn_block = 4;
  FlashBench bench(KAZ_FIRMWARE_IMAGE, options);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_loader());
  const auto report = flasher.write(changed(kBuildId, 1));
  ASSERT_FALSE(report);
  EXPECT_NE(full_text(report.error()).find("EB4"), std::string::npos) << report.error().message;
  EXPECT_NE(full_text(report.error()).find("worn"), std::string::npos);
  // Through boot mode the chip says so itself.
  Flasher boot(bench, bench, writer(), {});
  const auto entered = boot.enter_boot(bench);
  ASSERT_FALSE(entered);
  EXPECT_NE(full_text(entered.error()).find("cannot erase"), std::string::npos);
}

TEST(Flash, ReadsWhatStandsThere) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_loader());
  const auto bytes = flasher.read({0x1000, 0x1a40});
  ASSERT_TRUE(bytes) << bytes.error().message;
  const FlashImage image = firmware();
  EXPECT_TRUE(std::ranges::equal(*bytes, image.bytes({0x1000, 0x1a40})));
  EXPECT_TRUE(flasher.verify(image));
  const auto other = flasher.verify(changed(kBuildId, 1));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().fault, Fault::failed);
}

// The loader keeps vectors and itself; what stands there is compared all the same.
TEST(Flash, VerifyLooksAtVectorsAndLoaderToo) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_loader());
  for (const std::uint32_t at : {0x10u, 0xc100u}) {
    FlashImage image = firmware();
    const std::uint8_t other = image.bytes({at, at + 1})[0] ^ 1u;
    image.put(at, {&other, 1});
    const auto verified = flasher.verify(image);
    ASSERT_FALSE(verified) << at;
    EXPECT_EQ(verified.error().fault, Fault::failed);
    EXPECT_NE(full_text(verified.error()).find("vectors or loader (EB0, EB6) differ"),
              std::string::npos)
        << verified.error().message;
  }
}

// A copy of another board's whole flash: the application is taken from it, calibration and address are not.
TEST(Flash, ACopyOfAnotherBoardLeavesCalibrationAndAddress) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  for (const std::uint32_t at : {0x400u, 0x800u, 0xc00u}) bench.chip().poke(at, 0x5a);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  FlashImage copy = changed(kBuildId, 0x55);
  copy.put(0x400, std::vector<std::uint8_t>(0x400, 0xff));  // of a board that was never calibrated
  copy.put(0x800, std::vector<std::uint8_t>(0x800, 0xa5));
  std::vector<std::string> notes;
  FlasherOptions options;
  options.note = [&](const std::string& line) { notes.push_back(line); };
  Flasher flasher(bench, bench, writer(), options);
  ASSERT_TRUE(flasher.enter_loader());
  const auto report = flasher.write(copy);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->erased, 1);
  for (const std::uint32_t at : {0x400u, 0x800u, 0xc00u}) {
    std::uint8_t is = 0;
    bench.chip().peek(at, {&is, 1});
    EXPECT_EQ(is, 0x5a) << std::hex << at;
  }
  ASSERT_EQ(notes.size(), 3u);
  EXPECT_EQ(notes[2].find("EB3 keeps the board's address: the image"), 0u) << notes[2];
  const auto verified = flasher.verify(copy);
  ASSERT_FALSE(verified);
  EXPECT_NE(full_text(verified.error()).find("calibration or address (EB1 to EB3) differ"),
            std::string::npos)
      << verified.error().message;
  EXPECT_TRUE(flasher.verify(changed(kBuildId, 0x55)));
}

// Bytes ff of a file are compared as all others.
TEST(Flash, VerifyComparesBlankBytesToo) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  bench.chip().poke(0x18000, 0);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_loader());
  FlashImage image = firmware();
  EXPECT_TRUE(flasher.verify(image));
  image.put(0x18000, std::vector<std::uint8_t>(64, 0xff));
  const auto verified = flasher.verify(image);
  ASSERT_FALSE(verified);
  EXPECT_EQ(verified.error().fault, Fault::failed);
}

// Replies come later than they are waited for at first, and hardly any request is repeated for it.
TEST(Flash, SlowRepliesAreWaitedFor) {
  FlashBench bench;
  Flasher flasher(bench, bench, writer(), {});
  ASSERT_TRUE(flasher.enter_boot(bench));
  bench.set_latency(milliseconds(250));
  const auto report = flasher.write(firmware());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->repeated, 0);
  EXPECT_LT(report->repeated, 20);
  EXPECT_TRUE(holds(bench, firmware()));
}

// The loader keeps its own blocks: an update of nothing would pass for one.
TEST(Flash, AFileOfTheLoadersBlockAloneIsRefusedThroughTheLoader) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  FlasherOptions force;
  force.force = true;
  Flasher flasher(bench, bench, writer(), force);
  ASSERT_TRUE(flasher.enter_loader());
  FlashImage loader;
  loader.put(0xc100, std::array<std::uint8_t, 4>{1, 2, 3, 4});
  loader.put(0x20, std::array<std::uint8_t, 4>{1, 2, 3, 4});
  const auto report = flasher.write(loader);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().fault, Fault::usage);
  for (const char* part :
       {"cannot write any part of the image", "only bytes in EB0, EB6", "--reset"})
    EXPECT_NE(full_text(report.error()).find(part), std::string::npos) << report.error().message;
  EXPECT_TRUE(flasher.check(loader, true)) << "boot mode writes all of it";
  loader.put(0x8000, std::array<std::uint8_t, 4>{1, 2, 3, 4});
  EXPECT_TRUE(flasher.check(loader, false)) << "EB5 can be written";
}

// Three replies are there in time, but the program is kept waiting until its time-out has passed.
TEST(Flash, ALateProgramDoesNotGiveUpAHealthyBoard) {
  constexpr Time kPatience = milliseconds(60);
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(bench.sleep_until(milliseconds(200)));
  ASSERT_TRUE(Flasher(bench, bench, writer(), {}).enter_loader());
  bench.set_latency(milliseconds(16));  // of an FTDI adapter as the driver sets it
  host::StallingLine late(bench, bench);
  late.length = milliseconds(100);
  late.pause = milliseconds(50);
  host::LatenessMeter meter(late, late);
  late.stalls = 1;
  EXPECT_FALSE(host::WriterLink(meter, meter).info(kPatience, 1)) << "nobody measures lateness";
  late.stalls = 3;
  const auto info = host::WriterLink(meter, meter, &meter).info(kPatience, 1);
  EXPECT_TRUE(info) << info.error().message;
  // Late at every wait: the reply to the try before is found.
  late.stalls = 1000;
  late.pause = Time::zero();
  EXPECT_TRUE(host::WriterLink(meter, meter, &meter).info(kPatience, 1));
  // No reply and late: the first likely cause.
  bench.cut_power_at(bench.now(), std::chrono::hours(1));
  const auto never = host::WriterLink(meter, meter, &meter).info(kPatience, 1);
  ASSERT_FALSE(never);
  EXPECT_EQ(never.error().fault, Fault::environment);
  EXPECT_NE(full_text(never.error()).find("1. this machine is too busy"), std::string::npos)
      << never.error().message;
}

TEST(Flash, ADeadBoardIsGivenUpWithoutMoreTries) {
  FlashBench bench(KAZ_FIRMWARE_IMAGE);
  bench.cut_power_at(Time::zero(), std::chrono::hours(1));
  host::LatenessMeter meter(bench, bench);
  host::WriterLink link(meter, meter, &meter);
  const auto dead = link.info(milliseconds(60), 4);
  ASSERT_FALSE(dead);
  EXPECT_EQ(link.repeated(), 3);
  EXPECT_EQ(full_text(dead.error()).find("too busy"), std::string::npos) << dead.error().message;
}

TEST(Flash, NoiseIsRepeatedAway) {
  auto noise = faults::Schedule::parse("at 2 s for 60 s link_flip 0.0005\n", "test");
  ASSERT_TRUE(noise) << noise.error().message;
  FlashBench bench;
  bench.set_faults(&*noise);
  Flasher flasher(bench, bench, writer(), {});
  const auto entered = flasher.enter_boot(bench);
  ASSERT_TRUE(entered) << entered.error().message;
  const auto report = flasher.write(firmware());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->repeated, 0);
  EXPECT_TRUE(holds(bench, firmware()));
}

}  // namespace
}  // namespace kaz::flash_test
