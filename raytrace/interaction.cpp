#include "raytrace/interaction.h"

#include <cmath>

#include "core/constants.h"

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
  const double share = lobe == Lobe::specular ? specular : lobe == Lobe::diffuse ? diffuse : transmitted;
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

void add_momentum(std::array<double, 6>& sums, const Vec3& at_m, const Vec3& direction,
                  double power_W) {
  const Vec3 force = direction * (power_W / speed_of_light_m_s);
  const Vec3 torque = at_m.cross(force);
  for (int k = 0; k < 3; ++k) {
    sums[k] += force[k];
    sums[3 + k] += torque[k];
  }
}

// Sends the rest of hit i on its way; returns the momentum flow that it takes along [N].
Vec3 send_on(const InteractionContext& context, const HitBuffer& buffer, int i,
             const OpticalSurface& surface, BandValues power_W, const Vec3& direction,
             LedgerSums& ledger, Continuation& next) {
  const Hits& hits = buffer.hits;
  SobolStream stream = context.stream;
  stream.group = hits.depth[i] + 1u;
  const auto point = sobol_point(stream, buffer.sample[i]);
  const Lobe lobe = choose_lobe(surface, hits.bands, point[0], power_W);

  const TrianglePlane& plane = context.scene->plane(hits.instance[i], hits.triangle[i]);
  const Vec3 front(plane.normal[0], plane.normal[1], plane.normal[2]);
  const Vec3 normal = hits.front[i] != 0 ? front : Vec3(-front);  // towards where the ray came from
  const Vec3 position(hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]);
  Vec3 onward = direction;
  double lift = context.scene->lift_m;
  switch (lobe) {
    case Lobe::specular:
      onward = direction - 2.0 * direction.dot(normal) * normal;
      break;
    case Lobe::diffuse:
      onward = lambertian_direction(normal, point[1], point[2]);
      break;
    case Lobe::transmitted:
      lift = -lift;
      break;
  }
  const Ray ray = make_ray(position + lift * normal, onward, buffer.sample[i]);
  // What leaves is what the ray carries, rounded as it is.
  const Vec3 taken(ray.direction[0], ray.direction[1], ray.direction[2]);
  double total = 0.0;
  for (int b = 0; b < hits.bands; ++b) total += power_W[b];
  if (total < context.cutoff_W) {
    ledger.truncated_W += total;
    add_momentum(ledger.momentum_out, position, taken, total);
  } else {
    next.rays.push_back(ray);
    next.power_W.insert(next.power_W.end(), power_W.begin(), power_W.begin() + hits.bands);
  }
  return taken * (total / speed_of_light_m_s);
}

}  // namespace

void LedgerSums::add(const LedgerSums& other) {
  escaped_W += other.escaped_W;
  truncated_W += other.truncated_W;
  for (size_t k = 0; k < 6; ++k) {
    momentum_in[k] += other.momentum_in[k];
    momentum_out[k] += other.momentum_out[k];
  }
  for (size_t i = 0; i < absorbed_W.size(); ++i) absorbed_W[i] += other.absorbed_W[i];
}

void interact(const InteractionContext& context, HitBuffer& buffer, LedgerSums& ledger,
              Continuation& next) {
  Hits& hits = buffer.hits;
  const Scene& scene = context.scene->scene;
  for (int i = 0; i < hits.count; ++i) {
    const Instance& instance = scene.instances[hits.instance[i]];
    const OpticalSurface& surface =
        scene.surfaces[hits.front[i] != 0 ? instance.front_surface : instance.back_surface];
    BandValues power_W{};
    double incident = 0.0, absorbed = 0.0;
    for (int b = 0; b < hits.bands; ++b) {
      power_W[b] = hits.incident_W[b][i];
      hits.absorbed_W[b][i] = power_W[b] * surface.absorbed[b];
      incident += power_W[b];
      absorbed += hits.absorbed_W[b][i];
    }
    const Vec3 direction(buffer.direction[0][i], buffer.direction[1][i], buffer.direction[2][i]);
    Vec3 force = direction * (incident / speed_of_light_m_s);
    const double left = incident - absorbed;
    if (left > 0.0) {
      force -= send_on(context, buffer, i, surface, power_W, direction, ledger, next);
    }
    ledger.absorbed_W[hits.instance[i]] += absorbed;
    for (int k = 0; k < 3; ++k) hits.force_N[k][i] = force[k];
    if (hits.depth[i] == 0) {
      const Vec3 position(hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]);
      add_momentum(ledger.momentum_in, position, direction, incident);
    }
  }
}

}  // namespace photorque
