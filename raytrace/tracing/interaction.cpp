#include "raytrace/tracing/interaction.h"

#include <bit>
#include <cmath>

#include "core/constants.h"
#include "raytrace/tracing/bsdf_interaction.h"

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
  const BandValues& of_band = lobe == Lobe::specular  ? surface.specular
                              : lobe == Lobe::diffuse ? surface.diffuse
                                                      : surface.transmitted;
  const double fraction = lobe == Lobe::specular  ? specular
                          : lobe == Lobe::diffuse ? diffuse
                                                  : transmitted;
  const double scale = total / fraction;
  for (int b = 0; b < bands; ++b) power_W[b] *= of_band[b] * scale;
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
             const Vec3& normal, PowerBalanceSums& power_balance, Continuation& next) {
  const Hits& hits = buffer.hits;
  const auto point = sequence.point(buffer.sample[i]);
  BandValues power_W{};
  for (int b = 0; b < hits.bands; ++b) power_W[b] = hits.incident_W[b][i];
  const Lobe lobe = choose_lobe(surface, hits.bands, point[0], power_W);

  const Vec3 position(hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]);
  const double ray_offset =
      lobe == Lobe::transmitted ? -context.scene->ray_offset_m : context.scene->ray_offset_m;
  const Vec3 onward = lobe == Lobe::specular  ? mirrored(direction, normal)
                      : lobe == Lobe::diffuse ? lambertian_direction(normal, point[1], point[2])
                                              : direction;
  go_on(context, hits.bands, {position, position + ray_offset * normal, onward, buffer.sample[i]},
        power_W, power_balance, next);
}

// Four neighbours of a column.
using Quad = Eigen::Array4d;
Eigen::Map<const Quad> quad(const Hits::Column<double>& column, int first) {
  return Eigen::Map<const Quad>(column.data() + first);
}

// Makes the rows after the last hit, up to a whole quad, carry no momentum.
void pad_quad(Hits& hits) {
  for (size_t k = 0; k < 3; ++k) {
    std::fill_n(hits.position_m[k].begin() + hits.count, 3, 0.0);
    std::fill_n(hits.force_N[k].begin() + hits.count, 3, 0.0);
  }
}

// Whether everything stays where it hits.
bool all_black(const TraceableScene::Data& scene, const HitBuffer& buffer) {
  const Hits& hits = buffer.hits;
  return buffer.one_side && scene.black[2 * hits.instance[0] + hits.front[0]] != 0;
}

void absorb_all(Hits& hits) {
  for (int b = 0; b < hits.bands; ++b) {
    std::copy_n(hits.incident_W[b].begin(), hits.count, hits.absorbed_W[b].begin());
  }
}

// absorbed_W and left_W of every hit.
void absorb(const TraceableScene::Data& scene, HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  std::fill_n(buffer.left_W.begin(), hits.count, 0.0);
  for (int b = 0; b < hits.bands; ++b) {
    const double* fraction = scene.absorbed_fraction[b].data();
    const double* incident = hits.incident_W[b].data();
    double* absorbed = hits.absorbed_W[b].data();
    if (buffer.one_side) {
      const double same = fraction[2 * hits.instance[0] + hits.front[0]];
      for (int i = 0; i < hits.count; ++i) absorbed[i] = incident[i] * same;
    } else {
      for (int i = 0; i < hits.count; ++i) {
        absorbed[i] = incident[i] * fraction[2 * hits.instance[i] + hits.front[i]];
      }
    }
    for (int i = 0; i < hits.count; ++i) buffer.left_W[i] += incident[i] - absorbed[i];
  }
}

// Whether any hit has power that goes on. By the bits, which are found several at a time.
bool any_left(const HitBuffer& buffer) {
  uint64_t bits = 0;
  for (int i = 0; i < buffer.hits.count; ++i) bits |= std::bit_cast<uint64_t>(buffer.left_W[i]);
  return bits != 0;
}

void book_absorbed(const HitBuffer& buffer, PowerBalanceSums& power_balance) {
  const Hits& hits = buffer.hits;
  for (int b = 0; b < hits.bands; ++b) {
    const double* absorbed = hits.absorbed_W[b].data();
    int i = 0;
    if (buffer.one_side) {
      auto& sums = power_balance.absorbed_lanes_W[hits.instance[0]];
      Quad even = Eigen::Map<Quad>(sums.data()), odd = Quad::Zero();
      for (; i + 8 <= hits.count; i += 8) {
        even += Eigen::Map<const Quad>(absorbed + i);
        odd += Eigen::Map<const Quad>(absorbed + i + 4);
      }
      Eigen::Map<Quad>(sums.data()) = even + odd;
    }
    for (; i < hits.count; ++i) {
      power_balance.absorbed_lanes_W[hits.instance[i]][static_cast<size_t>(i & 3)] += absorbed[i];
    }
  }
}

