#include "raytrace/tracing/interaction.h"

#include <bit>
#include <numeric>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/tracing/find_hits.h"

namespace photorque {

namespace {

using ComponentPowers = std::array<double, components.size()>;

// The fractions at one hit: a reference to the surface's constant fractions, which needs no copy,
// or the result of its law.
class HitAlbedo {
 public:
  HitAlbedo(const OpticalSurface& surface, double cosine, int bands) {
    static constexpr BandValues none{};
    const Bsdf* bsdf = surface.bsdf.get();
    if (bsdf == nullptr || !bsdf->law) {
      of_ = {&surface.specular, &surface.diffuse, &surface.transmitted,
             bsdf == nullptr ? &none : &bsdf->retroreflected};
      return;
    }
    for (size_t c = 0; c < of_.size(); ++c) of_[c] = &by_law_[c];
    for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
      const PowerFractions fractions = bsdf->law->fractions(cosine, band);
      for (const Component c : components) {
        by_law_[static_cast<size_t>(c)][band] = fractions.of(c);
      }
    }
  }
  HitAlbedo(const HitAlbedo&) = delete;
  HitAlbedo& operator=(const HitAlbedo&) = delete;

  // Fractions per band.
  const BandValues& operator[](Component c) const { return *of_[static_cast<size_t>(c)]; }

