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
#include "inference/decide.h"
#include "inference/estimator/evidence.h"

namespace photorque {

using inference::Verdict;
// Name as in diagnosis.json.
std::string name_of(Verdict verdict);

// A name with spaces in place of underscores.
std::string in_words(std::string name);

// One key of an experiment file with fitted numbers, in the unit in its name.
struct FittedParameter {
  std::string key;                 // "dipole_A_m2"
  std::vector<double> value;       // one number, or an array in the order of the file
  std::vector<double> sigma = {};  // one standard error of each; 0: fixed
  double neutral = 0.0;            // value without effect
};

// An effect of the catalogue that acts in addition to those of the experiment.
struct FoundEffect {
  std::string kind;          // name of a disturbance kind
  double probability = 0.0;  // posterior of it or of an indistinguishable effect, 0 to 1
  std::vector<FittedParameter> parameters;
  std::vector<std::string> indistinguishable_from;  // kinds that explain these data equally well
  std::string explanation;                          // one sentence of physics
  // Combinations of numbers that are identifiable although no single number is: "compliance_s2: x −
  // 0.99 z = (4.4 ± 0.1)×10⁻¹⁰".
  std::vector<std::string> known_together = {};
  // Parameters with text values: the node of a wall, the axes of a box.
  std::vector<std::pair<std::string, std::string>> texts = {};
  // Table of the effect in an experiment; empty: Diagnosis::effect_table.
  std::string table = {};
  // Initial states of a part that moves relative to the body, in the first recording, by the keys
  // of its kind.
  std::vector<FittedParameter> initial_states = {};
};

// Result of one domain if motion and light are recorded together.
struct DomainAnswer {
  std::string of;  // "motion", "light"
  Verdict verdict = Verdict::consistent;
  double confidence = 0.0;
  std::string sentence;
};

// Part of the torque that no known law explains, fitted as an empirical function of one variable or
// of two.
struct EmpiricalTorque {
  std::string variable;                  // "yaw", "tilt", "rate", "time", …
  std::string unit;                      // unit of `at`: "deg", "rad/s", "s", …
  bool about_lab_axes = false;           // components along lab axes; otherwise body axes
  std::vector<double> at;                // ascending
  std::vector<Vec3> torque_N_m;          // at each
  std::vector<Vec3> standard_error_N_m;  // one per torque; empty: unknown
  // The law with its constants and their errors, "T = (4.4 ± 0.1)e-06 N m cos(3 ψ − 95°) about the
  // vertical"; empty if there is no short formula.
  std::string formula = {};
  std::string looks_like = {};  // weak evidence: physics that commonly has this form
  // The law as a disturbance of the kind empirical_torque: keys with their values in TOML, and the
  // fitted ones.
  std::vector<std::pair<std::string, std::string>> shape = {};
  std::vector<FittedParameter> parameters = {};
};

// Location of the differences between recording and nominal model.
struct Where {
  struct ChannelMisfit {
    std::string name;              // "gyro_z_rad_s", "attitude_x_arcsec"
    double chi2_per_sample = 0.0;  // 1 for noise alone
    // The median of the squared residuals over that of a normal distribution, which is robust to
    // outliers and heavy tails.
    double chi2_of_median = 0.0;  // 0: unknown
  };
  std::vector<ChannelMisfit> channels;  // under the nominal model; worst first
  struct Interval {
    double from = 0.0, to = 0.0;
  };
  std::vector<Interval> intervals_s;  // in the first recording, in order of time
  std::optional<Interval> band_Hz;
  struct Dependence {
    std::string variable;  // tilt, heading, rate, time, charge, command, irradiance, …
    // Fraction of the difference that a function of it explains, 0 to 1; 0: not known.
    double strength = 0.0;
  };
  std::vector<Dependence> depends_on;  // strongest first
};

// One of the fully fitted explanations.
struct Alternative {
  std::vector<std::string> kinds;  // empty: nothing is missing
  std::string label = {};          // printed if the kind is not sufficient: "unknown in heading"
  double log_evidence_relative = 0.0;  // natural logarithm, relative to "nothing is missing"
  std::optional<double> holdout_chi2_per_sample = {};
  std::string remark = {};  // reason for rejection: "would feed energy"
  bool chosen = false;      // its model is reported
  std::string of = {};      // "motion" or "light", if both are recorded together
};

// Prediction of recordings that are never used in the fit.
struct Holdout {
  std::map<std::string, double> rms_before, rms_after;  // by channel, in the channel's unit
  double chi2_per_sample_before = 0.0;
  double chi2_per_sample_after = 0.0;
  int64_t samples = 0;
  // Prediction with the uncertainty of the parameters; empty: not computed.
  std::optional<inference::Predictive> predictive = {};
  double explained_fraction = 0.0;
};
// Fraction of the nominal model's residual above noise that another model explains, 0 to 1. It is 1
// if that residual is below five standard errors of noise, and 0 if the other model diverges.
double explained_fraction(double chi2_per_sample_before, double chi2_per_sample_after,
                          int64_t samples);

// Mean of two values, weighted by their numbers of samples; 0 without samples.
double weighted_mean(double a, int64_t samples_a, double b, int64_t samples_b);
// Adds χ² and number of samples of more held-out data. The prediction of the larger excess is kept;
// rms and explained fraction are unchanged.
void add_held_out(const Holdout& more, Holdout& all);

// An experiment that distinguishes effects which these data do not.
struct Manoeuvre {
  std::vector<std::string> separates;  // kinds
  std::string text;                    // "spin up to 1 rad/s and let it run down for 600 s"
  double log_evidence_expected = 0.0;  // expected lead of the true effect; 0: not computed
};

// One channel of one recording over time in full; the report thins it. All vectors have the length
// of `time_s`; NaN where a value is absent. If `measured` is empty, only residuals are plotted.
struct ChannelSeries {
  std::string name;   // "attitude_x_arcsec"
  std::string label;  // as printed: "Attitude about lab x"
  std::string unit;   // unit of measured, before and after
  std::vector<double> time_s;
  std::vector<double> measured, before, after;
  std::string residual_unit;                            // unit of the two below
  std::vector<double> residual_before, residual_after;  // measured − model
  double noise = 0.0;  // standard deviation of one reading, in residual_unit
};
// Attitude of the body over time (lab from body), if recorded. All vectors have the length of
// `time_s`. Those of the models are empty in a diagnosis of light, in which the motion is exact.
struct AttitudeSeries {
  std::vector<double> time_s;
  std::vector<Quat> measured;
  // Rotation vectors in lab axes from the predicted to the measured attitude, for the nominal and
  // the chosen model, and one standard error.
  std::vector<Vec3> off_before_rad, off_after_rad, error_rad;
};

// Readings of a scan or of current-voltage sweeps with both models, row by row: irradiance [W/m²],
// current [A]. All vectors have the length of `measured` or are empty.
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
  bool is_held_out = false;  // the whole recording
};

