#include "receivers/gather/bodies/sunlit_body.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "receivers/gather/bodies/partition.h"

namespace photorque {
namespace {

constexpr size_t most_facets = 20'000;
constexpr double widest_rad = 1.0 * degree_rad;  // largest half-angle treated as a point in shadows

// Sums the force and torque of the onward light of each owner, the piece that emitted the ray.
OnwardSink adding_to(std::vector<TwofoldSum>& sums, const ScatteredLight& scattered) {
  return {[&](uint32_t owner, const WrenchSum& wrench) {
            sums[owner].head<6>() += wrench;
            sums[owner].tail<6>() += wrench;
          },
          [&](uint32_t owner, size_t side, const Vec2& uv, const BandValues& power_W) {
            if (scattered.unseen(side)) return;
            for (size_t b = 0; b < power_W.size(); ++b) {
              if (power_W[b] > 0.0) sums[owner] += power_W[b] * scattered.per_watt_at(side, uv, b);
            }
          }};
}

}  // namespace

// Computation for one direction of the light.
class SunlitBody::Direction {
 public:
  Direction(const SunlitBody& body, const RigidTransform& lab_from_body, double tolerance_N_m)
      : body_(body),
        lamp_(body.beam_, body.light_, lab_from_body.inverse(), body.scene_.scene().bands,
              scene_diameter_m(body.scene_)),
        tolerance_N_m_(tolerance_N_m),
        bands_(static_cast<size_t>(body.scene_.scene().bands.count())),
        onward_(body.scene_, body.shape_.facets.numbers(), body.about_m_) {}

  SunlitWrench run() {
    const Vec3 travel = lamp_.body_from_emitter().direction(Vec3::UnitZ());
    LineGrid grid(body_.scene_, body_.shape_.outlines, travel);
    for (uint32_t instance = 0; instance < body_.shape_.facets.instances(); ++instance) {
      const bool outside = lamp_.outside(body_.shape_.facets.ball_of(instance));
      const auto inward = outside ? body_.shape_.facets.inward(instance) : std::nullopt;
      for (const Facet& facet : body_.shape_.facets.of(instance)) {
        for (const bool front : {false, true}) {
          if (inward != front) add_side({&facet, front}, grid);
        }
      }
    }
    find_lit();
    find_covered();
    add_direct();
    trace_onward_light();
    found_.rays += onward_.rays();
    return found_;
  }

 private:
  // A side of a facet that faces this light.
  struct LitSide {
    FacetSide side;
    size_t number;  // 2 · facet + front
    Vec3 travel;    // the mean direction of arriving light
    ArrivingLight light;
    FirstContact contact;
    const OpticalSurface* surface;
    bool throws;  // mirrors or transmits light
  };

  struct LitPiece {
    Piece piece;
    uint32_t side;         // index in sides_
    bool covered = false;  // another surface is close above it
  };

  void add_side(const FacetSide& side, LineGrid& grid) {
    const Exposure exposure = lamp_.exposure_of(side);
    if (exposure == Exposure::none) return;
    const Facet& facet = *side.facet;
    const Vec3 normal = side.normal();
    const ArrivingLight light = lamp_.arriving(facet.ball.centre_m, normal);
    const Vec3 travel = light.momentum_W_m2.normalized();
    if (!(light.irradiance_W_m2 > 0.0) || !(normal.dot(travel) < -1e-9)) return;
    const Scene& scene = body_.scene_.scene();
    const OpticalSurface& surface = scene.surface(scene.instances[facet.instance], side.front);
    const bool free = side.is_free();
    const bool throws =
        any_positive(surface.transmitted) || (!free && any_positive(surface.specular));
    const size_t number = 2 * body_.shape_.facets.number_of(facet);
    sides_.push_back({side, number + (side.front ? 1 : 0), travel, light,
                      FirstContact(surface, side.front, lamp_.fraction(), static_cast<int>(bands_)),
                      &surface, throws});
    cut(facet, free, exposure == Exposure::whole, grid);
  }

  // The outlines that are visible along a direction. The last result is kept, because consecutive
  // facets often have the same plane and therefore the same direction.
  std::span<const Line> seen_along(const Vec3& direction) {
    if (!(direction - seen_direction_).isZero(1e-12)) {
      seen_ = body_.shape_.outlines.in_light(direction, true);
      for (const auto& cuts : body_.shape_.cuts)
        seen_.insert(seen_.end(), cuts.begin(), cuts.end());
      seen_direction_ = direction;
    }
    return seen_;
  }

