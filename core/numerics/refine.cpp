// Construction of a RotationTable: test of the symmetry, refinement, check.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/random.h"
#include "core/numerics/table.h"

namespace photorque {

class RotationTableBuilder {
 public:
  RotationTableBuilder(const RotationFunction& function, const RotationTableOptions& options,
                       const std::function<void(size_t, const std::string&)>& progress)
      : function_(function), options_(options), progress_(progress) {}

  RotationTable build() {
    begin();
    find_symmetry();
    if (table_.twists_ > 1) find_twists();
    make_roots();
    refine();
    check();
    return std::move(table_);
  }

 private:
  using Box = RotationTable::Box;
  static constexpr int degree = RotationTable::degree, side = RotationTable::side;
  static constexpr size_t max_twists = 64;
  // Nodes lie on a lattice of 2^20 steps across the square; a leaf of the last level still has a
  // lattice point between its nodes.
  static constexpr int32_t lattice = 1 << 20;
  static constexpr int max_level = 12;

  // An attitude on the lattice; the turn ψ is in units of 2^−20 of the period.
  struct Key {
    int half;
    int32_t x, y, turn;
    auto operator<=>(const Key&) const = default;
  };

  void begin() {
    both_halves_ = options_.max_angle_rad > 0.5 * pi;
    reach_ = radius_at(std::min(options_.max_angle_rad, 0.5 * pi));
    table_.axis_from_lab_ = options_.axis_from_lab;
    // Squares around the discs, slightly wider so that the rim of the disc is inside.
    table_.half_width_ = 1.0001 * reach_;
    table_.twists_ = 2;
  }

  double coordinate(int32_t at) const { return table_.half_width_ * (2.0 * at / lattice - 1.0); }

  Quat attitude(const Key& key) const {
    const double twist = 2.0 * pi / table_.fold_ * key.turn / lattice;
    return attitude(RotationPoint{key.half, coordinate(key.x), coordinate(key.y), twist});
  }
  Quat attitude(const RotationPoint& point) const {
    return options_.axis_from_lab.conjugate() * rotation_at(point);
  }

  std::vector<RotationSample> evaluate(std::span<const Quat> attitudes) {
    std::vector<RotationSample> samples = function_(attitudes);
    evaluated_ += attitudes.size();
    for (const RotationSample& sample : samples) note(sample);
    return samples;
  }

  void note(const RotationSample& sample) {
    const auto& groups = options_.group_of_channel;
    if (table_.channels_ == 0) {
      table_.channels_ = sample.value.size();
      const size_t count = 1 + static_cast<size_t>(*std::ranges::max_element(groups));
      RotationTableError& error = table_.error_;
      for (auto* all : {&error.scale, &error.rms, &error.max, &error.noise, &noise_squares_}) {
        all->assign(count, 0.0);
      }
      noise_counts_.assign(count, 0);
    }
    for (size_t c = 0; c < sample.value.size(); ++c) {
      if (!std::isfinite(sample.value[c])) throw NumericalError("light that is no finite number");
      const auto group = static_cast<size_t>(groups[c]);
      double& scale = table_.error_.scale[group];
      scale = std::max(scale, std::abs(sample.value[c]));
      noise_squares_[group] += sample.error[c] * sample.error[c];
      ++noise_counts_[group];
    }
  }

  // The difference of two samples relative to the allowed difference: the tolerance plus 4.5
  // standard errors of the difference. The scatter of the table's own values is that of a sample.
  double excess(std::span<const double> value, const RotationSample& truth, double fraction) const {
    double worst = 0.0;
    for (size_t c = 0; c < truth.value.size(); ++c) {
      const auto group = static_cast<size_t>(options_.group_of_channel[c]);
      const double allowed = fraction * options_.tolerance * table_.error_.scale[group] +
                             4.5 * std::sqrt(2.0) * truth.error[c];
      const double difference = std::abs(value[c] - truth.value[c]);
      if (difference > 0.0) worst = std::max(worst, difference / std::max(allowed, 1e-300));
    }
    return worst;
  }

