#include "attitude/estimation/conventions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "attitude/estimation/free_inertia.h"
#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/numerics/median.h"

namespace photorque {
namespace {

// Largest disagreement of the right convention. Scale errors, misalignments and biases cause less.
constexpr double agrees = 0.2;
// A gyro bias of this size is not evidence of a wrong convention.
constexpr double usual_bias_rad_s = 0.01;

// An interpretation of the four numbers of a quaternion.
struct QuaternionReading {
  bool scalar_last = false, conjugated = false;
  const char* text = "";  // empty: as the header states
};

constexpr std::array<QuaternionReading, 4> quaternion_readings = {
    {{false, false, ""},
     {false, true, "the quaternions rotate lab vectors into the body (they are conjugated)"},
     {true, false, "the quaternions have their scalar last"},
     {true, true, "the quaternions have their scalar last and are conjugated"}}};

Quat read(const Quat& q, const QuaternionReading& reading) {
  // The columns were read as w, x, y, z; with the scalar last they are x, y, z, w.
  const Quat in_order = reading.scalar_last ? Quat(q.z(), q.w(), q.x(), q.y()) : q;
  return reading.conjugated ? in_order.conjugate() : in_order;
}

struct Pair {
  Quat from, to;
  double interval_s;
  Vec3 gyro_rad_s;  // mean
};

// Median rate between successive attitudes.
double usual_rate_rad_s(const Observation& seen) {
  std::vector<double> rates;
  for (size_t i = 1; i < seen.blocks(); ++i) {
    if (seen.attitude_rows[i] == 0.0 || seen.attitude_rows[i - 1] == 0.0) continue;
    rates.push_back(turn_vector(seen.attitude[i - 1].conjugate() * seen.attitude[i]).norm() /
                    (seen.time_s[i] - seen.time_s[i - 1]));
  }
  return rates.empty() ? 0.0 : upper_median(std::move(rates));
}

// Pairs of attitudes that differ by about one second, or one radian if the body rotates faster, and
// the mean rate of the gyro between them.
std::vector<Pair> pairs_of(const Observation& seen) {
  const double interval_s = 1.0 / std::max(1.0, usual_rate_rad_s(seen));
  constexpr size_t most = 400;
  std::vector<Pair> all;
  const size_t stride = std::max<size_t>(1, seen.blocks() / most);
  for (size_t i = 0; i < seen.blocks(); i += stride) {
    if (seen.attitude_rows[i] == 0.0) continue;
    Vec3 sum = Vec3::Zero();
    double count = 0.0;
    for (size_t j = i; j < seen.blocks(); ++j) {
      if (!seen.gyro_rad_s[j].allFinite()) continue;
      sum += seen.gyro_rad_s[j];
      count += 1.0;
      const double passed_s = seen.time_s[j] - seen.time_s[i];
      if (passed_s > 3.0 * interval_s) break;
      if (passed_s < interval_s || seen.attitude_rows[j] == 0.0) continue;
      all.push_back({seen.attitude[i], seen.attitude[j], passed_s, sum / count});
      break;
    }
  }
  return all;
}

// Disagreement of gyro and attitude: the mean square difference of the rates relative to their mean
// square, averaged over the axes. Biases up to usual_bias_rad_s do not count.
double disagreement(const std::vector<Pair>& pairs, const Mat3& gyro_matrix = Mat3::Identity(),
                    const QuaternionReading& reading = {}) {
  Vec3 mean = Vec3::Zero(), square = Vec3::Zero(), energy = Vec3::Zero();
  for (const Pair& p : pairs) {
    const Vec3 rate =
        turn_vector(read(p.from, reading).conjugate() * read(p.to, reading)) / p.interval_s;
    const Vec3 off = gyro_matrix * p.gyro_rad_s - rate;
    mean += off;
    square += off.cwiseAbs2();
    energy += rate.cwiseAbs2();
  }
  const double n = static_cast<double>(pairs.size());
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double m = mean[k] / n, variance = square[k] / n - m * m;
    const double bias = std::max(0.0, std::abs(m) - usual_bias_rad_s);
    sum += (variance + bias * bias) / (energy[k] / n + 1e-5);
  }
  return sum / 3.0;
}

struct GyroReading {
  Mat3 matrix;
  int changes;  // number of changed or reversed axes, plus one for another unit
  std::string text;
};

std::vector<GyroReading> gyro_readings() {
  std::vector<GyroReading> all;
  const std::array<std::array<int, 3>, 6> orders = {
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  struct Unit {
    double to_rad_s;
    const char* text;
  };
  for (const Unit& unit : {Unit{1.0, ""}, Unit{degree_rad, "the gyro reads degrees per second"},
                           Unit{1.0 / degree_rad,
                                "the gyro reads radians per second, not the degrees of its "
                                "header"}}) {
    const int changed = unit.to_rad_s == 1.0 ? 0 : 1;
    for (const auto& order : orders) {
      for (int signs = 0; signs < 8; ++signs) {
        GyroReading r{Mat3::Zero(), changed, unit.text};
        std::string axes;
        for (int k = 0; k < 3; ++k) {
          const bool reversed = ((signs >> k) & 1) != 0;
          const int from = order[static_cast<size_t>(k)];
          r.matrix(k, from) = (reversed ? -1.0 : 1.0) * unit.to_rad_s;
          r.changes += (reversed ? 1 : 0) + (from != k ? 1 : 0);
          axes += std::string(k > 0 ? ", " : "") + (reversed ? "-" : "+") + "xyz"[from];
        }
        if (r.changes > changed) {
          r.text += std::string(changed > 0 ? " and " : "") + "the gyro's axes x, y, z are " + axes;
        }
        all.push_back(r);
      }
    }
  }
  return all;
}

// An interpretation of gyro and quaternions.
struct Interpretation {
  GyroReading gyro = {Mat3::Identity(), 0, ""};
  QuaternionReading quaternions = {};
  double disagreement = 0.0;
};

// The interpretation of least disagreement, or that of the header, whose disagreement is `as_is`.
// Among interpretations that agree equally well, the one with the fewest changes is used.
template <class Disagreement>
Interpretation best_interpretation(double as_is, std::span<const QuaternionReading> quaternions,
                                   const Disagreement& disagreement_of) {
  Interpretation best;
  best.disagreement = as_is;
  double best_cost = as_is;
  for (const QuaternionReading& reading : quaternions) {
    const int changed = reading.scalar_last || reading.conjugated ? 1 : 0;
    for (const GyroReading& gyro : gyro_readings()) {
      const double d = disagreement_of(gyro.matrix, reading);
      const double cost = d + 0.01 * (gyro.changes + changed);
      if (cost >= best_cost) continue;
      best = {gyro, reading, d};
      best_cost = cost;
    }
  }
  return best;
}

// Whether an interpretation agrees, and far better than that of the header.
bool is_right(double found, double as_is) {
  return found <= agrees && found <= 0.2 * as_is;
}

std::string read_so(const std::string& convention, const std::string& reason) {
  return "convention: " + convention + ": this convention was used, because only with it " + reason;
}

void read_gyro_as(const Mat3& matrix, Observation& seen) {
  const Mat3 from = matrix.cwiseSign().cwiseAbs();
  for (size_t i = 0; i < seen.blocks(); ++i) {
    // A missing axis remains missing and does not affect the others.
    const Vec3 read = (seen.gyro_rows[i].array() > 0.0).select(seen.gyro_rad_s[i], Vec3::Zero());
    seen.gyro_rows[i] = from * seen.gyro_rows[i];
    seen.gyro_rad_s[i] =
        (seen.gyro_rows[i].array() > 0.0).select(matrix * read, Vec3::Constant(empty_cell));
  }
}

// Rates of all three axes and their derivatives, from straight lines through seven readings.
struct Change {
  Vec3 rate_rad_s, slope_rad_s2;
};

std::vector<Change> changes_of(const Observation& seen) {
  constexpr size_t most = 600, reach = 3;
  const Observation rows = seen.averaged(most);
  std::vector<Change> all;
  for (size_t i = reach; i + reach < rows.blocks(); ++i) {
    double mean_s = 0.0, spread_s2 = 0.0;
    Vec3 mean = Vec3::Zero(), product = Vec3::Zero();
    constexpr double count = 2.0 * reach + 1.0;
    for (size_t j = i - reach; j <= i + reach; ++j) {
      mean_s += rows.time_s[j] / count;
      mean += rows.gyro_rad_s[j] / count;
    }
    for (size_t j = i - reach; j <= i + reach; ++j) {
      const double t = rows.time_s[j] - mean_s;
      spread_s2 += t * t;
      product += t * (rows.gyro_rad_s[j] - mean);
    }
    if (mean.allFinite() && product.allFinite()) all.push_back({mean, product / spread_s2});
  }
  return all;
}

// Mean square of I ω' + ω × I ω relative to that of I ω', with the rates converted by `gyro`.
double disagreement(const std::vector<Change>& changes, const Mat3& inertia_kg_m2,
                    const Mat3& gyro) {
  double off = 0.0, all = 0.0;
  for (const Change& c : changes) {
    const Vec3 rate = gyro * c.rate_rad_s, torque = inertia_kg_m2 * (gyro * c.slope_rad_s2);
    off += (torque + rate.cross(inertia_kg_m2 * rate)).squaredNorm();
    all += torque.squaredNorm();
  }
  return all > 0.0 ? off / all : 0.0;
}

// The axes of wheels with a negative estimated moment of inertia.
std::array<bool, 3> reversed_wheels(const FreeInertia& found) {
  constexpr double sigmas = 5.0;
  std::array<bool, 3> reversed{};
  for (int k = 0; k < 3; ++k) {
    reversed[static_cast<size_t>(k)] = found.wheel[k] < -sigmas * found.wheel_sigma[k];
  }
  return reversed;
}

// Reverses the speeds of these wheels. Returns a clause about the change; empty: none.
std::string turn_wheels(const std::array<bool, 3>& reversed, std::span<Observation> segments) {
  std::string names;
  for (int k = 0; k < 3; ++k) {
    if (!reversed[static_cast<size_t>(k)]) continue;
    for (Observation& seen : segments) {
      for (ZeroOrderHold& held : seen.schedule.held) {
        held.wheel.speed_rad_s[k] *= -1.0;
        held.wheel.acceleration_rad_s2[k] *= -1.0;
      }
    }
    names += std::string(names.empty() ? "" : ", ") + "wheel_" + "xyz"[k] + "_rad_s";
  }
  if (names.empty()) return "";
  return "the sign of " + names +
         " was reversed; otherwise the wheel would have a negative moment of inertia";
}

// An interpretation of the gyro, and the inertia estimated from the rates with it.
struct FreeReading {
  GyroReading gyro;
  FreeInertia inertia;

  // The cost of this interpretation: the number of changes, plus the squared deviation from the
  // stated inertia in units of a fifth of the mean moment.
  double cost(const Mat3& inertia_kg_m2) const {
    constexpr double step = 0.2;
    const Vec3 stated = 3.0 / inertia_kg_m2.trace() * inertia_kg_m2.diagonal();
    double changes = gyro.changes;
    for (const bool reversed : reversed_wheels(inertia)) changes += reversed ? 1.0 : 0.0;
    return changes + (inertia.value.head<3>() - stated).squaredNorm() / (step * step);
  }
};

// All interpretations of the gyro under which the rates are consistent with some inertia.
std::vector<FreeReading> free_readings(std::span<const Observation> segments) {
  constexpr size_t most = 600;
  std::vector<Observation> rows;
  for (const Observation& seen : segments) rows.push_back(seen.averaged(most));
  std::vector<FreeReading> all;
  for (const GyroReading& gyro : gyro_readings()) {
    std::vector<Observation> turned = rows;
    for (Observation& seen : turned) read_gyro_as(gyro.matrix, seen);
    if (const auto found = free_inertia(turned, FreeDrag::none)) all.push_back({gyro, *found});
  }
  return all;
}

// The best interpretation: that of the header, unless another has a much smaller residual.
const FreeReading* best_reading(const std::vector<FreeReading>& all, const Mat3& inertia_kg_m2) {
  // `good`: residual below which the header is accepted. `better`: ratio by which another must be
  // smaller. `alike`: ratio within which interpretations are equivalent, so that the cost decides.
  constexpr double good = 0.05, better = 1.0 / 3.0, alike = 1.2;
  const FreeReading* as_is = nullptr;
  const FreeReading* best = nullptr;
  for (const FreeReading& r : all) {
    if (r.gyro.changes == 0) as_is = &r;
    if (best == nullptr || r.inertia.left < best->inertia.left) best = &r;
  }
  if (best == nullptr) return nullptr;
  if (as_is != nullptr &&
      (as_is->inertia.left < good || best->inertia.left > better * as_is->inertia.left)) {
    return as_is;
  }
  const FreeReading* taken = best;
  for (const FreeReading& r : all) {
    if (r.inertia.left > alike * best->inertia.left) continue;
    if (r.cost(inertia_kg_m2) < taken->cost(inertia_kg_m2)) taken = &r;
  }
  return taken;
}

// Repairs the conventions with an inertia estimated from the rates, ignoring the stated one.
std::string repair_by_any_inertia(std::span<Observation> segments, const Mat3& inertia_kg_m2) {
  const std::vector<FreeReading> all = free_readings(segments);
  const FreeReading* taken = best_reading(all, inertia_kg_m2);
  if (taken == nullptr || taken->inertia.left > agrees) return "";
  const std::string wheels = turn_wheels(reversed_wheels(taken->inertia), segments);
  std::string text;
  if (taken->gyro.changes > 0) {
    for (Observation& seen : segments) read_gyro_as(taken->gyro.matrix, seen);
    text = read_so(taken->gyro.text,
                   "the rates change as any inertia makes them; a free body shows neither which "
                   "axis is reversed nor whether two are exchanged");
  }
  if (wheels.empty()) return text;
  return text + (text.empty() ? "convention: " : "; ") + wheels;
}

}  // namespace

std::string repair_free_rates(std::span<Observation> segments, const Mat3& inertia_kg_m2) {
  constexpr size_t fewest = 20;
  std::vector<Change> changes;
  for (const Observation& seen : segments) {
    if (!seen.has_gyro || seen.has_some_attitude()) return "";
    std::ranges::copy(changes_of(seen), std::back_inserter(changes));
  }
  if (changes.size() < fewest) return "";
  const double as_is = disagreement(changes, inertia_kg_m2, Mat3::Identity());
  // The stated inertia explains at least half of the change of the rates; torques may explain the
  // rest.
  if (as_is < 0.5) {
    const auto found = free_inertia({segments.begin(), segments.end()}, FreeDrag::none);
    if (!found || found->left > agrees) return "";
    const std::string wheels = turn_wheels(reversed_wheels(*found), segments);
    return wheels.empty() ? "" : "convention: " + wheels;
  }
  const Interpretation best =
      best_interpretation(as_is, std::span(quaternion_readings).first(1),
                          [&](const Mat3& gyro, const QuaternionReading&) {
                            return disagreement(changes, inertia_kg_m2, gyro);
                          });
  if (!is_right(best.disagreement, as_is)) return repair_by_any_inertia(segments, inertia_kg_m2);
  for (Observation& seen : segments) read_gyro_as(best.gyro.matrix, seen);
  return read_so(best.gyro.text,
                 "the rates change as the stated inertia makes them; a free body does not show "
                 "which axis is reversed");
}

Recording read_as(const AngleConvention& angles, Recording recording) {
  recording.angle_sequence = angles.sequence;
  for (Channel& channel : recording.channels) {
    if (channel.name != "roll_rad" && channel.name != "pitch_rad" && channel.name != "yaw_rad") {
      continue;
    }
    for (double& angle : channel.values) angle *= angles.factor;
  }
  return recording;
}

std::optional<AngleConvention> convention_of_angles(const Recording& recording,
                                                    const Platform& platform,
                                                    const std::string& name) {
  const MotionColumns motion(recording, platform, name);
  if (!motion.has_angles() || !motion.has_gyro() || !recording.angle_sequence.empty()) {
    return std::nullopt;
  }
  const auto pairs_as = [&](const AngleConvention& angles) {
    return pairs_of(
        observe(read_as(angles, recording), name, platform, std::numeric_limits<size_t>::max()));
  };
  const AngleConvention usual{std::string(angle_sequences[0])};
  const std::vector<Pair> as_usual = pairs_as(usual);
  constexpr size_t fewest = 20;
  if (as_usual.size() < fewest) return usual;
  const double as_is = disagreement(as_usual);
  if (as_is < agrees) return usual;
  double by_axes = as_is;
  for (const GyroReading& gyro : gyro_readings()) {
    by_axes = std::min(by_axes, disagreement(as_usual, gyro.matrix));
  }
  double best = as_is;
  AngleConvention found = usual;
  for (const double factor : {1.0, degree_rad, 1.0 / degree_rad}) {
    for (const std::string_view sequence : angle_sequences) {
      const AngleConvention tried{std::string(sequence), factor};
      const double d = disagreement(pairs_as(tried));
      if (!(d < best)) continue;
      best = d;
      found = tried;
    }
  }
  constexpr double better = 0.5;  // relative to other axes of the gyro
  if (!is_right(best, as_is) || best > better * by_axes) return usual;
  const std::string unit = found.factor == 1.0  ? ""
                           : found.factor < 1.0 ? " and are in degrees under a header of radians"
                                                : " and are in radians under a header of degrees";
  const std::string angles = found.sequence == usual.sequence
                                 ? "roll, pitch and yaw" + unit.substr(4)
                                 : "roll, pitch and yaw are turned in the sequence " +
                                       found.sequence + ", " + formula_of(found.sequence) +
                                       ", not " + usual.sequence + unit;
  found.text = read_so(angles, "the rates integrate to the angles");
  return found;
}

std::string repair_conventions(std::span<Observation> segments) {
  std::vector<Pair> pairs;
  for (const Observation& seen : segments) {
    if (!seen.has_gyro) return "";
    std::ranges::copy(pairs_of(seen), std::back_inserter(pairs));
  }
  if (pairs.size() < 20) return "";
  const double as_is = disagreement(pairs);
  if (as_is < agrees) return "";
  const auto [gyro, quaternions, best] = best_interpretation(
      as_is, quaternion_readings, [&](const Mat3& matrix, const QuaternionReading& reading) {
        return disagreement(pairs, matrix, reading);
      });
  if (!is_right(best, as_is)) return "";
  for (Observation& seen : segments) {
    for (Quat& attitude : seen.attitude) attitude = read(attitude, quaternions);
    read_gyro_as(gyro.matrix, seen);
  }
  const std::string of_quaternions = quaternions.text;
  const bool both = !of_quaternions.empty() && !gyro.text.empty();
  return read_so(of_quaternions + (both ? "; " : "") + gyro.text,
                 "the rates integrate to the attitude");
}

}  // namespace photorque
