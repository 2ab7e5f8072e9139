#include "tools/tasks/direction_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/parallel.h"
#include "receivers/wrench/smoothing.h"
#include "receivers/wrench/spad.h"
#include "receivers/wrench/table_product.h"

namespace photorque {
namespace {

// The experiment's sun: the table is per unit of its pressure.
struct SunLight {
  Vec3 towards_lab;
  double pressure_Pa = 0.0;  // irradiance over the speed of light
};

SunLight only_sun(const Experiment& experiment) {
  const std::vector<Settings>& sources = experiment.file.sources;
  const size_t lamps = sources.size() + experiment.file.further_beams.size();
  if (lamps != 1 || sources.size() != 1 || sources[0].text("kind") != "sun") {
    throw experiment.file.settings.error(
        "torque_map",
        "directions of light with " + std::to_string(lamps) +
            (lamps == 1 ? " source that is no sun" : " sources"),
        "one [[source]] of kind \"sun\" (lamps at a place have no single direction: use tilts)");
  }
  const double irradiance_W_m2 = sources[0].number_or("irradiance_W_m2", solar_irradiance_W_m2);
  const Vec3 travel = experiment.beams[0].lab_from_emitter.rotation * Vec3::UnitZ();
  return {-travel, irradiance_W_m2 / speed_of_light_m_s};
}

// Attitude in which the Sun stands at `towards_body`. It depends on nothing else, so that the same
// direction, reached by two azimuths, is the same trace.
RigidTransform lab_from_body_with_sun(const Vec3& towards_body, const Vec3& towards_lab) {
  return {Quat::FromTwoVectors(towards_body, towards_lab), Vec3::Zero()};
}

// The earlier node with the same direction, or this one: azimuths at a pole, and a full turn.
size_t first_of_direction(const WrenchTable& table, size_t around, size_t polar) {
  constexpr double same = 1e-12;
  if (std::abs(table.polar_rad[polar]) > 0.5 * pi - same) return table.node(0, polar);
  const double turn = table.around_rad[around] - table.around_rad[0];
  return std::abs(turn - 2.0 * pi) < same ? table.node(0, polar) : table.node(around, polar);
}

// A node of the table, in their order.
struct Direction {
  size_t node, first;  // of the table; the earlier one with the same direction, or itself
  size_t around, polar;
  RigidTransform lab_from_body;
};

std::vector<Direction> directions_of(const WrenchTable& table, const DirectionGrid& grid,
                                     const SunLight& sun) {
  std::vector<Direction> all;
  for (size_t a = 0; a < grid.azimuth_rad.size(); ++a) {
    for (size_t e = 0; e < grid.elevation_rad.size(); ++e) {
      const Vec3 towards_body = towards_light({grid.elevation_rad[e], grid.azimuth_rad[a]});
      all.push_back({table.node(a, e), first_of_direction(table, a, e), a, e,
                     lab_from_body_with_sun(towards_body, sun.towards_lab)});
    }
  }
  return all;
}

// Without what only a full, regular sphere has, format_spad() refuses: then there is no such file.
bool covers_sphere(const WrenchTable& table) {
  const auto spans = [](const std::vector<double>& axis, double half) {
    return axis.size() > 1 && std::abs(axis.front() + half) < 1e-9 &&
           std::abs(axis.back() - half) < 1e-9;
  };
  const auto regular = [](const std::vector<double>& axis) {
    for (size_t i = 2; i < axis.size(); ++i) {
      if (std::abs(axis[i] - 2.0 * axis[i - 1] + axis[i - 2]) > 1e-9) return false;
    }
    return true;
  };
  return spans(table.around_rad, pi) && spans(table.polar_rad, 0.5 * pi) &&
         regular(table.around_rad) && regular(table.polar_rad);
}

void copy_node(WrenchTable& table, size_t to, size_t from) {
  for (auto* values : {&table.force_body_N, &table.torque_body_N_m, &table.force_error_N,
                       &table.torque_error_N_m}) {
    (*values)[to] = (*values)[from];
  }
}

// The longest of these vectors; its error is that of the component along it.
Estimate longest(const std::vector<Vec3>& vectors, const std::vector<Vec3>& errors) {
  Estimate result;
  for (size_t i = 0; i < vectors.size(); ++i) {
    const double length = vectors[i].norm();
    if (length <= result.value) continue;
    result = {length, (vectors[i] / length).cwiseProduct(errors[i]).norm()};
  }
  return result;
}

void print_summary(const Console& console, const WrenchTable& table, const SunLight& sun) {
  const Estimate force_N = longest(table.force_body_N, table.force_error_N);
  const Estimate torque_N_m = longest(table.torque_body_N_m, table.torque_error_N_m);
  const auto over_pressure = [&](const Estimate& e) {
    return Estimate{e.value / sun.pressure_Pa, e.standard_error / sun.pressure_Pa};
  };
  console.heading("Light pressure over " + std::to_string(table.nodes()) + " directions");
  console.line("  torques are about the origin of the body frame (of the model's file)");
  console.line("  largest force    " + show(force_N, "N") + ", over pressure " +
               show(over_pressure(force_N), "m2"));
  console.line("  largest torque   " + show(torque_N_m, "N m") + ", over pressure " +
               show(over_pressure(torque_N_m), "m3"));
  double worst_N_m = 0.0;
  for (const Vec3& error : table.torque_error_N_m) {
    worst_N_m = std::max(worst_N_m, error.cwiseAbs().maxCoeff());
  }
  console.line("  standard errors of torques are at most " +
               show(worst_N_m / std::max(torque_N_m.value, 1e-300)) + " of the largest torque");
  console.line("  mean push along the light's travel over all directions " +
               show(mean_push_N(table) / sun.pressure_Pa) + " m2");
}

// What light that has met a surface before does, about the point of the table, twice: from either
// half of the replicates.
TwofoldWrench bounced_of(const WrenchReceiver& receiver, const BinSums& sums,
                         const WrenchTable& table) {
  const int half = sums.replicates / 2;
  const auto mean = [&](int from, int to) {
    WrenchComponents all{};
    for (int r = from; r < to; ++r) {
      const auto bins = sums.of(r);
      for (size_t bin = receiver.direct_entries(); bin < receiver.bins(); ++bin) {
        all[bin % all.size()] += bins[bin] / (to - from);
      }
    }
    const Wrench there = wrench_about(
        Wrench{{all[0], all[1], all[2]}, {all[3], all[4], all[5]}, receiver.about_body_m()},
        table.about_body_m);
    const Vec3 &f = there.force_N, &t = there.torque_N_m;
    return WrenchComponents{f.x(), f.y(), f.z(), t.x(), t.y(), t.z()};
  };
  return {mean(0, half), mean(half, sums.replicates)};
}

// The bounced part of a table over the sphere, which the table does not hold yet.
class BouncedLight {
 public:
  BouncedLight(const OpticalRun& run, const SunLight& sun, size_t nodes)
      : run_(run), sun_(sun), halves_(nodes) {}

