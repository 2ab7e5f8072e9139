#include "receivers/gather/bodies/body_in_flow.h"
#include "tools/coupling/direction_map.h"

namespace photorque {
namespace {

class FlowDirections final : public LightDirections {
 public:
  FlowDirections(const OpticalRun& run, const DistantSource& source, const Vec3& about_body_m)
      : source_(source),
        body_(run.scene(), run.experiment().flow->speed_ratio, run.experiment().flow->walls,
              about_body_m) {}

  DirectionWrench at(const RigidTransform& lab_from_body) const override {
    const BodyInFlow::Result result =
        body_.wrench(lab_from_body.inverse().direction(-source_.towards_lab));
    DirectionWrench found;
    for (size_t k = 0; k < found.direct.size(); ++k) {
      found.direct[k] = source_.pressure_Pa * result.per_pressure[static_cast<Eigen::Index>(k)];
    }
    found.rays = result.rays;
    return found;
  }

  void fill(WrenchTable& table, const std::vector<DirectionWrench>& found, bool, const Console&,
            int, std::vector<std::string>&) const override {
    for (size_t node = 0; node < table.nodes(); ++node) {
      const WrenchComponents& one = found[node].direct;
      table.force_body_N[node] = {one[0], one[1], one[2]};
      table.torque_body_N_m[node] = {one[3], one[4], one[5]};
    }
  }

 private:
  DistantSource source_;
  BodyInFlow body_;
};

}  // namespace

std::unique_ptr<LightDirections> flow_directions(const OpticalRun& run, const DistantSource& source,
                                                 const Vec3& about_body_m) {
  return std::make_unique<FlowDirections>(run, source, about_body_m);
}

}  // namespace photorque