  // Random numbers in (0, 1) for the choice of attitudes.
  double uniform(uint64_t index, uint64_t dimension) const {
    return unit_interval(hash_words(options_.seed, 0x6174746974756465ull, index, dimension));
  }

  // An attitude of the domain, uniform in p.
  RotationPoint random_point(uint64_t index) const {
    RotationPoint point;
    const double radius = reach_ * std::sqrt(uniform(index, 0));
    const double around = 2.0 * pi * uniform(index, 1);
    point.x = radius * std::cos(around);
    point.y = radius * std::sin(around);
    point.twist_rad = 2.0 * pi * uniform(index, 2);
    if (both_halves_ && uniform(index, 3) < 0.5) {
      point.half = 1;
      // The part of the other half around its pole is beyond the largest angle and is not sampled.
      const double least = radius_at(pi - options_.max_angle_rad);
      if (radius < least) point.half = 0;
    }
    return point;
  }

  static constexpr uint64_t pilots = 4;

  void find_symmetry() {
    report_progress("looking for symmetry");
    constexpr double by[] = {1.0, 2.4};  // angles without a common measure
    std::vector<Quat> attitudes;
    for (uint64_t i = 0; i < pilots; ++i) {
      RotationPoint point = random_point(i);
      attitudes.push_back(attitude(point));
      for (const double turn : by) {
        RotationPoint turned = point;
        turned.twist_rad += turn;
        attitudes.push_back(attitude(turned));
      }
    }
    const std::vector<RotationSample> samples = evaluate(attitudes);
    bool round = true;
    for (size_t i = 0; i < samples.size(); i += 3) {
      for (size_t k = 1; k < 3; ++k) {
        round = round && excess(samples[i + k].value, samples[i], 0.5) <= 1.0;
      }
    }
    if (round) {
      table_.twists_ = 1;
      return;
    }
    for (const int fold : {12, 8, 6, 5, 4, 3, 2}) {
      std::vector<Quat> turned_attitudes;
      for (uint64_t i = 0; i < pilots; ++i) {
        RotationPoint turned = random_point(i);
        turned.twist_rad += 2.0 * pi / fold;
        turned_attitudes.push_back(attitude(turned));
      }
      const std::vector<RotationSample> turned = evaluate(turned_attitudes);
      bool repeats = true;
      for (size_t i = 0; i < pilots; ++i) {
        repeats = repeats && excess(turned[i].value, samples[3 * i], 0.5) <= 1.0;
      }
      if (repeats) {
        table_.fold_ = fold;
        return;
      }
    }
  }

  std::vector<double> twist_weights(double twist_rad, size_t count) const {
    std::vector<double> weights;
    const double n = static_cast<double>(count);
    for (size_t j = 0; j < count; ++j) {
      const double angle = table_.fold_ * twist_rad - 2.0 * pi * static_cast<double>(j) / n;
      double value = 1.0;
      for (size_t k = 1; 2 * k <= count; ++k) {
        value += (2 * k == count ? 1.0 : 2.0) * std::cos(static_cast<double>(k) * angle);
      }
      weights.push_back(value / n);
    }
    return weights;
  }

  // Doubles the number of values of ψ until the pilot attitudes are interpolated within half the
  // allowed error.
  void find_twists() {
    for (size_t count = 4; count <= max_twists; count *= 2) {
      report_progress("refining over the yaw");
      bool good = true;
      for (uint64_t i = 0; i < pilots && good; ++i) {
        RotationPoint point = random_point(i);
        std::vector<Quat> attitudes = {attitude(point)};
        const double asked = point.twist_rad;
        for (size_t j = 0; j < count; ++j) {
          point.twist_rad =
              2.0 * pi / table_.fold_ * static_cast<double>(j) / static_cast<double>(count);
          attitudes.push_back(attitude(point));
        }
        const std::vector<RotationSample> samples = evaluate(attitudes);
        const std::vector<double> weights = twist_weights(asked, count);
        std::vector<double> value(table_.channels_, 0.0);
        for (size_t j = 0; j < count; ++j) {
          for (size_t c = 0; c < value.size(); ++c)
            value[c] += weights[j] * samples[j + 1].value[c];
        }
        good = excess(value, samples[0], 0.5) <= 1.0;
      }
      table_.twists_ = count;
      if (good) return;
    }
  }

