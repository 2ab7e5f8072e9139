// The floor shakes: T = −m r × a_B, r the centre of mass's offset, a the floor's acceleration.
//
// One of
//   acceleration_m_s2[3] (lab axes), frequency_Hz, phase [rad] (or phase_deg; default 0):
//     a = a₀ sin(2π f t + φ);
//   the table spectrum = {frequency_Hz = […], density_m2_s3 = […] (one-sided, the same along all
//     axes), tones (default 32), seed (default 1)}: see vibration.h;
//   accelerogram_file: a CSV with t_s, acceleration_x_m_s2, …_y_…, …_z_… in lab axes, at rest
//     outside its time; the path is relative to the experiment's file.
// The last two take scale (default 1). The floor moves without turning.
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/motion/vibration.h"
#include "attitude/disturbances/sinusoid.h"
#include "attitude/environment/time_series.h"

namespace photorque {
namespace {

template <class T>
Vec3Of<T> shaken(const EvaluationContext<T>& now, const Vec3Of<T>& acceleration_lab_m_s2) {
  const Vec3Of<T> felt_body_m_s2 = now.to_body(acceleration_lab_m_s2);
  return -now.mass_kg * now.mass_offset_body_m.cross(felt_body_m_s2);
}

struct ToneVibration final : TorqueLaw<ToneVibration> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> acceleration_m_s2 =
        sinusoid(now.time_s, own.parameter(3), own.parameter(4)) * own.vector(0);
    return shaken(now, acceleration_m_s2);
  }
};

class SpectrumVibration final : public TorqueLaw<SpectrumVibration> {
 public:
  explicit SpectrumVibration(std::vector<VibrationTone> tones) : tones_(std::move(tones)) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    Vec3Of<T> sum = Vec3Of<T>::Constant(T(0.0));
    for (const VibrationTone& tone : tones_) {
      for (int k = 0; k < 3; ++k) {
        sum[k] += tone.amplitude_lab_m_s2[k] *
                  sinusoid(now.time_s, T(tone.frequency_Hz), T(tone.phase_rad[k]));
      }
    }
    const Vec3Of<T> acceleration_m_s2 = own.parameter(0) * sum;
    return shaken(now, acceleration_m_s2);
  }

 private:
  std::vector<VibrationTone> tones_;
};

class RecordedVibration final : public TorqueLaw<RecordedVibration> {
 public:
  explicit RecordedVibration(TimeSeries acceleration_lab_m_s2)
      : acceleration_lab_m_s2_(std::move(acceleration_lab_m_s2)) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> acceleration_m_s2 =
        own.parameter(0) * acceleration_lab_m_s2_.sample(now.time_s);
    return shaken(now, acceleration_m_s2);
  }

  std::vector<Switch> switches(std::span<const Parameter>, double from_s,
                               double to_s) const override {
    std::vector<Switch> ends;
    for (const double t_s : acceleration_lab_m_s2_.ends_within(from_s, to_s)) {
      ends.push_back({t_s, -1});
    }
    return ends;
  }

 private:
  TimeSeries acceleration_lab_m_s2_;
};

Disturbance read_spectrum(const Settings& settings) {
  const Settings s = settings.table("spectrum");
  const std::vector<double> frequency_Hz = s.numbers("frequency_Hz", Range::positive());
  const std::vector<double> density_m2_s3 = s.numbers("density_m2_s3", Range::not_negative());
  if (density_m2_s3.size() != frequency_Hz.size()) {
    throw s.error("density_m2_s3", std::to_string(density_m2_s3.size()) + " numbers",
                  std::to_string(frequency_Hz.size()) + ", one for each frequency");
  }
  std::vector<SpectrumPoint> points;
  for (size_t i = 0; i < frequency_Hz.size(); ++i) {
    points.push_back({frequency_Hz[i], Vec3::Constant(density_m2_s3[i])});
    if (i > 0 && !(frequency_Hz[i] > frequency_Hz[i - 1])) {
      throw s.error("frequency_Hz", "frequencies out of order", "rising frequencies");
    }
  }
  if (points.size() < 2) throw s.error("frequency_Hz", "one frequency", "at least two");
  const auto tones = static_cast<int>(s.integer_or("tones", 32, 1, 10000));
  const auto seed = static_cast<uint64_t>(s.integer_or("seed", 1, 0, INT64_MAX));
  return make_disturbance<SpectrumVibration>(
      {scalar_parameter_or(settings, "scale", 1.0, Range::not_negative())}, Stage::torque, {},
      tones_of_spectrum(points, tones, seed));
}

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  if (settings.has("spectrum")) return read_spectrum(settings);
  if (settings.has("accelerogram_file")) {
    return make_disturbance<RecordedVibration>(
        {scalar_parameter_or(settings, "scale", 1.0, Range::not_negative())}, Stage::torque, {},
        read_time_series(file_of(settings, "accelerogram_file"),
                         {"acceleration_x_m_s2", "acceleration_y_m_s2", "acceleration_z_m_s2"},
                         TimeSeries::Outside::zero));
  }
  return make_disturbance<ToneVibration>(
      {vector_parameter(settings, "acceleration_m_s2"),
       scalar_parameter(settings, "frequency_Hz", Range::not_negative()),
       phase_parameter(settings)});
}

}  // namespace

DisturbanceKind floor_vibration_kind() {
  return {"floor_vibration", "the floor shakes the bearing under a centre of mass that is off",
          read};
}

}  // namespace photorque