  void set(size_t node, const OpticalResult& result, const WrenchTable& table) {
    halves_[node] = bounced_of(run_.wrench(), result.sums[run_.wrench_index()], table);
  }
  void copy(size_t to, size_t from) { halves_[to] = halves_[from]; }

  // Adds it to the table: smoothed, unless neighbours are too far apart for that.
  void add_to(WrenchTable& table, const Console& console, int threads) const {
    const SmoothWrench smooth = smooth_over_sphere(table, halves_);
    double own_square = 0.0, smooth_square = 0.0;
    for (size_t k = 3; k < 6; ++k) {
      for (const TwofoldWrench& one : halves_) {
        own_square += 0.25 * std::pow(one.first[k] - one.second[k], 2);
      }
      smooth_square += std::pow(smooth.error[k], 2) * static_cast<double>(halves_.size());
    }
    const bool smoother = smooth_square < own_square;
    for (size_t node = 0; node < table.nodes(); ++node) {
      for (size_t k = 0; k < 6; ++k) {
        const TwofoldWrench& one = halves_[node];
        const double value =
            smoother ? smooth.at_node[6 * node + k] : 0.5 * (one.first[k] + one.second[k]);
        const double error =
            smoother ? smooth.error[k] : std::sqrt(own_square / 3.0 / halves_.size());
        const auto axis = static_cast<Eigen::Index>(k % 3);
        auto& values = k < 3 ? table.force_body_N : table.torque_body_N_m;
        auto& errors = k < 3 ? table.force_error_N : table.torque_error_N_m;
        values[node][axis] += value;
        errors[node][axis] = std::hypot(errors[node][axis], error);
      }
    }
    if (smoother) say(smooth, table, console, threads);
  }

