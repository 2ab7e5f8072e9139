// Result of `diagnose` as plain data. The engine fills it; the writers of diagnosis.json,
// improved.toml and report.html read it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/transform.h"
#include "inference/estimator/evidence.h"

namespace photorque {

enum class Verdict {
  consistent,       // differences are noise, or within the uncertainty that the user stated
  missing_physics,  // the effects named explain all that differs
  unexplained,      // structure is left after the best known physics
};
// As in diagnosis.json.
std::string name_of(Verdict verdict);

// One key of an experiment file with its fitted numbers, in the unit that the key names.
struct FittedParameter {
  std::string key;                 // "dipole_A_m2"
  std::vector<double> value;       // one number, or an array in the order of the file
  std::vector<double> sigma = {};  // one standard error of each; 0: was not fitted
  double neutral = 0.0;            // the value with which nothing acts
};

// An effect of the catalogue that acts in addition to those of the experiment.
struct FoundEffect {
  std::string kind;          // name of a disturbance kind
  double probability = 0.0;  // that it acts, given the recordings, 0 to 1
  std::vector<FittedParameter> parameters;
  std::vector<std::string> indistinguishable_from;  // kinds that explain these data as well
  std::string explanation;                          // one sentence of physics
  // Combinations of numbers that are determined where no single number is: "compliance_s2: x − 0.99
  // z = (4.4 ± 0.1)×10⁻¹⁰".
  std::vector<std::string> known_together = {};
  // Parameters that are texts: the node of a wall, the axes of a box.
  std::vector<std::pair<std::string, std::string>> texts = {};
  // Under which table an experiment has it; empty: Diagnosis::effect_table.
  std::string table = {};
  // Initial states of a part that moves beside the body, in the first recording, by the keys of its
  // kind.
  std::vector<FittedParameter> begins = {};
};

// Result of recordings of one kind, where motion and light were recorded together.
struct DomainAnswer {
  std::string of;  // "motion", "light"
  Verdict verdict = Verdict::consistent;
  double confidence = 0.0;
  std::string sentence;
};

// Part of the torque that no known law explains, fitted without a law as a function of one
// variable, or of two.
struct EmpiricalTorque {
  std::string variable;                  // "yaw", "tilt", "rate", "time", …
  std::string unit;                      // of `at`: "deg", "rad/s", "s", …
  bool about_lab_axes = false;           // components along lab axes; otherwise body axes
  std::vector<double> at;                // rises
  std::vector<Vec3> torque_N_m;          // at each
  std::vector<Vec3> standard_error_N_m;  // of each; empty: unknown
  // The law with its constants and their errors, "T = (4.4 ± 0.1)e-06 N m cos(3 ψ − 95°) about the
  // vertical"; empty where no short one does it.
  std::string formula = {};
  std::string looks_like = {};  // physics that commonly looks like this
  // The law as a disturbance of the kind empirical_torque: keys with their values in TOML, and
  // those that were fitted.
  std::vector<std::pair<std::string, std::string>> shape = {};
  std::vector<FittedParameter> parameters = {};
};

// Where recording and nominal model part.
struct Where {
  struct ChannelMisfit {
    std::string name;              // "gyro_z_rad_s", "attitude_x_arcsec"
    double chi2_per_sample = 0.0;  // 1 for noise alone
    // The median of the squared residuals over that of a normal distribution, which outliers and
    // heavy tails do not move.
    double chi2_of_median = 0.0;  // 0: unknown
  };
  std::vector<ChannelMisfit> channels;  // under the nominal model; worst first
  struct Interval {
    double from = 0.0, to = 0.0;
  };
  std::vector<Interval> intervals_s;  // of the first recording, in order of time
  std::optional<Interval> band_Hz;
  struct Dependence {
    std::string variable;   // tilt, heading, rate, time, charge, command, irradiance, …
    double strength = 0.0;  // fraction of the difference that a function of it explains, 0 to 1
  };
  std::vector<Dependence> depends_on;  // strongest first
};

// One explanation among those that were fitted in full.
struct Alternative {
  std::vector<std::string> kinds;  // empty: nothing is missing
  std::string label = {};          // printed where the kind does not say it: "unknown in heading"
  double log_evidence_relative = 0.0;  // natural logarithm, over that of "nothing is missing"
  std::optional<double> holdout_chi2_per_sample = {};
  std::string remark = {};  // why it was not chosen: "would feed energy"
  bool chosen = false;      // its model is the one that is reported
  std::string of = {};      // "motion" or "light", where both were recorded together
};

// Recordings against the prediction, numbers never used in the fit.
struct Holdout {
  std::map<std::string, double> rms_before, rms_after;  // by channel, in the channel's unit
  double chi2_per_sample_before = 0.0;
  double chi2_per_sample_after = 0.0;
  int64_t samples = 0;
  // How the model predicts them with the uncertainty of its parameters; empty: it was not asked.
  std::optional<inference::Predictive> predictive = {};
  double explained_fraction = 0.0;
};
// The fraction of the nominal model's residual beyond noise that another model explains, 0 to 1; 1
// where that residual is less than five standard errors of noise, 0 where the other diverges.
double explained_fraction(double chi2_per_sample_before, double chi2_per_sample_after,
                          int64_t samples);

// An experiment that distinguishes effects which these data do not.
struct Manoeuvre {
  std::vector<std::string> separates;  // kinds
  std::string text;                    // "spin up to 1 rad/s and let it run down for 600 s"
  double log_evidence_expected = 0.0;  // by which the right one would lead; 0: not computed
};

// One channel of one recording over time, in full; the report thins it. All vectors have the length
// of `time_s`; NaN where there is no number. `measured` may be empty: then only residuals are
// drawn.
struct ChannelSeries {
  std::string name;   // "attitude_x_arcsec"
  std::string label;  // as printed: "Attitude about lab x"
  std::string unit;   // of measured, before and after
  std::vector<double> time_s;
  std::vector<double> measured, before, after;
  std::string residual_unit;                            // of the two below
  std::vector<double> residual_before, residual_after;  // measured − model
  double noise = 0.0;  // one standard deviation of one reading, residual_unit
};
// Attitude of the body over time, lab from body, where a recording has it. All vectors have the
// length of `time_s`; those of the models are empty where light was diagnosed: there the motion is
// exact.
struct AttitudeSeries {
  std::vector<double> time_s;
  std::vector<Quat> measured;
  // Rotation vectors about lab axes from the camera readings of the nominal and of the chosen model
  // to the real readings, and one standard error of them.
  std::vector<Vec3> off_before_rad, off_after_rad, error_rad;
};

// Readings of a scan or of current-voltage sweeps beside both models, row by row: irradiance
// [W/m²], current [A]. All vectors have the length of `measured`, or are empty.
struct LightSeries {
  std::string name;               // "irradiance_W_m2", "current_A"
  std::vector<double> u_m, v_m;   // scans: map coordinates
  std::vector<double> voltage_V;  // sweeps
  std::vector<int> sweep;
  std::vector<Quat> lab_from_body;
  std::vector<double> measured, before, after;
  std::vector<double> noise;  // one standard deviation; empty: unknown
};

struct RecordingSeries {
  std::string recording;  // file name
  std::vector<ChannelSeries> channels;
  std::vector<Where::Interval> held_out_s;  // never used in the fit
  AttitudeSeries attitude = {};
  std::optional<LightSeries> light = {};
  bool is_held_out = false;  // all of it
};

// The array on its receiver, map coordinates [m], and the parts that a found effect concerns.
struct DrawnArray {
  struct Cell {
    double u_low, u_high, v_low, v_high;
  };
  std::vector<Cell> cells;       // by their numbers
  std::vector<size_t> suspects;  // of them
  std::vector<Cell> shadows;     // regions that something hides
};

// State and length of the first recording, so that improved.toml can propagate it again.
struct Replay {
  std::string recording;  // path as given: commands and currents are read from it
  bool has_commands = false;
  double duration_s = 0.0;
  double output_rate_Hz = 10.0;
  std::array<double, 4> initial_attitude = {1, 0, 0, 0};  // w, x, y, z
  Vec3 initial_rate_rad_s = Vec3::Zero();                 // body axes
  double initial_time_s = 0.0;                            // as in the recording
  double initial_charge_C = 0.0;                          // drawn from the battery
  // Of a platform that slides: place and velocity along lab x and y.
  std::optional<std::array<double, 4>> initial_place_m_m_s = {};
};

// Finding about an instrument: noise that differs from the experiment's, clocks. Never platform
// physics.
struct InstrumentFinding {
  std::string channel;  // "attitude_x_arcsec", "gyro_z_rad_s", "time"
  std::string what;     // "noise_level", "noise_correlation_time_s", …; `value` is in its unit
  double value = 0.0;
  double sigma = 0.0;  // standard error of the value; 0: has none
  std::string text;    // one sentence
};

// Recordings that are of one body, where others are of another: its inertia tensor in units of its
// mean moment, which is all that motion without a known torque determines.
struct BodyOfRecordings {
  std::vector<std::string> recordings;         // names as given
  std::vector<double> inertia_relative;        // Ixx, Iyy, Izz, Ixy, Ixz, Iyz
  std::vector<double> inertia_relative_sigma;  // of each
};

// Rows, rejected and repaired readings, and gaps of the files.
struct DataQuality {
  int64_t rows = 0;
  int64_t used = 0;                         // rows of which a number entered the fit
  std::map<std::string, int64_t> rejected;  // by reason: "outlier", "gap", "repeated_time", …
  std::map<std::string, int64_t> repaired;  // "flipped_quaternion", …
  double median_interval_s = 0.0;
  double jitter_s = 0.0;
  double max_gap_s = 0.0;
};

struct Diagnosis {
  Verdict verdict = Verdict::consistent;
  double confidence = 0.0;   // probability that the verdict and the names are right
  std::string sentence;      // the finding in one sentence, for the top of the report
  std::string because = {};  // of "unexplained": which evidence decided it
  Where where;
  std::vector<FoundEffect> effects;
  std::vector<DomainAnswer> domains = {};  // of motion and light together; else empty
  // Under which table an experiment has such effects: [[disturbance]] of motion, [[effect]] of
  // light.
  std::string effect_table = "disturbance";
  std::vector<EmpiricalTorque> empirical;
  // Effects that the reported model contains beside these without naming them: its predictions need
  // them.
  std::vector<FoundEffect> unnamed = {};
  double chi2_per_sample_before = 0.0;
  double chi2_per_sample_after = 0.0;
  int64_t samples = 0;                               // numbers that were fitted
  std::vector<Where::ChannelMisfit> channels_after;  // worst first; empty where light was diagnosed
  std::optional<Holdout> holdout;
  std::vector<Alternative> alternatives;  // best first
  std::vector<Manoeuvre> manoeuvres;
  // Parameters with a prior, after the fit; keys as "disturbance[0].offset_m".
  std::vector<FittedParameter> priors_refined;
  std::vector<InstrumentFinding> instruments;
  std::vector<BodyOfRecordings> bodies;  // two or more: the recordings are not of one body
  std::vector<std::string> warnings;     // "the quaternions look conjugated", …
  DataQuality data;
  std::vector<RecordingSeries> series;
  std::optional<DrawnArray> array = {};
  std::optional<Replay> replay;
};

}  // namespace photorque
