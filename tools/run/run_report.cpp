// result.json and the pictures of a run.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "host/flash/diagnostic.h"
#include "host/robot/connect.h"
#include "shared/board/board.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/drawing/figure.h"
#include "tools/run/outside_view.h"

namespace kaz::tools {
namespace {

using nlohmann::ordered_json;

constexpr double kDegrees = 180 / std::numbers::pi;

double rounded(double value, double unit) {
  return std::round(value / unit) / std::round(1 / unit);  // 0.3, where 3 * 0.1 is not
}

// At most ten samples a second: enough for a plot, small enough to read.
ordered_json thinned_errors(const Score& score) {
  ordered_json rows = ordered_json::array();
  double next = 0;
  for (std::size_t i = 0; i < score.time_s.size(); ++i) {
    if (score.time_s[i] < next) continue;
    next = score.time_s[i] + 0.0999;
    ordered_json row{{"t_s", rounded(score.time_s[i], 0.001)}};
    if (std::isnan(score.error_deg[i])) {
      row["deg"] = nullptr;
    } else {
      row["deg"] = rounded(score.error_deg[i], 0.001);
    }
    rows.push_back(row);
  }
  return rows;
}

ordered_json board_json(const BehaviorReport& report) {
  const double tick_8states = KZ_STATES_PER_TICK / 8.0;
  ordered_json json{{"firmware", host::firmware_version_text(report.identity.firmware_version)},
                    {"protocol", report.identity.protocol_version},
                    {"build", host::build_text(report.identity.build_id)},
                    {"missed_ticks", report.health.missed_ticks},
                    {"bad_frames", report.health.bad_check + report.health.bad_stuffing +
                                       report.health.too_short + report.health.too_long +
                                       report.health.line_errors}};
  // The native engine has no image and counts no states.
  if (report.identity.image_crc != 0) json["crc"] = host::hex_word(report.identity.image_crc);
  if (report.health.worst_8states != 0)
    json["worst_tick_share"] = rounded(report.health.worst_8states / tick_8states, 1e-4);
  return json;
}

ordered_json link_json(const host::LinkStatistics& link) {
  ordered_json json{{"requests", link.requests},   {"replies", link.replies},
                    {"timeouts", link.timeouts},   {"retries", link.retries},
                    {"refused", link.refused},     {"bad_frames", link.bad_frames},
                    {"bytes_out", link.bytes_out}, {"bytes_in", link.bytes_in}};
  if (link.replies == 0) return json;
  json["round_trip_s"] = rounded(link.round_trip.smoothed_s, 1e-6);
  json["round_trip_min_s"] = rounded(link.round_trip.min_s, 1e-6);
  json["round_trip_mean_s"] = rounded(link.round_trip.mean_s, 1e-6);
  json["round_trip_max_s"] = rounded(link.round_trip.max_s, 1e-6);
  return json;
}

ordered_json lateness_json(const RunLateness& lateness) {
  ordered_json json = ordered_json::object();
  if (lateness.simulator_lost_s)
    json["simulator_lost_s"] = rounded(*lateness.simulator_lost_s, 1e-3);
  json["host_late_s"] = rounded(lateness.host_late_s, 1e-3);
  json["host_worst_late_s"] = rounded(lateness.host_worst_late_s, 1e-3);
  return json;
}

figure::LinePlot joint_plot(const BehaviorReport& report, const std::string& title,
                            double behavior::CycleRow::*target,
                            double behavior::CycleRow::*measured,
                            double TruthProbe::Sample::*truth) {
  figure::Series target_curve{"target", figure::kOrange, {}, {}};
  figure::Series pot_curve{"potentiometer", figure::kBlue, {}, {}};
  figure::Series true_curve{"true", figure::kGreen, {}, {}};
  for (const auto& row : report.recording.cycles) {
    const double t = seconds(row.time - report.start);
    target_curve.x.push_back(t);
    target_curve.y.push_back(row.*target * kDegrees);
    pot_curve.x.push_back(t);
    pot_curve.y.push_back(row.*measured * kDegrees);
  }
  figure::LinePlot plot;
  plot.title = title;
  plot.y_label = "degrees";
  plot.series = {target_curve, pot_curve};
  if (report.probe != nullptr) {
    for (const auto& sample : report.probe->samples()) {
      true_curve.x.push_back(seconds(sample.time - report.start));
      true_curve.y.push_back(sample.*truth * kDegrees);
    }
    true_curve.style = figure::Series::Style::dashed;
    plot.series.push_back(true_curve);
  }
  return plot;
}

bool has_points(const figure::LinePlot& plot) {
  for (const figure::Series& series : plot.series) {
    for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
      if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) return true;
    }
  }
  return false;
}

