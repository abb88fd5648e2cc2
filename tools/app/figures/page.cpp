// The figures on a page, beside what the paper shows.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/figures/page.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"

namespace kaz::tools {
namespace {

struct PaperFigure {
  int number;
  const char* caption;  // the paper's
  const char* paper;    // what it shows there
  const char* ours;
};

constexpr PaperFigure kPaperFigures[] = {
    {3, "Simulation environment for vision based behavior",
     "A red ball falls in front of the robot. The panels show the simulator and its view, color "
     "extraction, depth by block matching, and optical flow.",
     "All views show the frame with the largest motion of the ball since the previous frame. "
     "For this choice, downward motion has twice the weight of motion in other directions. "
     "Frames without ball, depth or flow are not used. The outside view shows the robot at the "
     "exposure."},
    {5, "Experimental setup: task of the robot is to approach the ball and catch it",
     "The robot, obstacles, and the ball behind them.",
     "The world before the robot moves, from its right and from above."},
    {6, "Visual processing and local map representation of the experiment",
     "(A) planes (red) in pictures from looking around; (B) the floor of each picture in foot "
     "coordinates; (C) the merged map, brighter where the floor is more certain; (D) the planned "
     "path.",
     "Panels (A) to (D) are from one walk of the virtual robot. In (B) to (D) the robot is at the "
     "bottom center and forward is up. Floor is white, obstacles are black, unseen cells are gray. "
     "The path was planned on this map."},
    {7, "Frame information messaging in visual processing modules",
     "Each module passes on the posture that the robot had at the exposure, because the head has "
     "moved by the time the results arrive.",
     "Two maps show the results of the same sweep: one with the eyes' pose at the exposure, the "
     "other with the eyes' pose when the result arrives. Black lines are the true edges of the "
     "boxes, which are unknown to the robot."},
    {8, "Vision based behavior program in simulation world and real world",
     "The behaviors search-ball, track-ball and catch-ball, in the simulation and on the real "
     "robot.",
     "The simulated catch. Below each view is the picture of the left eye. This figure shows "
     "no real robot."},
};

const char* const kStyle = R"(
figure { margin: 1em 0 } figure img { max-width: 100%; height: auto; border: 1px solid #ddd }
dt { font-weight: 600 } dd { margin: 0 0 .6em 0 }
)";

const PaperFigure& figure_of(int number) {
  return *std::ranges::find(kPaperFigures, number, &PaperFigure::number);
}

std::string section(const PaperFigure& figure, const nlohmann::ordered_json& facts) {
  const std::string number = std::to_string(figure.number);
  std::string text = "<h2>Figure " + number + ": " + xml_text(figure.caption) + "</h2>\n";
  text += "<figure><img src=\"" + xml_text(facts.value("file", std::string())) +
          "\" alt=\"figure " + number + "\"></figure>\n";
  text += "<dl><dt>Paper</dt><dd>" + xml_text(figure.paper) + "</dd><dt>Here</dt><dd>" +
          xml_text(figure.ours) + "</dd></dl>\n";
  nlohmann::ordered_json numbers = facts;
  numbers.erase("file");
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  return text + "<details><summary>numbers</summary><pre>" +
         xml_text(numbers.dump(2, ' ', false, replace)) + "</pre></details>\n";
}

}  // namespace

std::string paper_caption(int number) {
  return figure_of(number).caption;
}

std::string figures_page(const nlohmann::ordered_json& result) {
  std::string text = hil::page_head("Figures of the paper", kStyle);
  text +=
      "<h1>Figures of the paper</h1>\n<p class=\"facts\">Each figure is from one run of the "
      "virtual robot";
  text += ", seed " + result.at("seed").dump() + ", " +
          xml_text(result.at("provenance").value("date", std::string())) + ": " +
          xml_text(result.at("provenance").value("command", std::string())) + "</p>\n";
  for (const PaperFigure& figure : kPaperFigures) {
    const auto facts = result.at("figures").find(std::to_string(figure.number));
    if (facts != result.at("figures").end()) text += section(figure, *facts);
  }
  if (result.contains("not_drawn")) {
    for (const auto& [number, why] : result["not_drawn"].items())
      text += "<p class=\"failed\">Figure " + xml_text(number) +
              " is missing: " + xml_text(why.get<std::string>()) + "</p>\n";
  }
  return text + hil::kPageEnd;
}

}  // namespace kaz::tools
