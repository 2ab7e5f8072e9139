// Boxes that explain missing light.
#include <algorithm>
#include <cmath>

#include "diagnosis/light/scan.h"
#include "scenes/effects/stated.h"

namespace photorque {
namespace {

// A ray from a lamp to a place of a scan, which may cross the carved plane.
struct CarvingRay {
  size_t place;
  double light;  // light of the lamp, in standard errors of the reading
  Vec3 from, to;
};

// Light on the scans and its deficit, in standard errors.
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
      const RigidTransform pose = displaced_pose(lamps->beams[l], fields.lamps[l].geometry.aim,
                                                 fields.lamps[l].geometry.shift_m);
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
    for (const double residual : residuals) data.missing.push_back(-residual);
  }
  return data;
}

struct CarvedBox {
  double gain = 0.0, opacity = 1.0;
  Vec3 centre = Vec3::Zero();
  Vec2 size = Vec2::Zero();
};

// The rays' intersections with a plane z, on a grid of elements.
class CarvedPlane {
 public:
  CarvedPlane(const CarvingData& data, double z) : data_(data), z_(z) {
    for (const CarvingRay& ray : data.rays) {
      const double t = (z - ray.to.z()) / (ray.from.z() - ray.to.z());
      if (!(t > 0.0 && t < 1.0)) continue;
      const Vec3 at = ray.to + t * (ray.from - ray.to);
      hits_.push_back({&ray, {at.x(), at.y()}, 0, 0});
      low_ = low_.cwiseMin(hits_.back().at);
      high_ = high_.cwiseMax(hits_.back().at);
    }
    if (is_empty()) return;
    step_ = (high_ - low_) / cells;
    for (Hit& hit : hits_) {
      const Vec2 k = (hit.at - low_).cwiseQuotient(step_);
      hit.x = std::clamp(static_cast<int>(k.x()), 0, cells - 1);
      hit.y = std::clamp(static_cast<int>(k.y()), 0, cells - 1);
    }
  }

  bool is_empty() const { return hits_.empty() || !((high_ - low_).minCoeff() > 0.0); }

  // The best patch of elements that may be opaque: most of the light through each must be missing
  // at its destination. The mean over its rays tolerates a few places.
  CarvedBox largest_patch() const {
    std::vector<double> sum(cells * cells, 0.0), weight(cells * cells, 0.0);
    for (const Hit& h : hits_) {
      const double share = std::clamp(data_.missing[h.ray->place] / h.ray->light, -0.5, 1.0);
      sum[element(h)] += h.ray->light * share;
      weight[element(h)] += h.ray->light;
    }
    constexpr double opaque = 0.6;
    std::vector<bool> is_open(cells * cells, true);
    for (size_t e = 0; e < is_open.size(); ++e) {
      is_open[e] = !(weight[e] > 0.0 && sum[e] > opaque * weight[e]);
    }
    CarvedBox best;
    for (size_t seed = 0; seed < is_open.size(); ++seed) {
      if (is_open[seed]) continue;
      const CarvedBox box = explained(patch_about(seed, is_open));
      if (box.gain > best.gain) best = box;
    }
    return best;
  }

  // The partly transparent element that explains most. A box smaller than the apertures has no
  // umbra, so only a part of the light through its element is missing. grown() enlarges the element
  // as long as that explains more.
  CarvedBox best_element() const {
    std::vector<double> with(cells * cells, 0.0), square(cells * cells, 0.0);
    for (const Hit& h : hits_) {
      with[element(h)] += h.ray->light * data_.missing[h.ray->place];
      square[element(h)] += h.ray->light * h.ray->light;
    }
    size_t best = 0;
    double gain = 0.0;
    for (size_t e = 0; e < with.size(); ++e) {
      if (with[e] <= 0.0 || with[e] * with[e] <= gain * square[e]) continue;
      gain = with[e] * with[e] / square[e];
      best = e;
    }
    const int x = static_cast<int>(best) % cells, y = static_cast<int>(best) / cells;
    return explained({x, x, y, y});
  }

  CarvedBox grown(CarvedBox box) const {
    const Vec2 half = 0.5 * box.size, middle(box.centre.x(), box.centre.y());
    const Vec2 from = (middle - half - low_).cwiseQuotient(step_),
               to = (middle + half - low_).cwiseQuotient(step_);
    Rectangle r{static_cast<int>(std::lround(from.x())), static_cast<int>(std::lround(to.x())) - 1,
                static_cast<int>(std::lround(from.y())), static_cast<int>(std::lround(to.y())) - 1};
    for (bool grows = true; grows;) {
      grows = false;
      const Rectangle wider[] = {{r.x0 - 1, r.x1, r.y0, r.y1},
                                 {r.x0, r.x1 + 1, r.y0, r.y1},
                                 {r.x0, r.x1, r.y0 - 1, r.y1},
                                 {r.x0, r.x1, r.y0, r.y1 + 1}};
      for (const Rectangle& w : wider) {
        if (w.x0 < 0 || w.y0 < 0 || w.x1 >= cells || w.y1 >= cells) continue;
        const CarvedBox more = explained(w);
        if (more.gain <= box.gain) continue;
        box = more;
        r = w;
        grows = true;
      }
    }
    return box;
  }

