// photorque selftest: tests whether this machine computes correctly. It runs small experiments with
// known closed-form results through the same readers, tracer, propagator and writers as any other
// run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "tools/coupling/propagate.h"
#include "tools/runs/output_folder.h"
#include "tools/verbs/trace.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::selftest {
namespace {

namespace fs = std::filesystem;

constexpr double irradiance_W_m2 = 1361.0, area_m2 = 1.0, arm_m = 2.0;

// A square of 1 m² that faces up, 2 m along x from the body's origin (arm_m): four corners and two
// triangles as base64.
std::string plate_gltf() {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"name":"plate","translation":[2,0,0]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"materials":[{"name":"coat"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-0.5,0,-0.5],"max":[0.5,0,0.5]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)"
         "AAAAvwAAAAAAAAA/AAAAPwAAAAAAAAA/AAAAPwAAAAAAAAC/AAAAvwAAAAAAAAC/AAABAAIAAAACAAMA"
         R"("}]})";
}

std::string plate_toml(const std::string& optics) {
  return "[scene]\nfile = \"plate.gltf\"\n[[material]]\nname = \"coat\"\n" + optics +
         "\n[[source]]\nkind = \"sun\"\nirradiance_W_m2 = 1361\ndirection = [0, 0, -1]\n"
         "[[receiver]]\nnode = \"plate\"\nbins = [8, 8]\n"
         "[trace]\nrays = 262144\n";
}

std::string motion_toml(const std::string& law) {
  return "[platform]\ntopology = \"free\"\nmass_kg = 7.0\n"
         "inertia_kg_m2 = [[0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.1]]\n"
         "[environment]\ngravity_m_s2 = 9.80665\n[[disturbance]]\n" +
         law + "\n[propagate]\nduration_s = 10\ninitial_rate_rad_s = [0, 0, 0.5]\n";
}

// Main figures by name.
using Figures = std::map<std::string, Estimate>;

// Runs small experiments in a separate folder, and writes their results there.
class Bench {
 public:
  Bench(const RunOptions& options, const fs::path& folder) : options_(options), folder_(folder) {
    write_file_whole(folder_ / "plate.gltf", plate_gltf());
  }

  Figures trace(const std::string& toml, int threads = 0) const {
    return written("trace", run_trace(experiment(toml, threads), Console()));
  }
  Figures propagate(const std::string& toml) const {
    return written("propagate", run_propagate(experiment(toml, 0), Console()));
  }

 private:
  RunOptions experiment(const std::string& toml, int threads) const {
    RunOptions one = options_;
    one.experiment = folder_ / "experiment.toml";
    one.threads = threads;
    write_file_whole(one.experiment, toml);
    return one;
  }
  template <class Run>
  Figures written(const char* verb, const Run& run) const {
    write_run(run.result, folder_ / "results", verb);
    Figures figures;
    for (const Quantity& one : run.result.product.quantities) figures[one.name] = one.estimate;
    return figures;
  }

  const RunOptions& options_;
  fs::path folder_;
};

class Account {
 public:
  explicit Account(const Console& console) : console_(console) {}

  // Compares `found` with `expected`. The tolerance is six standard errors plus the fraction `part`
  // of `expected`, which covers approximations of the theory.
  void near(const std::string& what, const Estimate& found, double expected, double part) {
    constexpr double sigmas = 6.0;
    const bool right = std::abs(found.value - expected) <=
                       sigmas * found.standard_error + part * std::abs(expected);
    tell(what, right, show(found.value) + ", expected " + show(expected));
  }
  void tell(const std::string& what, bool right, const std::string& how) {
    checks_.push_back({{"name", what}, {"right", right}, {"result", how}});
    wrong_ += right ? 0 : 1;
    console_.line((right ? "  right  " : "  WRONG  ") + padded(what, 58) + how);
  }
  size_t checks() const { return checks_.size(); }
  int wrong() const { return wrong_; }
  std::string json() const {
    const nlohmann::ordered_json all = {
        {"schema", "photorque.selftest/1"}, {"wrong", wrong_}, {"checks", checks_}};
    return all.dump(2);
  }

