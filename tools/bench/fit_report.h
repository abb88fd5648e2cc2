// Reports a fit of the motor model as JSON, HTML and text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hil/report/provenance.h"
#include "tools/lockstep/motor_fit.h"

namespace kaz::tools {

nlohmann::ordered_json fit_json(const lockstep::MotorFit& fit);
// Returns a page with the parameters, the residuals before and after the fit, and the curves. `report`: name
// of the bench report. `from`: time, program version and command of the fit.
std::string fit_html(const lockstep::MotorFit& fit, const std::string& report,
                     const hil::Provenance& from);
// Returns the parameters and the residuals of the fit as lines of text.
std::string fit_text(const lockstep::MotorFit& fit);

}  // namespace kaz::tools