// Plots without a point are left out.
figure::PlotPage tracking_page(const BehaviorReport& report) {
  figure::LinePlot error;
  error.title = "Angle between the left eye's axis and the ball";
  error.y_label = "degrees";
  error.series = {{"error", figure::kRed, report.score.time_s, report.score.error_deg}};
  error.lines = {{3.0, figure::kGrey, "3 degrees"}};
  error.y_min = 0;
  error.y_max = 12;
  figure::PlotPage page;
  page.title = report.behavior + " through the " + to_string(report.backend.mcu) + " mcu";
  if (report.probe == nullptr) page.title = report.behavior + " over " + report.backend.robot;
  page.x_label = "time, s";
  page.plots = {joint_plot(report, "Neck pan (positive: left)", &behavior::CycleRow::pan_target,
                           &behavior::CycleRow::pan_measured, &TruthProbe::Sample::pan_rad),
                joint_plot(report, "Neck tilt (positive: down)", &behavior::CycleRow::tilt_target,
                           &behavior::CycleRow::tilt_measured, &TruthProbe::Sample::tilt_rad),
                error};
  if (report.score.found_s) {
    for (auto& plot : page.plots) {
      plot.spans = {{*report.score.found_s, report.run_s, figure::kGreen, "tracking"}};
    }
  }
  std::erase_if(page.plots, [](const figure::LinePlot& plot) { return !has_points(plot); });
  return page;
}

// Writes the map as a picture. Returns false if the behavior has no map.
Result<bool> write_map(const BehaviorReport& report, const OutputFolder& folder) {
  if (report.map == nullptr || !*report.map) return false;
  KAZ_TRY(figure::write_png(folder.path("map.png"), **report.map));
  return true;
}

// What an onlooker sees at the start and at the end; nothing of a real robot. Returns the names written.
Result<std::vector<std::string>> write_start_and_end(const BehaviorReport& report,
                                                     sim::Simulation* simulation,
                                                     const OutputFolder& folder) {
  constexpr int kWidth = 640;
  if (simulation == nullptr || !report.start_pose) return std::vector<std::string>();
  const sim::Scene& scene = simulation->world().scene();
  std::vector<std::string> names;
  for (const auto& [name, pose] : {std::pair{"start.png", *report.start_pose},
                                   std::pair{"end.png", simulation->world().pose()}}) {
    const auto drawn =
        KAZ_TRY(simulation->picture(outside_view(scene, framing_of(scene, pose), kWidth), pose));
    KAZ_TRY(figure::write_png(folder.path(name), drawn));
    names.emplace_back(name);
  }
  return names;
}

Result<std::vector<std::string>> write_pictures(const BehaviorReport& report,
                                                const Snapshots& snapshots,
                                                const OutputFolder& folder) {
  auto names = snapshots.write(folder);
  if (!names) return names;
  if (KAZ_TRY(write_map(report, folder))) names->push_back("map.png");
  const figure::PlotPage page = tracking_page(report);
  if (page.plots.empty()) return names;
  for (const auto& [name, write] : {std::pair{"pan_tilt.png", &figure::write_plot_png},
                                    std::pair{"pan_tilt.svg", &figure::write_plot_svg}}) {
    if (snapshots.stopped()) break;
    KAZ_TRY(write(folder.path(name), page));
    names->push_back(name);
  }
  return names;
}

const char* word_of(const BehaviorReport& report) {
  if (report.interrupted) return "interrupted";
  if (report.machine_failed) return "environment";
  return report.outcome.success ? "done" : "failed";
}

