// A short form of the table: things are in the map before the robot reaches them, and floor is floor.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/studies/map_table/table.h"

namespace kaz::map_table {
namespace {

TEST(MapTable, ThingsOnFloorsWithAPatternAreInTheMapInTime) {
  for (const char* name : {"carpet box 2 cm high", "wood can", "checker box, dark side"}) {
    SCOPED_TRACE(name);
    const auto rows = measure(name, 1, 501, sim::kDefaultRenderer);
    ASSERT_TRUE(rows) << rows.error().message;
    ASSERT_EQ(rows->size(), 1U);
    const Found& f = rows->front().found;
    EXPECT_EQ(f.in_time, f.things);
    EXPECT_GT(f.floor_cells, 1000);
    EXPECT_LT(f.floor_wrong, 0.02 * f.floor_cells);
  }
}

}  // namespace
}  // namespace kaz::map_table
