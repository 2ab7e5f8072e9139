// What the readings can tell apart.
#include <algorithm>
#include <cmath>

#include "tools/proof/light/case.h"

namespace photorque::injected {
namespace {

using Vector = std::vector<double>;
using Columns = std::vector<Vector>;

double squares(const Vector& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return sum;
}

// Steps x that make |r − Σ xₖ cₖ|² smallest, by Gauss's elimination of the normal equations with
// `damping` on their diagonal.
Vector least_squares(const Columns& c, const Vector& r, double damping) {
  const size_t n = c.size();
  std::vector<Vector> a(n, Vector(n + 1, 0.0));
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < n; ++j) {
      for (size_t k = 0; k < r.size(); ++k) a[i][j] += c[i][k] * c[j][k];
    }
    for (size_t k = 0; k < r.size(); ++k) a[i][n] += c[i][k] * r[k];
    a[i][i] = a[i][i] * (1.0 + damping) + 1e-12;
  }
  for (size_t i = 0; i < n; ++i) {
    size_t pivot = i;
    for (size_t j = i; j < n; ++j) {
      if (std::abs(a[j][i]) > std::abs(a[pivot][i])) pivot = j;
    }
    std::swap(a[i], a[pivot]);
    if (a[i][i] == 0.0) a[i][i] = 1e-12;
    for (size_t j = 0; j < n; ++j) {
      if (j == i) continue;
      const double f = a[j][i] / a[i][i];
      for (size_t k = i; k <= n; ++k) a[j][k] -= f * a[i][k];
    }
  }
  Vector x(n);
  for (size_t i = 0; i < n; ++i) x[i] = a[i][n] / a[i][i];
  return x;
}

constexpr size_t thinned(LightRows::Kind kind) {
  return kind == LightRows::Kind::scan ? 300 : kind == LightRows::Kind::sweep ? 80 : 16;
}

}  // namespace

LightJudge::LightJudge(const LightCase& c)
    : believed_(c.believed), voltage_is_set_(c.voltage_is_set()), noise_(c.noise) {
  for (const auto& recording : c.recordings) {
    if (!recording.rows.first) continue;
    const size_t all = recording.rows.size(), most = thinned(recording.rows.kind);
    std::vector<size_t> some;
    for (size_t i = 0; i < std::min(all, most); ++i) {
      some.push_back(i * all / std::min(all, most));
    }
    rows_.push_back(recording.rows.part(some));
    scale_.push_back(static_cast<double>(all) / static_cast<double>(some.size()));
    const Vector readings = injected_readings(believed_, rows_.back(), voltage_is_set_);
    errors_.push_back(reading_errors(believed_, rows_.back(), noise_, readings));
  }
}

Vector LightJudge::whitened(const LightWorld& world) const {
  Vector all;
  for (size_t r = 0; r < rows_.size(); ++r) {
    const Vector readings = injected_readings(world, rows_[r], voltage_is_set_);
    const double weight = std::sqrt(scale_[r]);
    for (size_t k = 0; k < readings.size(); ++k) {
      all.push_back(weight * readings[k] / errors_[r][k]);
    }
  }
  return all;
}

double LightJudge::gain(const std::vector<LightEffect>& effects) const {
  LightWorld world = believed_;
  for (const LightEffect& e : effects) act(e, world);
  const Vector with = whitened(world), without = whitened(believed_);
  Vector off(with.size());
  for (size_t k = 0; k < off.size(); ++k) off[k] = with[k] - without[k];
  return squares(off);
}

double LightJudge::left(const LightWorld& kept, const std::vector<const Rival*>& rivals,
                        const Vector& target) const {
  Vector x, step, low, high;
  for (const Rival* rival : rivals) {
    const RivalNumbers& n = rival->numbers;
    x.insert(x.end(), n.neutral.begin(), n.neutral.end());
    step.insert(step.end(), n.step.begin(), n.step.end());
    low.insert(low.end(), n.low.begin(), n.low.end());
    high.insert(high.end(), n.high.begin(), n.high.end());
  }
  const auto off = [&](const Vector& at) {
    LightWorld world = kept;
    size_t first = 0;
    for (const Rival* rival : rivals) {
      const size_t count = rival->numbers.neutral.size();
      rival->act(world, Vector(at.begin() + static_cast<std::ptrdiff_t>(first),
                               at.begin() + static_cast<std::ptrdiff_t>(first + count)));
      first += count;
    }
    Vector r = whitened(world);
    for (size_t k = 0; k < r.size(); ++k) r[k] = target[k] - r[k];
    return r;
  };
  Vector r = off(x);
  double best = squares(r);
  const double begin = best;
  for (int iteration = 0; iteration < 8 && !x.empty() && best > 1.0; ++iteration) {
    Columns columns;
    for (size_t k = 0; k < x.size(); ++k) {
      Vector moved = x;
      const double by = x[k] + step[k] > high[k] || x[k] + step[k] < low[k] ? -step[k] : step[k];
      moved[k] += by;
      Vector column = off(moved);
      for (size_t i = 0; i < r.size(); ++i) column[i] = (r[i] - column[i]) / by;
      columns.push_back(column);
    }
    bool better = false;
    for (double damping : {1e-9, 1e-2, 1.0, 30.0}) {
      const Vector by = least_squares(columns, r, damping);
      Vector next = x;
      for (size_t k = 0; k < x.size(); ++k) next[k] = std::clamp(x[k] + by[k], low[k], high[k]);
      const Vector trial = off(next);
      const double now = squares(trial);
      if (!(now < best)) continue;
      better = now < 0.98 * best;
      best = now, x = next, r = trial;
      break;
    }
    // Far off after the first step: no rival.
    if (!better || best > std::max(3000.0, 0.3 * begin)) break;
  }
  return best;
}

