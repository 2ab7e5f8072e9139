#include "attitude/recordings/oem.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/environment/environment.h"
#include "attitude/recordings/kvn.h"
#include "core/constants.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

constexpr double km_m = 1e3;
constexpr double beside_s = 60.0;         // permitted extrapolation at the ends of an ephemeris
constexpr double max_uncertainty = 1e-3;  // of the interpolation, relative to the distance
constexpr double same_instant_s = 1e-3;

struct State {
  double time_s;  // since the first state of the file
  Vec3 position_m, velocity_m_s;
  int line;
};

// The interpolation that a segment states.
struct Method {
  bool uses_velocity = true;
  size_t states = 4;
};

Vec3 about_z(const Vec3& v, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, Vec3::UnitZ()) * v;
}

}  // namespace

std::array<Vec3, 2> OrbitEphemeris::Piece::at(double time_s) const {
  Vec3 value = Vec3::Zero(), slope = Vec3::Zero();
  for (size_t k = coefficients.size(); k-- > 0;) {
    const double from_node_s = time_s - nodes_s[k];
    slope = slope * from_node_s + value;
    value = value * from_node_s + coefficients[k];
  }
  return {value, slope};
}

std::array<Vec3, 2> OrbitEphemeris::at(double time_s) const {
  if (!(time_s >= -beside_s && time_s <= duration_s() + beside_s)) {
    throw NumericalError(file_ + ": the orbit is known for " + shortest(duration_s()) + " s from " +
                         epoch_text(start_) + " UTC, not at " + shortest(time_s) +
                         " s; shorten the run or take a longer ephemeris");
  }
  const auto after = std::ranges::upper_bound(pieces_, time_s, {}, &Piece::from_s);
  return (after == pieces_.begin() ? *after : *(after - 1)).at(time_s);
}

struct OrbitEphemeris::Reader : MessageFile {
  OrbitEphemeris& into;
  std::optional<Epoch> first;  // of the file's states, in its time system
  std::string frame, time_system;

  // Checks that all segments have equal frames, time systems and objects.
  void read_frame(const KvnItem& meta) {
    const std::string centre = required(meta, {"CENTER_NAME"}).value;
    if (kvn_word(centre) != "EARTH") {
      throw error(meta, "CENTER_NAME", in_quotes(centre), "EARTH: orbits about the Earth");
    }
    const std::string here = required(meta, {"REF_FRAME"}).value;
    if (axes_of_frame(here) == FrameAxes::unknown) {
      throw error(meta, "REF_FRAME", in_quotes(here),
                  "EME2000, J2000, GCRF, ICRF, TOD, MOD, TEME or ITRF (with or without its year)");
    }
    const std::string system = required(meta, {"TIME_SYSTEM"}).value;
    utc({}, system, meta);
    const std::string object = required(meta, {"OBJECT_NAME"}).value;
    if (frame.empty()) frame = here, time_system = system, into.object_name_ = object;
    const auto same = [&](const char* key, const std::string& before, const std::string& now) {
      if (kvn_word(before) == kvn_word(now)) return;
      throw error(meta, key, in_quotes(now) + " after " + in_quotes(before),
                  "segments of one object, frame and time system");
    };
    same("REF_FRAME", frame, here);
    same("TIME_SYSTEM", time_system, system);
    same("OBJECT_NAME", into.object_name_, object);
  }

  Method read_method(const KvnItem& meta) const {
    const KvnItem* named = meta.find({"INTERPOLATION"});
    Method method;
    if (named == nullptr) return method;
    const std::string name = kvn_word(named->value);
    if (name != "HERMITE" && name != "LAGRANGE" && name != "LINEAR") {
      throw error(meta, "INTERPOLATION", in_quotes(named->value), "HERMITE, LAGRANGE or LINEAR");
    }
    method.uses_velocity = name == "HERMITE";
    size_t degree = 1;
    if (name != "LINEAR") {
      const double number = require_number(required(meta, {"INTERPOLATION_DEGREE"}).value,
                                           {path.string(), meta.line}, "INTERPOLATION_DEGREE");
      degree = require_count(number, {path.string(), meta.line}, "INTERPOLATION_DEGREE", 1, 15);
    }
    method.states = std::max<size_t>(2, method.uses_velocity ? (degree + 2) / 2 : degree + 1);
    return method;
  }

