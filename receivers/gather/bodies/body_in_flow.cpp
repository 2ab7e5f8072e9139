#include "receivers/gather/bodies/body_in_flow.h"

#include <utility>

#include "receivers/gather/bodies/onward.h"

namespace photorque {

// The computation for one direction of the flow.
class BodyInFlow::Direction {
 public:
  Direction(const BodyInFlow& body, const Vec3& travel)
      : body_(body),
        travel_(travel),
        least_m2_(least_piece * body.shape_.facets.area_m2()),
        grid_(body.scene_, body.shape_.outlines, travel) {}

  Result run() {
    for (const Facet& facet : body_.shape_.facets.all()) {
      const std::optional<bool> inward = body_.shape_.facets.inward(facet.instance);
      for (const bool front : {false, true}) {
        if (inward != front) add_side({&facet, front});
      }
    }
    const std::vector<uint8_t> clear = unshadowed(body_.scene_, rays_);
    for (size_t i = 0; i < clear.size(); ++i) {
      if (clear[i] != 0) found_.per_pressure += shaded_[i];
    }
    found_.rays = rays_.size();
    return found_;
  }

 private:
  void add_side(const FacetSide& side) {
    const Facet& facet = *side.facet;
    const Vec3 normal = side.normal();
    const MolecularFlux flux(body_.speed_ratio_, travel_, normal);
    if (flux.is_none()) return;
    const Vec3 force_m2 = facet.area_m2 * flux.force(body_.walls_[facet.instance]);
    const auto wrench_at = [&](const Vec3& at_m) {
      return wrench_of(force_m2, at_m - body_.about_m_);
    };
    const Vec3& middle_m = facet.ball.centre_m;
    if (side.is_free()) {
      found_.per_pressure += wrench_at(middle_m);
      return;
    }
    if (!(normal.dot(travel_) < -1e-9)) {
      test(middle_m, normal, flux.arriving().normalized(), wrench_at(middle_m));
      return;
    }
    cut(facet, normal);
    for (const Piece& piece : parts_) {
      const Vec3 at_m = facet.at(piece.centre_uv);
      test(at_m, normal, travel_, piece.share * wrench_at(at_m));
    }
  }

  // Cuts the facet into pieces that are entirely in shadow or entirely lit.
  void cut(const Facet& facet, const Vec3& normal) {
    Screen screen(facet);
    const double rounding_m = plane_rounding * scene_diameter_m(body_.scene_);
    const size_t number = body_.shape_.facets.number_of(facet);
    screen.add(body_.shape_.cuts[number], normal, travel_, rounding_m);
    grid_.over(facet.corner_m, lines_);
    screen.add(lines_, normal, travel_, rounding_m);
    parts_.clear();
    screen.cut({}, least_m2_, parts_);
  }

  // Queues the wrench of molecules that travel along `travel`; it counts if nothing blocks them.
  void test(const Vec3& at_m, const Vec3& normal, const Vec3& travel, const WrenchSum& wrench) {
    rays_.push_back(
        probe(body_.scene_, at_m, normal, -travel, 4.0 * scene_diameter_m(body_.scene_)));
    shaded_.push_back(wrench);
  }

  const BodyInFlow& body_;
  Vec3 travel_;
  double least_m2_;
  LineGrid grid_;
  std::vector<Line> lines_;
  std::vector<Piece> parts_;
  std::vector<ShadowRay> rays_;
  std::vector<WrenchSum> shaded_;  // of each ray
  Result found_;
};

BodyInFlow::BodyInFlow(const TraceableScene& scene, double speed_ratio, std::vector<GasWall> walls,
                       const Vec3& about_m)
    : scene_(scene),
      speed_ratio_(speed_ratio),
      walls_(std::move(walls)),
      about_m_(about_m),
      shape_(scene) {}

BodyInFlow::Result BodyInFlow::wrench(const Vec3& travel) const {
  return Direction(*this, travel).run();
}

}  // namespace photorque
