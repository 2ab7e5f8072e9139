#include "diagnosis/light/trials/scan.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace photorque {
namespace {

// All combinations of the starts that a kind names for what it does not fit linearly.
std::vector<std::vector<double>> grid_of_starts(const LightCandidate& c) {
  std::vector<std::vector<double>> all = {c.start()};
  for (size_t k = 0; k < c.numbers.size(); ++k) {
    const std::vector<double>& starts = c.kind.parameters[c.numbers[k].parameter].starts;
    if (starts.empty()) continue;
    std::vector<std::vector<double>> more;
    for (const std::vector<double>& x : all) {
      for (const double s : starts) {
        more.push_back(x);
        more.back()[k] = s;
      }
    }
    all = std::move(more);
  }
  return all;
}

// What is left of a recording, with what it takes to see how a law on the light would lower it.
struct Left {
  const LightRun* run;
  std::vector<double> signals;
  Eigen::VectorXd residuals;
  SignalSlopes slopes;
};

std::vector<Left> left_of(const LightTrial& parent, const LightCandidates& all,
                          const std::vector<FittedRun>& runs) {
  std::vector<Left> left;
  const LightState state = state_of(parent, all);
  for (const FittedRun& run : runs) {
    Left l{run.run.get(), {}, residuals_of(parent, all, run), {}};
    l.signals = run.run->signals(state, run.run->fields(state, run.nominal.get()));
    run.run->residuals(state, l.signals, &l.slopes);
    left.push_back(std::move(l));
  }
  return left;
}

// The fall of χ² if a law's strengths were free, nothing else moving.
double gain_alone(const LightCandidate& c, const std::vector<double>& start,
                  const std::vector<Left>& left) {
  std::vector<size_t> strengths;
  for (size_t k = 0; k < c.numbers.size(); ++k) {
    if (c.numbers[k].is_strength) strengths.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(strengths.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
  for (const Left& l : left) {
    Eigen::MatrixXd J(l.residuals.size(), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      std::vector<double> x = start;
      for (const size_t s : strengths) x[s] = 0.0;
      x[strengths[static_cast<size_t>(k)]] = 1.0;
      LightState alone(0, 0, 0, 0);
      c.kind.act(alone, 0, x);
      std::vector<double> change(l.signals.size());
      for (size_t i = 0; i < change.size(); ++i) {
        change[i] = l.signals[i] * (alone.light_laws.front()(l.run->circumstances()[i]) - 1.0);
      }
      J.col(k) = -l.run->moved(l.slopes, change);
    }
    H += J.transpose() * J;
    g += J.transpose() * l.residuals;
  }
  H.diagonal().array() *= 1.0 + 1e-9;
  const double gain = g.dot(H.ldlt().solve(g));
  return std::isfinite(gain) ? gain : 0.0;
}

std::vector<LightStart> best_of_grid(const LightCandidate& c, const std::vector<Left>& left,
                                     const Thresholds::Scoring& limits) {
  constexpr size_t few = 12, most = 3;
  const std::vector<std::vector<double>> grid = grid_of_starts(c);
  std::vector<LightStart> result;
  if (grid.size() <= few || !c.is_empirical() || c.kind.in_circuit) {
    for (const std::vector<double>& x : grid) result.push_back({x});
    return result;
  }
  std::vector<double> gain;
  for (const std::vector<double>& x : grid) gain.push_back(gain_alone(c, x, left));
  std::vector<size_t> order(grid.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, [&](size_t a, size_t b) { return gain[a] > gain[b]; });
  for (const size_t i : order) {
    if (result.size() == most || gain[i] < limits.min_scan_gain) break;
    result.push_back({grid[i]});
  }
  return result;
}

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

std::vector<std::vector<LightStart>> scanned_starts(const LightTrial& parent,
                                                    const LightCandidates& all,
                                                    const std::vector<size_t>& candidates,
                                                    const std::vector<FittedRun>& runs,
                                                    int threads) {
  std::vector<std::vector<LightStart>> result(candidates.size());
  const std::vector<Left> left = left_of(parent, all, runs);
  parallel_for(candidates.size(), threads, [&](size_t i) {
    const LightCandidate& c = all[candidates[i]];
    switch (c.kind.scan) {
      case LightEffectKind::Scan::shadow_in_lab:
        result[i] = shadow_starts(parent, all, runs, false);
        break;
      case LightEffectKind::Scan::shadow_on_body:
        result[i] = shadow_starts(parent, all, runs, true);
        break;
      case LightEffectKind::Scan::trapped:
        result[i] = {{trapped_interval(parent, all, runs)}};
        break;
      case LightEffectKind::Scan::none:
        result[i] = best_of_grid(c, left, all.limits.scoring);
        break;
    }
  });
  return result;
}

std::vector<double> trapped_interval(const LightTrial& parent, const LightCandidates& all,
                                     const std::vector<FittedRun>& runs) {
  // The span of the largest sum of gains (J. Bentley, Communications of the ACM 27, 865 (1984)).
  const LightState state = [&] {
    LightState s = state_of(parent, all);
    s.trapped.clear();
    return s;
  }();
  double best = 0.0;
  std::vector<double> interval = {0.0, -1.0, 0.0};
  for (const FittedRun& run : runs) {
    const LightRecording& r = run.run->recording();
    if (r.kind != LightRecording::Kind::run) continue;
    const std::vector<double> signals =
        run.run->signals(state, run.run->fields(state, run.nominal.get()));
    const std::vector<double> gain = run.run->gain_if_trapped(state, signals);
    double sum = 0.0;
    size_t from = 0;
    for (size_t i = 0; i < gain.size(); ++i) {
      if (sum <= 0.0) {
        sum = 0.0;
        from = i;
      }
      sum += gain[i];
      if (sum > best && gain[i] > 0.0) {
        best = sum;
        interval = {r.time_s[from], r.time_s[i], static_cast<double>(run.run->number())};
      }
    }
  }
  return interval;
}

std::vector<std::vector<double>> in_order_of_place(const LightRun& run,
                                                   const Eigen::VectorXd& residuals) {
  std::vector<std::vector<double>> ordered(run.channels().size());
  if (run.recording().kind != LightRecording::Kind::scan) {
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {
      const auto k = static_cast<size_t>(i);
      ordered[static_cast<size_t>(run.sample_channel()[k])].push_back(residuals[i]);
    }
    return ordered;
  }
  const LightRecording& r = run.recording();
  const SurfaceGrid& g = run.lab().grid();
  const double area = (g.u_high - g.u_low) * (g.v_high - g.v_low);
  // Per attitude a block holds some twenty places.
  size_t attitudes = 1;
  for (size_t i = 1; i < r.rows(); ++i) {
    if (r.lab_from_body[i].coeffs() != r.lab_from_body[i - 1].coeffs()) ++attitudes;
  }
  constexpr double places_of_a_block = 20.0;
  const double side = std::sqrt(places_of_a_block * area * static_cast<double>(attitudes) /
                                static_cast<double>(r.rows()));
  struct Place {
    size_t attitude;
    int block_v, block_u;
    size_t row;
    auto key() const { return std::tuple(attitude, block_v, block_u, row); }
  };
  std::vector<Place> places;
  size_t attitude = 0;
  for (size_t i = 0; i < r.rows(); ++i) {
    if (i > 0 && r.lab_from_body[i].coeffs() != r.lab_from_body[i - 1].coeffs()) ++attitude;
    places.push_back({attitude, static_cast<int>(std::floor((r.v_m[i] - g.v_low) / side)),
                      static_cast<int>(std::floor((r.u_m[i] - g.u_low) / side)), i});
  }
  std::ranges::sort(places, [](const Place& a, const Place& b) { return a.key() < b.key(); });
  for (const Place& p : places) {
    ordered[0].push_back(residuals[static_cast<Eigen::Index>(p.row)]);
  }
  return ordered;
}

}  // namespace photorque
