#include "receivers/gather/bodies/lamp.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "receivers/gather/quadrature.h"

namespace photorque {
namespace {

// Integrates the light of a lamp over a triangle. Halves its sides until the seven-point rules on
// the triangle and on its quarters agree.
class FacetQuadrature {
 public:
  FacetQuadrature(const BodyLamp& lamp, const FirstContact& contact, const Vec3& normal,
                  const Vec3& about_m)
      : lamp_(lamp), contact_(contact), normal_(normal), about_m_(about_m) {}

  BodyLamp::Open run(const Facet& facet) {
    const double all_N = lamp_.light().emitter().power_W() / speed_of_light_m_s;
    force_tolerance_N_ = tolerance * all_N;
    torque_tolerance_N_m_ =
        force_tolerance_N_ * ((facet.ball.centre_m - about_m_).norm() + facet.ball.radius_m);
    const Piece whole{facet.corner_m, facet.area_m2};
    const Ball& ball = facet.ball;
    if (ball.radius_m < tiny * lamp_.scale_m(ball)) return in_one(whole, ball);
    descend(whole, 0);
    return sum_;
  }

 private:
  static constexpr double tolerance = 2e-7;  // of all momentum of the beam, for each piece
  static constexpr double tiny = 0.1;        // of the length over which the light changes
  // Fraction of the same length: pieces below this size are accurate enough.
  static constexpr double smooth = 1.0;
  static constexpr int depth = 8;

  struct Piece {
    TriangleCorners corner_m;
    double area_m2;

    Ball ball() const { return ball_around(corner_m); }
    std::array<Piece, 4> quarters() const {
      const auto& [a, b, c] = corner_m;
      const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
      const double quarter_m2 = 0.25 * area_m2;
      return {Piece{{a, ab, ca}, quarter_m2}, Piece{{ab, b, bc}, quarter_m2},
              Piece{{ca, bc, c}, quarter_m2}, Piece{{ab, bc, ca}, quarter_m2}};
    }
  };

  WrenchSum density(const Vec3& at_m) const {
    const Vec3 force =
        contact_.of_flow(lamp_.arriving(at_m, normal_), normal_) / speed_of_light_m_s;
    return wrench_of(force, at_m - about_m_);
  }
  WrenchSum mean_of(const Piece& piece) const {
    // Not a structured binding: Clang 14 cannot capture one.
    const Vec3& origin = piece.corner_m[0];
    const Vec3 edge1 = piece.corner_m[1] - origin, edge2 = piece.corner_m[2] - origin;
    return triangle_mean(
        [&](double s, double t) { return density(origin + s * edge1 + t * edge2); });
  }

  // The difference of the rules of degree 5 and 1 measures the curvature of the light. The
  // remaining error is smaller by higher powers of the size.
  BodyLamp::Open in_one(const Piece& piece, const Ball& ball) {
    const WrenchSum mean = mean_of(piece), middle = density(ball.centre_m);
    const double shrink = std::pow(ball.radius_m / lamp_.scale_m(ball), 2) * piece.area_m2;
    return {piece.area_m2 * mean, shrink * (mean - middle).head<3>().matrix().norm(),
            shrink * (mean - middle).tail<3>().matrix().norm()};
  }

  // Divides the piece until the light changes little enough over it for a few points.
  void descend(const Piece& piece, int level) {
    const Ball ball = piece.ball();
    if (lamp_.misses(ball)) return;
    if (level == depth || ball.radius_m < smooth * lamp_.scale_m(ball)) {
      refine(piece, mean_of(piece), level);
      return;
    }
    for (const Piece& quarter : piece.quarters()) descend(quarter, level + 1);
  }

  void refine(const Piece& piece, const WrenchSum& mean, int level) {
    const std::array<Piece, 4> quarters = piece.quarters();
    std::array<WrenchSum, 4> means;
    WrenchSum finer = WrenchSum::Zero();
    for (size_t i = 0; i < 4; ++i) {
      means[i] = lamp_.misses(quarters[i].ball()) ? WrenchSum::Zero().eval() : mean_of(quarters[i]);
      finer += 0.25 * means[i];
    }
    // The difference of the two rules is used as the error of the finer rule; the true error is
    // smaller.
    const double force_N = piece.area_m2 * (finer - mean).head<3>().matrix().norm();
    const double torque_N_m = piece.area_m2 * (finer - mean).tail<3>().matrix().norm();
    const bool good = force_N <= force_tolerance_N_ && torque_N_m <= torque_tolerance_N_m_;
    if (level == depth || good) {
      sum_.wrench += piece.area_m2 * finer;
      sum_.force_error_N += force_N;
      sum_.torque_error_N_m += torque_N_m;
      return;
    }
    for (size_t i = 0; i < 4; ++i) {
      if (!lamp_.misses(quarters[i].ball())) refine(quarters[i], means[i], level + 1);
    }
  }