double LightJudge::left_by_all(const std::vector<Rival>& rivals, const Vector& target) const {
  const Vector without = whitened(believed_);
  Vector r(target.size());
  for (size_t k = 0; k < r.size(); ++k) r[k] = target[k] - without[k];
  Columns columns;
  for (const Rival& rival : rivals) {
    for (size_t n = 0; n < rival.numbers.neutral.size(); ++n) {
      Vector x = rival.numbers.neutral;
      if (rival.kind == "led_droop" && n == 1) continue;
      x[n] += rival.numbers.step[n];
      LightWorld world = believed_;
      rival.act(world, x);
      Vector column = whitened(world);
      for (size_t k = 0; k < column.size(); ++k) column[k] -= without[k];
      columns.push_back(column);
    }
  }
  const Vector x = least_squares(columns, r, 1e-6);
  for (size_t n = 0; n < columns.size(); ++n) {
    for (size_t k = 0; k < r.size(); ++k) r[k] -= x[n] * columns[n][k];
  }
  return squares(r);
}

double LightJudge::judge(LightCase& c, double near) const {
  const Vector target = whitened(c.truth());
  bool scans = false, circuit = false, runs = false;
  for (const LightRows& rows : rows_) {
    scans = scans || rows.kind == LightRows::Kind::scan;
    circuit = circuit || rows.kind != LightRows::Kind::scan;
    runs = runs || rows.kind == LightRows::Kind::run;
  }
  const std::vector<Rival> rivals = light_rivals(believed_, scans, circuit, runs);
  if (c.verdict == "unexplained") return left_by_all(rivals, target);
  const auto accept = [&](std::vector<std::string> names) {
    std::ranges::sort(names);
    if (std::ranges::find(c.accept, names) == c.accept.end()) c.accept.push_back(names);
  };
  std::vector<std::string> true_names;
  for (const LightEffect& e : c.effects) true_names.push_back(e.kind);
  accept(true_names);
  for (const LightEffect& e : c.effects) {
    if (e.index >= 0) c.accept_index[e.kind].push_back(e.index);
  }
  // One alone; or, of a pair, one in the place of the other.
  double alone = squares(target);
  for (const Rival& rival : rivals) {
    const double remains = left(believed_, {&rival}, target);
    alone = std::min(alone, remains);
    if (remains < near) {
      accept({rival.kind});
      if (rival.index >= 0) c.accept_index[rival.kind].push_back(rival.index);
    }
  }
  for (size_t kept = 0; c.effects.size() == 2 && kept < 2; ++kept) {
    const LightEffect& stays = c.effects[kept];
    const auto same = std::ranges::find_if(rivals, [&](const Rival& rival) {
      return rival.kind == stays.kind && rival.index == stays.index;
    });
    LightWorld with = believed_;
    act(stays, with);
    for (const Rival& rival : rivals) {
      if (rival.kind == stays.kind) continue;
      const double remains = same == rivals.end() || same->numbers.neutral.empty()
                                 ? left(with, {&rival}, target)
                                 : left(believed_, {&*same, &rival}, target);
      if (remains >= near) continue;
      accept({stays.kind, rival.kind});
      if (rival.index >= 0) c.accept_index[rival.kind].push_back(rival.index);
    }
  }
  // A box over one cell is a shade over it.
  const auto all = c.accept;
  for (auto names : all) {
    if (!scans || std::ranges::find(names, "cell_shaded") == names.end()) continue;
    std::ranges::replace(names, std::string("cell_shaded"), std::string("unmodelled_shadow"));
    accept(names);
  }
  return alone;
}

}  // namespace photorque::injected
