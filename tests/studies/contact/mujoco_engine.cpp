// Tosses on MuJoCo: Newton's method and elliptic cones.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <memory>

#include <mujoco/mujoco.h>

#include "sim/body/description/libmujoco.h"
#include "tests/studies/contact/engine.h"

namespace kaz::contact {
namespace {

struct DeleteModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};

// Both geoms have the same contact parameters, so that MuJoCo's rules of mixing do not matter.
enum Value { kMu, kStiffness, kDamping, kImpedance, kFloor };

std::string model_text(int steps) {
  std::array<char, 900> text{};
  std::snprintf(text.data(), text.size(),
                "<mujoco><option timestep='%.17g' gravity='0 0 %.17g' solver='Newton' "
                "cone='elliptic' tolerance='1e-10'/><worldbody>"
                "<geom type='plane' size='9 9 1' condim='3'/>"
                "<body><freejoint/><inertial pos='0 0 0' mass='%.17g' diaginertia='%.17g %.17g "
                "%.17g'/><geom type='box' size='%.17g %.17g %.17g' condim='3'/></body>"
                "</worldbody></mujoco>",
                1 / (kRate * steps), -kGravity, kCubeMass, kCubeInertia, kCubeInertia, kCubeInertia,
                kHalf, kHalf, kHalf);
  return text.data();
}

void set_contact(mjModel& model, std::span<const double> values) {
  for (int geom = 0; geom < model.ngeom; ++geom) {
    model.geom_friction[3 * geom] = values[kMu];
    mjtNum* solref = model.geom_solref + mjNREF * geom;
    solref[0] = -values[kStiffness];
    solref[1] = -values[kDamping];
    mjtNum* solimp = model.geom_solimp + mjNIMP * geom;
    solimp[0] = solimp[1] = values[kImpedance];
  }
  model.geom_pos[2] = values[kFloor];
}

void set_start(mjData& data, const Toss& toss) {
  const Pose& pose = toss.path.front();
  const Eigen::Vector3d spin = pose.turn.conjugate() * toss.spin.front();  // body axes
  const std::array<double, 7> at{pose.at.x(),   pose.at.y(),   pose.at.z(),  pose.turn.w(),
                                 pose.turn.x(), pose.turn.y(), pose.turn.z()};
  std::copy(at.begin(), at.end(), data.qpos);
  for (int k = 0; k < 3; ++k) {
    data.qvel[k] = toss.velocity.front()[k];
    data.qvel[3 + k] = spin[k];
  }
}

Result<Path> simulate_in_mujoco(const mjModel& base, int steps, const Toss& toss,
                                std::span<const double> values) {
  const std::unique_ptr<mjModel, DeleteModel> model(mj_copyModel(nullptr, &base));
  const std::unique_ptr<mjData, DeleteData> data(mj_makeData(model.get()));
  if (!model || !data)
    return fail(Fault::environment, "MuJoCo cannot allocate its data; free some memory");
  set_contact(*model, values);
  set_start(*data, toss);
  Path path{toss.path.front()};
  while (path.size() < toss.path.size()) {
    for (int i = 0; i < steps; ++i) mj_step(model.get(), data.get());
    const mjtNum* q = data->qpos;
    const Pose pose{{q[0], q[1], q[2]}, Eigen::Quaterniond(q[3], q[4], q[5], q[6]).normalized()};
    const bool valid = pose.at.allFinite() && pose.turn.coeffs().allFinite();
    path.push_back(valid ? pose : path.back());
  }
  return path;
}

}  // namespace

Result<Engine> mujoco_engine(int steps) {
  const auto model = KAZ_TRY(sim::compile_mujoco({{"cube.xml", model_text(steps)}}, "cube.xml"));
  // MuJoCo's own handler writes a file.
  mju_user_warning = [](const char*) {};
  Engine engine;
  engine.name = "mujoco";
  engine.parameters = {{"mu", "", 0.02, 1, 0.18, true},
                       {"stiffness", "1/s2", 1e3, 1e7, 3e4, true},
                       {"damping", "1/s", 1, 1e4, 100, true},
                       {"impedance", "", 0.3, 0.999, 0.95, false},
                       {"floor", "m", -0.005, 0.002, -0.001, false}};
  engine.simulate = [model, steps](const Toss& toss, std::span<const double> values) {
    return simulate_in_mujoco(*model, steps, toss, values);
  };
  return engine;
}

}  // namespace kaz::contact
