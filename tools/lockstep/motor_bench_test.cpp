#include <cstdio>
#include <gtest/gtest.h>
#include "sim/body/motor_bench.h"
#include "tools/lockstep/stand_rig.h"
#include "sim/board/sensor_file.h"
namespace kaz::lockstep {
TEST(MotorBench, Prints) {
  sim::SimulationOptions options;
  options.sensors = *sim::sensors_by_name("nominal"); if (getenv("S")) options.seed = std::stoul(getenv("S"));
  options.sensor_figures = *sim::load_sensor_file("shared/robot/kaz/sensors.xml");
  auto made = sim::make_stand(options, {.motor = sim::test::motor_figures(), .disc_kgm2 = getenv("D") ? atof(getenv("D")) : 4e-4});
  ASSERT_TRUE(made);
  StandRig rig(std::move(*made));
  hil::BenchReport report;
  hil::Limits limits;
  hil::BenchJudge judge(report, limits, [&](const hil::Measurement& m) {
    std::printf("%8.2f s %-24s %9.4f +- %.4f %-8s [%g %g] %s %s\n", kaz::seconds(rig.clock().now()), m.of->name.c_str(), m.value, m.error, m.of->unit.c_str(), m.low, m.high, hil::verdict_text(m.verdict), m.message.c_str());
  });
  hil::MotorBenchOptions bench;
  if (const char* f = getenv("F")) bench.filter = f;
  int k=0; bench.progress=[&](double, const std::string&){}; auto& st=*sim::stand_of(rig.simulation()); (void)k; (void)st;
  auto ran = rig.run(bench, judge);

  ASSERT_TRUE(ran) << ran.error().message;
  if (getenv("P")) for (auto& p : report.plots) for (auto& s : p.series) { std::printf("# %s %s\n", p.id.c_str(), s.name.c_str()); for (auto& [x,y] : s.points) std::printf("%g %g\n", x, y); }
}
}
namespace kaz::lockstep {
TEST(MotorBench, Truth) {
  sim::SimulationOptions options;
  options.sensors = *sim::sensors_by_name("nominal"); if (getenv("S")) options.seed = std::stoul(getenv("S"));
  options.sensor_figures = *sim::load_sensor_file("shared/robot/kaz/sensors.xml");
  auto made = sim::make_stand(options, {.motor = sim::test::motor_figures(), .disc_kgm2 = getenv("D") ? atof(getenv("D")) : 4e-4});
  StandRig rig(std::move(*made));
  auto robot = host::Robot::connect(rig.link(), rig.clock(), hil::bench_connection());
  hil::MotorOnBench m(*robot, &rig.stand(), 2);
  m.go_to(m.lower_rad()+0.1);
  (void)robot->unlock(60);
  (void)robot->raw_drive(2, 1, std::chrono::milliseconds(200));
  for (int i = 0; i < 150; ++i) { (void)rig.simulation().step(); if (i%10==0) { auto& j = rig.simulation().world().joints()[2]; std::printf("%d w %.4f V %.4f T %.1f angle %.4f A %.3f\n", i, j.velocity, rig.simulation().board().supply_volts(), j.winding_celsius, j.angle, j.current);} }
  m.come_to_rest(); m.go_to(m.lower_rad()+0.1); std::printf("from true %.5f\n", rig.simulation().world().joints()[2].angle);
  double f = hil::mean_angle(m.watch(0.3)); std::printf("told %.5f\n", f);
  auto tr = m.drive(1, 1.9, 0.6);
  std::printf("now true %.5f w %.4f\n", rig.simulation().world().joints()[2].angle, rig.simulation().world().joints()[2].velocity);
  for (auto& q : tr) std::printf("%.3f %.4f %.3f\n", q.t_s, q.angle_rad, q.volts);
  // backlash
  m.come_to_rest(); m.go_to(m.middle_rad());
  for (int i = 0; i < 6; ++i) {
    (void)rig.stand().press(2, i % 2 ? 0.03 : -0.03); m.wait(0.3);
    auto t = m.watch(1);
    std::printf("true %.5f told %.5f n %zu\n", rig.simulation().world().joints()[2].angle, hil::mean_angle(t), t.size());
  }
}
}
#include "tools/lockstep/motor_fit.h"
namespace kaz::lockstep {
TEST(MotorFit, Recovers) {
  sim::SimulationOptions options;
  options.sensors = *sim::sensors_by_name("nominal");
  options.sensor_figures = *sim::load_sensor_file("shared/robot/kaz/sensors.xml");
  for (int k = 0; k < 4; ++k) {
  auto altered = sim::test::motor_figures();
  const double f = k % 2 ? 1.3 : 0.75, g = k / 2 ? 0.85 : 1.2;
  altered.friction_nm *= f; altered.backlash_rad *= 2 - f; altered.stall_slope_nm_per_v *= g; altered.stiction_ratio = k%2 ? 1.1 : 1.6;
  altered.back_emf_nms_per_rad *= 2.1 - g; altered.rotor_inertia_kgm2 *= k%2 ? 0.7 : 1.6; altered.winding_heat_capacity *= 1.4;
  auto made = sim::make_stand(options, {.motor = altered});
  StandRig rig(std::move(*made));
  hil::BenchReport report; hil::Limits limits; hil::BenchJudge judge(report, limits);
  auto rr = rig.run({}, judge); if (!rr) { for (auto& m: report.measurements) std::printf("%s %g %s\n", m.of->name.c_str(), m.value, m.message.c_str()); FAIL() << rr.error().message << " k " << k; }
  auto fit = fit_motor(report, {.joint = "", .start = sim::test::motor_figures(), .board = options, .progress = nullptr});
  ASSERT_TRUE(fit) << fit.error().message;
  const double truth[] = {altered.stall_slope_nm_per_v, altered.friction_nm, altered.back_emf_nms_per_rad, altered.stiction_ratio, altered.rotor_inertia_kgm2, altered.backlash_rad, altered.winding_heat_capacity};
  std::printf("rounds %d change %.4f\n", fit->rounds, fit->last_change);
  for (size_t i = 0; i < fit->figures.size(); ++i) std::printf("%-24s before %.5f true %.5f fitted %.5f off %.2f %%\n", fit->figures[i].name.c_str(), fit->figures[i].before, truth[i], fit->figures[i].after, 100*(fit->figures[i].after/truth[i]-1));
  for (auto& q : fit->gaps) std::printf("   %-24s %8.4f before %8.4f after %8.4f %s\n", q.name.c_str(), q.measured, q.before, q.after, q.unit.c_str());
  }
}
}