  // The corner and width of a box in steps of the lattice.
  struct Cell {
    int half = 0;
    int32_t x = 0, y = 0, width = lattice;
    int level = 0;
    size_t box = 0;
  };

  Key node_key(const Cell& cell, size_t node, size_t twist) const {
    const int32_t step = cell.width / degree;
    const auto i = static_cast<int32_t>(node % side), j = static_cast<int32_t>(node / side);
    const auto turn =
        static_cast<int32_t>(twist * (lattice / max_twists) * (max_twists / table_.twists_));
    return {cell.half, cell.x + i * step, cell.y + j * step, turn};
  }

  void request_nodes(const Cell& cell, std::set<Key>& wanted) const {
    for (size_t node = 0; node < RotationTable::nodes; ++node) {
      for (size_t t = 0; t < table_.twists_; ++t) wanted.insert(node_key(cell, node, t));
    }
  }

  // Points between the nodes, on the lattice of the next level, each at one of the turns.
  std::vector<Key> test_keys(const Cell& cell) const {
    static constexpr int places[8][2] = {{1, 3}, {3, 7}, {7, 5}, {5, 1},
                                         {1, 7}, {7, 1}, {3, 1}, {5, 7}};
    const size_t count = cell.level == 0 ? 8 : 4;
    std::vector<Key> keys;
    for (size_t k = 0; k < count; ++k) {
      const int32_t step = cell.width / (2 * degree);
      Key key = node_key(cell, 0, (k * 5 + static_cast<size_t>(cell.level)) % table_.twists_);
      key.x = cell.x + places[k][0] * step;
      key.y = cell.y + places[k][1] * step;
      // Only attitudes within the largest angle.
      if (std::hypot(coordinate(key.x), coordinate(key.y)) <= reach_) keys.push_back(key);
    }
    return keys;
  }

  // Whether a cell contains an attitude within the largest angle.
  bool reaches(const Cell& cell) const {
    const auto nearest = [&](int32_t from, int32_t width) {
      return coordinate(std::clamp(lattice / 2, from, from + width));
    };
    return std::hypot(nearest(cell.x, cell.width), nearest(cell.y, cell.width)) <= reach_;
  }

  void sample(const std::set<Key>& wanted) {
    std::vector<Key> keys;
    std::vector<Quat> attitudes;
    for (const Key& key : wanted) {
      if (known_.contains(key)) continue;
      keys.push_back(key);
      attitudes.push_back(attitude(key));
    }
    const std::vector<RotationSample> samples = evaluate(attitudes);
    for (size_t i = 0; i < keys.size(); ++i) known_.emplace(keys[i], samples[i]);
  }

  // Sets the nodes of a leaf.
  void fill(const Cell& cell) {
    Box& box = table_.boxes_[cell.box];
    box.node_x = box.x;
    box.node_y = box.y;
    box.node_width = box.width;
    for (size_t node = 0; node < RotationTable::nodes; ++node) {
      const auto [at, fresh] = index_.emplace(node_key(cell, node, 0), index_.size());
      if (fresh) add_harmonics(cell, node);
      box.sample[node] = static_cast<uint32_t>(at->second);
    }
  }

  // The trigonometric polynomial through the values over ψ, as stored by RotationTable.
  // Source: A. Zygmund, Trigonometric Series, ch. X (of an even count the last term is a cosine).
  void add_harmonics(const Cell& cell, size_t node) {
    const size_t count = table_.twists_;
    for (size_t h = 0; h < count; ++h) {
      const size_t k = (h + 1) / 2;
      const double scale = h == 0 || 2 * k == count ? 1.0 : 2.0;
      std::vector<double> sum(table_.channels_, 0.0);
      for (size_t t = 0; t < count; ++t) {
        const double angle =
            2.0 * pi * static_cast<double>(k * t % count) / static_cast<double>(count);
        const double weight = scale / static_cast<double>(count) *
                              (h > 0 && h % 2 == 0 ? std::sin(angle) : std::cos(angle));
        const std::vector<double>& value = known_.at(node_key(cell, node, t)).value;
        for (size_t c = 0; c < sum.size(); ++c) sum[c] += weight * value[c];
      }
      table_.values_.insert(table_.values_.end(), sum.begin(), sum.end());
    }
  }

