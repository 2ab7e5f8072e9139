#include "raytrace/surfaces/measured_brdf.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/quadrature.h"

namespace photorque {
namespace {

// Distance [rad] of an angle from the range of the nodes; 0 inside and within 1e-9 rad of it.
double beyond(const std::vector<double>& nodes, double angle) {
  constexpr double slack_rad = 1e-9;
  const double far = std::max(nodes.front() - angle, angle - nodes.back());
  return far > slack_rad ? far : 0.0;
}

// Sorted union of both lists, 0 and `last`, without duplicates.
std::vector<double> joined(std::vector<double> angles, const std::vector<double>& more,
                           double last) {
  angles.insert(angles.end(), more.begin(), more.end());
  angles.insert(angles.end(), {0.0, last});
  std::sort(angles.begin(), angles.end());
  const auto same = [](double a, double b) { return b - a < 1e-9; };
  angles.erase(std::unique(angles.begin(), angles.end(), same), angles.end());
  return angles;
}

double interpolated(const BrdfTable& table, double incidence, double scatter, double azimuth) {
  const NodePlace i = place_among(table.incidence_rad, incidence);
  const NodePlace o = place_among(table.scatter_rad, scatter);
  const NodePlace a = place_among(table.azimuth_rad, azimuth);
  double sum = 0.0;
  for (size_t corner = 0; corner < 8; ++corner) {
    const size_t di = corner & 1, dk = (corner >> 1) & 1, da = corner >> 2;
    const double weight =
        (di ? i.part : 1.0 - i.part) * (dk ? o.part : 1.0 - o.part) * (da ? a.part : 1.0 - a.part);
    if (weight == 0.0) continue;
    sum += weight * table.at(i.below + di, o.below + dk, a.below + da);
  }
  return sum;
}

double symmetrise(const BrdfTable& table, ReciprocalBrdf& brdf) {
  const std::vector<double>& polar = brdf.incidence_rad;
  double difference2 = 0.0, mean2 = 0.0;
  for (size_t i = 0; i < polar.size(); ++i) {
    for (size_t o = 0; o <= i; ++o) {
      const auto guessed = [&](size_t in, size_t to) {
        return beyond(table.incidence_rad, polar[in]) + beyond(table.scatter_rad, polar[to]);
      };
      const double one_way = guessed(i, o), other_way = guessed(o, i);
      for (size_t a = 0; a < brdf.azimuth_rad.size(); ++a) {
        const double there = interpolated(table, polar[i], polar[o], brdf.azimuth_rad[a]);
        const double back = interpolated(table, polar[o], polar[i], brdf.azimuth_rad[a]);
        const double mean = one_way == other_way  ? 0.5 * (there + back)
                            : one_way < other_way ? there
                                                  : back;
        brdf.at(i, o, a) = brdf.at(o, i, a) = mean;
        if (one_way > 0.0 || other_way > 0.0) continue;
        difference2 += (there - back) * (there - back);
        mean2 += mean * mean;
      }
    }
  }
  return mean2 > 0.0 ? std::sqrt(difference2 / mean2) : 0.0;
}

// Averages over the azimuth at normal incidence and at normal scattering, where the azimuth is
// undefined.
void average_along_normal(ReciprocalBrdf& brdf) {
  const std::vector<double>& azimuth = brdf.azimuth_rad;
  for (size_t o = 0; o < brdf.incidence_rad.size(); ++o) {
    double mean = 0.0;
    for (size_t a = 0; a + 1 < azimuth.size(); ++a) {
      mean += 0.5 * (brdf.at(0, o, a) + brdf.at(0, o, a + 1)) * (azimuth[a + 1] - azimuth[a]) / pi;
    }
    for (size_t a = 0; a < azimuth.size(); ++a) {
      brdf.at(0, o, a) = brdf.at(o, 0, a) = mean;
    }
  }
}

}  // namespace

NodePlace place_among(const std::vector<double>& nodes, double angle) {
  if (nodes.size() < 2 || angle <= nodes.front()) return {};
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, angle);
  const auto i = static_cast<size_t>(above - nodes.begin());
  return {i - 1, std::min(1.0, (angle - nodes[i - 1]) / (nodes[i] - nodes[i - 1]))};
}

ReciprocalBrdf reciprocal_brdf(const BrdfTable& table) {
  ReciprocalBrdf brdf;
  brdf.incidence_rad = joined(table.incidence_rad, table.scatter_rad, 0.5 * pi);
  brdf.scatter_rad = brdf.incidence_rad;
  brdf.azimuth_rad = joined(table.azimuth_rad, {}, pi);
  const size_t polar = brdf.incidence_rad.size();
  brdf.brdf_1_sr.resize(polar * polar * brdf.azimuth_rad.size());
  brdf.asymmetry = symmetrise(table, brdf);
  average_along_normal(brdf);
  return brdf;
}