// Returns the text that follows the outcome's sentence: ", by ground truth 98.2 %". Without ground truth, the
// score uses the same pictures as a tracking behavior, whose sentence already states this share.
std::string score_text(const BehaviorReport& report) {
  if (!report.score.found_s || !report.score.within_3deg) return "";
  const bool by_truth = report.score.measured_by == "truth";
  const bool stated = std::ranges::any_of(report.outcome.measurements, [](const auto& measurement) {
    return measurement.first == "tracking_within_3deg";
  });
  if (stated && !by_truth) return "";
  char text[120];
  std::snprintf(text, sizeof text, "%s by %s %.1f %%",
                stated ? "," : "; after the ball was found, within 3 degrees of the image center:",
                by_truth ? "ground truth" : "vision", 100 * *report.score.within_3deg);
  return text;
}

}  // namespace

const OutputKind& run_output() {
  static const OutputKind kind{
      "run",
      {"recording.mcap", "start.png", "end.png", "left_eye.png", "color_extraction.png",
       "outside.png", "moments.png", "moments.jpg", "map.png", "pan_tilt.png", "pan_tilt.svg",
       "vision.csv", "frames.txt", "result.json"}};
  return kind;
}

std::string growing_recording(const std::string& out) {
  return out + "/recording.mcap.part";
}

Result<std::string> place_recording(const OutputFolder& folder) {
  const std::string path = folder.path("recording.mcap");
  KAZ_TRY(put_in_place(growing_recording(folder.folder()), path));
  return path;
}

void add_times(ordered_json& result, double run_s, double rtf) {
  result["duration_s"] = rounded(run_s, 1e-3);
  result["rtf"] = rounded(rtf, 1e-3);
}

ordered_json broken_off_json(const char* outcome, const std::string& sentence,
                             const std::string& behavior, const BackendOptions& backend) {
  ordered_json result{
      {"outcome", outcome}, {"sentence", sentence}, {"behavior", behavior}, {"seed", backend.seed}};
  if (!backend.at_port()) {
    result["mcu"] = to_string(backend.mcu);
    result["world"] = backend.world;
    result["dynamics"] = backend.dynamics;
    result["physics_step_ms"] = backend.physics_step_ms;
    result["renderer"] = to_string(backend.renderer);
  } else {
    result["robot"] = backend.robot;
    result["camera"] = backend.camera;
  }
  result["provenance"] = provenance_json();
  return result;
}

