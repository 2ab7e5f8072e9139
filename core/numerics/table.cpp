#include "core/numerics/table.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/snapshot.h"

namespace photorque {

RotationPoint point_of(const Quat& q, RotationSlopes* slopes) {
  // The other half is the first one of a body turned by half a turn about x: q ⊗ (0, 1, 0, 0).
  const bool other = q.x() * q.x() + q.y() * q.y() > q.w() * q.w() + q.z() * q.z();
  const double w = other ? -q.x() : q.w(), x = other ? q.w() : q.x();
  const double y = other ? q.z() : q.y(), z = other ? -q.y() : q.z();
  const double n = w * w + z * z;
  RotationPoint point;
  point.half = other ? 1 : 0;
  point.x = 2.0 * (x * z - w * y) / n;
  point.y = 2.0 * (y * z + w * x) / n;
  point.twist_rad = 2.0 * std::atan2(z, w);
  if (slopes == nullptr) return point;
  const double two = 2.0 / n;
  const std::array<std::array<double, 4>, 3> own = {
      {{-two * (y + w * point.x), two * z, -two * w, two * (x - z * point.x)},
       {two * (x - w * point.y), two * w, two * z, two * (y - z * point.y)},
       {-two * z, 0.0, 0.0, two * w}}};
  if (!other) {
    *slopes = own;
    return point;
  }
  // (w, x, y, z) of the turned body are (−x, w, z, −y) of this one.
  for (size_t r = 0; r < 3; ++r) (*slopes)[r] = {own[r][1], -own[r][0], -own[r][3], own[r][2]};
  return point;
}

Quat rotation_at(const RotationPoint& point) {
  const Quat swing = Quat(1.0, 0.5 * point.y, -0.5 * point.x, 0.0).normalized();
  const Quat twist(std::cos(0.5 * point.twist_rad), 0.0, 0.0, std::sin(0.5 * point.twist_rad));
  const Quat half = twist * swing;
  // Undoes the half turn about x.
  return point.half == 0 ? half : half * Quat(0.0, -1.0, 0.0, 0.0);
}

double radius_at(double angle_rad) {
  return 2.0 * std::tan(0.5 * angle_rad);
}

namespace {

constexpr int side = RotationTable::side;

// Lagrange polynomials of the nodes 0, 1, … degree at one position: their values and slopes.
struct Lagrange {
  std::array<double, side> weight, slope;

  explicit Lagrange(double at) {
    for (int i = 0; i < side; ++i) {
      double value = 1.0, rate = 0.0;
      for (int k = 0; k < side; ++k) {
        if (k == i) continue;
        const double factor = 1.0 / (i - k);
        rate = (rate * (at - k) + value) * factor;
        value *= (at - k) * factor;
      }
      weight[static_cast<size_t>(i)] = value;
      slope[static_cast<size_t>(i)] = rate;
    }
  }
};

constexpr size_t max_twists = 64;
constexpr uint64_t most_repeats = 1000;  // maximum periods in a turn

// Basis functions 1, cos θ, sin θ, cos 2θ, … with θ = fold · ψ, and their derivatives with respect
// to ψ. The `count` numbers that are stored over ψ are their coefficients.
struct Harmonics {
  std::array<double, max_twists> weight, slope;

