// A recording with its forward model: expected readings for a state.
//
// The state determines, in this order, the light of each lamp on every place, the signals (readings
// of a scan; photocurrents of every cell at every instant), and the residuals, whitened by their
// noise:
//   scan    (measured − predicted)/σ
//   sweep   the signed distance of a point from the curve, in standard errors
//   run     voltage and current of the maximum at which the tracker operates; if the tracker's
//           steps are stated, the distance from the curve as for a sweep
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include "diagnosis/light/model/illumination.h"
#include "diagnosis/light/model/recording.h"
#include "photovoltaics/network/curve.h"

namespace photorque {

// Fields of all lamps and walls at one state; fields of equal geometry are shared.
struct LightFields {
  struct Part {
    LampGeometry geometry;
    std::shared_ptr<const LampField> field;
  };
  std::vector<Part> lamps;
  std::map<std::pair<size_t, bool>, std::vector<Part>> walls;  // by wall and whether specular
};

// Derivatives of the residuals with respect to the signals.
struct SignalSlopes {
  // Scans: ∂r/∂signal of each residual. Sweeps and runs: ∂r/∂photocurrent of each cell.
  std::vector<double> of_scan;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_photocurrent;
};

class LightRun {
 public:
  // Throws InputError if a sweep or a run has no array, or if noise is neither stated nor found.
  LightRun(const LightLab& lab, LightRecording recording);

  const LightRecording& recording() const { return recording_; }
  const LightLab& lab() const { return *lab_; }
  // Number of the recording in a diagnosis, from 0; held-out recordings come last.
  int number() const { return number_; }
  void set_number(int number) { number_ = number; }
  size_t rows() const { return recording_.rows(); }
  // Number of residuals, and the channel of each.
  size_t samples() const { return sample_row_.size(); }
  const std::vector<int>& sample_channel() const { return sample_channel_; }
  // The readings that are compared with the model.
  struct Expected;
  struct Channel {
    const char* name;  // "irradiance_W_m2", "current_A", "array_voltage_V", …
    std::vector<double> LightRecording::*measured;
    double Expected::*expected;
  };
  const std::vector<Channel>& channels() const { return channels_; }
  double row_noise(size_t row) const { return irradiance_sigma_[row]; }

  // Selects rows.
  LightRun part(const std::vector<size_t>& rows) const;
  // For a scan: selects the fields of the chosen rows for its part.
  static LightFields part(const LightFields& fields, const std::vector<size_t>& rows);
  // Copies the recording and its noise to another nominal model.
  LightRun in(const LightLab& lab) const;

  // Reuses parts of `near` with equal geometry. Light from walls is slow to compute and varies
  // little for small lamp movements: with `kept` it is reused even if the lamps move.
  enum class Walls { followed, kept };
  LightFields fields(const LightState& state, const LightFields* near,
                     Walls walls = Walls::followed) const;
  // Light of all lamps on every output, before effects that act on all light. With known light of a
  // near state, only the lamps that differ are recomputed.
  struct KnownLight {
    const LightState* state;
    const LightFields* fields;
    const std::vector<double>* light;
  };
  std::vector<double> light(const LightState& state, const LightFields& fields,
                            const KnownLight* near = nullptr) const;
  // `light` must be that of the state.
  std::vector<double> signals_of(const LightState& state, std::vector<double> light) const;
  std::vector<double> signals(const LightState& state, const LightFields& fields) const {
    return signals_of(state, light(state, fields));
  }
  // Whitened residuals, one per sample. `slopes` may be null.
  Eigen::VectorXd residuals(const LightState& state, const std::vector<double>& signals,
                            SignalSlopes* slopes) const;
  // Change of the residuals for a change of the signals.
  Eigen::VectorXd moved(const SignalSlopes& slopes, const std::vector<double>& change) const;

  // For runs: the fall of χ² of each row if the tracker is at a maximum that is not the highest.
  std::vector<double> gain_if_trapped(const LightState& state,
                                      const std::vector<double>& signals) const;

  // Expected readings: irradiance of a scan; voltage and current of runs; current of a sweep at the
  // measured voltage.
  struct Expected {
    double irradiance_W_m2 = 0.0, voltage_V = 0.0, current_A = 0.0;
  };
  std::vector<Expected> expected(const LightState& state) const;

  // Position, time and conditions of each output.
  const std::vector<SampleConditions>& circumstances() const { return circumstances_; }
  // The curve of the array in the light of a row.
  ArrayCurve curve(const LightState& state, const std::vector<double>& signals, size_t row) const;

 private:
  bool is_scan() const { return recording_.kind == LightRecording::Kind::scan; }
  bool is_run() const { return recording_.kind == LightRecording::Kind::run; }
  bool holds_maximum() const { return is_run() && !lab_->noise().tracker_step_V; }
  void place_scan();
  void place_cells();
  void face_walls();
  void find_noise();
  // Some rows of a scan whose light is known.
  struct PartOf {
    const LightRun* whole;
    const std::vector<size_t>* rows;
  };
  LightRun(const LightLab& lab, LightRecording recording, const PartOf* known);
  void find_circumstances(const PartOf* known);
  void number_samples();
  void keep_scales_of(const LightRun& whole);
  bool is_trapped(const LightState& state, size_t row) const;
  // χ² of a reading relative to a maximum.
  double chi2_at(const ArrayPoint& maximum, size_t row) const;
  // The maximum at which the tracker operates; none in the dark.
  struct Held {
    ArrayPoint at, highest;
    bool is_corner = false;  // see ArrayCurve::Scan
    bool is_highest = true, has_others = false;
  };
  std::optional<Held> held_maximum(const ArrayCurve& curve, bool is_trapped, size_t row) const;
  double current_law(const LightState& state, size_t row, double voltage_V) const;
  std::vector<double> photocurrents(const std::vector<double>& signals, size_t row) const;

  void choose_knots();
  LampField expanded(LampField field) const;
  CellTables cells_at(double temperature_K, double leak_S) const;

  // Interpolation of a row between attitudes at which light is evaluated: indices of knots,
  // weights.
  struct Between {
    std::array<uint32_t, 4> knot{};
    std::array<double, 4> weight{};
  };
  const LightLab* lab_;
  LightRecording recording_;
  LightSites sites_;
  std::vector<std::shared_ptr<const WallExchange>> exchange_;  // with each wall
  std::vector<Between> between_;           // for runs, per row; empty: no interpolation
  std::map<double, CellTables> cells_at_;  // for sweeps, by temperature
  std::vector<size_t> first_output_;       // one per row; rows of one curve share theirs
  std::vector<size_t> cell_of_point_;      // scans: the cell that contains a row, or none
  std::vector<double> irradiance_sigma_;   // scans, per row
  int number_ = 0;
  double voltage_scale_V_ = 1.0, current_scale_A_ = 1.0;
  std::vector<SampleConditions> circumstances_;  // per output
  std::vector<size_t> sample_row_;
  std::vector<int> sample_channel_;
  std::vector<Channel> channels_;
};

}  // namespace photorque
