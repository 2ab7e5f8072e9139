#include "tools/coupling/direction_map.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "attitude/disturbances/fields/torque_surface.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/parallel.h"
#include "core/text/format.h"
#include "receivers/gather/bodies/body_in_flow.h"
#include "receivers/wrench/spad.h"
#include "receivers/wrench/table_product.h"
#include "tools/coupling/table_cache.h"

namespace photorque {
namespace {

// The Sun; or a gas that exerts a dynamic pressure of 1 Pa.
DistantSource only_source(const Experiment& experiment) {
  if (experiment.flow) return {Vec3::UnitZ(), 1.0};
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

// First node with the same direction: azimuths coincide at a pole and after a full turn. The node
// itself if there is no earlier one.
size_t first_of_direction(const WrenchTable& table, size_t around, size_t polar) {
  constexpr double same = 1e-12;
  if (std::abs(table.polar_rad[polar]) > 0.5 * pi - same) return table.node(0, polar);
  const double turn = table.around_rad[around] - table.around_rad[0];
  return std::abs(turn - 2.0 * pi) < same ? table.node(0, polar) : table.node(around, polar);
}

// A node of the table.
struct Direction {
  size_t node, first;  // indices: of the node; of the first node with the same direction
  size_t around, polar;
  RigidTransform lab_from_body;
};

std::vector<Direction> directions_of(const WrenchTable& table, const DirectionGrid& grid,
                                     const DistantSource& source) {
  std::vector<Direction> all;
  for (size_t a = 0; a < grid.azimuth_rad.size(); ++a) {
    for (size_t e = 0; e < grid.elevation_rad.size(); ++e) {
      const Vec3 towards_body = towards_light({grid.elevation_rad[e], grid.azimuth_rad[a]});
      all.push_back({table.node(a, e), first_of_direction(table, a, e), a, e,
                     source.lab_from_body(towards_body)});
    }
  }
  return all;
}

// Whether the table covers a full, regular sphere, as format_spad() requires; otherwise that file
// is not written.
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

// The longest of these vectors; its error is the component of the error along it.
Estimate longest(const std::vector<Vec3>& vectors, const std::vector<Vec3>& errors) {
  Estimate result;
  for (size_t i = 0; i < vectors.size(); ++i) {
    const double length = vectors[i].norm();
    if (length <= result.value) continue;
    result = {length, (vectors[i] / length).cwiseProduct(errors[i]).norm()};
  }
  return result;
}

void print_summary(const Console& console, const WrenchTable& table, const DistantSource& source,
                   const std::string& title) {
  const Estimate force_N = longest(table.force_body_N, table.force_error_N);
  const Estimate torque_N_m = longest(table.torque_body_N_m, table.torque_error_N_m);
  const auto over_pressure = [&](const Estimate& e) {
    return Estimate{e.value / source.pressure_Pa, e.standard_error / source.pressure_Pa};
  };
  console.heading(title + " over " + std::to_string(table.nodes()) + " directions");
  console.line("  torques are about the origin of the body frame (of the model's file)");
  console.line("  largest force    " + show(force_N, "N") + ", divided by the pressure " +
               show(over_pressure(force_N), "m2"));
  console.line("  largest torque   " + show(torque_N_m, "N m") + ", divided by the pressure " +
               show(over_pressure(torque_N_m), "m3"));
  double worst_N_m = 0.0;
  for (const Vec3& error : table.torque_error_N_m) {
    worst_N_m = std::max(worst_N_m, error.cwiseAbs().maxCoeff());
  }
  if (worst_N_m > 0.0) {
    console.line("  largest standard error of a torque, relative to the largest torque " +
                 readable_number(worst_N_m / std::max(torque_N_m.value, 1e-300), 2));
  }
  console.line("  mean force along its direction, divided by the pressure " +
               show(mean_push_N(table) / source.pressure_Pa) + " m2");
}

// Prints by how much the torque that a propagation interpolates in the table differs from the
// torque of `light` in directions between the nodes. Only for wrenches without noise. `radius_m`:
// that of the scene.
void print_interpolation_error(const Console& console, const LightDirections& light,
                               const WrenchTable& table, const DistantSource& source,
                               double radius_m, int threads, Warnings& warnings) {
  constexpr size_t fresh = 64;
  constexpr double much = 0.05;
  const TorqueSurface surface(table);
  const std::vector<RigidTransform> attitudes = fresh_directions(fresh, source);
  std::vector<double> differences_N_m(fresh);
  parallel_for(fresh, threads, [&](size_t i) {
    const DirectionWrench own = light.at(attitudes[i]);
    const Vec3 towards_body = attitudes[i].inverse().direction(source.towards_lab);
    Vec3 difference = surface.at(azimuth_and_elevation(towards_body)).torque_body_N_m;
    for (size_t k = 0; k < 3; ++k) {
      difference[static_cast<Eigen::Index>(k)] -=
          own.direct[3 + k] + 0.5 * (own.bounced.first[3 + k] + own.bounced.second[3 + k]);
    }
    differences_N_m[i] = difference.norm();
  });
  double squares = 0.0;
  for (const double one : differences_N_m) squares += one * one / fresh;
  // A torque that is zero by symmetry counts as the largest force at a small lever arm.
  constexpr double small_arm = 1e-3;
  double largest_N_m = std::max(largest_torque_N_m(table), 1e-300);
  for (const Vec3& force_N : table.force_body_N) {
    largest_N_m = std::max(largest_N_m, small_arm * radius_m * force_N.norm());
  }
  const double rms = std::sqrt(squares) / largest_N_m;
  const std::string found =
      readable_number(rms, 2) + " of the largest torque (rms in " + std::to_string(fresh) +
      " directions), at most " +
      readable_number(*std::ranges::max_element(differences_N_m) / largest_N_m, 2);
  console.line("  error of interpolation between the nodes: " + found);
  if (rms > much) {
    warnings.add({"the directions are too far apart: interpolation errors are " + found +
                  ". Choose smaller torque_map.azimuth_step_deg and elevation_step_deg"},
                 "the table");
  }
}

// The completed directions in order, with a checkpoint at intervals.
class DoneDirections {
 public:
  DoneDirections(const OpticalRun& run, const Console& console, CheckpointFile* file)
      : console_(console), file_(file) {
    if (file_ == nullptr) return;
    identity_ =
        table_cache_version() + "torque-map, seed " + std::to_string(run.provenance().seed) + "\n";
    for (const auto& [name, hash] : run.provenance().inputs) identity_ += name + " " + hash + "\n";
    const std::optional<CheckpointFile::Kept> kept = file_->read(identity_);
    if (!kept) return;
    Snapshot snapshot(kept->state);
    keep(snapshot);
    if (!snapshot.is_whole()) {
      throw InputError(
          {file_->path().string()}, "", "a damaged checkpoint",
          "a checkpoint of this run. Use another --out, or remove the file to start again");
    }
    console_.line("goes on from " + file_->path().string() + ": " + std::to_string(all_.size()) +
                  " directions are done");
  }

  size_t count() const { return all_.size(); }
  const DirectionWrench& operator[](size_t i) const { return all_[i]; }
  void add(std::vector<DirectionWrench> more) {
    std::ranges::move(more, std::back_inserter(all_));
    if (file_ == nullptr || !file_->due()) return;
    Snapshot snapshot;
    keep(snapshot);
    try {
      file_->write(identity_, 0.0, snapshot.bytes());
    } catch (const InputError& error) {  // the disk may be full for a while
      console_.line("note: no checkpoint: " + std::string(error.what()));
    }
  }

 private:
  void keep(Snapshot& snapshot) {
    snapshot.each(all_, [&](DirectionWrench& one) { snapshot(one); });
  }

  const Console& console_;
  CheckpointFile* file_;
  std::string identity_;
  std::vector<DirectionWrench> all_;
};

// Computes the remaining directions in blocks, each direction on one thread, because a single
// direction is too short for parallel work.
void find_all(const LightDirections& light, const std::vector<Direction>& distinct,
              const Console& console, int threads, DoneDirections& done) {
  constexpr size_t block = 64;
  const auto progress = console.progress("directions");
  const WallTime wall;
  const size_t before = done.count();
  while (done.count() < distinct.size()) {
    const size_t from = done.count();
    std::vector<DirectionWrench> found(std::min(block, distinct.size() - from));
    parallel_for(found.size(), threads,
                 [&](size_t i) { found[i] = light.at(distinct[from + i].lab_from_body); });
    done.add(std::move(found));
    if (progress) {
      progress(static_cast<double>(done.count()) / static_cast<double>(distinct.size()));
    }
    const double left_s = wall.elapsed_s() * static_cast<double>(distinct.size() - done.count()) /
                          static_cast<double>(done.count() - before);
    console.note_progress("directions: " + std::to_string(done.count()) + " of " +
                          std::to_string(distinct.size()) + " done, about " +
                          show(std::ceil(left_s)) + " s to go");
  }
  console.done();
}

// Passes every node to `watch` in order, traced for display. Directions that occur again are not
// traced again.
void show_nodes(const OpticalRun& run, const std::vector<Direction>& all, size_t nodes,
                const NodeWatch& watch) {
  constexpr uint64_t enough = 1 << 16;  // rays for painting a scene
  std::map<size_t, OpticalResult> earlier;
  for (const Direction& one : all) {
    if (one.first != one.node) {
      watch({run, nodes, one.lab_from_body, earlier.at(one.first)});
      continue;
    }
    const ExperimentFile& file = run.experiment().file;
    const OpticalResult result = run.run(
        one.lab_from_body, {}, std::min(file.torque_map_rays.value_or(file.trace.rays), enough));
    watch({run, nodes, one.lab_from_body, result});
    if (one.around == 0) earlier.emplace(one.node, result);
  }
}

// Force and torque of a gas flow, at the pressure of `source`.
class FlowDirections final : public LightDirections {
 public:
  FlowDirections(const OpticalRun& run, const DistantSource& source, const Vec3& about_body_m)
      : source_(source),
        body_(run.scene(), run.experiment().flow->speed_ratio, run.experiment().flow->walls,
              about_body_m) {}

  DirectionWrench at(const RigidTransform& lab_from_body) const override {
    const BodyInFlow::Result result =
        body_.wrench(lab_from_body.inverse().direction(-source_.towards_lab));
    DirectionWrench found;
    for (size_t k = 0; k < found.direct.size(); ++k) {
      found.direct[k] = source_.pressure_Pa * result.per_pressure[static_cast<Eigen::Index>(k)];
    }
    found.rays = result.rays;
    return found;
  }

  void fill(WrenchTable& table, const std::vector<DirectionWrench>& found, bool, const Console&,
            int, std::vector<std::string>&) const override {
    for (size_t node = 0; node < table.nodes(); ++node) {
      const WrenchComponents& one = found[node].direct;
      table.force_body_N[node] = {one[0], one[1], one[2]};
      table.torque_body_N_m[node] = {one[3], one[4], one[5]};
    }
  }

 private:
  DistantSource source_;
  BodyInFlow body_;
};

}  // namespace

RigidTransform DistantSource::lab_from_body(const Vec3& towards_body) const {
  return {rotation_between(towards_body, towards_lab), Vec3::Zero()};
}

std::vector<RigidTransform> fresh_directions(size_t count, const DistantSource& sun) {
  constexpr double golden_rad = 2.39996322972865332;
  std::vector<RigidTransform> attitudes;
  for (size_t i = 0; i < count; ++i) {
    const double height = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const TableAngles angles{std::asin(height), golden_rad * (static_cast<double>(i) + 0.3)};
    attitudes.push_back(sun.lab_from_body(towards_light(angles)));
  }
  return attitudes;
}

double largest_torque_N_m(const WrenchTable& table) {
  double largest_N_m = 0.0;
  for (const Vec3& torque : table.torque_body_N_m)
    largest_N_m = std::max(largest_N_m, torque.norm());
  return largest_N_m;
}

DirectionMap map_over_directions(const Console& console, const OpticalRun& run, int threads,
                                 const NodeWatch& watch, CheckpointFile* checkpoint) {
  const DirectionGrid& grid = *run.experiment().file.light_directions;
  const DistantSource source = only_source(run.experiment());
  WrenchTable table = make_wrench_table(WrenchTable::Angles::azimuth_elevation, grid.elevation_rad,
                                        grid.azimuth_rad);
  const bool whole = covers_sphere(table);
  const WallTime wall;
  const std::vector<Direction> all = directions_of(table, grid, source);
  std::vector<Direction> distinct;
  std::vector<size_t> place(table.nodes());  // index in `distinct` per node
  for (const Direction& one : all) {
    if (one.first == one.node) distinct.push_back(one);
    place[one.node] = one.first == one.node ? distinct.size() - 1 : place[one.first];
  }
  const bool is_gas = run.experiment().flow.has_value();
  std::unique_ptr<LightDirections> light =
      is_gas ? std::make_unique<FlowDirections>(run, source, table.about_body_m)
             : sunlit_directions(run, source, table.about_body_m, threads);
  const bool is_noisy = light == nullptr;
  if (is_noisy) light = traced_directions(run, source, table.about_body_m);
  DoneDirections done(run, console, checkpoint);
  find_all(*light, distinct, console, threads, done);

  uint64_t rays = 0;
  Warnings warnings;
  for (size_t i = 0; i < distinct.size(); ++i) {
    rays += done[i].rays;
    warnings.add(done[i].warnings,
                 "azimuth " + show(stated_deg(grid.azimuth_rad[distinct[i].around])) +
                     " deg, elevation " + show(stated_deg(grid.elevation_rad[distinct[i].polar])) +
                     " deg");
  }
  std::vector<DirectionWrench> found;
  for (size_t node = 0; node < table.nodes(); ++node) found.push_back(done[place[node]]);
  std::vector<std::string> doubts;
  light->fill(table, found, whole, console, threads, doubts);
  warnings.add(doubts, "the table");
  if (watch) show_nodes(run, all, table.nodes(), watch);
  const double wall_s = wall.elapsed_s();
  print_summary(console, table, source, is_gas ? "Drag" : "Light pressure");
  if (whole && !is_noisy) {
    print_interpolation_error(console, *light, table, source, run.experiment().scene.radius_m(),
                              threads, warnings);
  }

  warnings.print(console);
  RunResult result{wrench_table_product(table, "body", is_gas ? "gas" : "light"),
                   warnings.into(run.provenance()),
                   {wall_s, rays}};
  if (whole) {
    const std::string body = run.experiment().file.path.stem().string();
    const SpadFile spad{body, scaled(table, 1.0 / source.pressure_Pa), true};
    result.files.push_back(
        {body + ".spo",
         [text = format_spad(spad, run.provenance().one_line())](
             const std::filesystem::path& path) { write_file_whole(path, text); },
         "force and torque divided by the pressure, as a SPAD file"});
  }
  return {std::move(table), std::move(result)};
}

}  // namespace photorque