  void make_roots() {
    std::set<Key> wanted;
    for (int half = 0; half < (both_halves_ ? 2 : 1); ++half) {
      Cell cell{.half = half, .box = table_.boxes_.size()};
      table_.roots_[static_cast<size_t>(half)] = static_cast<int32_t>(cell.box);
      Box box;
      box.x = box.y = coordinate(0);
      box.width = 2.0 * table_.half_width_;
      table_.boxes_.push_back(box);
      leaves_.push_back(cell);
      request_nodes(cell, wanted);
    }
    report_progress("tracing light");
    sample(wanted);
    for (const Cell& cell : leaves_) fill(cell);
    pending_ = leaves_;
  }

  // Cuts a leaf into four parts, which use its polynomial until they have their own.
  std::vector<Cell> cut(const Cell& cell) {
    const auto first = static_cast<int32_t>(table_.boxes_.size());
    const Box parent = table_.boxes_[cell.box];
    table_.boxes_[cell.box].children = first;
    std::vector<Cell> parts;
    for (int q = 0; q < 4; ++q) {
      Cell part = cell;
      part.width = cell.width / 2;
      part.x += (q & 1) != 0 ? part.width : 0;
      part.y += (q & 2) != 0 ? part.width : 0;
      part.level = cell.level + 1;
      part.box = table_.boxes_.size();
      Box box = parent;
      box.children = -1;
      box.x = coordinate(part.x);
      box.y = coordinate(part.y);
      box.width = 0.5 * parent.width;
      table_.boxes_.push_back(box);
      if (reaches(part)) parts.push_back(part);
    }
    std::erase_if(leaves_, [&](const Cell& leaf) { return leaf.box == cell.box; });
    return parts;
  }

  void split(const std::vector<Cell>& cells) {
    std::set<Key> wanted;
    std::vector<Cell> parts;
    for (const Cell& cell : cells) {
      for (const Cell& part : cut(cell)) {
        request_nodes(part, wanted);
        parts.push_back(part);
      }
    }
    sample(wanted);
    for (const Cell& part : parts) fill(part);
    leaves_.insert(leaves_.end(), parts.begin(), parts.end());
    pending_ = parts;
  }

  // The interpolated values of all channels.
  std::vector<double> value_at(const Quat& attitude) const {
    std::vector<double> value(table_.channels_);
    table_.at(attitude, 0, value);
    return value;
  }

  // Refines level by level. If `max_samples` does not suffice, the worst leaves are cut first.
  void refine() {
    while (!pending_.empty()) {
      std::set<Key> wanted;
      for (const Cell& cell : pending_) {
        for (const Key& key : test_keys(cell)) wanted.insert(key);
      }
      report_progress("refining");
      sample(wanted);
      std::vector<std::pair<double, Cell>> failing;
      for (const Cell& cell : pending_) {
        double worst = 0.0;
        for (const Key& key : test_keys(cell)) {
          worst = std::max(worst, excess(value_at(attitude(key)), known_.at(key), 1.0));
        }
        if (worst > 1.0 && cell.level < max_level) failing.emplace_back(worst, cell);
      }
      split_affordable(failing);
    }
  }

  void split_affordable(std::vector<std::pair<double, Cell>>& failing) {
    std::ranges::stable_sort(failing, std::greater<>(), &std::pair<double, Cell>::first);
    // A leaf that is cut needs at most 56 nodes more.
    const size_t price = 56 * table_.twists_;
    const size_t left = options_.max_samples > evaluated_ ? options_.max_samples - evaluated_ : 0;
    if (failing.size() > left / price) failing.resize(left / price);
    std::vector<Cell> cells;
    for (const auto& [worst, cell] : failing) cells.push_back(cell);
    pending_.clear();
    if (!cells.empty()) split(cells);
  }

