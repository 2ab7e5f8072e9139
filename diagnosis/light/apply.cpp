#include "diagnosis/light/apply.h"

#include <set>

#include "diagnosis/light/model/field.h"
#include "diagnosis/light/written.h"

namespace photorque {
namespace {

// An emitter that gives a share of its power.
class DimmedEmitter final : public Emitter {
 public:
  DimmedEmitter(std::shared_ptr<const Emitter> full, double share)
      : full_(std::move(full)), share_(share) {}
  double power_W() const override { return share_ * full_->power_W(); }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    full_->emit(samples, rays);
  }
  double relative_intensity(double angle_rad) const override {
    return full_->relative_intensity(angle_rad);
  }

 private:
  std::shared_ptr<const Emitter> full_;
  double share_;
};

}  // namespace

std::vector<std::string> apply_written_effects(Experiment& experiment) {
  std::vector<std::string> notices;
  const std::vector<Settings> effects = experiment.file.others("effect");
  if (effects.empty()) return notices;
  const LightLab lab(experiment);
  const LightState state = written_state(lab);
  const std::set<std::string> traced = {"led_failed",      "led_derated",  "led_aim",
                                        "beam_divergence", "source_shift", "source_power",
                                        "attitude_bias"};
  for (const Settings& effect : effects) {
    const std::string kind = effect.text("kind");
    if (traced.contains(kind)) continue;
    notices.push_back(effect.name() + ": " + kind +
                      " acts in diagnose alone; a trace is without it");
  }
  std::vector<Beam> beams;
  const std::shared_ptr<const LampSet> lamps = lab.lamps_with(state.divergence);
  for (size_t l = 0; l < lamps->beams.size(); ++l) {
    Beam beam = lamps->beams[l];
    const double share = state.power * state.lamp_power[l];
    if (!(share > 0.0)) continue;
    beam.lab_from_emitter = pose_of(beam, geometry_of(state, l, false));
    if (share != 1.0) {
      beam.emitter = std::make_shared<const DimmedEmitter>(beam.emitter, share);
      if (beam.aperture) beam.aperture->exitance_W_m2 *= share;
    }
    beams.push_back(std::move(beam));
  }
  if (beams.empty()) {
    throw InputError({experiment.file.path.string()}, "effect", "no lamp that gives light",
                     "at least one");
  }
  for (const Settings& effect : effects) {
    if (effect.text("kind") != "attitude_bias" || !experiment.file.settings.has("torque_map"))
      continue;
    notices.push_back(effect.name() +
                      ": attitude_bias acts at [attitude]; the attitudes of a torque map, of "
                      "[array.tracker] and of [light] are as they are stated");
  }
  const double angle = state.attitude_bias_rad.norm();
  if (angle > 0.0) {
    const Vec2 axis = state.attitude_bias_rad / angle;
    experiment.lab_from_body.rotation =
        Quat(Eigen::AngleAxisd(angle, Vec3(axis.x(), axis.y(), 0.0))) *
        experiment.lab_from_body.rotation;
  }
  experiment.beams = std::move(beams);
  return notices;
}

}  // namespace photorque
