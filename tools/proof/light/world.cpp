#include "tools/proof/light/world.h"

#include <algorithm>
#include <map>

#include "core/constants.h"

namespace photorque::injected {
namespace {

// A place on a unit disc and its share of the area.
struct DiscPlace {
  double x, y, share;
};

std::vector<DiscPlace> disc_rule(const std::vector<std::pair<double, double>>& rings, int around) {
  std::vector<DiscPlace> places;
  for (size_t k = 0; k < rings.size(); ++k) {
    const double r = std::sqrt(rings[k].first);
    for (int i = 0; i < around; ++i) {
      const double angle =
          2.0 * pi * (i + 0.5 * static_cast<double>(k % 2)) / static_cast<double>(around);
      places.push_back({r * std::cos(angle), r * std::sin(angle), rings[k].second / around});
    }
  }
  return places;
}

// Gauss's rule of two for the squared radius: exact for polynomials up to the fifth power.
const std::vector<DiscPlace>& smooth_rule() {
  static const auto rule =
      disc_rule({{0.5 - 0.5 * 0.5773502691896257, 0.5}, {0.5 + 0.5 * 0.5773502691896257, 0.5}}, 6);
  return rule;
}

// Many equal shares, for apertures that are hidden in part.
const std::vector<DiscPlace>& fine_rule() {
  static const auto rule = [] {
    constexpr int count = 16;
    std::vector<std::pair<double, double>> rings;
    for (int i = 0; i < count; ++i) rings.emplace_back((i + 0.5) / count, 1.0 / count);
    return disc_rule(rings, 48);
  }();
  return rule;
}

bool crosses_wall(const InjectedWall& w, const Triple& a, const Triple& b) {
  const double from = a[w.axis] - w.at_m, to = b[w.axis] - w.at_m;
  if ((from > 0.0) == (to > 0.0)) return false;
  const double t = from / (from - to);
  const size_t other = 1 - w.axis;
  const double along = a[other] + t * (b[other] - a[other]), up = a[2] + t * (b[2] - a[2]);
  return along > w.from_m && along < w.to_m && up > w.bottom_m && up < w.top_m;
}

bool crosses_box(const InjectedBox& box, const Triple& a, const Triple& b) {
  double enter = 0.0, leave = 1.0;
  for (size_t k = 0; k < 3; ++k) {
    const double d = b[k] - a[k];
    if (d == 0.0) {
      if (a[k] < box.low_m[k] || a[k] > box.high_m[k]) return false;
      continue;
    }
    const double t1 = (box.low_m[k] - a[k]) / d, t2 = (box.high_m[k] - a[k]) / d;
    enter = std::max(enter, std::min(t1, t2));
    leave = std::min(leave, std::max(t1, t2));
  }
  return enter < leave;
}

// Everything in body axes at one attitude.
struct Placed {
  const InjectedLight* world;
  Quaternion lab_from_body;
  struct Lamp {
    const InjectedLamp* lamp;
    Triple centre, axis, e1, e2;
    double on_axis;
  };
  std::vector<Lamp> lamps;
};

Triple to_lab(const Quaternion& q, const Triple& v) {
  return to_body(conjugate(q), v);
}

bool is_hidden(const Placed& at, const Triple& source, const Triple& point,
               const InjectedWall* but) {
  for (const InjectedWall& wall : at.world->walls) {
    if (&wall != but && crosses_wall(wall, source, point)) return true;
  }
  for (const InjectedBox& box : at.world->boxes) {
    const bool hidden = box.on_body ? crosses_box(box, source, point)
                                    : crosses_box(box, to_lab(at.lab_from_body, source),
                                                  to_lab(at.lab_from_body, point));
    if (hidden) return true;
  }
  return false;
}

// Whether the aperture may be hidden in part: what hides comes near the cone to it.
bool may_be_hidden(const Placed& at, const Placed::Lamp& lamp, const Triple& point) {
  const double margin = lamp.lamp->radius_m;
  for (const InjectedWall& wall : at.world->walls) {
    InjectedWall wider = wall;
    wider.from_m -= margin, wider.to_m += margin;
    wider.bottom_m -= margin, wider.top_m += margin;
    for (const double side : {-margin, 0.0, margin}) {
      wider.at_m = wall.at_m + side;
      if (crosses_wall(wider, lamp.centre, point)) return true;
    }
  }
  for (InjectedBox box : at.world->boxes) {
    for (size_t k = 0; k < 3; ++k) box.low_m[k] -= margin, box.high_m[k] += margin;
    if (box.on_body ? crosses_box(box, lamp.centre, point)
                    : crosses_box(box, to_lab(at.lab_from_body, lamp.centre),
                                  to_lab(at.lab_from_body, point))) {
      return true;
    }
  }
  return false;
}

// Fresnel's transmission of unpolarised light over that at normal incidence.
double through_glass(double index, double cosine) {
  const double sine2 = std::max(0.0, 1.0 - cosine * cosine) / (index * index);
  const double inside = std::sqrt(1.0 - sine2);
  const double s = (cosine - index * inside) / (cosine + index * inside);
  const double p = (inside - index * cosine) / (inside + index * cosine);
  const double straight = (index - 1.0) / (index + 1.0);
  return (1.0 - 0.5 * (s * s + p * p)) / (1.0 - straight * straight);
}

// From one lamp onto a point with a normal.
double from_lamp(const Placed& at, const Placed::Lamp& lamp, const Triple& point,
                 const Triple& normal, const InjectedWall* but, bool glass) {
  const bool hidden = may_be_hidden(at, lamp, point);
  double sum = 0.0;
  for (const DiscPlace& place : hidden ? fine_rule() : smooth_rule()) {
    const Triple source =
        plus(lamp.centre,
             times(lamp.lamp->radius_m, plus(times(place.x, lamp.e1), times(place.y, lamp.e2))));
    const Triple to = minus(point, source);
    const double r = length(to), straight = dot(to, lamp.axis) / r, meets = -dot(to, normal) / r;
    if (straight <= 0.0 || meets <= 0.0) continue;
    if (hidden && is_hidden(at, source, point, but)) continue;
    double light = lamp.lamp->fall(std::acos(std::min(1.0, straight))) * meets / (r * r);
    if (glass) light *= through_glass(*at.world->glass_index, meets);
    sum += place.share * light;
  }
  return sum * lamp.on_axis;
}

// Per watt of one lamp. Those of the lamps that did not change are looked up: of a world that was
// tried before most did not.
const std::vector<double>& light_of(const Placed& at, const Placed::Lamp& lamp,
                                    const std::vector<std::array<double, 2>>& points, bool glass) {
  InjectedLight::Known& known = *at.world->known;
  constexpr size_t most = 3000;
  std::vector<double> key(at.lab_from_body.begin(), at.lab_from_body.end());
  const auto add = [&key](const auto& numbers) {
    key.insert(key.end(), numbers.begin(), numbers.end());
  };
  add(lamp.lamp->position_m);
  add(lamp.lamp->axis);
  add(std::array{lamp.lamp->radius_m, lamp.lamp->fwhm_rad, lamp.lamp->order, lamp.lamp->exponent,
                 static_cast<double>(lamp.lamp->profile), glass ? *at.world->glass_index : 0.0,
                 at.world->plate.z_m, static_cast<double>(points.size())});
  add(points.front());
  add(points.back());
  add(points[points.size() / 2]);
  for (const InjectedWall& w : at.world->walls) {
    add(std::array{static_cast<double>(w.axis), w.at_m, w.from_m, w.to_m, w.bottom_m, w.top_m});
  }
  for (const InjectedBox& b : at.world->boxes) {
    key.push_back(b.on_body ? 1.0 : 0.0);
    add(b.low_m);
    add(b.high_m);
  }
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  if (known.size() >= most) known.clear();
  std::vector<double> light;
  for (const auto& [u, v] : points) {
    light.push_back(from_lamp(at, lamp, {u, v, at.world->plate.z_m}, {0, 0, 1}, nullptr, glass));
  }
  return known[key] = std::move(light);
}

Placed::Lamp placed_lamp(const InjectedLamp& lamp, const Quaternion& q, double on_axis) {
  Placed::Lamp at{&lamp, to_body(q, lamp.position_m), to_body(q, lamp.axis), {}, {}, on_axis};
  const Triple any = std::abs(at.axis[0]) < 0.7 ? Triple{1, 0, 0} : Triple{0, 1, 0};
  at.e1 = cross(at.axis, any);
  at.e1 = times(1.0 / length(at.e1), at.e1);
  at.e2 = cross(at.axis, at.e1);
  return at;
}

// Light that a wall throws back by Lambert's law, once.
std::vector<double> thrown_back(const Placed& at, const InjectedWall& wall,
                                const std::vector<std::array<double, 2>>& points) {
  constexpr int across = 150, upward = 60;
  std::vector<double> light(points.size(), 0.0);
  Triple normal = {};
  normal[wall.axis] = wall.facing;
  const double width = (wall.to_m - wall.from_m) / across;
  for (int j = 0; j < upward; ++j) {
    // Narrow strips near the bottom, where the plate is near.
    const auto height = [&](double t) {
      return wall.bottom_m + (wall.top_m - wall.bottom_m) * t * t;
    };
    const double low = height(j / double(upward)), high = height((j + 1) / double(upward));
    for (int i = 0; i < across; ++i) {
      Triple patch = {};
      patch[wall.axis] = wall.at_m;
      patch[1 - wall.axis] = wall.from_m + (i + 0.5) * width;
      patch[2] = 0.5 * (low + high);
      double arrives = 0.0;
      for (const auto& lamp : at.lamps) {
        arrives += lamp.lamp->power_W * from_lamp(at, lamp, patch, normal, &wall, false);
      }
      const double leaves = wall.diffuse * arrives / pi * width * (high - low);
      if (leaves == 0.0) continue;
      for (size_t k = 0; k < points.size(); ++k) {
        const Triple to = {points[k][0] - patch[0], points[k][1] - patch[1],
                           at.world->plate.z_m - patch[2]};
        const double r2 = dot(to, to), out = dot(to, normal), in = -to[2];
        if (out > 0.0 && in > 0.0) light[k] += leaves * out * in / (r2 * r2);
      }
    }
  }
  return light;
}

// As from a mirror: straight from where the lamps seem to be, through the wall's rectangle.
double mirrored(const Placed& at, const InjectedWall& wall, const Triple& point) {
  double sum = 0.0;
  const auto turned = [&](Triple v, double about) {
    v[wall.axis] = 2.0 * about - v[wall.axis];
    return v;
  };
  for (const auto& lamp : at.lamps) {
    if ((lamp.centre[wall.axis] - wall.at_m) * wall.facing <= 0.0) continue;
    for (const DiscPlace& place : fine_rule()) {
      const Triple real =
          plus(lamp.centre,
               times(lamp.lamp->radius_m, plus(times(place.x, lamp.e1), times(place.y, lamp.e2))));
      const Triple source = turned(real, wall.at_m), axis = turned(lamp.axis, 0.0);
      if (!crosses_wall(wall, source, point)) continue;
      const Triple to = minus(point, source);
      const double r = length(to), straight = dot(to, axis) / r, meets = -to[2] / r;
      if (straight <= 0.0 || meets <= 0.0) continue;
      sum += place.share * lamp.lamp->power_W * lamp.on_axis *
             lamp.lamp->fall(std::acos(std::min(1.0, straight))) * meets / (r * r);
    }
  }
  return wall.specular * sum;
}

}  // namespace

double InjectedLamp::fall(double angle_rad) const {
  if (profile == Profile::cosine_power) return std::pow(std::cos(angle_rad), exponent);
  const double x = 2.0 * angle_rad / fwhm_rad;
  return std::exp2(-(profile == Profile::gaussian ? x * x : std::pow(x, order)));
}

double InjectedLamp::on_axis_per_sr() const {
  constexpr int steps = 20000;
  double sum = 0.0;
  const double step = 0.5 * pi / steps;
  for (int i = 0; i < steps; ++i) {
    const double angle = (i + 0.5) * step;
    sum += fall(angle) * std::sin(angle) * step;
  }
  return 1.0 / (2.0 * pi * sum);
}

namespace {

// Every lamp in body axes.
Placed all_placed(const InjectedLight& world, const Quaternion& attitude) {
  const Quaternion q =
      product(quaternion_of({world.bias_rad[0], world.bias_rad[1], 0.0}), attitude);
  Placed at{&world, q, {}};
  double on_axis = 0.0;
  for (size_t l = 0; l < world.lamps.size(); ++l) {
    const InjectedLamp& lamp = world.lamps[l];
    const bool again = l > 0 && lamp.fwhm_rad == world.lamps[l - 1].fwhm_rad &&
                       lamp.exponent == world.lamps[l - 1].exponent &&
                       lamp.profile == world.lamps[l - 1].profile &&
                       lamp.order == world.lamps[l - 1].order;
    if (!again) on_axis = lamp.on_axis_per_sr();
    at.lamps.push_back(placed_lamp(lamp, q, on_axis));
  }
  return at;
}

}  // namespace

std::vector<bool> may_be_shaded(const InjectedLight& world, const Quaternion& attitude,
                                const std::vector<std::array<double, 2>>& points_m) {
  const Placed at = all_placed(world, attitude);
  std::vector<bool> shaded;
  for (const auto& [u, v] : points_m) {
    shaded.push_back(std::ranges::any_of(at.lamps, [&, u = u, v = v](const Placed::Lamp& lamp) {
      return may_be_hidden(at, lamp, {u, v, world.plate.z_m});
    }));
  }
  return shaded;
}

std::vector<double> injected_light(const InjectedLight& world, const Quaternion& attitude,
                                   const std::vector<std::array<double, 2>>& points_m,
                                   bool into_cells) {
  const Placed at = all_placed(world, attitude);
  std::vector<double> light(points_m.size(), world.ambient_W_m2);
  const bool glass = into_cells && world.glass_index.has_value();
  for (const auto& lamp : at.lamps) {
    if (lamp.lamp->power_W == 0.0) continue;
    const std::vector<double>& one = light_of(at, lamp, points_m, glass);
    for (size_t k = 0; k < light.size(); ++k) light[k] += lamp.lamp->power_W * one[k];
  }
  for (const InjectedWall& wall : world.walls) {
    if (!(wall.specular > 0.0)) continue;
    for (size_t k = 0; k < points_m.size(); ++k) {
      light[k] += mirrored(at, wall, {points_m[k][0], points_m[k][1], world.plate.z_m});
    }
  }
  for (const InjectedWall& wall : world.walls) {
    if (wall.diffuse == 0.0) continue;
    const std::vector<double> more = thrown_back(at, wall, points_m);
    for (size_t k = 0; k < light.size(); ++k) light[k] += more[k];
  }
  return light;
}

}  // namespace photorque::injected