 private:
  const Console& console_;
  nlohmann::ordered_json checks_ = nlohmann::ordered_json::array();
  int wrong_ = 0;
};

bool are_equal(const Figures& a, const Figures& b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) {
    return x.first == y.first && x.second.value == y.second.value &&
           x.second.standard_error == y.second.standard_error;
  });
}

void check_light(const Bench& bench, Account& account) {
  // The Sun's rays are inclined to each other by its angular radius, which reduces the momentum
  // along the axis by a quarter of the radius squared, 5e-6.
  constexpr double lean = 1e-5;
  const double power_W = irradiance_W_m2 * area_m2, force_N = power_W / speed_of_light_m_s;
  const auto black = bench.trace(plate_toml("absorptance = 1"));
  account.near("sunlight on a plate by quadrature [W]", black.at("power_on_plate_W"), power_W,
               1e-9);
  account.near("sunlight on a plate by rays [W]", black.at("direct_by_rays_on_plate_W"), power_W,
               1e-9);
  account.near("radiation force on a black plate [N]", black.at("force_z_body_body_N"), -force_N,
               lean);
  account.near("radiation torque about the origin [N m]", black.at("torque_y_body_body_N_m"),
               arm_m * force_N, lean);
  account.tell("power balance closes", black.at("ledger_closure").value < 1e-12,
               "to " + show(black.at("ledger_closure").value));
  const auto mirror = bench.trace(plate_toml("absorptance = 0\nspecular = 1"));
  account.near("radiation force on a mirror [N]", mirror.at("force_z_body_body_N"), -2.0 * force_N,
               lean);
  const auto one = bench.trace(plate_toml("absorptance = 0.3\ndiffuse = 0.7"), 1);
  const auto seven = bench.trace(plate_toml("absorptance = 0.3\ndiffuse = 0.7"), 7);
  account.tell("equal bits with one and seven threads", are_equal(one, seven), "");
}

void check_motion(const Bench& bench, Account& account) {
  constexpr double integrator = 1e-9;
  const auto drag =
      bench.propagate(motion_toml("kind = \"bearing_drag\"\ncoefficient_N_m_s = 0.01"));
  account.near("rate after viscous drag [rad/s]", drag.at("final_rate_rad_s"), 0.5 * std::exp(-1.0),
               integrator);
  const auto turbine =
      bench.propagate(motion_toml("kind = \"turbine_torque\"\ntorque_N_m = 0.001"));
  account.near("rate after a constant torque [rad/s]", turbine.at("final_rate_rad_s"),
               0.5 + 0.001 * 10.0 / 0.1, integrator);
  account.near("angle after a constant torque [deg]", turbine.at("final_yaw_deg"),
               std::remainder((0.5 * 10.0 + 0.5 * 0.01 * 100.0) / degree_rad, 360.0), integrator);
}

struct RemovedAtEnd {
  const fs::path& folder;
  ~RemovedAtEnd() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

void add_options(Command& command, CommandOptions& options) {
  command.add_common(options);
}

void run(const CommandOptions& options, const Program& program) {
  const Console console = terminal(options);
  const fs::path folder = temporary_beside(fs::temp_directory_path() / "photorque_selftest");
  std::optional<Interruption::Watch> watch;
  if (program.interruption != nullptr) watch.emplace(*program.interruption, folder.parent_path());
  Account account(console);
  {
    const RemovedAtEnd removed{folder};
    const Bench bench(options, folder);
    check_light(bench, account);
    check_motion(bench, account);
  }
  console.line(std::to_string(account.checks()) + " checks, " + std::to_string(account.wrong()) +
               " wrong");
  if (options.json) std::puts(account.json().c_str());
  if (account.wrong() > 0) {
    throw NumericalError(std::to_string(account.wrong()) + " of " +
                         std::to_string(account.checks()) + " checks of this machine are wrong");
  }
}

}  // namespace

Verb kind() {
  return {"selftest", "Comparison with closed forms on this machine, in seconds",
          command_with(add_options, run)};
}

}  // namespace photorque::verbs::selftest