  const BodyLamp& lamp_;
  const FirstContact& contact_;
  Vec3 normal_, about_m_;
  double force_tolerance_N_ = 0.0, torque_tolerance_N_m_ = 0.0;
  BodyLamp::Open sum_{WrenchSum::Zero()};
};

}  // namespace

WrenchSum wrench_of(const Vec3& force_N, const Vec3& lever_m) {
  WrenchSum wrench;
  wrench << force_N.array(), lever_m.cross(force_N).array();
  return wrench;
}

void BodyLight::reach(double low_m, double high_m) {
  // Fraction of the largest height: nearer light is computed without a table.
  constexpr double nearest = 0.05;
  if (light_->parallel() || !(high_m > 0.0)) return;
  high_m_ = std::max(high_m_, high_m);
  low_m_ = std::min(low_m_, std::max(low_m, nearest * high_m_));
  slabs_.clear();
  for (double from_m = low_m_; from_m < high_m_; from_m *= slab) {
    slabs_.push_back(std::make_unique<Slab>());
  }
}

const MomentumTable* BodyLight::table_at(double height_m) const {
  if (!(height_m >= low_m_ && height_m < high_m_)) return nullptr;
  const auto index = std::min(static_cast<size_t>(std::log(height_m / low_m_) / std::log(slab)),
                              slabs_.size() - 1);
  Slab& one = *slabs_[index];
  std::call_once(one.made, [&] {
    // The range is extended slightly because of the rounding of the index.
    const double from_m = low_m_ * std::pow(slab, static_cast<double>(index));
    one.table = MomentumTable::make(*light_, 0.9999 * from_m, 1.0001 * slab * from_m, 1);
  });
  return one.table ? &*one.table : nullptr;
}

bool BodyLamp::outside(const Ball& ball) const {
  return light().parallel() || (ball.centre_m - body_from_emitter().translation_m).norm() >
                                   ball.radius_m + light().radius_m();
}

Exposure BodyLamp::exposure_of(const FacetSide& side) const {
  const Vec3 normal = side.normal();
  const double cosine = -normal.dot(body_from_emitter().direction(Vec3::UnitZ()));
  const double reach_sine = std::sin(std::min(light().reach_rad(), 0.5 * pi));
  // First test: directions of the rays.
  if (cosine <= -reach_sine) return Exposure::none;
  const bool all_directions = cosine > reach_sine && light().reach_rad() < 0.5 * pi;
  if (light().parallel()) return all_directions ? Exposure::whole : Exposure::partly;
  // Second test: position of the aperture.
  const Vec3 way = body_from_emitter().translation_m - side.facet->ball.centre_m;
  const double spread_m = light().radius_m() * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double height_m = normal.dot(way);
  if (height_m + spread_m <= 0.0 || misses(side.facet->ball)) return Exposure::none;
  return all_directions || height_m > spread_m ? Exposure::whole : Exposure::partly;
}

double BodyLamp::typical_W(const FacetSide& side) const {
  const Ball& ball = side.facet->ball;
  const double area_m2 = side.facet->area_m2;
  if (light().parallel() || ball.radius_m < 0.3 * scale_m(ball)) {
    return std::max(0.0, arriving(ball.centre_m, side.normal()).irradiance_W_m2) * area_m2;
  }
  return std::min(typical_W_m2(ball) * area_m2, light().emitter().power_W());
}

ArrivingLight BodyLamp::arriving(const Vec3& at_m, const Vec3& normal) const {
  const Vec3 at = emitter_from_body().point(at_m);
  const Vec3 normal_emitter = emitter_from_body().direction(normal);
  const MomentumTable* table = table_.table_at(at.z());
  ArrivingLight here =
      table ? table->arriving(at, normal_emitter) : light().arriving(at, normal_emitter);
  here.momentum_W_m2 = body_from_emitter().direction(here.momentum_W_m2);
  return here;
}

BodyLamp::Open BodyLamp::open_wrench(const FacetSide& side, const FirstContact& contact,
                                     const Vec3& about_m) const {
  const Facet& facet = *side.facet;
  const Vec3 normal = side.normal();
  if (!light().parallel()) {
    Open open = FacetQuadrature(*this, contact, normal, about_m).run(facet);
    const Vec3 centre = emitter_from_body().point(facet.ball.centre_m);
    if (const MomentumTable* table = table_.table_at(centre.z())) {
      const double force_N = 3.0 * table->error_W_m2() * facet.area_m2 / speed_of_light_m_s;
      open.force_error_N += force_N;
      open.torque_error_N_m +=
          force_N * ((facet.ball.centre_m - about_m).norm() + facet.ball.radius_m);
    }
    return open;
  }
  const Vec3 force_N = facet.area_m2 / speed_of_light_m_s *
                       contact.of_flow(arriving(facet.ball.centre_m, normal), normal);
  return {wrench_of(force_N, facet.ball.centre_m - about_m)};
}

}  // namespace photorque
