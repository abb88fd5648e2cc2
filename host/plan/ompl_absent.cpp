// The planner of OMPL where OMPL is not installed.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/ompl_planner.h"

namespace kaz::plan {

Result<std::unique_ptr<Planner>> make_ompl_planner(const OmplOptions&) {
  return fail(Fault::environment,
              "the planner ompl is not in this build because OMPL was not found: install "
              "libompl-dev and rebuild, or use the planner grid");
}

}  // namespace kaz::plan