// The array on its receiver, map coordinates [m], and the parts that a found effect concerns.
struct DrawnArray {
  struct Cell {
    double u_low, u_high, v_low, v_high;
  };
  std::vector<Cell> cells;       // by cell number
  std::vector<size_t> suspects;  // indices of cells
  std::vector<Cell> shadows;     // hidden regions
};

// Initial state and length of the first recording, for a propagation with improved.toml.
struct Replay {
  std::string recording;  // path as given: commands and currents are read from it
  bool has_commands = false;
  double duration_s = 0.0;
  double output_rate_Hz = 10.0;
  std::array<double, 4> initial_attitude = {1, 0, 0, 0};  // w, x, y, z
  Vec3 initial_rate_rad_s = Vec3::Zero();                 // body axes
  double initial_time_s = 0.0;                            // as in the recording
  double initial_charge_C = 0.0;                          // drawn from the battery
  // For a sliding platform: position and velocity along lab x and y.
  std::optional<std::array<double, 4>> initial_place_m_m_s = {};
  double initial_turns = 0.0;  // whole turns about the only axis in addition to the attitude
};

// Finding about an instrument, for example noise that differs from the experiment's, or a clock
// error; never platform physics.
struct InstrumentFinding {
  std::string channel;  // "attitude_x_arcsec", "gyro_z_rad_s", "time"
  std::string what;     // "noise_level", "noise_correlation_time_s", …; `value` is in its unit
  double value = 0.0;
  double sigma = 0.0;  // standard error of the value; 0: unknown
  std::string text;    // one sentence
};

// Recordings of one body if others are of another body. The inertia tensor is in units of its mean
// moment, because motion without a known torque does not determine its scale.
struct BodyOfRecordings {
  std::vector<std::string> recordings;         // names as given
  std::vector<double> inertia_relative;        // Ixx, Iyy, Izz, Ixy, Ixz, Iyz
  std::vector<double> inertia_relative_sigma;  // standard error of each
};

// Rows, rejected and repaired readings, and gaps of the files.
struct DataQuality {
  int64_t rows = 0;
  int64_t used = 0;                         // rows with at least one fitted number
  std::map<std::string, int64_t> rejected;  // by reason: "outlier", "gap", "repeated_time", …
  std::map<std::string, int64_t> repaired;  // "flipped_quaternion", …
  double median_interval_s = 0.0;
  double jitter_s = 0.0;
  double max_gap_s = 0.0;
};

struct Diagnosis {
  Verdict verdict = Verdict::consistent;
  double confidence = 0.0;   // probability that verdict and names are correct
  std::string sentence;      // the finding, for the top of the report
  std::string because = {};  // decisive evidence for "unexplained"
  Where where;
  std::vector<FoundEffect> effects;
  std::vector<DomainAnswer> domains = {};  // for motion and light together; otherwise empty
  // Table of these effects in an experiment: [[disturbance]] for motion, [[effect]] for light.
  std::string effect_table = "disturbance";
  std::vector<EmpiricalTorque> empirical;
  // Unnamed effects that the reported model contains because its predictions require them.
  std::vector<FoundEffect> unnamed = {};
  double chi2_per_sample_before = 0.0;
  double chi2_per_sample_after = 0.0;
  int64_t samples = 0;                               // fitted numbers
  std::vector<Where::ChannelMisfit> channels_after;  // worst first; empty in a diagnosis of light
  std::optional<Holdout> holdout;
  std::vector<Alternative> alternatives;  // best first
  std::vector<Manoeuvre> manoeuvres;
  // Parameters with a prior, after the fit; keys as "disturbance[0].offset_m".
  std::vector<FittedParameter> priors_refined;
  std::vector<InstrumentFinding> instruments;
  std::vector<BodyOfRecordings> bodies;  // two or more: the recordings are of different bodies
  std::vector<std::string> warnings;     // "the quaternions look conjugated", …
  DataQuality data;
  std::vector<RecordingSeries> series;
  std::optional<DrawnArray> array = {};
  std::optional<Replay> replay;
};

// Sentence for an effect that only fitted and held-out recordings together show.
inline constexpr const char* undecided_effect =
    "only fitted and held-out recordings together show an effect, and they do not determine which "
    "one: see the alternatives";
// Sentence for held-out data that do not distinguish the named effects from the nominal model.
std::string untested_names(const Holdout& holdout);

}  // namespace photorque