  State read_state(const KvnItem& item) {
    const auto [epoch_of_row, v] = row(item);
    constexpr size_t plain = 6, with_acceleration = 9;
    if (v.size() != plain && v.size() != with_acceleration) {
      throw error(item, "", std::to_string(v.size()) + " numbers",
                  "an epoch, position [km] and velocity [km/s], with or without acceleration");
    }
    const Epoch time = epoch(epoch_of_row, "epoch", item);
    if (!first) first = time;
    State state{time.seconds_since(*first), km_m * Vec3(v[0], v[1], v[2]),
                km_m * Vec3(v[3], v[4], v[5]), item.line};
    if (!(state.position_m.norm() > reference_radius_of_earth_m)) {
      throw error(item, "", "a distance of " + shortest(state.position_m.norm() / km_m) + " km",
                  "kilometres from the Earth's centre, above its surface");
    }
    if (axes_of_frame(frame) == FrameAxes::earth) {
      const double angle_rad =
          earth_rotation_angle_rad(*to_utc(*first, time_system)) + earth_rate_rad_s * state.time_s;
      const Vec3 dragged_m_s = earth_rate_rad_s * Vec3::UnitZ().cross(state.position_m);
      state.velocity_m_s = about_z(state.velocity_m_s + dragged_m_s, angle_rad);
      state.position_m = about_z(state.position_m, angle_rad);
    }
    return state;
  }

  // The polynomial through `count` states around the interval after states[i].
  static Piece piece_at(const std::vector<State>& states, size_t i, const Method& method,
                        size_t count) {
    count = std::min(count, states.size());
    const size_t before = (count - 1) / 2;
    const size_t begin = std::min(i - std::min(i, before), states.size() - count);
    Piece piece{states[i].time_s, states[i + 1].time_s, {}, {}};
    std::vector<Vec3> velocities;
    for (size_t k = begin; k < begin + count; ++k) {
      for (int twice = 0; twice < (method.uses_velocity ? 2 : 1); ++twice) {
        piece.nodes_s.push_back(states[k].time_s);
        piece.coefficients.push_back(states[k].position_m);
        velocities.push_back(states[k].velocity_m_s);
      }
    }
    // Divided differences. That of a node with itself is the velocity.
    const std::vector<double>& x = piece.nodes_s;
    for (size_t order = 1; order < x.size(); ++order) {
      for (size_t k = x.size(); k-- > order;) {
        const double apart_s = x[k] - x[k - order];
        Vec3& c = piece.coefficients[k];
        c = apart_s > 0.0 ? Vec3((c - piece.coefficients[k - 1]) / apart_s) : velocities[k];
      }
    }
    return piece;
  }

  // Compares with the polynomial of one state less, or of one more for few states.
  void check_accuracy(const std::vector<State>& states, size_t i, const Method& method,
                      const Piece& piece) const {
    const size_t other = method.states > 3 ? method.states - 1 : method.states + 1;
    const double middle_s = 0.5 * (states[i].time_s + states[i + 1].time_s);
    const Vec3 here_m = piece.at(middle_s)[0];
    const double error_m =
        (piece_at(states, i, method, other).at(middle_s)[0] - here_m).norm() / here_m.norm();
    if (error_m <= max_uncertainty) return;
    throw InputError(
        {path.string(), states[i + 1].line}, "",
        "a state " + shortest(states[i + 1].time_s - states[i].time_s) +
            " s after the one before, too far for the interpolation (it is uncertain by " +
            shortest(std::round(1e3 * error_m) / 10.0) + " % of the distance)",
        "states closer together, or another INTERPOLATION");
  }

