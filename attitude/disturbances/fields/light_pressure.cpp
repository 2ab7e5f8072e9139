#include "attitude/disturbances/fields/light_pressure.h"

namespace photorque {
namespace {

std::vector<Switch> switches_of(const std::vector<LampGroup>& groups) {
  std::vector<double> all_s;
  for (const LampGroup& group : groups) {
    all_s.insert(all_s.end(), group.switches_s.begin(), group.switches_s.end());
  }
  return switches_at(all_s);
}

// The value and, for DualLanes, its derivatives by the chain rule: Σ slope · derivative of the
// component of the quaternion.
Lanes chained(const QuatOf<Lanes>&, const Lanes& value, const std::array<Lanes, 4>&) {
  return value;
}
DualLanes chained(const QuatOf<DualLanes>& q, const Lanes& value,
                  const std::array<Lanes, 4>& slopes) {
  const DualLanes by_w_and_x = DualLanes::chain(q.w(), q.x(), value, slopes[0], slopes[1]);
  return by_w_and_x + DualLanes::chain(q.y(), q.z(), 0.0, slopes[2], slopes[3]);
}

class TabulatedLight final : public TorqueLaw<TabulatedLight> {
 public:
  TabulatedLight(const std::shared_ptr<const RotationTable>& table, std::vector<LampGroup> groups)
      : groups_(std::move(groups)) {
    for (const LampGroup& group : groups_) torques_.push_back(table->only(group.first_channel, 3));
  }

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>&, const EvaluationContext<T>& now) const {
    Vec3Of<T> sum = Vec3Of<T>::Constant(T(0.0));
    for (size_t g = 0; g < groups_.size(); ++g) {
      const T output(each_lane(values(now.time_s), groups_[g].output));
      sum += (groups_[g].in_orbit ? output * now.illumination : output) *
             look_up<T>(now.attitude, torques_[g]);
    }
    return sum;
  }

  std::vector<Switch> switches(std::span<const Parameter>) const override {
    return switches_of(groups_);
  }

 private:
  template <class T>
  static Vec3Of<T> look_up(const QuatOf<T>& attitude, const RotationTable& table) {
    std::array<Lanes, 3> value;
    std::array<std::array<Lanes, 4>, 3> slope;
    constexpr bool with_slopes = std::is_same_v<T, DualLanes>;
    for (int i = 0; i < Lanes::count; ++i) {
      const Quat q(values(attitude.w())[i], values(attitude.x())[i], values(attitude.y())[i],
                   values(attitude.z())[i]);
      std::array<double, 3> torque{};
      std::array<double, 12> by{};
      if constexpr (with_slopes) {
        table.at(q, 0, torque, by);
      } else {
        table.at(q, 0, torque);
      }
      for (size_t k = 0; k < 3; ++k) {
        value[k].set(i, torque[k]);
        for (size_t j = 0; with_slopes && j < 4; ++j) slope[k][j].set(i, by[4 * k + j]);
      }
    }
    return {chained(attitude, value[0], slope[0]), chained(attitude, value[1], slope[1]),
            chained(attitude, value[2], slope[2])};
  }

  std::vector<RotationTable> torques_;  // of each group
  std::vector<LampGroup> groups_;
};

class TracedLight final : public TorqueLaw<TracedLight> {
 public:
  explicit TracedLight(std::vector<LampGroup> groups) : groups_(std::move(groups)) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>&, const EvaluationContext<T>& now) const {
    return now.traced_light_body_N_m;
  }

  std::vector<Switch> switches(std::span<const Parameter>) const override {
    return switches_of(groups_);
  }

 private:
  std::vector<LampGroup> groups_;
};

Disturbance disturbance_of(std::shared_ptr<const Law> law) {
  Disturbance disturbance;
  disturbance.kind = "radiation_pressure";
  disturbance.law = std::move(law);
  return disturbance;
}

}  // namespace

Disturbance light_from_table(const std::shared_ptr<const RotationTable>& table,
                             std::vector<LampGroup> groups) {
  return disturbance_of(std::make_shared<TabulatedLight>(table, std::move(groups)));
}

Disturbance light_from_tracer(std::vector<LampGroup> groups) {
  return disturbance_of(std::make_shared<TracedLight>(std::move(groups)));
}

}  // namespace photorque