 private:
  // How far the series is off in directions that it was not made from.
  void say(const SmoothWrench& smooth, const WrenchTable& table, const Console& console,
           int threads) const {
    constexpr size_t fresh = 32;
    constexpr uint64_t more = 8;  // rays, so that their own noise counts less
    const ExperimentFile& file = run_.experiment().file;
    std::vector<double> square(fresh, 0.0), noise(fresh, 0.0);
    parallel_for(fresh, threads, [&](size_t i) {
      // Evenly over the sphere, off the nodes.
      constexpr double golden_rad = 2.39996322972865332;
      const double height = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / fresh;
      const TableAngles angles{std::asin(height), golden_rad * (static_cast<double>(i) + 0.3)};
      const RigidTransform attitude =
          lab_from_body_with_sun(towards_light(angles), sun_.towards_lab);
      const OpticalResult result =
          run_.run(attitude, {}, more * file.torque_map_rays.value_or(file.trace.rays));
      const TwofoldWrench truth =
          bounced_of(run_.wrench(), result.sums[run_.wrench_index()], table);
      const Eigen::VectorXd own = smooth.series.at(angles.around_rad, angles.polar_rad);
      for (size_t k = 3; k < 6; ++k) {
        const double mean = 0.5 * (truth.first[k] + truth.second[k]);
        square[i] += std::pow(mean - own[static_cast<Eigen::Index>(k)], 2) / 3.0;
        noise[i] += 0.25 * std::pow(truth.first[k] - truth.second[k], 2) / 3.0;
      }
    });
    double squares = 0.0, noises = 0.0;
    for (size_t i = 0; i < fresh; ++i) {
      squares += square[i] / fresh;
      noises += noise[i] / fresh;
    }
    const double largest_N_m = longest(table.torque_body_N_m, table.torque_error_N_m).value;
    const double stated = std::sqrt((std::pow(smooth.error[3], 2) + std::pow(smooth.error[4], 2) +
                                     std::pow(smooth.error[5], 2)) /
                                    3.0);
    console.line("  light that bounced is smoothed by spherical harmonics up to degree " +
                 std::to_string(smooth.series.degree()) + ": torque error " +
                 show(stated / largest_N_m) + " of the largest (rms); " + std::to_string(fresh) +
                 " fresh directions differ by " + show(std::sqrt(squares) / largest_N_m) +
                 ", of which " + show(std::sqrt(noises) / largest_N_m) + " is their own noise");
  }

  const OpticalRun& run_;
  const SunLight& sun_;
  std::vector<TwofoldWrench> halves_;
};

}  // namespace

TorqueMapRun map_over_direction(const Console& console,
                                const std::shared_ptr<const OpticalRun>& shared, int threads,
                                const NodeWatch& watch) {
  const OpticalRun& run = *shared;
  const DirectionGrid& grid = *run.experiment().file.light_directions;
  const SunLight sun = only_sun(run.experiment());
  WrenchTable table = make_wrench_table(WrenchTable::Angles::azimuth_elevation, grid.elevation_rad,
                                        grid.azimuth_rad);
  const bool whole = covers_sphere(table);
  BouncedLight bounced(run, sun, table.nodes());
  uint64_t rays = 0;
  Warnings warnings;
  const WallTime wall;
  const std::vector<Direction> all = directions_of(table, grid, sun);
  // For the watch alone, which sees every node: what the same direction gave before.
  std::map<size_t, OpticalResult> earlier;
  const auto progress = console.progress("directions");
  // So many at a time, each on one thread: a trace of one direction is too short to share out.
  constexpr size_t block = 64;
  std::vector<OpticalResult> results(block);
  for (size_t from = 0; from < all.size(); from += block) {
    const size_t count = std::min(block, all.size() - from);
    parallel_for(count, threads, [&](size_t i) {
      const Direction& one = all[from + i];
      if (one.first != one.node) return;
      results[i] = run.run(one.lab_from_body, {}, run.experiment().file.torque_map_rays);
    });
    for (size_t i = 0; i < count; ++i) {
      const Direction& one = all[from + i];
      if (one.first != one.node) {
        copy_node(table, one.node, one.first);
        bounced.copy(one.node, one.first);
        if (watch) watch({run, table.nodes(), one.lab_from_body, earlier.at(one.first)});
        continue;
      }
      const OpticalResult& result = results[i];
      if (watch) {
        watch({run, table.nodes(), one.lab_from_body, result});
        if (one.around == 0) earlier.emplace(one.node, result);
      }
      const BinSums& sums = result.sums[run.wrench_index()];
      set_node(table, one.node, whole ? run.wrench().direct(sums) : run.wrench().total(sums));
      bounced.set(one.node, result, table);
      warnings.add(run.warnings(result),
                   "azimuth " + show(stated_deg(grid.azimuth_rad[one.around])) +
                       " deg, elevation " + show(stated_deg(grid.elevation_rad[one.polar])) +
                       " deg");
      rays += result.rays;
    }
    const size_t done = from + count;
    if (progress) progress(static_cast<double>(done) / static_cast<double>(all.size()));
    const double left_s = wall.elapsed_s() * static_cast<double>(all.size() - done) /
                          static_cast<double>(std::max<size_t>(done, 1));
    console.note_progress("directions: " + std::to_string(done) + " of " +
                          std::to_string(all.size()) + " traced, about " + show(std::ceil(left_s)) +
                          " s to go");
  }
  console.done();
  if (whole) bounced.add_to(table, console, threads);
  const double wall_s = wall.elapsed_s();
  print_summary(console, table, sun);

  warnings.print(console);
  RunResult result{
      wrench_table_product(table, "body"), warnings.into(run.provenance()), {wall_s, rays}};
  if (whole) {
    const std::string body = run.experiment().file.path.stem().string();
    const SpadFile spad{body, scaled(table, 1.0 / sun.pressure_Pa), true};
    result.files.push_back(
        {body + ".spo",
         [text = format_spad(spad, run.provenance().one_line())](
             const std::filesystem::path& path) { write_file_whole(path, text); },
         "force and torque over pressure in the SPAD layout"});
  }
  return {shared, std::move(table), std::move(result)};
}

}  // namespace photorque
