// Checks of the options of `kaz flash`, before a port is opened.
// SPDX-License-Identifier: Apache-2.0
#include "tools/flash/arguments.h"

#include <algorithm>
#include <string>
#include <vector>

#include "tools/base/arguments.h"

namespace kaz::tools {
namespace {

Result<void> check_erase(const FlashArguments& arguments) {
  if (arguments.reset.empty()) {
    if (arguments.blocks.empty())
      return fail(Fault::usage,
                  "no blocks are selected: give --blocks N,N to erase blocks, or --reset HOW to "
                  "erase the whole flash, including calibration and address");
    const auto kept = [](int block) {
      return block == host::kVectorBlock || block == host::kLoaderBlock;
    };
    if (std::ranges::any_of(arguments.blocks, kept))
      return fail(
          Fault::usage,
          "the loader erases neither EB0 (vectors) nor EB6 (the loader); to erase the whole "
          "flash through boot mode, give --reset HOW and leave out --blocks");
    std::vector<int> sorted = arguments.blocks;
    std::ranges::sort(sorted);
    if (const auto twice = std::ranges::adjacent_find(sorted); twice != sorted.end())
      return fail(Fault::usage,
                  "--blocks contains EB" + std::to_string(*twice) + " twice; give each block once");
    return {};
  }
  if (arguments.blocks.empty()) return {};
  return fail(Fault::usage,
              "--blocks is not valid with --reset, because boot mode erases the whole flash; leave "
              "out one of the two options");
}

}  // namespace

Result<void> check(const FlashArguments& arguments) {
  if (arguments.from + arguments.length > host::kFlashBytes)
    return fail(Fault::usage, "the flash ends at 0x01ffff; give --from and --length within it");
  if (arguments.port.empty() && !arguments.dry_run)
    return fail(Fault::usage, "--robot is missing: give serial:PATH of the board's port");
  if (arguments.port.empty()) return {};
  const std::string port = KAZ_TRY(parse_port(arguments.port)).name();
  if (arguments.port != port && arguments.port != "serial:" + port)
    return fail(
        Fault::usage,
        "--robot " + arguments.port +
            ": the loader always uses 115,200 baud, so give no baud rate here. For boot mode, set "
            "the baud rate with --boot-baud. Give " +
            host::robot_option(port));
  if (!arguments.writer.empty() && arguments.reset.empty())
    return fail(Fault::usage,
                "--writer is only valid with boot mode: give --reset HOW too; the resident loader "
                "has its own writer");
  if (arguments.verb == "erase") return check_erase(arguments);
  return {};
}

}  // namespace kaz::tools