namespace {

// ∫ (1 − s) w and ∫ s w over an interval; s runs from 0 to 1 along it.
struct HatWeights {
  double low = 0.0, high = 0.0;
};

template <typename Weight>
std::vector<HatWeights> hat_weights(const std::vector<double>& nodes, const Weight& weight) {
  std::vector<HatWeights> hats;
  for (size_t i = 0; i + 1 < nodes.size(); ++i) {
    const double width = nodes[i + 1] - nodes[i];
    HatWeights hat;
    for (const auto& [x, w] : gauss_legendre(16)) {
      const double s = 0.5 * (1.0 + x);
      const double value = 0.5 * w * width * weight(nodes[i] + s * width);
      hat.low += (1.0 - s) * value;
      hat.high += s * value;
    }
    hats.push_back(hat);
  }
  return hats;
}

class BrdfLobe final : public Lobe {
 public:
  explicit BrdfLobe(const BrdfTable& table) : brdf_(reciprocal_brdf(table)) { integrate(); }

  double reflectance(double cosine) const {
    const auto [i, part] = place_of(cosine);
    return (1.0 - part) * reflectance_[i] + part * reflectance_[i + 1];
  }
  double asymmetry() const { return brdf_.asymmetry; }
  // Node with the largest reflectance: the reflectance is linear between nodes.
  size_t brightest_node() const {
    return static_cast<size_t>(std::max_element(reflectance_.begin(), reflectance_.end()) -
                               reflectance_.begin());
  }
  double node_rad(size_t i) const { return polar()[i]; }
  double node_reflectance(size_t i) const { return reflectance_[i]; }

  Vec3 direction(const Arrival& light, const Draw& draw) const override {
    const auto [i, part] = place_of(light.cosine);
    const double high = part * reflectance_[i + 1], low = (1.0 - part) * reflectance_[i];
    const size_t node = draw.extra(1) * (low + high) < high ? i + 1 : i;
    const Cell cell = choose_cell(node, draw.u);
    CellPoint point = point_in(cell, cell.along, draw.v);
    constexpr uint64_t most = 256;  // the acceptance is at least 1/4
    for (uint64_t attempt = 1; attempt < most; ++attempt) {
      if (draw.extra(3 * attempt - 1) * cell.largest < value_in(node, cell, point)) break;
      const Draw now = draw.attempt(attempt);
      point = point_in(cell, now.u, now.v);
    }
    return point.out;
  }

  Vec3 mean_direction(const Arrival& light) const override {
    const auto [i, part] = place_of(light.cosine);
    const double whole = (1.0 - part) * reflectance_[i] + part * reflectance_[i + 1];
    if (!(whole > 0.0)) return Vec3::Zero();
    return ((1.0 - part) * momentum_[i] + part * momentum_[i + 1]) / whole;
  }

  double density(const Arrival& light, const Vec3& out) const override {
    const auto [i, i_part] = place_of(light.cosine);
    const auto [o, o_part] = place_of(std::max(out.z(), 0.0));
    const auto [a, a_part] = place_among(azimuth(), std::atan2(std::abs(out.y()), -out.x()));
    const auto along_azimuth = [&, a = a, a_part = a_part](size_t in, size_t to) {
      return (1.0 - a_part) * brdf_.at(in, to, a) + a_part * brdf_.at(in, to, a + 1);
    };
    const auto along_both = [&, o = o, o_part = o_part](size_t in) {
      return (1.0 - o_part) * along_azimuth(in, o) + o_part * along_azimuth(in, o + 1);
    };
    const double f = (1.0 - i_part) * along_both(i) + i_part * along_both(i + 1);
    const double whole = reflectance(light.cosine);
    return whole > 0.0 ? f * out.z() / whole : 0.0;
  }

 private:
  const std::vector<double>& polar() const { return brdf_.incidence_rad; }
  const std::vector<double>& azimuth() const { return brdf_.azimuth_rad; }
  // Place of a cosine among the polar angles.
  NodePlace place_of(double cosine) const {
    return place_among(polar(), std::acos(std::min(cosine, 1.0)));
  }

  void integrate() {
    const auto power = hat_weights(polar(), [](double t) { return std::sin(t) * std::cos(t); });
    const auto up =
        hat_weights(polar(), [](double t) { return std::sin(t) * std::cos(t) * std::cos(t); });
    const auto aside =
        hat_weights(polar(), [](double t) { return std::sin(t) * std::sin(t) * std::cos(t); });
    const auto around = hat_weights(azimuth(), [](double) { return 1.0; });
    const auto forward = hat_weights(azimuth(), [](double a) { return std::cos(a); });
    for (size_t i = 0; i < polar().size(); ++i) {
      double reflected = 0.0;
      Vec3 momentum = Vec3::Zero();
      for (size_t o = 0; o + 1 < polar().size(); ++o) {
        for (size_t a = 0; a + 1 < azimuth().size(); ++a) {
          // Factor 2: both sides of the plane of incidence.
          const auto sum = [&](const HatWeights& polar, const HatWeights& azimuth) {
            return 2.0 * (polar.low * (azimuth.low * brdf_.at(i, o, a) +
                                       azimuth.high * brdf_.at(i, o, a + 1)) +
                          polar.high * (azimuth.low * brdf_.at(i, o + 1, a) +
                                        azimuth.high * brdf_.at(i, o + 1, a + 1)));
          };
          reflected += sum(power[o], around[a]);
          momentum.x() -= sum(aside[o], forward[a]);
          momentum.z() += sum(up[o], around[a]);
          cell_sums_.push_back(reflected);
        }
      }
      reflectance_.push_back(reflected);
      momentum_.push_back(momentum);
    }
  }