  // Number of times that a facet is cut into quarters to get cells of about the size of mirror
  // cells. mirror_level() follows from its area; long_level(), for small facets, from its length.
  static uint32_t level_of(const Facet& facet, double cell_m2) {
    const double times = 0.5 * std::log2(facet.area_m2 / cell_m2);
    return static_cast<uint32_t>(std::clamp(std::ceil(times), 0.0, 8.0));
  }
  uint32_t mirror_level(const Facet& facet) const { return level_of(facet, body_.mirror_cell_m2_); }
  uint32_t long_level(const Facet& facet) const {
    const double times = std::log2(facet.ball.radius_m / std::sqrt(body_.mirror_cell_m2_));
    return static_cast<uint32_t>(std::clamp(std::ceil(times), 0.0, 2.0));
  }

  // Cuts a facet into pieces, and those that mirror or transmit light into cells.
  void cut(const Facet& facet, bool free, bool whole, LineGrid& grid) {
    const LitSide& lit = sides_.back();
    Screen screen(facet);
    const auto add = [&](std::span<const Line> lines, const Vec3& normal, const Vec3& direction) {
      screen.add(lines, normal, direction, plane_rounding * scene_diameter_m(body_.scene_));
    };
    const Vec3 normal = lit.side.normal();
    const std::vector<Line>& cuts = body_.shape_.cuts[lit.number / 2];
    if (!free) {
      add(cuts, normal, lit.travel);
      if (whole) {
        grid.over(facet.corner_m, lines_);
        add(lines_, normal, lit.travel);
      } else {  // at grazing incidence a small change of direction moves shadows far
        add(grid.lines(), normal, lit.travel);
      }
    }
    const uint32_t cells = lit.throws ? mirror_level(facet) : 0;
    if (cells > 0) {  // a small facet is represented by one point
      const Vec3 mirrored = lit.travel - 2.0 * normal.dot(lit.travel) * normal;
      if (!free && any_positive(lit.surface->specular))
        add(seen_along(mirrored), normal, -mirrored);
      if (any_positive(lit.surface->transmitted)) {
        add(cuts, -normal, -lit.travel);
        add(grid.lines(), -normal, -lit.travel);
      }
    }
    const uint32_t finest = lit.throws && cells == 0 ? long_level(facet) : cells;
    const std::span<const Line> close = body_.scattered_.lines(lit.number);
    if (!free) add(close, normal, -normal);
    parts_.clear();
    const Levels levels{finest, level_of(facet, body_.scattered_.patch_m2())};
    screen.cut(levels, least_piece * body_.area_m2_, parts_);
    for (const Piece& piece : parts_) {
      pieces_.push_back({piece, static_cast<uint32_t>(sides_.size() - 1)});
    }
  }

  // Traces one shadow ray for each piece and keeps the lit pieces.
  void find_lit() {
    const double far_m = 4.0 * scene_diameter_m(body_.scene_);
    std::vector<ShadowRay> rays;
    for (const LitPiece& one : pieces_) {
      const LitSide& lit = sides_[one.side];
      rays.push_back(probe(body_.scene_, lit.side.facet->at(one.piece.centre_uv), lit.side.normal(),
                           -lit.travel, far_m));
    }
    const std::vector<uint8_t> clear = unshadowed(rays);
    std::vector<LitPiece> kept;
    for (size_t i = 0; i < pieces_.size(); ++i) {
      if (clear[i] != 0) kept.push_back(pieces_[i]);
    }
    std::swap(pieces_, kept);
  }

  // Finds out for the lit pieces near a line whether another surface is close above them.
  void find_covered() {
    std::vector<ShadowRay> rays;
    std::vector<size_t> whose;
    for (size_t i = 0; i < pieces_.size(); ++i) {
      const LitSide& lit = sides_[pieces_[i].side];
      if (body_.scattered_.lines(lit.number).empty()) continue;
      const Vec3 normal = lit.side.normal();
      rays.push_back(probe(body_.scene_, lit.side.facet->at(pieces_[i].piece.centre_uv), normal,
                           normal, body_.scattered_.close_m()));
      whose.push_back(i);
    }
    const std::vector<uint8_t> clear = unshadowed(rays);
    for (size_t i = 0; i < whose.size(); ++i) pieces_[whose[i]].covered = clear[i] == 0;
  }

  std::vector<uint8_t> unshadowed(std::span<const ShadowRay> rays) {
    found_.rays += rays.size();
    return photorque::unshadowed(body_.scene_, rays);
  }

