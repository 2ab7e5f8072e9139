#include "raytrace/surfaces/brdf_table.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

// How far an angle lies beyond the nodes.
double beyond(const std::vector<double>& nodes, double angle) {
  constexpr double slack_rad = 1e-9;
  const double far = std::max(nodes.front() - angle, angle - nodes.back());
  return far > slack_rad ? far : 0.0;
}

// All angles of the lists and both ends, each once.
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
    const size_t row = (i.below + di) * table.scatter_rad.size() + o.below + dk;
    sum += weight * table.brdf_1_sr[row * table.azimuth_rad.size() + a.below + da];
  }
  return sum;
}

double symmetrise(const BrdfTable& table, ReciprocalBrdf& brdf) {
  const std::vector<double>& polar = brdf.polar_rad;
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
        brdf.brdf_1_sr[brdf.index(i, o, a)] = brdf.brdf_1_sr[brdf.index(o, i, a)] = mean;
        if (one_way > 0.0 || other_way > 0.0) continue;
        difference2 += (there - back) * (there - back);
        mean2 += mean * mean;
      }
    }
  }
  return mean2 > 0.0 ? std::sqrt(difference2 / mean2) : 0.0;
}

// Along the normal there is no azimuth.
void average_along_normal(ReciprocalBrdf& brdf) {
  const std::vector<double>& azimuth = brdf.azimuth_rad;
  for (size_t o = 0; o < brdf.polar_rad.size(); ++o) {
    double mean = 0.0;
    for (size_t a = 0; a + 1 < azimuth.size(); ++a) {
      mean += 0.5 * (brdf.at(0, o, a) + brdf.at(0, o, a + 1)) * (azimuth[a + 1] - azimuth[a]) / pi;
    }
    for (size_t a = 0; a < azimuth.size(); ++a) {
      brdf.brdf_1_sr[brdf.index(0, o, a)] = brdf.brdf_1_sr[brdf.index(o, 0, a)] = mean;
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
  brdf.polar_rad = joined(table.incidence_rad, table.scatter_rad, 0.5 * pi);
  brdf.azimuth_rad = joined(table.azimuth_rad, {}, pi);
  brdf.brdf_1_sr.resize(brdf.polar_rad.size() * brdf.polar_rad.size() * brdf.azimuth_rad.size());
  brdf.asymmetry = symmetrise(table, brdf);
  average_along_normal(brdf);
  return brdf;
}

}  // namespace photorque