  void add_segment(const KvnItem& meta, const std::vector<const KvnItem*>& rows) {
    read_frame(meta);
    const Method method = read_method(meta);
    std::vector<State> states;
    for (const KvnItem* row : rows) {
      const State state = read_state(*row);
      if (!states.empty() && !(state.time_s > states.back().time_s)) {
        throw error(*row, "epoch", "a time at or before that of the row before",
                    "rows in order of time");
      }
      states.push_back(state);
    }
    if (states.size() < 2) {
      throw error(meta, "", std::to_string(states.size()) + " states", "at least two states");
    }
    const auto usable_s = [&](const char* key, double otherwise_s) {
      const KvnItem* item = meta.find({key});
      return item != nullptr ? epoch(item->value, key, meta).seconds_since(*first) : otherwise_s;
    };
    const double from_s =
        std::max(states.front().time_s, usable_s("USEABLE_START_TIME", states.front().time_s));
    const double to_s =
        std::min(states.back().time_s, usable_s("USEABLE_STOP_TIME", states.back().time_s));
    if (!(to_s > from_s)) {
      throw error(meta, "USEABLE_STOP_TIME", "no usable time between the states",
                  "a stop after the start");
    }
    std::vector<Piece>& pieces = into.pieces_;
    if (!pieces.empty() && from_s > pieces.back().to_s + same_instant_s) {
      throw error(meta, "",
                  "a segment that begins " + shortest(from_s - pieces.back().to_s) +
                      " s after the end of the one before",
                  "segments without a gap");
    }
    // Where two segments overlap, the later one is used.
    while (!pieces.empty() && pieces.back().from_s >= from_s) pieces.pop_back();
    if (!pieces.empty()) pieces.back().to_s = std::min(pieces.back().to_s, from_s);
    for (size_t i = 0; i + 1 < states.size(); ++i) {
      if (states[i + 1].time_s <= from_s || states[i].time_s >= to_s) continue;
      Piece piece = piece_at(states, i, method, method.states);
      check_accuracy(states, i, method, piece);
      piece.from_s = std::max(piece.from_s, from_s);
      piece.to_s = std::min(piece.to_s, to_s);
      pieces.push_back(std::move(piece));
    }
  }

  void read() {
    required(message, {"CCSDS_OEM_VERS"});
    const KvnItem* meta = nullptr;
    std::vector<const KvnItem*> rows;
    const auto end_segment = [&] {
      if (meta != nullptr) add_segment(*meta, rows);
      rows.clear();
    };
    for (const KvnItem& item : message.items) {
      if (item.kind == KvnItem::Kind::block && item.key == "META") {
        end_segment();
        meta = &item;
      } else if (item.kind == KvnItem::Kind::block && item.key == "DATA") {
        for (const KvnItem& row : item.items) rows.push_back(&row);
      } else if (item.kind == KvnItem::Kind::data) {
        if (meta == nullptr) throw error(item, "", "a row of data", "META_START before it");
        rows.push_back(&item);
      } else if (item.kind == KvnItem::Kind::block && item.key != "COVARIANCE") {
        throw error(item, "", item.key + "_START", "META_START or COVARIANCE_START");
      }
    }
    end_segment();
    if (into.pieces_.empty()) throw error(message, "", "no segment", "META and rows of states");
    finish();
  }

  // Converts times to those since the first usable time.
  void finish() {
    const double shift_s = into.pieces_.front().from_s;
    for (Piece& piece : into.pieces_) {
      piece.from_s -= shift_s, piece.to_s -= shift_s;
      for (double& node_s : piece.nodes_s) node_s -= shift_s;
    }
    into.start_ = *to_utc(first->after(shift_s), time_system);
    into.greenwich_angle_rad_ = axes_of_frame(frame) == FrameAxes::of_date
                                    ? greenwich_sidereal_time_rad(into.start_)
                                    : earth_rotation_angle_rad(into.start_);
  }
};

OrbitEphemeris::OrbitEphemeris(const std::filesystem::path& path) : file_(path.string()) {
  Reader{MessageFile(path, "OEM"), *this, {}, {}, {}}.read();
}

}  // namespace photorque
