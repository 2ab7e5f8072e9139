// Boxes that could cast what is missing of the light.
#include <algorithm>
#include <cmath>

#include "diagnosis/light/trials/scan.h"

namespace photorque {
namespace {

// A ray from a lamp to a place of a scan, where it crosses the plane that is carved.
struct CarvingRay {
  size_t place;
  double light;  // of the lamp, in errors of the reading
  Vec3 from, to;
};

// What shines on the scans and what is missing of it, in errors.
struct CarvingData {
  std::vector<CarvingRay> rays;
  std::vector<double> missing;  // per place
};

CarvingData carving_data(const LightTrial& parent, const LightCandidates& all,
                         const std::vector<FittedRun>& runs, bool on_body) {
  CarvingData data;
  const LightState state = state_of(parent, all);
  for (const FittedRun& run : runs) {
    const LightRecording& r = run.run->recording();
    if (r.kind != LightRecording::Kind::scan) continue;
    const Eigen::VectorXd residuals = residuals_of(parent, all, run);
    const LightFields fields = run.run->fields(state, run.nominal.get());
    const auto lamps = all.lab->lamps_with(state.divergence);
    for (size_t l = 0; l < lamps->beams.size(); ++l) {
      const RigidTransform pose = pose_of(lamps->beams[l], fields.lamps[l].geometry);
      for (size_t i = 0; i < r.rows(); ++i) {
        const double light = state.power * state.lamp_power[l] * state.detector_gain *
                             (*fields.lamps[l].field)[i] / run.run->row_noise(i);
        constexpr double shows = 2.0;
        if (light < shows) continue;
        const Vec3 place = all.lab->point_body_m(r.u_m[i], r.v_m[i]);
        const Quat& q = r.lab_from_body[i];
        const Vec3 lamp = pose.translation_m;
        data.rays.push_back({data.missing.size() + i, light,
                             on_body ? Vec3(q.conjugate() * lamp) : lamp,
                             on_body ? place : Vec3(q * place)});
      }
    }
    for (Eigen::Index i = 0; i < residuals.size(); ++i) data.missing.push_back(-residuals[i]);
  }
  return data;
}

struct CarvedBox {
  double gain = 0.0;
  Vec3 centre = Vec3::Zero();
  Vec2 size = Vec2::Zero();
};

// The largest patch of elements that may be opaque in the plane z, and what it would explain.
CarvedBox carve(const CarvingData& data, double z) {
  constexpr int cells = 48;
  struct Hit {
    const CarvingRay* ray;
    Vec2 at;
  };
  std::vector<Hit> hits;
  Vec2 low(1e300, 1e300), high(-1e300, -1e300);
  for (const CarvingRay& ray : data.rays) {
    const double t = (z - ray.to.z()) / (ray.from.z() - ray.to.z());
    if (!(t > 0.0 && t < 1.0)) continue;
    const Vec3 at = ray.to + t * (ray.from - ray.to);
    hits.push_back({&ray, {at.x(), at.y()}});
    low = low.cwiseMin(hits.back().at);
    high = high.cwiseMax(hits.back().at);
  }
  CarvedBox best;
  if (hits.empty() || !((high - low).minCoeff() > 0.0)) return best;
  const Vec2 step = (high - low) / cells;
  const auto element = [&](const Vec2& at) {
    const Vec2 k = (at - low).cwiseQuotient(step);
    return static_cast<size_t>(std::clamp(static_cast<int>(k.y()), 0, cells - 1) * cells +
                               std::clamp(static_cast<int>(k.x()), 0, cells - 1));
  };
  // How much of the light through an element is missing where it would arrive, in means that
  // tolerate a few places.
  std::vector<double> sum(cells * cells, 0.0), weight(cells * cells, 0.0);
  for (const Hit& h : hits) {
    const size_t e = element(h.at);
    const double share = std::clamp(data.missing[h.ray->place] / h.ray->light, -0.5, 1.0);
    sum[e] += h.ray->light * share;
    weight[e] += h.ray->light;
  }
  constexpr double opaque = 0.6;
  std::vector<int> patch(cells * cells, 0);
  for (size_t e = 0; e < patch.size(); ++e) {
    patch[e] = weight[e] > 0.0 && sum[e] > opaque * weight[e] ? -1 : 0;
  }
  // Connected patches, each tried as the rectangle about it.
  int patches = 0;
  for (size_t seed = 0; seed < patch.size(); ++seed) {
    if (patch[seed] != -1) continue;
    ++patches;
    int x0 = cells, x1 = -1, y0 = cells, y1 = -1;
    std::vector<size_t> open = {seed};
    patch[seed] = patches;
    while (!open.empty()) {
      const auto e = static_cast<int>(open.back());
      open.pop_back();
      const int x = e % cells, y = e / cells;
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
      const int near[4][2] = {{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}};
      for (const auto& [nx, ny] : near) {
        if (nx < 0 || ny < 0 || nx >= cells || ny >= cells) continue;
        const auto k = static_cast<size_t>(ny * cells + nx);
        if (patch[k] != -1) continue;
        patch[k] = patches;
        open.push_back(k);
      }
    }
    const Vec2 from = low + Vec2(x0 * step.x(), y0 * step.y()),
               to = low + Vec2((x1 + 1) * step.x(), (y1 + 1) * step.y());
    std::vector<double> hidden(data.missing.size(), 0.0);
    for (const Hit& h : hits) {
      const bool in = (h.at - from).minCoeff() >= 0.0 && (to - h.at).minCoeff() >= 0.0;
      if (in) hidden[h.ray->place] += h.ray->light;
    }
    double gain = 0.0;
    for (size_t i = 0; i < hidden.size(); ++i) {
      gain += hidden[i] * (2.0 * data.missing[i] - hidden[i]);
    }
    if (gain > best.gain) {
      best = {gain, Vec3(0.5 * (from.x() + to.x()), 0.5 * (from.y() + to.y()), z), to - from};
    }
  }
  return best;
}

}  // namespace

std::vector<LightStart> shadow_starts(const LightTrial& parent, const LightCandidates& all,
                                      const std::vector<FittedRun>& runs, bool on_body) {
  const CarvingData data = carving_data(parent, all, runs, on_body);
  if (data.rays.empty()) return {};
  double highest = -1e300, lowest = 1e300;
  for (const CarvingRay& ray : data.rays) {
    highest = std::max(highest, ray.to.z());
    lowest = std::min(lowest, ray.from.z());
  }
  std::vector<CarvedBox> found;
  constexpr int planes = 24;
  for (int k = 0; k < planes; ++k) {
    const double part = (k + 0.5) / planes;
    const CarvedBox box = carve(data, highest + 0.9 * part * (lowest - highest));
    if (box.gain > all.limits.scoring.min_scan_gain) found.push_back(box);
  }
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.gain > b.gain; });
  constexpr size_t most = 3;
  if (found.size() > most) found.resize(most);
  std::vector<LightStart> starts;
  for (const CarvedBox& box : found) {
    starts.push_back(
        {{1.0, box.centre.x(), box.centre.y(), box.centre.z(), box.size.x(), box.size.y()}});
  }
  return starts;
}

}  // namespace photorque