Result<ordered_json> write_report(const BehaviorReport& report, sim::Simulation* simulation,
                                  const Snapshots& snapshots, const OutputFolder* folder,
                                  bool recorded) {
  ordered_json result{{"outcome", word_of(report)},
                      {"sentence", report.outcome.sentence},
                      {"behavior", report.behavior},
                      {"seed", report.backend.seed}};
  add_times(result, report.run_s, report.rtf);
  // What was not measured is absent.
  if (report.score.within_3deg)
    result["tracking_within_3deg"] = rounded(*report.score.within_3deg, 1e-4);
  if (report.score.rms_deg) result["tracking_rms_deg"] = rounded(*report.score.rms_deg, 1e-4);
  if (report.score.within_3deg || !report.score.time_s.empty())
    result["tracking_measured_by"] = report.score.measured_by;
  if (report.score.found_s) result["tracking_from_s"] = rounded(*report.score.found_s, 1e-3);
  if (report.interrupted) {
    mark_interrupted(result);
  } else if (!report.outcome.success && !report.machine_failed) {
    if (!report.outcome.cause.empty()) result["cause"] = report.outcome.cause;
  }
  for (const auto& [name, value] : report.outcome.measurements) {
    if (!result.contains(name) || result[name].is_null()) result[name] = rounded(value, 1e-6);
  }
  if (simulation != nullptr) {
    result["mcu"] = to_string(report.backend.mcu);
    if (const std::string emulator = simulation->board().mcu().emulator_engine(); !emulator.empty())
      result["emulator_engine"] = emulator;
    result["world"] = report.backend.world;
    result["dynamics"] = simulation->world().dynamics();
    result["physics_step_ms"] = report.backend.physics_step_ms;
    result["renderer"] = to_string(report.backend.renderer);
    if (simulation->world().dynamics() != "reduced")  // which has no gaps
      result["joint_gap_m"] = rounded(simulation->world().largest_joint_gap_m(), 1e-7);
    const sim::SolverDiagnostics& diagnostics = simulation->world().diagnostics();
    if (simulation->world().measures_convergence())
      result["unconverged_steps"] = diagnostics.unconverged_steps;
    if (diagnostics.unconverged_steps > 0) result["warning"] = diagnostics.summary();
  } else {
    result["robot"] = report.backend.robot;
    if (!report.camera_warning.empty()) result["warning"] = report.camera_warning;
  }
  if (!report.recording_sha256.empty()) result["recording_sha256"] = report.recording_sha256;
  result["provenance"] = provenance_json();
  result["board"] = board_json(report);
  result["link"] = link_json(report.link);
  if (report.lateness) result["lateness"] = lateness_json(*report.lateness);
  for (const faults::Fault& fault : report.not_begun)
    result["faults_not_begun"].push_back(faults::text_of(fault));
  if (!report.vision.empty()) result["vision"] = report.vision;
  if (report.profile) result["profile"] = profile_json(*report.profile);
  if (folder != nullptr) {
    if (recorded) {
      KAZ_TRY(place_recording(*folder));
      result["recording"] = "recording.mcap";
    }
    auto names = KAZ_TRY(write_start_and_end(report, simulation, *folder));
    // Drawing the others takes seconds, which an interrupted run has not.
    if (report.interrupted) {
      if (KAZ_TRY(write_map(report, *folder))) names.emplace_back("map.png");
      if (!names.empty()) result["pictures"] = names;
    } else {
      const auto others = KAZ_TRY(write_pictures(report, snapshots, *folder));
      names.insert(names.end(), others.begin(), others.end());
      result["pictures"] = names;
      // The run had ended: its outcome stands.
      if (snapshots.stopped()) {
        mark_interrupted(result);
        result["not_drawn"] = {{"other pictures", "interrupted while the pictures were drawn"}};
      } else if (report.looks && std::ranges::find(names, "pan_tilt.png") == names.end())
        result["not_drawn"] = {{"pan_tilt.png", "head and ball were not measured"}};
    }
    KAZ_TRY(folder->write("vision.csv", report.vision_table));
    if (!report.score.time_s.empty()) result["tracking_error"] = thinned_errors(report.score);
    KAZ_TRY(folder->write_json("result.json", result));
  }
  return result;
}

void print_report(const ordered_json& result, const BehaviorReport& report, const std::string& out,
                  bool json) {
  if (json) {
    print_json(result);
    return;
  }
  print_lines("%s: %s%s\n", word_of(report), report.outcome.sentence.c_str(),
              score_text(report).c_str());
  std::printf("%.1f s of robot time, %.1f times as fast as real time", report.run_s, report.rtf);
  if (report.health.worst_8states != 0) {  // native counts no states
    std::printf("; worst tick of the board %.0f %%",
                100 * report.health.worst_8states / (KZ_STATES_PER_TICK / 8.0));
  }
  std::printf("\n");
  if (!report.vision_text.empty())
    print_lines("vision, computing time per picture: %s\n", report.vision_text.c_str());
  if (result.contains("warning"))
    print_lines("warning: %s\n", result["warning"].get<std::string>().c_str());
  if (result.contains("recording_sha256")) {
    std::printf("recording %s\n", result["recording_sha256"].get<std::string>().c_str());
  }
  if (result.contains("not_drawn")) {
    for (const auto& [name, why] : result["not_drawn"].items())
      std::printf("no %s: %s\n", name.c_str(), why.get<std::string>().c_str());
  }
  if (report.profile) print_lines("%s", profile_text(*report.profile).c_str());
  const bool pictures = result.contains("pictures") && !result["pictures"].empty();
  if (!out.empty() && !report.interrupted)
    std::printf("%sresult.json %s in %s\n", pictures ? "pictures and " : "",
                pictures ? "are" : "is", out.c_str());
}

}  // namespace kaz::tools
