// LEDs of one kind on a plane, all parallel or all aimed at one point.
//
// The x and y axes of the plane are those of the lab, rotated by the shortest rotation from the
// vertical (up or down, whichever is nearer) to its normal. The LEDs are called name[0], name[1], …
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "sources/lamps/settings.h"

namespace photorque::kinds::led_array {
namespace {

constexpr int64_t max_leds = 100000;

enum class Layout : size_t { grid, ring, hexagonal, positions };

namespace key {
constexpr ChoiceKey layout("layout",
                           {{"grid", "rectangular grid of columns and rows"},
                            {"ring", "equal spacing on a circle, starting at +x"},
                            {"hexagonal", "close packed, the ring around the centre first"},
                            {"positions", "LEDs at given points"}},
                           "arrangement of the LEDs");
constexpr NumbersKey grid_count("count", {1.0, max_leds, false, false},
                                "number of LEDs [along x, along y]", {.size = 2});
constexpr NumberKey grid_pitch("pitch_m", Range::positive(),
                               "distance from one LED to the next; or [along x, along y]",
                               {.several = true});
constexpr IntegerKey count("count", 1, max_leds, "number of LEDs");
constexpr NumberKey ring_radius("ring_radius_m", Range::positive(), "radius of the circle");
constexpr NumberKey pitch("pitch_m", Range::positive(), "distance from one LED to the next");
constexpr Vec3sKey positions("positions_m", "positions of the LEDs, lab axes");
constexpr ChoiceKey aim("aim",
                        {{"parallel", "all LEDs emit along `direction`"},
                         {"converging", "all LEDs aim at one point"}},
                        0, "direction of the LEDs");
constexpr NumberKey focus(
    "focus_m", Range::positive(),
    "instead of `aim_m`: distance of the point from the centre along `direction`",
    {.optional = true});
constexpr NumberKey total_power("total_power_W", Range::positive(),
                                "radiant power of all LEDs, instead of `power_W` of each LED",
                                {.optional = true});
constexpr NumberKey power_spread("power_spread", 0.0, {0.0, 0.5},
                                 "relative standard deviation of the LEDs' powers");
constexpr NumberKey aim_spread(
    "aim_spread_deg", 0.0, {0.0, 0.5},
    "standard deviation of the LEDs' directions about each of two perpendicular axes");
constexpr IntegerKey spread_seed("spread_seed", 1, 0, INT64_MAX,
                                 "seed of the random deviations; 0: no deviations");
}  // namespace key

std::vector<Vec3> ring(int64_t count, double radius_m) {
  std::vector<Vec3> all;
  for (int64_t k = 0; k < count; ++k) {
    const double azimuth = 2.0 * pi * static_cast<double>(k) / static_cast<double>(count);
    all.emplace_back(radius_m * std::cos(azimuth), radius_m * std::sin(azimuth), 0.0);
  }
  return all;
}

// Hexagonal rings about the centre; 1, 7, 19, 37, … points fill whole hexagons. Within a ring the
// points nearest to the centre come first, so that an incomplete ring stays balanced.
std::vector<Vec3> hexagonal(int64_t count, double pitch_m) {
  struct Site {
    int ring;
    int norm;  // squared distance over squared pitch
    double azimuth;
    Vec3 at_m;
  };
  int rings = 0;
  while (1 + 3ll * rings * (rings + 1) < count) ++rings;
  std::vector<Site> sites;
  for (int q = -rings; q <= rings; ++q) {
    for (int r = std::max(-rings, -q - rings); r <= std::min(rings, rings - q); ++r) {
      const Vec3 at_m(pitch_m * (q + 0.5 * r), pitch_m * (0.5 * std::sqrt(3.0)) * r, 0.0);
      // The azimuth counts from +x; a point on +x with a rounding error stays first.
      constexpr double rounding = 1e-9;
      const double azimuth = std::atan2(at_m.y(), at_m.x());
      sites.push_back({std::max({std::abs(q), std::abs(r), std::abs(q + r)}), q * q + q * r + r * r,
                       azimuth < -rounding ? azimuth + 2.0 * pi : azimuth, at_m});
    }
  }
  std::sort(sites.begin(), sites.end(), [](const Site& a, const Site& b) {
    return std::tie(a.ring, a.norm, a.azimuth) < std::tie(b.ring, b.norm, b.azimuth);
  });
  std::vector<Vec3> all;
  for (int64_t k = 0; k < count; ++k) all.push_back(sites[static_cast<size_t>(k)].at_m);
  return all;
}

std::vector<Vec3> read_grid(const Settings& settings) {
  const std::vector<double> count = settings.get(key::grid_count);
  const bool whole =
      std::all_of(count.begin(), count.end(), [](double n) { return n == std::floor(n); });
  if (count.size() != 2 || !whole || count[0] * count[1] > max_leds) {
    throw settings.error(
        key::grid_count, describe(settings.raw(key::grid_count)),
        "two whole numbers [columns, rows], at most " + std::to_string(max_leds) + " LEDs");
  }
  Vec2 pitch_m;
  if (settings.raw(key::grid_pitch).is_array()) {
    const std::vector<double> both_m = settings.numbers(key::grid_pitch, Range::positive());
    if (both_m.size() != 2) {
      throw settings.error(key::grid_pitch, describe(settings.raw(key::grid_pitch)),
                           "one or two numbers > 0");
    }
    pitch_m = {both_m[0], both_m[1]};
  } else {
    pitch_m.setConstant(settings.get(key::grid_pitch));
  }
  std::vector<Vec3> all;
  for (int iy = 0; iy < count[1]; ++iy) {
    for (int ix = 0; ix < count[0]; ++ix) {
      all.emplace_back((ix - 0.5 * (count[0] - 1)) * pitch_m.x(),
                       (iy - 0.5 * (count[1] - 1)) * pitch_m.y(), 0.0);
    }
  }
  return all;
}

// Positions of the LEDs in the array's frame (its plane is z = 0), for every layout except
// `positions`.
std::vector<Vec3> read_layout(const Settings& settings, Layout layout) {
  if (layout == Layout::grid) return read_grid(settings);
  const int64_t count = settings.get(key::count);
  if (layout == Layout::ring) {
    return ring(count, settings.get(key::ring_radius));
  }
  return hexagonal(count, settings.get(key::pitch));
}

struct Placement {
  std::vector<Vec3> positions_m;  // lab frame
  std::vector<Vec3> directions;   // lab frame
};

Placement read_placement(const Settings& settings) {
  const auto layout = static_cast<Layout>(settings.get(key::layout));
  const bool converging = settings.get(key::aim) == 1;

  Placement placement;
  Vec3 centre_m;
  if (layout == Layout::positions) {
    placement.positions_m = settings.get(key::positions);
    centre_m = std::accumulate(placement.positions_m.begin(), placement.positions_m.end(),
                               Vec3(Vec3::Zero())) /
               static_cast<double>(placement.positions_m.size());
  } else {
    centre_m = settings.get(source_key::position);
  }

  // A converging array may have both a direction of its plane and a point at which its LEDs are
  // aimed.
  std::optional<Vec3> aim_m;
  if (converging) {
    // Checked here, because Settings would take the key `aim` for an `aim_m` without its unit.
    if (settings.has(source_key::aim) == settings.has(key::focus)) {
      throw settings.error(source_key::aim,
                           settings.has(source_key::aim) ? "focus_m too" : "nothing",
                           "a point to converge on, or focus_m");
    }
    aim_m = settings.has(source_key::aim)
                ? settings.get(source_key::aim)
                : Vec3(centre_m +
                       settings.get(key::focus) * read_direction_vector(settings).normalized());
  }
  const Vec3 normal = converging && settings.has(source_key::direction)
                          ? read_direction_vector(settings)
                          : read_direction(settings, centre_m);
  if (layout != Layout::positions) {
    // For a panel that looks straight down it is the half turn about x. Near there the axes follow
    // the direction continuously, as they do near straight up: a slightly tilted panel does not
    // rotate about its normal.
    const RigidTransform lab_from_array =
        normal.z() < 0.0 ? lamp_frame(normal, centre_m) : frame_looking_along(normal, centre_m);
    // LEDs are numbered as seen in the lab: rows by rising y, rings counter-clockwise, also if the
    // array looks down. This is possible because every layout equals its mirror image.
    const double up = lab_from_array.direction(Vec3::UnitY()).y() < 0.0 ? -1.0 : 1.0;
    for (const Vec3& at_m : read_layout(settings, layout)) {
      placement.positions_m.push_back(lab_from_array.point({at_m.x(), up * at_m.y(), at_m.z()}));
    }
  }
  for (const Vec3& at_m : placement.positions_m) {
    placement.directions.push_back(aim_m ? direction_to(settings, source_key::aim, at_m, *aim_m)
                                         : normal);
  }
  return placement;
}

double read_power_of_each(const Settings& settings, size_t count) {
  const bool total = settings.has(key::total_power);
  if (total && settings.has(source_key::power)) {
    throw settings.error(key::total_power, "also power_W", "only one of the two");
  }
  if (!total) return settings.get(source_key::power);
  return settings.get(key::total_power) / static_cast<double>(count);
}

// Random deviations of the LEDs of one panel from their stated values. The normal deviates
// (Box–Muller) depend only on seed and index of the LED: panels of different layouts consist of the
// same LEDs.
class Spread {
 public:
  explicit Spread(const Settings& settings)
      : power_(settings.get(key::power_spread)),
        aim_rad_(settings.get(key::aim_spread)),
        seed_(static_cast<uint64_t>(settings.get(key::spread_seed))) {}

