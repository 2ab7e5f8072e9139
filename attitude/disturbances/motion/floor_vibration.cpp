// The floor vibrates without rotation: T = −m r × a_B, where r is the offset of the centre of mass
// and a the acceleration of the floor: a sine, a random signal with a spectrum (vibration.h), or a
// recorded one.
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/motion/vibration.h"
#include "attitude/environment/time_series.h"

namespace photorque::kinds::floor_vibration {
namespace {

// At higher frequencies the phase loses its precision within a day: the steps would sample a slow
// alias.
constexpr Range tone_Hz{0.0, 1e6};
constexpr auto shaking = VectorKey("acceleration_m_s2",
                                   "amplitude a of a sine in T = −m r × a (zero without an offset "
                                   "of mass), lab axes; with the next two; *or*")
                             .optional();
constexpr auto frequency =
    ScalarKey("frequency_Hz", tone_Hz, "frequency of the sine", shaking.end()).optional();
constexpr ScalarKey phase("phase", 0.0, {}, "phase of the sine at t = 0, rad; or `phase_deg`",
                          frequency.end());
constexpr ScalarKey factor("scale", 1.0, Range::not_negative(),
                           "factor on the acceleration of a spectrum or a file");

namespace key {
constexpr UncertainNumberKey phase("phase_deg", {}, "phase in degrees, instead of `phase`",
                                   {.optional = true});
constexpr NumbersKey frequency("frequency_Hz", Range::positive(),
                               "frequencies of the spectrum, at least two, in rising order");
constexpr NumbersKey density(
    "density_m2_s3", Range::not_negative(),
    "one-sided power spectral density of the acceleration at each frequency, equal along all axes");
constexpr IntegerKey tones("tones", 32, 1, 10000,
                           "number of sinusoids that represent the spectrum");
constexpr IntegerKey seed("seed", 1, 0, INT64_MAX, "seed of the random phases of the sinusoids");
constexpr TableKey spectrum("spectrum",
                            "random acceleration of the floor with this spectrum; *or*");
constexpr TextKey accelerogram_file(
    "accelerogram_file",
    "CSV: `t_s`, `acceleration_x_m_s2`, `…_y_…`, `…_z_…`, lab axes, zero outside",
    {.optional = true});
}  // namespace key

template <class T>
Vec3Of<T> inertial_torque(const EvaluationContext<T>& now, const Vec3Of<T>& acceleration_lab_m_s2) {
  const Vec3Of<T> felt_body_m_s2 = now.to_body(acceleration_lab_m_s2);
  return -now.mass_kg * now.mass_offset_body_m.cross(felt_body_m_s2);
}

struct ToneVibration final : TorqueLaw<ToneVibration> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> acceleration_m_s2 =
        sinusoid(now.time_s, own[frequency], own[phase]) * own[shaking];
    return inertial_torque(now, acceleration_m_s2);
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
        sum[k] +=
            tone.amplitude_m_s2 * sinusoid(now.time_s, T(tone.frequency_Hz), T(tone.phase_rad[k]));
      }
    }
    const Vec3Of<T> acceleration_m_s2 = own[factor] * sum;
    return inertial_torque(now, acceleration_m_s2);
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
    const Vec3Of<T> acceleration_m_s2 = own[factor] * acceleration_lab_m_s2_.sample(now.time_s);
    return inertial_torque(now, acceleration_m_s2);
  }

  std::vector<Switch> switches(std::span<const Parameter>) const override {
    return switches_at(acceleration_lab_m_s2_.ends_s());
  }

 private:
  TimeSeries acceleration_lab_m_s2_;
};

Disturbance read_spectrum(const Settings& settings) {
  const Settings s = settings.get(key::spectrum);
  const std::vector<double> frequency_Hz = s.get(key::frequency);
  const std::vector<double> density_m2_s3 = s.get(key::density);
  if (density_m2_s3.size() != frequency_Hz.size()) {
    throw s.error(key::density, std::to_string(density_m2_s3.size()) + " numbers",
                  std::to_string(frequency_Hz.size()) + ", one for each frequency");
  }
  std::vector<SpectrumPoint> points;
  for (size_t i = 0; i < frequency_Hz.size(); ++i) {
    points.push_back({frequency_Hz[i], density_m2_s3[i]});
    if (i > 0 && !(frequency_Hz[i] > frequency_Hz[i - 1])) {
      throw s.error(key::frequency, "frequencies out of order", "rising frequencies");
    }
  }
  if (points.size() < 2) throw s.error(key::frequency, "one frequency", "at least two");
  const auto tones = static_cast<int>(s.get(key::tones));
  const auto seed = static_cast<uint64_t>(s.get(key::seed));
  return make_disturbance<SpectrumVibration>({parameters_of(settings, factor)}, Stage::torque, {},
                                             tones_of_spectrum(points, tones, seed));
}

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  if (settings.has(key::spectrum)) return read_spectrum(settings);
  if (settings.has(key::accelerogram_file)) {
    return make_disturbance<RecordedVibration>(
        {parameters_of(settings, factor)}, Stage::torque, {},
        read_time_series(file_of(settings, key::accelerogram_file),
                         {"acceleration_x_m_s2", "acceleration_y_m_s2", "acceleration_z_m_s2"},
                         TimeSeries::Outside::zero));
  }
  return make_disturbance<ToneVibration>({parameters_of(settings, shaking),
                                          parameters_of(settings, frequency),
                                          phase_parameter(settings, phase)});
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "floor_vibration",
      .summary = "the floor accelerates the bearing, with a displaced centre of mass",
      .read = read,
      .screening = {.parametrisations =
                        {{"the floor accelerates the bearing, with a displaced centre of mass",
                          {EffectKey::vector(shaking.name, 0.1),
                           EffectKey::shape(frequency.name, 1.0, 5.0, 0.0, 100.0),
                           EffectKey::shape(phase.name, 0.0, phase_scale, -EffectKey::unbounded)}}},
                    .needs = Requirement::gravity,
                    .scan = Scan::frequency,
                    .fast = true},
      .keys = {shaking, frequency, phase, key::phase,
               key::spectrum.of({key::frequency, key::density, key::tones, key::seed}),
               key::accelerogram_file, factor}};
}

}  // namespace photorque::kinds::floor_vibration