  void add_direct() {
    for (const LitPiece& one : pieces_) {
      const LitSide& lit = sides_[one.side];
      const double area_m2 = one.piece.share * lit.side.facet->area_m2;
      const Vec3 force_N =
          area_m2 / speed_of_light_m_s * lit.contact.of_flow(lit.light, lit.side.normal());
      const Vec3 at_m = lit.side.facet->at(one.piece.centre_uv);
      found_.direct += wrench_of(force_N, at_m - body_.about_m_);
      if (body_.scattered_.unseen(lit.number)) continue;
      for (size_t b = 0; b < bands_; ++b) {
        const double power_W =
            area_m2 * lit.light.irradiance_W_m2 * lamp_.fraction()[b] * lit.surface->diffuse[b];
        if (!(power_W > 0.0)) continue;
        found_.bounced +=
            power_W * body_.scattered_.per_watt(lit.number, one.piece, one.covered, b);
      }
    }
  }

  // The starting point of a ray: the centre of a piece. For a facet that is too small to be cut
  // along mirrored outlines it is a point from a hash, so that the errors of neighbouring facets
  // are independent.
  Vec2 place_in(const LitPiece& one) const {
    const Facet& facet = *sides_[one.side].side.facet;
    if (!one.piece.whole || mirror_level(facet) > 0) return one.piece.centre_uv;
    const Cell& cell = one.piece.cell;
    const uint64_t key = hash_words(sides_[one.side].number, cell.level, cell.path);
    const double root = std::sqrt(unit_interval(key)), second = unit_interval(mix_bits(key));
    return cell.at({1.0 - root, root * (1.0 - second), root * second});
  }

  void add_onward_rays(const LitPiece& one, uint32_t owner, std::vector<OnwardRay>& rays) const {
    const LitSide& lit = sides_[one.side];
    const Vec3 normal = lit.side.normal();
    const Vec3 at_m = lit.side.facet->at(place_in(one));
    const double offset_m = shadow_ray_offset_m(body_.scene_);
    const double power_W = one.piece.share * lit.side.facet->area_m2 * lit.light.irradiance_W_m2;
    const auto add = [&](const BandValues& share, const Vec3& direction, double above_m) {
      OnwardRay ray{at_m + above_m * normal, direction, {}, owner};
      double sum_W = 0.0;
      for (size_t b = 0; b < bands_; ++b) {
        ray.power_W[b] = power_W * lamp_.fraction()[b] * share[b];
        sum_W += ray.power_W[b];
      }
      if (sum_W > 0.0) rays.push_back(ray);
    };
    if (!lit.side.is_free()) {
      add(lit.surface->specular, lit.travel - 2.0 * normal.dot(lit.travel) * normal, offset_m);
    }
    const uint32_t part = lit.side.facet->instance;
    add(lit.surface->transmitted, lit.travel,
        -(offset_m + body_.scene_.scene().instances[part].sheet_depth_m));
  }

  // Follows mirrored and transmitted light in rounds. A cell whose four quarters disagree is cut
  // again in the next round.
  void trace_onward_light() {
    std::vector<LitPiece> now, next;
    for (const LitPiece& one : pieces_) {
      if (sides_[one.side].throws) now.push_back(one);
    }
    constexpr double cutoff = 1e-4;
    std::vector<OnwardRay> rays;
    std::vector<TwofoldSum> sums;
    const OnwardSink sink = adding_to(sums, body_.scattered_);
    while (!now.empty()) {
      sums.assign(now.size(), TwofoldSum::Zero());
      for (uint32_t i = 0; i < now.size(); ++i) {
        add_onward_rays(now[i], i, rays);
        if (rays.size() >= Hits::capacity || i + 1 == now.size()) {
          onward_.follow(rays, cutoff, sink);
        }
      }
      next.clear();
      for (size_t begin = 0, end = 0; begin < now.size(); begin = end) {
        end = end_of_family(now, begin);
        settle(std::span(now).subspan(begin, end - begin), std::span(sums).subspan(begin), next);
      }
      std::swap(now, next);
    }
    // Pieces without four quarters get the mean error of the others.
    if (sampled_area_m2_ > 0.0)
      found_.mirror_error = (mirrored_area_m2_ / sampled_area_m2_ * square_error_).sqrt();
  }

