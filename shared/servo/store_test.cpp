// The logs in flash: newest copy, where the next one goes, damage, torn copies, wear, numbers that
// go round.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/store.h"
#include "shared/servo/startup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <random>

#include "shared/protocol/messages.h"

namespace kaz::test {
namespace {

using Block = std::array<u8, KZ_STORE_BLOCK>;
using Line = std::array<u8, KZ_STORE_LINE>;

// Flash that is written line by line.
struct Flash {
  Flash() {
    for (Block& b : block) b.fill(0xFF);
  }
  std::array<const u8*, 2> images() const { return {block[0].data(), block[1].data()}; }
  kz_store scan(u8 blocks = KZ_CALIBRATION_BLOCKS, u8 parts = KZ_CALIBRATION_PARTS) const {
    kz_store store;
    kz_store_scan(&store, images().data(), blocks, parts);
    return store;
  }
  // Programming clears bits only.
  void program(u8 which, int line, const Line& bytes) {
    for (int i = 0; i < KZ_STORE_LINE; ++i) block[which][line * KZ_STORE_LINE + i] &= bytes[i];
  }
  u8* line(int which, int number) { return block[which].data() + number * KZ_STORE_LINE; }
  std::array<Block, 2> block;
};

struct Values {
  std::array<s16, KZ_JOINTS> centre, scale;
  explicit Values(int seed = 0) {
    for (int j = 0; j < KZ_JOINTS; ++j) {
      centre[j] = static_cast<s16>(seed * 37 - 100 * j);
      scale[j] = static_cast<s16>(16000 + seed + j);
    }
  }
  bool operator==(const Values&) const = default;
};

kz_store_plan plan_for(const Flash& flash) {
  const kz_store store = flash.scan();
  kz_store_plan plan;
  kz_store_plan_next(&store, &plan);
  return plan;
}

// The steps of a store: optional erasure, then three lines. Does the first `steps` of them.
constexpr int kAllSteps = 4;
kz_store_plan store(Flash& flash, const Values& values, int steps = kAllSteps) {
  const kz_store before = flash.scan();
  kz_store_plan plan;
  kz_store_plan_next(&before, &plan);
  if (plan.erase && steps > 0) flash.block[plan.block].fill(0xFF);
  for (u8 part = 0; part < KZ_CALIBRATION_PARTS && part + 1 < steps; ++part) {
    u8 data[KZ_STORE_DATA];
    Line line;
    kz_store_pack_calibration(data, part, values.centre.data(), values.scale.data());
    kz_store_encode(line.data(), &before, &plan, part, data);
    flash.program(plan.block, plan.line + part, line);
  }
  return plan;
}

std::optional<Values> load(const Flash& flash) {
  const kz_store found = flash.scan();
  kz_startup startup;
  kz_startup_nominal(&startup);
  kz_store_load_calibration(&found, flash.images().data(), &startup);
  if (startup.calibration == KZ_CALIBRATION_NOMINAL) return std::nullopt;
  EXPECT_EQ(startup.calibration, found.block == 0 ? KZ_CALIBRATION_A : KZ_CALIBRATION_B);
  Values values;
  std::copy_n(startup.pot_centre, KZ_JOINTS, values.centre.begin());
  std::copy_n(startup.pot_scale, KZ_JOINTS, values.scale.begin());
  return values;
}

TEST(Store, BlankBlocksHoldNothing) {
  const Flash flash;
  const kz_store found = flash.scan();
  EXPECT_EQ(found.sequence, 0);
  EXPECT_EQ(found.erases[0], 0);
  EXPECT_FALSE(load(flash));
  const kz_store_plan plan = plan_for(flash);
  EXPECT_EQ(plan.sequence, 1);
  EXPECT_EQ(plan.block, 0);
  EXPECT_EQ(plan.line, 0);
  EXPECT_EQ(plan.erase, 0);
}

// By hand from the header's description.
TEST(Store, LineIsAsDescribed) {
  Flash flash;
  Values values;
  values.centre[6] = 0x1234;
  values.scale[6] = -2;
  store(flash, values);
  const u8* line = flash.line(0, 1);
  EXPECT_EQ(line[0], 0);
  EXPECT_EQ(line[1], 1);  // sequence
  EXPECT_EQ(line[2], 1);  // part
  EXPECT_EQ(line[3], 0);  // erases
  EXPECT_EQ(line[4], 0x12);
  EXPECT_EQ(line[5], 0x34);
  EXPECT_EQ(line[6], 0xFF);
  EXPECT_EQ(line[7], 0xFE);
  EXPECT_EQ(line[28], 0);  // erases of block B
  EXPECT_EQ(line[29], 0xFF);
  u16 crc = 0xFFFF;
  for (int i = 0; i < 30; ++i) {
    crc ^= static_cast<u16>(line[i] << 8);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<u16>(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
  }
  EXPECT_EQ(line[30] << 8 | line[31], crc);
}

TEST(Store, NewestOfManyCountsAndBlocksAlternate) {
  Flash flash;
  for (int i = 1; i <= 200; ++i) {
    const kz_store_plan plan = store(flash, Values(i));
    const int round = (i - 1) / 10;  // ten copies of three lines fit in a block
    EXPECT_EQ(plan.block, round % 2);
    EXPECT_EQ(plan.line, (i - 1) % 10 * 3);
    EXPECT_EQ(plan.erase, i > 10 && (i - 1) % 10 == 0);
    EXPECT_EQ(load(flash), Values(i));
    const kz_store found = flash.scan();
    EXPECT_EQ(found.sequence, i);
    EXPECT_EQ(found.erases[0], round / 2);
    EXPECT_EQ(found.erases[1], (round + 1) / 2);
  }
}

TEST(Store, AStoreThatStopsAtAnyStepLeavesTheOldOrTheNewCopy) {
  for (int copies = 0; copies < 45; ++copies) {
    for (int steps = 0; steps <= kAllSteps; ++steps) {
      Flash flash;
      for (int i = 1; i <= copies; ++i) store(flash, Values(i));
      store(flash, Values(99), steps);
      const auto left = load(flash);
      if (steps == kAllSteps) {
        EXPECT_EQ(left, Values(99));
      } else if (copies == 0) {
        EXPECT_FALSE(left);
      } else {
        EXPECT_EQ(left, Values(copies)) << copies << " copies, " << steps << " steps";
      }
      store(flash, Values(100));
      EXPECT_EQ(load(flash), Values(100));
    }
  }
}

// The step that power ended moved any of its bits, and this happens again and again.
TEST(Store, TornLinesAndErasuresNeverCostTheLastCopy) {
  std::mt19937 random(7);
  Flash flash;
  store(flash, Values(0));
  Values kept(0);
  for (int i = 1; i <= 4000; ++i) {
    const int steps = static_cast<int>(random() % (kAllSteps + 1));
    const Flash before = flash;
    const kz_store_plan plan = store(flash, Values(i), steps);
    if (steps == kAllSteps) {
      kept = Values(i);
    } else {
      // The next step, cut off: some of the bits that it moves have moved.
      Flash whole = before;
      store(whole, Values(i), steps + 1);
      for (std::size_t at = 0; at < flash.block[plan.block].size(); ++at) {
        u8& cell = flash.block[plan.block][at];
        const u8 moves = cell ^ whole.block[plan.block][at];
        cell ^= moves & static_cast<u8>(random() & random());  // a quarter: never all of them
      }
    }
    ASSERT_EQ(load(flash), kept) << "store " << i;
  }
}

TEST(Store, OneDamagedBitMakesTheCopyBeforeCount) {
  for (int byte = 0; byte < KZ_CALIBRATION_PARTS * KZ_STORE_LINE; ++byte) {
    Flash flash;
    store(flash, Values(1));
    store(flash, Values(2));
    flash.line(0, 3)[byte] ^= static_cast<u8>(1 << byte % 8);
    EXPECT_EQ(load(flash), Values(1)) << byte;
    store(flash, Values(3));
    EXPECT_EQ(load(flash), Values(3)) << byte;
    EXPECT_EQ(flash.scan().block, 0);
  }
}

TEST(Store, PartsOfDifferentCopiesAreNoCopy) {
  Flash flash;
  store(flash, Values(1), 3);  // parts 0 and 1
  store(flash, Values(2), 2);  // part 0
  Flash other;
  store(other, Values(5));
  flash.program(0, 3, [&] {
    Line line;
    std::copy_n(other.line(0, 2), KZ_STORE_LINE, line.begin());
    return line;
  }());
  EXPECT_FALSE(load(flash));
  EXPECT_EQ(plan_for(flash).line, 4);
}

TEST(Store, FullBlockWithoutACopyMakesWayInTheOther) {
  Flash flash;
  flash.block[0].fill(0x00);
  const kz_store_plan plan = store(flash, Values(1));
  EXPECT_EQ(plan.block, 1);
  EXPECT_EQ(plan.erase, 1);
  EXPECT_EQ(load(flash), Values(1));
  EXPECT_EQ(flash.scan().erases[1], 1);
}

TEST(Store, NumbersGoRoundWithoutZero) {
  Flash flash;
  const auto with_number = [&flash](u16 last, const Values& values) {
    kz_store before = flash.scan();
    before.last = last;
    kz_store_plan plan;
    kz_store_plan_next(&before, &plan);
    for (u8 part = 0; part < KZ_CALIBRATION_PARTS; ++part) {
      u8 data[KZ_STORE_DATA];
      Line line;
      kz_store_pack_calibration(data, part, values.centre.data(), values.scale.data());
      kz_store_encode(line.data(), &before, &plan, part, data);
      flash.program(plan.block, plan.line + part, line);
    }
  };
  with_number(0xFFFD, Values(1));
  EXPECT_EQ(flash.scan().sequence, 0xFFFE);
  store(flash, Values(2));
  EXPECT_EQ(flash.scan().sequence, 0xFFFF);
  EXPECT_EQ(load(flash), Values(2));
  store(flash, Values(3));
  EXPECT_EQ(flash.scan().sequence, 1);
  EXPECT_EQ(load(flash), Values(3));
  for (int i = 4; i < 30; ++i) {
    store(flash, Values(i));
    EXPECT_EQ(flash.scan().sequence, i - 2);
    EXPECT_EQ(load(flash), Values(i));
  }
}

TEST(Store, CountOfErasuresStopsAt255AndOutlivesAnErasedBlock) {
  Flash flash;
  for (int i = 0; i < 10; ++i) store(flash, Values(i));
  for (int round = 0; round < 300; ++round) {
    for (int i = 0; i < 10; ++i) store(flash, Values(i));
    EXPECT_EQ(flash.scan().erases[1], std::min(255, round + 1));
    for (int i = 0; i < 10; ++i) store(flash, Values(i));
    EXPECT_EQ(flash.scan().erases[0], std::min(255, round + 1));
  }
  flash.block[1].fill(0xFF);
  EXPECT_EQ(flash.scan().erases[1], 255);
}

TEST(Store, AddressLog) {
  Flash flash;
  const auto put = [&flash](u8 address, u8 shared_line) {
    const kz_store before = flash.scan(KZ_ADDRESS_BLOCKS, KZ_ADDRESS_PARTS);
    kz_store_plan plan;
    kz_store_plan_next(&before, &plan);
    if (plan.erase) flash.block[plan.block].fill(0xFF);
    u8 data[KZ_STORE_DATA];
    Line line;
    kz_store_pack_address(data, address, shared_line);
    kz_store_encode(line.data(), &before, &plan, 0, data);
    flash.program(plan.block, plan.line, line);
    return plan;
  };
  const auto get = [&flash] {
    const kz_store found = flash.scan(KZ_ADDRESS_BLOCKS, KZ_ADDRESS_PARTS);
    kz_startup startup;
    kz_startup_nominal(&startup);
    kz_store_load_address(&found, flash.images().data(), &startup);
    return std::pair<int, int>(startup.address, startup.shared_line);
  };
  EXPECT_EQ(get(), (std::pair<int, int>(KZ_ADDRESS_DEFAULT, 0)));
  for (int i = 0; i < 100; ++i) {
    const kz_store_plan plan = put(static_cast<u8>(1 + i % 14), i % 2);
    EXPECT_EQ(plan.block, 0);
    EXPECT_EQ(plan.line, i % 32);
    EXPECT_EQ(plan.erase, i > 0 && i % 32 == 0);
    EXPECT_EQ(get(), (std::pair<int, int>(1 + i % 14, i % 2)));
  }
  EXPECT_EQ(flash.scan(KZ_ADDRESS_BLOCKS, KZ_ADDRESS_PARTS).erases[0], 3);
  put(15, 0);
  EXPECT_EQ(get(), (std::pair<int, int>(KZ_ADDRESS_DEFAULT, 0))) << "15 is no board's address";
}

}  // namespace
}  // namespace kaz::test