  void apply(size_t led, Beam& beam) const {
    if (seed_ == 0) return;
    if (power_ > 0.0) {
      constexpr double least = 0.01;  // an LED always emits
      const double factor = std::max(least, 1.0 + power_ * normal(led, 0));
      beam.emitter = std::make_shared<ScaledEmitter>(beam.emitter, factor);
      if (beam.aperture) beam.aperture->exitance_W_m2 *= factor;
    }
    if (aim_rad_ > 0.0) {
      const Vec3 turn_rad(aim_rad_ * normal(led, 1), aim_rad_ * normal(led, 2), 0.0);
      beam.lab_from_emitter.rotation = beam.lab_from_emitter.rotation * turn_by(turn_rad);
    }
  }

 private:
  double normal(size_t led, uint64_t which) const {
    const double u = unit_interval(hash_words(seed_, led, which, 0));
    const double v = unit_interval(hash_words(seed_, led, which, 1));
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * pi * v);
  }

  double power_, aim_rad_;
  uint64_t seed_;
};

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.get(source_key::name.with_default("led_array"));
  const Placement placement = read_placement(settings);
  const double power_W = read_power_of_each(settings, placement.positions_m.size());
  const Lamp lamp = read_lamp(settings, context, name, power_W);
  const Spread spread(settings);
  std::vector<Beam> beams;
  for (size_t i = 0; i < placement.positions_m.size(); ++i) {
    beams.push_back({name + "[" + std::to_string(i) + "]", lamp.emitter,
                     frame_looking_along(placement.directions[i], placement.positions_m[i]),
                     lamp.spectrum, lamp.aperture});
    spread.apply(i, beams.back());
  }
  return beams;
}

std::vector<Key> led_array_keys() {
  using namespace key;
  const Key centre = source_key::position.meaning("centre of the panel, lab axes");
  return joined(
      {{source_key::name.with_default("led_array"),
        layout.bringing({{grid_count, grid_pitch, centre},
                         {count, ring_radius, centre},
                         {count, pitch, centre},
                         {positions}}),
        source_key::direction.meaning("normal of the panel, lab axes, any length; or `aim_m`"),
        aim.bringing({{}, {focus}}),
        source_key::aim.meaning("point at which the LEDs, or the panel, are aimed"),
        source_key::power.usually("from `total_power_W`"), total_power, power_spread, aim_spread,
        spread_seed},
       lamp_keys()});
}

}  // namespace

SourceKind kind() {
  return {"led_array", "Equal LEDs in a grid, ring, hexagon or at given points", make,
          led_array_keys()};
}

}  // namespace photorque::kinds::led_array