  // A cell between scattering nodes, drawn in proportion to its power.
  struct Cell {
    size_t o, a;     // lower nodes
    double along;    // remainder of the random number, uniform in (0, 1)
    double largest;  // f at the brightest corner
  };
  Cell choose_cell(size_t node, double u) const {
    const size_t rows = azimuth().size() - 1, cells = (polar().size() - 1) * rows;
    const auto first = cell_sums_.begin() + static_cast<std::ptrdiff_t>(node * cells);
    const double wanted = u * reflectance_[node];
    const auto found =
        std::upper_bound(first, first + static_cast<std::ptrdiff_t>(cells) - 1, wanted);
    const auto cell = static_cast<size_t>(found - first);
    const double before = cell == 0 ? 0.0 : *(found - 1), power = *found - before;
    const size_t o = cell / rows, a = cell % rows;
    return {o, a, power > 0.0 ? std::clamp((wanted - before) / power, 0.0, 1.0) : 0.5,
            std::max({brdf_.at(node, o, a), brdf_.at(node, o, a + 1), brdf_.at(node, o + 1, a),
                      brdf_.at(node, o + 1, a + 1)})};
  }

  // A direction within a cell or its mirror image, distributed by Lambert's law.
  struct CellPoint {
    Vec3 out;
    double s, t;  // fractions between the nodes of the polar angle and of the azimuth
  };
  CellPoint point_in(const Cell& cell, double along, double around) const {
    const double low = std::sin(polar()[cell.o]), high = std::sin(polar()[cell.o + 1]);
    const double sine = std::sqrt(low * low + along * (high * high - low * low));
    const double lean = std::asin(std::min(sine, 1.0));
    const double width = polar()[cell.o + 1] - polar()[cell.o];
    const bool mirrored = around < 0.5;
    const double t = mirrored ? 2.0 * around : 2.0 * around - 1.0;
    const double angle = azimuth()[cell.a] + t * (azimuth()[cell.a + 1] - azimuth()[cell.a]);
    const double cosine = std::max(1e-9, std::sqrt(std::max(0.0, 1.0 - sine * sine)));
    return {{-sine * std::cos(angle), (mirrored ? -sine : sine) * std::sin(angle), cosine},
            std::clamp((lean - polar()[cell.o]) / width, 0.0, 1.0),
            t};
  }

  double value_in(size_t node, const Cell& cell, const CellPoint& point) const {
    const auto along_azimuth = [&](size_t o) {
      return (1.0 - point.t) * brdf_.at(node, o, cell.a) + point.t * brdf_.at(node, o, cell.a + 1);
    };
    return (1.0 - point.s) * along_azimuth(cell.o) + point.s * along_azimuth(cell.o + 1);
  }

  ReciprocalBrdf brdf_;
  std::vector<double> cell_sums_;    // [in][cell]: cumulative power, including the cell
  std::vector<double> reflectance_;  // per node of incidence
  std::vector<Vec3> momentum_;       // ∫ f cos θ_o o do, per node of incidence
};

class BrdfFractions final : public AlbedoLaw {
 public:
  BrdfFractions(std::shared_ptr<const BrdfLobe> lobe, const BandValues& scale)
      : lobe_(std::move(lobe)), scale_(scale) {}
  PowerFractions fractions(double cosine, size_t band) const override {
    // Rounding must not let a perfect reflector emit.
    const double reflected = std::min(1.0, scale_[band] * lobe_->reflectance(cosine));
    return {.absorbed = 1.0 - reflected, .diffuse = reflected};
  }

 private:
  std::shared_ptr<const BrdfLobe> lobe_;
  BandValues scale_;
};

}  // namespace

MeasuredSurface measured_surface(std::string name, const BrdfTable& table,
                                 const BandValues& scale) {
  const auto lobe = std::make_shared<const BrdfLobe>(table);
  Bsdf bsdf;
  bsdf.law = std::make_shared<BrdfFractions>(lobe, scale);
  bsdf.diffuse = lobe;
  bsdf.description = "measured scattering";
  MeasuredSurface measured;
  measured.surface.name = std::move(name);
  for (size_t band = 0; band < max_bands; ++band) {
    if (!(scale[band] > 0.0)) continue;  // band not in use
    set_fractions(measured.surface, band, bsdf.law->fractions(1.0, band));
  }
  measured.surface.bsdf = std::make_shared<const Bsdf>(std::move(bsdf));
  const size_t brightest = lobe->brightest_node();
  measured.largest_reflectance =
      lobe->node_reflectance(brightest) * *std::max_element(scale.begin(), scale.end());
  measured.at_incidence_rad = lobe->node_rad(brightest);
  measured.asymmetry = lobe->asymmetry();
  return measured;
}

}  // namespace photorque