  Harmonics(double twist_rad, size_t count, int fold) {
    weight[0] = 1.0;
    slope[0] = 0.0;
    if (count == 1) return;
    const double c1 = std::cos(fold * twist_rad), s1 = std::sin(fold * twist_rad);
    double c = 1.0, s = 0.0;
    for (size_t k = 1; 2 * k <= count; ++k) {
      const double next = c * c1 - s * s1;
      s = s * c1 + c * s1;
      c = next;
      const double rate = fold * static_cast<double>(k);
      weight[2 * k - 1] = c;
      slope[2 * k - 1] = -rate * s;
      if (2 * k == count) break;
      weight[2 * k] = s;
      slope[2 * k] = rate * c;
    }
  }
};

}  // namespace

RotationTable::Place RotationTable::place(const Quat& lab_from_body, RotationSlopes* slopes) const {
  constexpr double margin = 0.05;
  const RotationPoint point = point_of(axis_from_lab_ * lab_from_body, slopes);
  const int32_t root = roots_[static_cast<size_t>(point.half)];
  const double reach = (1.0 + margin) * half_width_;
  if (root < 0 || !(std::abs(point.x) <= reach && std::abs(point.y) <= reach)) {
    throw BeyondTable();
  }
  const Box* box = &boxes_[static_cast<size_t>(root)];
  while (box->children >= 0) {
    const double middle_x = box->x + 0.5 * box->width, middle_y = box->y + 0.5 * box->width;
    const size_t quarter = (point.x >= middle_x ? 1u : 0u) + (point.y >= middle_y ? 2u : 0u);
    box = &boxes_[static_cast<size_t>(box->children) + quarter];
  }
  const double scale = degree / box->node_width;
  return {box, (point.x - box->node_x) * scale, (point.y - box->node_y) * scale, point.twist_rad};
}

void RotationTable::at(const Quat& lab_from_body, size_t first, std::span<double> values) const {
  const Place where = place(lab_from_body, nullptr);
  const Lagrange x(where.x), y(where.y);
  const Harmonics twist(where.twist_rad, twists_, fold_);
  // Sums over the nodes first. If all channels are required, all harmonics and channels are one
  // run.
  const bool all = values.size() == channels_;
  const size_t rows = all ? 1 : twists_, length = all ? twists_ * channels_ : values.size();
  constexpr size_t usual = 512;
  std::array<double, usual> here;
  std::vector<double> elsewhere(rows * length > usual ? rows * length : 0);
  double* sum = elsewhere.empty() ? here.data() : elsewhere.data();
  std::fill(sum, sum + rows * length, 0.0);
  for (size_t j = 0, node = 0; j < side; ++j) {
    for (size_t i = 0; i < side; ++i, ++node) {
      const double weight = x.weight[i] * y.weight[j];
      const double* from = values_.data() + where.box->sample[node] * twists_ * channels_ + first;
      for (size_t row = 0; row < rows; ++row, from += channels_) {
        double* to = sum + row * length;
        for (size_t k = 0; k < length; ++k) to[k] += weight * from[k];
      }
    }
  }
  std::ranges::fill(values, 0.0);
  for (size_t t = 0; t < twists_; ++t) {
    for (size_t c = 0; c < values.size(); ++c) {
      values[c] += twist.weight[t] * sum[t * values.size() + c];
    }
  }
}

RotationTable RotationTable::only(size_t first, size_t count) const {
  RotationTable part = *this;
  part.channels_ = count;
  part.values_.clear();
  for (size_t row = first; row < values_.size(); row += channels_) {
    const auto from = values_.begin() + static_cast<std::ptrdiff_t>(row);
    part.values_.insert(part.values_.end(), from, from + static_cast<std::ptrdiff_t>(count));
  }
  return part;
}

void RotationTable::at(const Quat& lab_from_body, size_t first, std::span<double> values,
                       std::span<double> slopes) const {
  RotationSlopes chart;
  const Place where = place(lab_from_body, &chart);
  const Lagrange x(where.x), y(where.y);
  const Harmonics twist(where.twist_rad, twists_, fold_);
  const double scale = degree / where.box->node_width;
  std::ranges::fill(values, 0.0);
  std::vector<double> by(3 * values.size(), 0.0);
  for (size_t j = 0, node = 0; j < side; ++j) {
    for (size_t i = 0; i < side; ++i, ++node) {
      const double* from = values_.data() + where.box->sample[node] * twists_ * channels_ + first;
      for (size_t t = 0; t < twists_; ++t, from += channels_) {
        for (size_t c = 0; c < values.size(); ++c) {
          values[c] += x.weight[i] * y.weight[j] * twist.weight[t] * from[c];
          by[3 * c] += scale * x.slope[i] * y.weight[j] * twist.weight[t] * from[c];
          by[3 * c + 1] += scale * x.weight[i] * y.slope[j] * twist.weight[t] * from[c];
          by[3 * c + 2] += x.weight[i] * y.weight[j] * twist.slope[t] * from[c];
        }
      }
    }
  }
  // The coordinates depend on axis_from_lab ⊗ q, which is linear in q.
  const Quat& a = axis_from_lab_;
  const std::array<std::array<double, 4>, 4> turned = {{{a.w(), -a.x(), -a.y(), -a.z()},
                                                        {a.x(), a.w(), -a.z(), a.y()},
                                                        {a.y(), a.z(), a.w(), -a.x()},
                                                        {a.z(), -a.y(), a.x(), a.w()}}};
  for (size_t c = 0; c < values.size(); ++c) {
    for (size_t k = 0; k < 4; ++k) {
      double sum = 0.0;
      for (size_t r = 0; r < 3; ++r) {
        double inner = 0.0;
        for (size_t m = 0; m < 4; ++m) inner += chart[r][m] * turned[m][k];
        sum += by[3 * c + r] * inner;
      }
      slopes[4 * c + k] = sum;
    }
  }
}

void RotationTable::keep(Snapshot& snapshot) {
  std::array<double, 4> axis = {axis_from_lab_.w(), axis_from_lab_.x(), axis_from_lab_.y(),
                                axis_from_lab_.z()};
  int64_t fold = fold_;
  snapshot(axis, half_width_, channels_, twists_, leaves_);
  snapshot.at_most(fold, most_repeats);
  snapshot(roots_, boxes_, values_, error_.scale, error_.rms, error_.max, error_.noise,
           error_.points);
  axis_from_lab_ = Quat(axis[0], axis[1], axis[2], axis[3]);
  fold_ = static_cast<int>(fold);
}

std::string RotationTable::bytes() const {
  Snapshot snapshot;
  RotationTable(*this).keep(snapshot);
  return snapshot.bytes();
}

bool RotationTable::read(const std::string& bytes) {
  Snapshot snapshot(bytes);
  RotationTable table;
  table.keep(snapshot);
  const size_t channels = table.channels_, twists = table.twists_;
  if (!snapshot.is_whole() || channels == 0 || twists == 0 || twists > max_twists) return false;
  if (table.fold_ < 1) return false;
  const auto boxes = static_cast<int64_t>(table.boxes_.size());
  for (const int32_t root : table.roots_) {
    if (root >= boxes) return false;
  }
  // These comparisons cannot overflow, whatever the bytes are.
  if (channels > table.values_.size()) return false;
  const size_t samples = table.values_.size() / (twists * channels);
  for (int64_t index = 0; index < boxes; ++index) {
    const Box& box = table.boxes_[static_cast<size_t>(index)];
    const int64_t children = box.children;
    // Children must follow their parents, because a search would never end in a cycle.
    if (children >= 0 && (children <= index || children + 4 > boxes)) return false;
    for (const uint32_t sample : box.sample) {
      if (sample >= samples) return false;
    }
  }
  *this = std::move(table);
  return true;
}

}  // namespace photorque
