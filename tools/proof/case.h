// Injected cases: a platform, two runs, and what acts on it without being nominal.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/proof/motion.h"

namespace photorque {

struct InjectedRun {
  InjectedStart start;
  std::vector<InjectedCommand> commands;
  double duration_s = 0.0;
};

// How the errors of one instrument differ from independent normal ones of the stated level.
struct InjectedNoise {
  double scale = 1.0;          // level, in units of the stated one
  double time_s = 0.0;         // of their correlation, exp(−t/time); 0: none
  int student_degrees = 0;     // 3, 4, …: of Student's t, scaled to the level; 0: normal
  double outlier_share = 0.0;  // of the readings, at five times the level
  double step_sigma = 0.0;     // of what is reported, in units of the stated level; 0: fine

  bool is_as_stated() const {
    return scale == 1.0 && time_s == 0.0 && student_degrees == 0 && outlier_share == 0.0 &&
           step_sigma == 0.0;
  }
};

// Realistic instruments.
struct InjectedSensors {
  double rate_Hz = 10.0;                      // rows, and the gyro
  int camera_every = 1;                       // rows from one attitude to the next
  Triple camera_noise_arcsec = {37, 37, 12};  // as the experiment states
  double gyro_noise_rad_s = 2e-4;
  InjectedNoise camera, gyro;
  bool has_gyro = true, has_commands = true;  // columns of the recording
  bool dirty = false;  // drop-outs, gaps, outliers, jittered times, sign flips, a preamble
};

// What the experiment file says; sigma 0: stated as exact.
struct InjectedPriors {
  Triple offset_m = {}, offset_sigma_m = {};
  double drag_N_m_s = 0.0, drag_sigma_N_m_s = 0.0;
  double gyro_bias_sigma_rad_s = 0.0;
};

struct InjectedCase {
  std::string name;    // "magnetic_dipole_02"
  std::string family;  // none | single | pair | outside | triple | known_unknown | noise_none | …
  std::string maker;   // of platform and motion: "first", or "second" with its kind of motion
  std::string topology;
  uint64_t seed = 0;
  InjectedWorld world;
  InjectedPriors priors;
  InjectedSensors sensors;
  std::array<InjectedRun, 2> runs;  // recording and hold-out

  // The truth, for scoring.
  std::string verdict;
  std::vector<std::vector<std::string>> accept;  // sets of names that count as right
  std::vector<std::string> depends_on;
  // By how much the effects change chi² of the first run beyond all that the uncertain priors and
  // the unknown start can take up; of the weakest one where there are several.
  double chi2_gain = 0.0;
};

struct InjectedPlan {
  uint64_t seed = 1;
  int per_kind = 4;  // of every kind of the catalogue: strong, medium, weak, below the limit, …
  int none = 30;     // with nothing missing
  int pairs = 12;    // of two effects
  int outside = 3;   // of every law outside the catalogue
  int triples = 0;   // of three effects
  int known_unknown = 0;         // of one effect and one law outside
  int noise_none = 0;            // with nothing missing, and noise that is not as stated
  int noise_effect = 0;          // of one effect under correlated noise
  double strong_fraction = 0.0;  // of the strong single effects: chi² gains up to 1e9
  double second_fraction = 0.0;  // of all cases: platforms and motions of the second maker
  double duration_s = 400.0;
  double holdout_s = 300.0;
  std::vector<double> rates_Hz = {10.0, 20.0};
  double dirty_fraction = 0.3;
};

// How many cases a plan has.
size_t case_count(const InjectedPlan& plan);
// The i-th of them: the same plan gives the same cases, in whatever order they are drawn.
// NumericalError where none that shows is found.
InjectedCase draw_case(const InjectedPlan& plan, size_t index);

}  // namespace photorque
