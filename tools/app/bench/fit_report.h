// A fit of the motor model for machines and people.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hil/report/provenance.h"
#include "tools/lockstep/motor_fit.h"

namespace kaz::tools {

nlohmann::ordered_json fit_json(const lockstep::MotorFit& fit);
// One page with the parameters, the gap before and after, and the curves. `report`: the report's name;
// `from`: when, by which program and command the fit was made.
std::string fit_html(const lockstep::MotorFit& fit, const std::string& report,
                     const hil::Provenance& from);
// The same parameters and gaps as lines of text.
std::string fit_text(const lockstep::MotorFit& fit);

}  // namespace kaz::tools
