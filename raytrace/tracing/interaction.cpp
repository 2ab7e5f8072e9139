#include "raytrace/tracing/interaction.h"

#include <bit>
#include <cmath>

#include "core/constants.h"
#include "raytrace/tracing/scattering.h"

namespace photorque {
namespace {

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
  return buffer.one_side && scene.black[scene.side(hits.instance[0], hits.front[0])] != 0;
}

void absorb_all(Hits& hits) {
  for (int b = 0; b < hits.bands; ++b) {
    std::copy_n(hits.incident_W[b].begin(), hits.count, hits.absorbed_W[b].begin());
  }
}

// absorbed_W and left_W of every hit, by the fractions that hold at every angle.
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

// The same again where they depend on the angle of incidence.
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