 private:
  std::array<const BandValues*, components.size()> of_;
  std::array<BandValues, components.size()> by_law_;  // filled only if there is a law
};

// The power [W] that each component of hit i carries away, all bands.
ComponentPowers carried_W(const Hits& hits, int i, const HitAlbedo& albedo) {
  ComponentPowers carried{};
  for (const Component c : components) {
    for (int b = 0; b < hits.bands; ++b) {
      carried[static_cast<size_t>(c)] += hits.incident_W[b][i] * albedo[c][b];
    }
  }
  return carried;
}

// Draws a component in proportion to its power; the powers must not all be zero.
Component choose_component(const ComponentPowers& carried, double total_W, double u) {
  Component chosen = components.front();
  double at_W = u * total_W;
  for (const Component c : components) {
    const double power_W = carried[static_cast<size_t>(c)];
    if (power_W <= 0.0) continue;
    chosen = c;
    if (at_W < power_W) break;
    at_W -= power_W;
  }
  return chosen;
}

// Momentum flow [N] that leaves along all components. It is the expectation over the drawn
// component and direction, so that forces carry no noise of the draw.
Vec3 leaving_momentum_N(const OpticalSurface& surface, const Incidence& incidence,
                        const ComponentPowers& carried) {
  Vec3 flow_W = Vec3::Zero();
  for (const Component c : components) {
    const double power_W = carried[static_cast<size_t>(c)];
    if (power_W > 0.0) flow_W += mean_flow(surface, c, incidence, power_W);
  }
  return flow_W / speed_of_light_m_s;
}

// Momentum flow [N] of the heat radiation from both sides of the sheet, by Lambert's law on each.
Vec3 heat_momentum_N(const Bsdf& bsdf, bool front, const Vec3& lit_normal, double absorbed_W) {
  const double lit = front ? bsdf.front_emission : 1.0 - bsdf.front_emission;
  return bsdf.reemitted * absorbed_W * (2.0 * lit - 1.0) * lambertian_mean / speed_of_light_m_s *
         lit_normal;
}

// Direction and side of the light at hit i, in the body frame.
Incidence incidence_at(const TraceableScene::Data& scene, const HitBuffer& buffer, int i) {
  const Hits& hits = buffer.hits;
  return {buffer.direction(i), scene.normal(hits.instance[i], hits.triangle[i], hits.front[i])};
}

// Processes hit i of the buffer, whose absorbed_W is known. Subtracts the leaving momentum,
// including heat radiation, from force_N. Appends the continuing ray to `next`, or ends it if it
// carries less than the cutoff. The component and direction of the ray come from its own point of
// `sequence`. Used for all surfaces, plain or with a BSDF.
void scatter(const InteractionContext& context, const SobolSequence& sequence, HitBuffer& buffer,
             int i, PowerBalanceSums& power_balance, Continuation& next) {
  Hits& hits = buffer.hits;
  const TraceableScene::Data& scene = *context.scene;
  const OpticalSurface& surface = scene.surface(hits.instance[i], hits.front[i]);
  const Incidence incidence = incidence_at(scene, buffer, i);
  const Vec3 position = hits.position_at_m(static_cast<size_t>(i));
  const HitAlbedo albedo(surface, incidence.cosine, hits.bands);
  const ComponentPowers carried = carried_W(hits, i, albedo);

  Vec3 leaving_N = leaving_momentum_N(surface, incidence, carried);
  if (surface.bsdf && surface.bsdf->reemitted > 0.0) {
    double absorbed_W = 0.0;
    for (int b = 0; b < hits.bands; ++b) absorbed_W += hits.absorbed_W[b][i];
    const Vec3 heat_N =
        heat_momentum_N(*surface.bsdf, hits.front[i] != 0, incidence.normal, absorbed_W);
    power_balance.release_momentum(position, heat_N);
    leaving_N += heat_N;
  }
  for (int k = 0; k < 3; ++k) hits.force_N[k][i] -= leaving_N[k];

  const double total_W = std::accumulate(carried.begin(), carried.end(), 0.0);
  if (!(total_W > 0.0)) return;
  const auto point = sequence.point(buffer.sample[i]);
  const Component chosen = choose_component(carried, total_W, point[0]);
  // The ray takes all power that was not absorbed. Its power per band is that of the component,
  // scaled.
  const double scale = total_W / carried[static_cast<size_t>(chosen)];
  BandValues power_W;
  double ray_W = 0.0;
  for (int b = 0; b < hits.bands; ++b) {
    power_W[b] = hits.incident_W[b][i] * (albedo[chosen][b] * scale);
    ray_W += power_W[b];
  }
  const Draw draw{point[1], point[2], std::bit_cast<uint64_t>(point[3])};
  const Vec3 onward = scattered_direction(surface, chosen, incidence, draw);
  if (ray_W < context.cutoff_W) {
    power_balance.truncated_W += ray_W;
    power_balance.release(position, onward, ray_W);
    return;
  }
  const double above_m =
      chosen == Component::transmitted ? -scene.behind_m(hits.instance[i]) : scene.ray_offset_m;
  next.rays.push_back(
      make_ray(position - scene.centre_m + above_m * incidence.normal, onward, buffer.sample[i]));
  next.power_W.insert(next.power_W.end(), power_W.begin(), power_W.begin() + hits.bands);
}

// Four neighbouring entries of a column.
using Quad = Eigen::Array4d;
Eigen::Map<const Quad> quad(const Hits::Column<double>& column, int first) {
  return Eigen::Map<const Quad>(column.data() + first);
}

// Clears the rows after the last hit up to a multiple of four, so that they carry no momentum.
void pad_quad(Hits& hits) {
  for (size_t k = 0; k < 3; ++k) {
    std::fill_n(hits.position_m[k].begin() + hits.count, 3, 0.0);
    std::fill_n(hits.force_N[k].begin() + hits.count, 3, 0.0);
  }
}

// Whether all hits are on a side that absorbs all light.
bool all_black(const TraceableScene::Data& scene, const HitBuffer& buffer) {
  const Hits& hits = buffer.hits;
  return buffer.one_side && scene.black[scene.side(hits.instance[0], hits.front[0])] != 0;
}

void absorb_all(Hits& hits) {
  for (int b = 0; b < hits.bands; ++b) {
    std::copy_n(hits.incident_W[b].begin(), hits.count, hits.absorbed_W[b].begin());
  }
}

// Fills absorbed_W and left_W of every hit from fractions that do not depend on the angle.
void absorb(const TraceableScene::Data& scene, HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  std::fill_n(buffer.left_W.begin(), hits.count, 0.0);
  for (int b = 0; b < hits.bands; ++b) {
    const double* fraction = scene.absorbed_fraction[b].data();
    const double* incident = hits.incident_W[b].data();
    double* absorbed = hits.absorbed_W[b].data();
    if (buffer.one_side) {
      const double same = fraction[scene.side(hits.instance[0], hits.front[0])];
      for (int i = 0; i < hits.count; ++i) absorbed[i] = incident[i] * same;
    } else {
      for (int i = 0; i < hits.count; ++i) {
        absorbed[i] = incident[i] * fraction[scene.side(hits.instance[i], hits.front[i])];
      }
    }
    for (int i = 0; i < hits.count; ++i) buffer.left_W[i] += incident[i] - absorbed[i];
  }
}

// Recomputes absorbed_W and left_W where the fractions depend on the angle of incidence.
void absorb_by_angle(const TraceableScene::Data& scene, HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  for (int i = 0; i < hits.count; ++i) {
    const AlbedoLaw* law = scene.albedo_law[scene.side(hits.instance[i], hits.front[i])];
    if (law == nullptr) continue;
    const double cosine = incidence_at(scene, buffer, i).cosine;
    buffer.left_W[i] = 0.0;
    for (int b = 0; b < hits.bands; ++b) {
      const double absorbed = law->fractions(cosine, static_cast<size_t>(b)).absorbed;
      hits.absorbed_W[b][i] = hits.incident_W[b][i] * absorbed;
      buffer.left_W[i] += hits.incident_W[b][i] - hits.absorbed_W[b][i];
    }
  }
}

// Whether any hit has power that continues. Compares bits, because this loop is vectorised.
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

// Sets force_N of every hit to the arriving momentum flow.
void take_momentum(HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  const auto& direction = buffer.ray;  // columns 3 to 5
  Hits::Column<double> all_bands_W;
  const double* power_W = hits.incident_W[0].data();
  if (hits.bands > 1) {
    std::copy_n(power_W, hits.count, all_bands_W.begin());
    for (int b = 1; b < hits.bands; ++b) {
      for (int i = 0; i < hits.count; ++i) all_bands_W[i] += hits.incident_W[b][i];
    }
    power_W = all_bands_W.data();
  }
  for (int i = 0; i < hits.count; ++i) {
    const double momentum_N = power_W[i] * (1.0 / speed_of_light_m_s);
    hits.force_N[0][i] = direction[3][i] * momentum_N;
    hits.force_N[1][i] = direction[4][i] * momentum_N;
    hits.force_N[2][i] = direction[5][i] * momentum_N;
  }
}

// Adds the momentum of first hits to the balance, in four lanes, so that the bits are the same on
// every machine.
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

void interact(const InteractionContext& context, HitBuffer& buffer, PowerBalanceSums& power_balance,
              Continuation& next) {
  Hits& hits = buffer.hits;
  const TraceableScene::Data& scene = *context.scene;
  const bool black = all_black(scene, buffer);
  if (black) {
    absorb_all(hits);
  } else {
    absorb(scene, buffer);
    if (!scene.albedo_law.empty()) absorb_by_angle(scene, buffer);
  }
  take_momentum(buffer);
  if (context.depth == 0) book_momentum(hits, power_balance);
  book_absorbed(buffer, power_balance);
  if (black || !(scene.reemits || any_left(buffer))) return;
  SobolStream stream = context.stream;
  stream.group = static_cast<uint32_t>(context.depth) + 1u;
  const SobolSequence sequence(stream);
  for (int i = 0; i < hits.count; ++i) {
    if (scene.reemits || buffer.left_W[i] > 0.0) {
      scatter(context, sequence, buffer, i, power_balance, next);
    }
  }
}

}  // namespace photorque