 private:
  static constexpr int cells = 48;
  struct Hit {
    const CarvingRay* ray;
    Vec2 at;
    int x, y;
  };
  struct Rectangle {
    int x0, x1, y0, y1;  // elements, both ends included
  };
  static size_t place_of(int x, int y) {
    return static_cast<size_t>(y) * cells + static_cast<size_t>(x);
  }
  static size_t element(const Hit& h) { return place_of(h.x, h.y); }

  // Bounding rectangle of all opaque elements that are connected with `seed`; marks them as open.
  static Rectangle patch_about(size_t seed, std::vector<bool>& is_open) {
    Rectangle r{cells, -1, cells, -1};
    std::vector<size_t> edge = {seed};
    is_open[seed] = true;
    while (!edge.empty()) {
      const auto e = static_cast<int>(edge.back());
      edge.pop_back();
      const int x = e % cells, y = e / cells;
      r = {std::min(r.x0, x), std::max(r.x1, x), std::min(r.y0, y), std::max(r.y1, y)};
      const int near[4][2] = {{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}};
      for (const auto& [nx, ny] : near) {
        if (nx < 0 || ny < 0 || nx >= cells || ny >= cells) continue;
        const auto k = place_of(nx, ny);
        if (is_open[k]) continue;
        is_open[k] = true;
        edge.push_back(k);
      }
    }
    return r;
  }

  // The box over a rectangle with its best opacity, and its fall of χ².
  CarvedBox explained(const Rectangle& r) const {
    std::vector<double> hidden(data_.missing.size(), 0.0);
    for (const Hit& h : hits_) {
      if (h.x >= r.x0 && h.x <= r.x1 && h.y >= r.y0 && h.y <= r.y1) {
        hidden[h.ray->place] += h.ray->light;
      }
    }
    double with = 0.0, square = 0.0;
    for (size_t i = 0; i < hidden.size(); ++i) {
      with += hidden[i] * data_.missing[i];
      square += hidden[i] * hidden[i];
    }
    CarvedBox box;
    if (!(with > 0.0)) return box;
    box.opacity = std::min(1.0, with / square);
    box.gain = box.opacity * (2.0 * with - box.opacity * square);
    const Vec2 from = low_ + Vec2(r.x0 * step_.x(), r.y0 * step_.y()),
               to = low_ + Vec2((r.x1 + 1) * step_.x(), (r.y1 + 1) * step_.y());
    box.centre = Vec3(0.5 * (from.x() + to.x()), 0.5 * (from.y() + to.y()), z_);
    box.size = to - from;
    return box;
  }

  const CarvingData& data_;
  double z_;
  std::vector<Hit> hits_;
  Vec2 low_ = Vec2::Constant(1e300), high_ = Vec2::Constant(-1e300), step_ = Vec2::Zero();
};

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
  // Planes are so close that the shadows of lamps a fifth of a radian apart coincide to some
  // millimetres. For many rays fewer planes are used to save time.
  constexpr size_t many_rays = 200'000;
  const int planes = data.rays.size() < many_rays ? 60 : 24;
  const double spacing = 0.9 * (lowest - highest) / planes;
  const auto by_gain = [](const CarvedBox& a, const CarvedBox& b) { return a.gain > b.gain; };
  const auto height_of = [&](int k) { return highest + (k + 0.5) * spacing; };
  std::vector<CarvedBox> found, elements;
  for (int k = 0; k < planes; ++k) {
    const CarvedPlane plane(data, height_of(k));
    if (plane.is_empty()) continue;
    found.push_back(plane.largest_patch());
    elements.push_back(plane.best_element());
  }
  constexpr size_t grown = 6, most = 4;
  std::ranges::stable_sort(elements, by_gain);
  elements.resize(std::min(grown, elements.size()));
  for (const CarvedBox& box : elements) {
    if (box.gain > 0.0) found.push_back(CarvedPlane(data, box.centre.z()).grown(box));
  }
  std::ranges::stable_sort(found, by_gain);
  std::vector<CarvedBox> apart;
  for (const CarvedBox& box : found) {
    const bool is_known = std::ranges::any_of(apart, [&](const CarvedBox& other) {
      return std::abs(box.centre.z() - other.centre.z()) < 1.5 * std::abs(spacing) &&
             (box.centre - other.centre).head<2>().norm() < 0.5 * other.size.norm();
    });
    if (is_known || box.gain < all.limits.scoring.min_scan_gain || apart.size() == most) continue;
    apart.push_back(box);
  }
  std::vector<LightStart> starts;
  for (const CarvedBox& box : apart) {
    starts.push_back({{box.opacity, box.centre.x(), box.centre.y(), box.centre.z(), box.size.x(),
                       box.size.y()}});
  }
  return starts;
}

}  // namespace photorque
