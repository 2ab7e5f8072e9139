#include "raytrace/interaction.h"

#include <cmath>

#include "core/constants.h"
#include "raytrace/finish_interaction.h"

namespace photorque {
namespace {

enum class Lobe { specular, diffuse, transmitted };

// Draws a lobe in proportion to the power that it carries over all bands, and turns the powers of
// the bands into those of the ray that goes on: their sum is exactly what was not absorbed.
Lobe choose_lobe(const OpticalSurface& surface, int bands, double u, BandValues& power_W) {
  double specular = 0.0, diffuse = 0.0, transmitted = 0.0;
  for (int b = 0; b < bands; ++b) {
    specular += power_W[b] * surface.specular[b];
    diffuse += power_W[b] * surface.diffuse[b];
    transmitted += power_W[b] * surface.transmitted[b];
  }
  const double total = specular + diffuse + transmitted;
  const double at = u * total;
  const Lobe lobe = at < specular             ? Lobe::specular
                    : at < specular + diffuse ? Lobe::diffuse
                                              : Lobe::transmitted;
  const BandValues& fraction = lobe == Lobe::specular  ? surface.specular
                               : lobe == Lobe::diffuse ? surface.diffuse
                                                       : surface.transmitted;
  const double share = lobe == Lobe::specular  ? specular
                       : lobe == Lobe::diffuse ? diffuse
                                               : transmitted;
  const double scale = total / share;
  for (int b = 0; b < bands; ++b) power_W[b] *= fraction[b] * scale;
  return lobe;
}

// Lambert's law about the unit normal n: uniform in projected solid angle. The frame is that of
// Duff et al., "Building an orthonormal basis, revisited" (JCGT 6(1), 2017).
Vec3 lambertian_direction(const Vec3& n, double u, double v) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  const Vec3 s(1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
  const Vec3 t(b, sign + n.y() * n.y() * a, -n.y());
  const double radius = std::sqrt(u), angle = 2.0 * pi * v;
  return radius * std::cos(angle) * s + radius * std::sin(angle) * t + std::sqrt(1.0 - u) * n;
}

Ray make_ray(const Vec3& origin_m, const Vec3& direction, uint32_t sample) {
  Ray ray{};
  for (int k = 0; k < 3; ++k) {
    ray.origin_m[k] = static_cast<float>(origin_m[k]);
    ray.direction[k] = static_cast<float>(direction[k]);
  }
  ray.sample = sample;
  return ray;
}

// The side of the surface that was hit, as its unit normal.
Vec3 lit_normal(const InteractionContext& context, const Hits& hits, int i) {
  const TrianglePlane& plane = context.scene->plane(hits.instance[i], hits.triangle[i]);
  const Vec3 front(plane.normal[0], plane.normal[1], plane.normal[2]);
  return hits.front[i] != 0 ? front : Vec3(-front);
}

Vec3 mirrored(const Vec3& direction, const Vec3& normal) {
  return direction - 2.0 * direction.dot(normal) * normal;
}

// The momentum flow [N] that leaves with all lobes of hit i: the expectation over what send_on()
// draws, so that forces carry no noise of the draw. Lambertian light takes 2/3 of its power over c
// along the normal (e.g. Markley and Crassidis, Fundamentals of Spacecraft Attitude Determination
// and Control, section 3.3.6).
Vec3 expected_recoil(const Hits& hits, int i, const OpticalSurface& surface, const Vec3& direction,
                     const Vec3& normal) {
  double specular = 0.0, diffuse = 0.0, transmitted = 0.0;
  for (int b = 0; b < hits.bands; ++b) {
    specular += hits.incident_W[b][i] * surface.specular[b];
    diffuse += hits.incident_W[b][i] * surface.diffuse[b];
    transmitted += hits.incident_W[b][i] * surface.transmitted[b];
  }
  return (specular * mirrored(direction, normal) + (2.0 / 3.0) * diffuse * normal +
          transmitted * direction) /
         speed_of_light_m_s;
}

// Sends the rest of hit i on its way along one lobe.
void send_on(const InteractionContext& context, const SobolSequence& sequence,
             const HitBuffer& buffer, int i, const OpticalSurface& surface, const Vec3& direction,
             const Vec3& normal, LedgerSums& ledger, Continuation& next) {
  const Hits& hits = buffer.hits;
  const auto point = sequence.point(buffer.sample[i]);
  BandValues power_W{};
  for (int b = 0; b < hits.bands; ++b) power_W[b] = hits.incident_W[b][i];
  const Lobe lobe = choose_lobe(surface, hits.bands, point[0], power_W);

  const Vec3 position(hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]);
  const double lift = lobe == Lobe::transmitted ? -context.scene->lift_m : context.scene->lift_m;
  const Vec3 onward = lobe == Lobe::specular  ? mirrored(direction, normal)
                      : lobe == Lobe::diffuse ? lambertian_direction(normal, point[1], point[2])
                                              : direction;
  go_on(context, hits.bands, {position, position + lift * normal, onward, buffer.sample[i]},
        power_W, ledger, next);
}

using Lane = Eigen::Map<Eigen::ArrayXd>;
Lane lane(Hits::Column<double>& column, int count) {
  return {column.data(), count};
}

// Four partial sums in fixed order: that of Eigen's sum() depends on where the terms lie in memory.
template <typename Terms>
double ordered_sum(const Terms& terms) {
  Eigen::Array4d lanes = Eigen::Array4d::Zero();
  Eigen::Index i = 0;
  for (; i + 4 <= terms.size(); i += 4) lanes += terms.template segment<4>(i);
  for (; i < terms.size(); ++i) lanes[i % 4] += terms.coeff(i);
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

// absorbed_W and left_W of every hit.
void absorb(const TraceableScene::Data& scene, HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  lane(buffer.left_W, hits.count).setZero();
  for (int b = 0; b < hits.bands; ++b) {
    const double* fraction = scene.absorbed_fraction[b].data();
    const double* incident = hits.incident_W[b].data();
    double* absorbed = hits.absorbed_W[b].data();
    for (int i = 0; i < hits.count; ++i) {
      absorbed[i] = incident[i] * fraction[2 * hits.instance[i] + hits.front[i]];
    }
    lane(buffer.left_W, hits.count) +=
        lane(hits.incident_W[b], hits.count) - lane(hits.absorbed_W[b], hits.count);
  }
}

// The momentum that arrives: force_N of every hit, and the ledger's intake for first hits.
void take_momentum(const InteractionContext& context, HitBuffer& buffer, LedgerSums& ledger) {
  Hits& hits = buffer.hits;
  const int n = hits.count;
  for (size_t k = 0; k < 3; ++k) lane(hits.force_N[k], n).setZero();
  for (int b = 0; b < hits.bands; ++b) {
    for (size_t k = 0; k < 3; ++k) {
      lane(hits.force_N[k], n) +=
          lane(buffer.direction[k], n) * lane(hits.incident_W[b], n) * (1.0 / speed_of_light_m_s);
    }
  }
  if (context.depth > 0) return;
  for (size_t k = 0; k < 3; ++k) {
    const size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    ledger.momentum_in[k] += ordered_sum(lane(hits.force_N[k], n));
    ledger.momentum_in[3 + k] +=
        ordered_sum(lane(hits.position_m[k1], n) * lane(hits.force_N[k2], n) -
                    lane(hits.position_m[k2], n) * lane(hits.force_N[k1], n));
  }
}

}  // namespace

void LedgerSums::add(const LedgerSums& other) {
  escaped_W += other.escaped_W;
  truncated_W += other.truncated_W;
  for (size_t k = 0; k < 6; ++k) {
    momentum_in[k] += other.momentum_in[k];
    momentum_out[k] += other.momentum_out[k];
  }
  for (size_t i = 0; i < absorbed_lanes_W.size(); ++i) {
    for (size_t lane = 0; lane < 4; ++lane)
      absorbed_lanes_W[i][lane] += other.absorbed_lanes_W[i][lane];
  }
}

void LedgerSums::release(const Vec3& at_m, const Vec3& direction, double power_W) {
  release_momentum(at_m, direction * (power_W / speed_of_light_m_s));
}

void LedgerSums::release_momentum(const Vec3& at_m, const Vec3& force_N) {
  const Vec3 torque = at_m.cross(force_N);
  for (size_t k = 0; k < 3; ++k) {
    momentum_out[k] += force_N[static_cast<Eigen::Index>(k)];
    momentum_out[3 + k] += torque[static_cast<Eigen::Index>(k)];
  }
}

double LedgerSums::absorbed_W(size_t instance) const {
  const auto& lanes = absorbed_lanes_W[instance];
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

void go_on(const InteractionContext& context, int bands, const Departure& departure,
           const BandValues& power_W, LedgerSums& ledger, Continuation& next) {
  double total = 0.0;
  for (int b = 0; b < bands; ++b) total += power_W[b];
  if (total < context.cutoff_W) {
    ledger.truncated_W += total;
    ledger.release(departure.hit_m, departure.direction, total);
    return;
  }
  next.rays.push_back(make_ray(departure.origin_m, departure.direction, departure.sample));
  next.power_W.insert(next.power_W.end(), power_W.begin(), power_W.begin() + bands);
}

void interact(const InteractionContext& context, HitBuffer& buffer, LedgerSums& ledger,
              Continuation& next) {
  Hits& hits = buffer.hits;
  const Scene& scene = context.scene->scene;
  const bool finishes = !context.scene->finish.empty();
  absorb(*context.scene, buffer);
  if (finishes) absorb_by_angle(*context.scene, buffer);
  take_momentum(context, buffer, ledger);
  for (int b = 0; b < hits.bands; ++b) {
    for (int i = 0; i < hits.count; ++i) {
      ledger.absorbed_lanes_W[hits.instance[i]][static_cast<size_t>(i & 3)] +=
          hits.absorbed_W[b][i];
    }
  }
  SobolStream stream = context.stream;
  stream.group = static_cast<uint32_t>(context.depth) + 1u;
  const SobolSequence sequence(stream);
  if (finishes) settle_finishes(context, sequence, buffer, ledger, next);
  for (int i = 0; i < hits.count; ++i) {
    if (!(buffer.left_W[i] > 0.0)) continue;
    const Instance& instance = scene.instances[hits.instance[i]];
    const OpticalSurface& surface =
        scene.surfaces[hits.front[i] != 0 ? instance.front_surface : instance.back_surface];
    const Vec3 direction(buffer.direction[0][i], buffer.direction[1][i], buffer.direction[2][i]);
    const Vec3 normal = lit_normal(context, hits, i);
    const Vec3 recoil = expected_recoil(hits, i, surface, direction, normal);
    for (int k = 0; k < 3; ++k) hits.force_N[k][i] -= recoil[k];
    send_on(context, sequence, buffer, i, surface, direction, normal, ledger, next);
  }
}

}  // namespace photorque
