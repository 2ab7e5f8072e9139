// Only its own file names a kind of disturbance: others use its properties.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/architecture/tree.h"

namespace {

using namespace photorque::tree;

// Files outside a kind's own that hold its name in quotes, and why.
const std::map<std::string, std::set<std::string>> allowed = {
    // A gyro has a bias, and senses the turning Earth, whether the torques are modelled or not.
    {"attitude/filtering/motion_model.cpp", {"earth_rotation", "gyro_bias"}},
    // `balance` measures this kind.
    {"attitude/studies/balance.cpp", {"static_unbalance"}},
    // A chart and a key of diagnosis.json that had this name before the kind.
    {"tools/pages/charts.cpp", {"empirical_torque"}},
    {"diagnosis/json.cpp", {"empirical_torque"}},
    // Written into improved.toml and into a first experiment.
    {"diagnosis/improved.cpp", {"empirical_torque"}},
    {"diagnosis/guess/motion.cpp", {"sliding_spring"}},
    // Motion and light share this kind.
    {"diagnosis/light/together.cpp", {"gravity_tilt"}},
    // Kinds of the same form, named by one of the two.
    {"attitude/disturbances/bearing/turbine_torque.cpp", {"room_draft"}},
    {"attitude/disturbances/mass/battery_discharge.cpp", {"mass_shift", "static_unbalance"}},
    // A key of that table's name.
    {"attitude/disturbances/fields/helmholtz_cage.cpp", {"orbit"}},
    // `new` writes these kinds.
    {"tools/verbs/new_experiment.cpp", {"bearing_drag", "static_unbalance"}},
    // The orbit takes the direction of the Sun, and the planet's light that of the orbit; drag
    // needs an orbit.
    {"tools/runs/attitude_run.cpp", {"aerodynamic_drag", "orbit", "planet_light"}},
    // Light in the run is this kind; kinds with the same effect are refused.
    {"attitude/disturbances/fields/light_pressure.cpp", {"radiation_pressure"}},
    {"tools/coupling/couple.cpp", {"power_balance", "radiation_pressure"}},
    // Around a platform in orbit there is no air that cools its cells.
    {"tools/runs/array_power.cpp", {"orbit"}},
    // The trade compares ways by the disturbances that they are.
    {"tools/supply/onboard.cpp", {"battery_discharge", "tether"}},
    // A key of [environment.sun]: the path about the Sun.
    {"attitude/environment/sun.cpp", {"orbit"}},
};

// Name and own file of every kind, from the folder's list of words.
std::map<std::string, std::string> kinds_of_the_list() {
  static const std::regex word(R"(disturbances/[a-z]+/([a-z_]+)(?!\.cpp|[a-z_]))");
  std::string list = text_of(root / "attitude/CMakeLists.txt");
  list.erase(list.find("photorque_folder"));
  std::map<std::string, std::string> kinds;
  for (std::sregex_iterator it(list.begin(), list.end(), word), end; it != end; ++it) {
    kinds[(*it)[1]] = "attitude/" + it->str() + ".cpp";
  }
  return kinds;
}

TEST(KindNames, StandInTheKindsOwnFileAlone) {
  static const std::regex quoted(R"re("([a-z_]+)")re");
  const std::map<std::string, std::string> kinds = kinds_of_the_list();
  ASSERT_GT(kinds.size(), 30u);
  std::map<std::string, std::set<std::string>> found;
  for (const std::string folder : {"attitude", "diagnosis", "inference", "tools"}) {
    for (const fs::path& path : sources_of(folder)) {
      const std::string file = fs::relative(path, root).generic_string();
      if (file.starts_with("tools/benchmarks/")) continue;  // a benchmark keeps its cases
      const std::string text = without_comments(text_of(path));
      for (std::sregex_iterator it(text.begin(), text.end(), quoted), end; it != end; ++it) {
        const auto kind = kinds.find((*it)[1]);
        if (kind != kinds.end() && kind->second != file) found[file].insert(kind->first);
      }
    }
  }
  EXPECT_EQ(found, allowed);
}

}  // namespace