// The momentum that arrives at every hit.
void take_momentum(HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  const auto& direction = buffer.ray;  // columns 3 to 5
  Hits::Column<double> power_W = hits.incident_W[0];
  for (int b = 1; b < hits.bands; ++b) {
    for (int i = 0; i < hits.count; ++i) power_W[i] += hits.incident_W[b][i];
  }
  for (int i = 0; i < hits.count; ++i) {
    const double momentum_N = power_W[i] * (1.0 / speed_of_light_m_s);
    hits.force_N[0][i] = direction[3][i] * momentum_N;
    hits.force_N[1][i] = direction[4][i] * momentum_N;
    hits.force_N[2][i] = direction[5][i] * momentum_N;
  }
}

// The momentum of first hits, in four lanes, the same on every machine.
void book_momentum(Hits& hits, PowerBalanceSums& power_balance) {
  pad_quad(hits);
  std::array<Quad, 6> intake;
  intake.fill(Quad::Zero());
  for (int i = 0; i < hits.count; i += 4) {
    std::array<Quad, 3> force_N, at_m;
    for (size_t k = 0; k < 3; ++k) {
      force_N[k] = quad(hits.force_N[k], i);
      at_m[k] = quad(hits.position_m[k], i);
    }
    for (size_t k = 0; k < 3; ++k) {
      const size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      intake[k] += force_N[k];
      intake[3 + k] += at_m[k1] * force_N[k2] - at_m[k2] * force_N[k1];
    }
  }
  for (size_t k = 0; k < 6; ++k) {
    power_balance.momentum_in[k] += (intake[k][0] + intake[k][1]) + (intake[k][2] + intake[k][3]);
  }
}

}  // namespace

void PowerBalanceSums::add(const PowerBalanceSums& other) {
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

void PowerBalanceSums::release(const Vec3& at_m, const Vec3& direction, double power_W) {
  release_momentum(at_m, direction * (power_W / speed_of_light_m_s));
}

void PowerBalanceSums::release_momentum(const Vec3& at_m, const Vec3& force_N) {
  const Vec3 torque = at_m.cross(force_N);
  for (size_t k = 0; k < 3; ++k) {
    momentum_out[k] += force_N[static_cast<Eigen::Index>(k)];
    momentum_out[3 + k] += torque[static_cast<Eigen::Index>(k)];
  }
}

double PowerBalanceSums::absorbed_W(size_t instance) const {
  const auto& lanes = absorbed_lanes_W[instance];
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

void go_on(const InteractionContext& context, int bands, const Departure& departure,
           const BandValues& power_W, PowerBalanceSums& power_balance, Continuation& next) {
  double total = 0.0;
  for (int b = 0; b < bands; ++b) total += power_W[b];
  if (total < context.cutoff_W) {
    power_balance.truncated_W += total;
    power_balance.release(departure.hit_m, departure.direction, total);
    return;
  }
  next.rays.push_back(make_ray(departure.origin_m, departure.direction, departure.sample));
  next.power_W.insert(next.power_W.end(), power_W.begin(), power_W.begin() + bands);
}

void interact(const InteractionContext& context, HitBuffer& buffer, PowerBalanceSums& power_balance,
              Continuation& next) {
  Hits& hits = buffer.hits;
  const Scene& scene = context.scene->scene;
  const bool bsdfs = !context.scene->bsdf.empty();
  const bool black = all_black(*context.scene, buffer);
  if (black) {
    absorb_all(hits);
  } else {
    absorb(*context.scene, buffer);
    if (bsdfs) absorb_by_angle(*context.scene, buffer);
  }
  take_momentum(buffer);
  if (context.depth == 0) book_momentum(hits, power_balance);
  book_absorbed(buffer, power_balance);
  if (black) return;
  if (!bsdfs && !any_left(buffer)) return;
  SobolStream stream = context.stream;
  stream.group = static_cast<uint32_t>(context.depth) + 1u;
  const SobolSequence sequence(stream);
  if (bsdfs) settle_finishes(context, sequence, buffer, power_balance, next);
  for (int i = 0; i < hits.count; ++i) {
    if (!(buffer.left_W[i] > 0.0)) continue;
    const Instance& instance = scene.instances[hits.instance[i]];
    const OpticalSurface& surface =
        scene.surfaces[hits.front[i] != 0 ? instance.front_surface : instance.back_surface];
    const Vec3 direction = buffer.direction(i);
    const Vec3 normal = lit_normal(context, hits, i);
    const Vec3 recoil = expected_recoil(hits, i, surface, direction, normal);
    for (int k = 0; k < 3; ++k) hits.force_N[k][i] -= recoil[k];
    send_on(context, sequence, buffer, i, surface, direction, normal, power_balance, next);
  }
}

}  // namespace photorque
