// docs/pictures/figure7.png: the map that slow vision makes while the head turns, and its figures.
// SPDX-License-Identifier: Apache-2.0
//
// figure7_picture FILE [WIDTH [WORLD]]    width of the eyes' pictures, 320 or 640 px; an SDF file
// of boxes on a floor
#include <cstdio>
#include <cstdlib>

#include "tests/studies/figure7/panels.h"
#include "tools/figure/figure.h"

int main(int count, char** words) {
  if (count < 2 || count > 4) {
    std::fprintf(stderr, "usage: figure7_picture FILE [WIDTH [WORLD]]\n");
    return 2;
  }
  kaz::figure7::Options options{KAZ_YARD, KAZ_ROBOT, KAZ_FIRMWARE_IMAGE};
  if (count >= 3) options.eye_width = std::atoi(words[2]);
  if (count == 4) options.world = words[3];
  const auto run = kaz::figure7::sweep(options);
  const auto done = run ? kaz::figure::write_png(words[1], kaz::figure7::panels(*run))
                        : kaz::Result<void>(tl::unexpected(run.error()));
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return static_cast<int>(done.error().fault);
  }
  for (const auto* map : {&run->with, &run->without}) {
    const auto s = kaz::figure7::score(kaz::figure7::edge_errors(*map, run->edges, 0.2, 0.8));
    std::printf(
        "%s frame information, %d pictures, %d places on edges: mean %+.1f mm, middle "
        "%.1f, 95 %% %.1f, all %.1f mm\n",
        map == &run->with ? "with" : "without", run->pictures, s.points, 1e3 * s.mean_m,
        1e3 * s.middle_m, 1e3 * s.p95_m, 1e3 * s.max_m);
  }
  return 0;
}