  // One past the end of a family: the four quarters of one cell if all are uncut, else one piece.
  static size_t end_of_family(const std::vector<LitPiece>& all, size_t begin) {
    const auto of_family = [&](size_t i) {
      return i < all.size() && all[i].side == all[begin].side && all[i].piece.whole &&
             all[i].piece.cell.level == all[begin].piece.cell.level &&
             all[i].piece.cell.path / 4 == all[begin].piece.cell.path / 4;
    };
    if (all[begin].piece.cell.level == 0) return begin + 1;
    for (size_t i = begin; i < begin + 4; ++i) {
      if (!of_family(i)) return begin + 1;
    }
    return begin + 4;
  }

  // Adds the result of a family to the total, or cuts its members again.
  void settle(std::span<const LitPiece> family, std::span<const TwofoldSum> sums,
              std::vector<LitPiece>& next) {
    constexpr uint32_t deepest = 14;
    constexpr size_t most_cells = 200'000;  // in one round
    TwofoldSum sum = TwofoldSum::Zero();
    for (size_t i = 0; i < family.size(); ++i) sum += sums[i];
    // The middle quarter of a linear function equals the mean of the others; `bent` is the
    // deviation from it.
    WrenchSum bent = WrenchSum::Zero();
    if (family.size() == 4) bent = (sum - 4.0 * sums[3]).head<6>().abs() / 3.0;
    const bool fine = !(bent.tail<3>().maxCoeff() > tolerance_N_m_);
    if (fine || family[0].piece.cell.level >= deepest || next.size() > most_cells) {
      found_.bounced += sum;
      double area_m2 = 0.0;
      for (const LitPiece& one : family) {
        area_m2 += one.piece.share * sides_[one.side].side.facet->area_m2;
      }
      mirrored_area_m2_ += area_m2;
      if (family.size() < 4) return;
      // The four values are treated as random samples: the error of their sum is twice their
      // standard deviation, and `bent` is 1.15 times it.
      square_error_ += 3.0 * bent.square();
      sampled_area_m2_ += area_m2;
      return;
    }
    for (const LitPiece& one : family) {
      for (uint32_t q = 0; q < 4; ++q) {
        const Cell cell = one.piece.cell.quarter(q);
        next.push_back({{cell, cell.share(), cell.centre(), true}, one.side, one.covered});
      }
    }
  }

  const SunlitBody& body_;
  BodyLamp lamp_;
  double tolerance_N_m_;
  size_t bands_;
  OnwardLight onward_;
  std::vector<LitSide> sides_;
  std::vector<LitPiece> pieces_;
  std::vector<Line> lines_;
  std::vector<Line> seen_;
  Vec3 seen_direction_ = Vec3::Zero();
  std::vector<Piece> parts_;
  WrenchSum square_error_ = WrenchSum::Zero();             // of the families of four quarters
  double mirrored_area_m2_ = 0.0, sampled_area_m2_ = 0.0;  // of all cells; of these families
  SunlitWrench found_;
};

std::unique_ptr<const SunlitBody> SunlitBody::make(const TraceableScene& scene,
                                                   std::span<const Beam> beams, const Vec3& about_m,
                                                   const SunlitEffort& effort) {
  if (beams.size() != 1 || !beams[0].aperture || !std::isinf(beams[0].aperture->radius_m)) {
    return nullptr;
  }
  const DiscLight light(*beams[0].emitter, *beams[0].aperture);
  if (light.reach_rad() > widest_rad) return nullptr;
  size_t triangles = 0;
  for (const Instance& one : scene.scene().instances) {
    triangles += scene.scene().meshes[one.mesh].triangles.size();
  }
  if (triangles == 0 || triangles > most_facets || !all_plain(scene.scene())) return nullptr;
  return std::unique_ptr<const SunlitBody>(new SunlitBody(scene, beams[0], about_m, effort));
}

SunlitBody::SunlitBody(const TraceableScene& scene, const Beam& beam, const Vec3& about_m,
                       const SunlitEffort& effort)
    : scene_(scene),
      beam_(beam),
      about_m_(about_m),
      shape_(scene),
      light_(std::make_shared<DiscLight>(*beam_.emitter, *beam_.aperture)),
      area_m2_(shape_.facets.area_m2()),
      mirror_cell_m2_(area_m2_ / static_cast<double>(effort.mirror_cells)),
      scattered_(scene, shape_, about_m, effort.scattered) {}

SunlitWrench SunlitBody::wrench(const RigidTransform& lab_from_body, double tolerance_N_m) const {
  return Direction(*this, lab_from_body, tolerance_N_m).run();
}

}  // namespace photorque