  const Cell& leaf_at(const RotationPoint& point) const {
    for (const Cell& leaf : leaves_) {
      if (leaf.half != point.half) continue;
      const auto holds = [&](double at, int32_t from) {
        return at >= coordinate(from) && at <= coordinate(from + leaf.width);
      };
      if (holds(point.x, leaf.x) && holds(point.y, leaf.y)) return leaf;
    }
    throw NumericalError("no leaf of the table of light over attitude");
  }

  // Measures the error at new attitudes. Leaves that fail are cut, and further attitudes are
  // tested.
  void check() {
    constexpr int rounds = 4;
    uint64_t next = 1000;
    for (int round = 0; round < rounds; ++round) {
      report_progress("checking");
      std::vector<RotationPoint> points;
      std::vector<Quat> attitudes;
      while (points.size() < options_.check_points) {
        points.push_back(random_point(next++));
        attitudes.push_back(attitude(points.back()));
      }
      const std::vector<RotationSample> truths = evaluate(attitudes);
      std::vector<std::pair<double, Cell>> failing;
      measure(attitudes, truths);
      for (size_t i = 0; i < points.size(); ++i) {
        const double worst = excess(value_at(attitudes[i]), truths[i], 1.0);
        if (!(worst > 1.0)) continue;
        const Cell& leaf = leaf_at(points[i]);
        const bool again = std::ranges::any_of(
            failing, [&](const auto& other) { return other.second.box == leaf.box; });
        if (!again && leaf.level < max_level) failing.emplace_back(worst, leaf);
      }
      if (failing.empty() || round + 1 == rounds) break;
      split_affordable(failing);
      if (pending_.empty()) break;
      refine();
    }
    table_.leaves_ = leaves_.size();
    for (size_t g = 0; g < noise_squares_.size(); ++g) {
      table_.error_.noise[g] = std::sqrt(noise_squares_[g] / static_cast<double>(noise_counts_[g]));
    }
  }

  void measure(const std::vector<Quat>& attitudes, const std::vector<RotationSample>& truths) {
    RotationTableError& error = table_.error_;
    std::vector<double> squares(error.scale.size(), 0.0);
    std::vector<size_t> counts(error.scale.size(), 0);
    std::ranges::fill(error.max, 0.0);
    for (size_t i = 0; i < attitudes.size(); ++i) {
      const std::vector<double> value = value_at(attitudes[i]);
      for (size_t c = 0; c < value.size(); ++c) {
        const auto group = static_cast<size_t>(options_.group_of_channel[c]);
        const double difference = value[c] - truths[i].value[c];
        squares[group] += difference * difference;
        ++counts[group];
        error.max[group] = std::max(error.max[group], std::abs(difference));
      }
    }
    for (size_t g = 0; g < squares.size(); ++g) {
      error.rms[g] = std::sqrt(squares[g] / static_cast<double>(counts[g]));
    }
    error.points = attitudes.size();
  }

  void report_progress(const std::string& what) const {
    if (progress_) progress_(evaluated_, what);
  }

  const RotationFunction& function_;
  const RotationTableOptions& options_;
  const std::function<void(size_t, const std::string&)>& progress_;
  RotationTable table_;
  bool both_halves_ = false;
  double reach_ = 0.0;  // largest |p|
  size_t evaluated_ = 0;
  std::map<Key, RotationSample> known_;
  std::map<Key, size_t> index_;  // place of a node's values; the turn of the key is 0
  std::vector<Cell> leaves_, pending_;
  std::vector<double> noise_squares_;
  std::vector<size_t> noise_counts_;
};

RotationTable make_rotation_table(const RotationFunction& function,
                                  const RotationTableOptions& options,
                                  const std::function<void(size_t, const std::string&)>& progress) {
  if (!(options.max_angle_rad > 0.0 && options.max_angle_rad <= pi)) {
    throw NumericalError("a table of attitudes needs a largest angle");
  }
  return RotationTableBuilder(function, options, progress).build();
}

}  // namespace photorque
