#include "tools/runs/optical_run.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "images/writers/image_file.h"
#include "receivers/gather/bodies/wrench.h"
#include "receivers/kind.h"
#include "scenes/effects/stated.h"
#include "sources/profiles/beam_shape.h"
#include "tools/runs/memory.h"

namespace photorque {
namespace {

// Adds notices for maps on surfaces in several layers, whose light is added in the same bins.
void add_notices_of_layers(Experiment& experiment) {
  constexpr double noticeable = 1e-3;
  for (const NamedReceiver& receiver : experiment.receivers) {
    if (!receiver.flux_map) continue;
    const SurfaceGrid& grid = receiver.flux_map->grid();
    if (!(grid.overlapping_m2 > noticeable * grid.total_area_m2())) continue;
    experiment.notices.push_back(
        receiver.name + ": " + readable_number(grid.overlapping_m2, 3) + " of " +
        readable_number(grid.total_area_m2(), 3) +
        " m² lie above each other, seen along its normal; such bins hold the light of all layers "
        "over the area of all: give a layer of interest a separate node (part)");
  }
}

Experiment read(const RunOptions& options) {
  ExperimentFile file =
      read_experiment_text(options.experiment, options.experiment_text(), options.all_overrides());
  for (const FurtherLamp& lamp : options.lamps) {
    file.further_beams.push_back(lamp.beam);
    file.inputs.emplace_back("lamp " + lamp.beam.name, lamp.hash);
  }
  Experiment experiment = resolve_experiment(std::move(file), [](const std::string& bytes) {
    LinearPicture picture = read_picture(bytes);
    return BaseColours{picture.width, picture.height, std::move(picture.rgb)};
  });
  for (std::string& notice : apply_stated_effects(experiment)) {
    experiment.notices.push_back(std::move(notice));
  }
  add_notices_of_layers(experiment);
  return experiment;
}

// Index of the first wrench receiver that contains every instance; adds one if there is none.
size_t whole_wrench(Experiment& experiment) {
  std::vector<uint32_t> all(experiment.scene.instances.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<uint32_t>(i);
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    const auto& wrench = experiment.receivers[i].wrench;
    if (wrench && wrench->part_names().size() == all.size()) return i;
  }
  // Two receivers named "body" would overwrite each other's files. This is reported before the
  // trace.
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    const NamedReceiver& other = experiment.receivers[i];
    if (other.wrench && other.name == "body") {
      throw experiment.file.receivers[i].error(
          "name", "a wrench of a part called \"body\", as the one of the whole is", "another name");
    }
  }
  const auto wrench = std::make_shared<const WrenchReceiver>("body", experiment.scene, all);
  experiment.receivers.push_back({{.receiver = wrench, .wrench = wrench}, "body", "wrench"});
  return experiment.receivers.size() - 1;
}

// Largest difference, in standard errors, between force and torque summed over surfaces and those
// computed from the rays alone.
double momentum_disagreement(const OpticalRun& run, const OpticalResult& result) {
  const PowerBalance& power_balance = result.power_balance;
  const int replicates = result.sums[run.wrench_index()].replicates;
  const WrenchEstimate surfaces = run.wrench_of(result);
  const double counting_N = counting_error_W(result, replicates) / speed_of_light_m_s;
  double worst = 0.0;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<size_t>(k);
    const auto compare = [&](const Estimate& rays, double value, double error, double arm) {
      const double sigma = std::hypot(rays.standard_error, error, counting_N * arm);
      const double rounding = 1e-7 * arm * result.sent_W / speed_of_light_m_s;
      worst = std::max(worst, std::abs(rays.value - value) / (sigma + rounding));
    };
    compare(power_balance.force_N[i], surfaces.mean.force_N[k], surfaces.force_error_N()[k], 1.0);
    compare(power_balance.torque_N_m[i], surfaces.mean.torque_N_m[k],
            surfaces.torque_error_N_m()[k], run.experiment().scene.radius_m());
  }
  return worst;
}

// Checks before the trace that the maps fit into memory.
Experiment checked(Experiment experiment, const RunOptions& options) {
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  uint64_t bytes = 0;
  for (const NamedReceiver& named : experiment.receivers) {
    bytes +=
        named.receiver->bins() * trace_bytes_per_bin(experiment.file.trace.replicates, threads);
  }
  require_memory(options.max_memory_GB, bytes, {options.experiment.string()}, "receiver");
  return experiment;
}

}  // namespace

OpticalRun::OpticalRun(const RunOptions& options, const Console& console)
    : experiment_(checked(read(options), options)),
      scene_(experiment_.scene),
      threads_(options.threads) {
  wrench_ = whole_wrench(experiment_);
  const auto inside = std::make_shared<const InsideLightReceiver>(experiment_.scene);
  if (inside->bins() > 0) {
    inside_light_ = inside;
    inside_index_ = add_receiver({{inside}, "inside", "inside_light"});
  }
  provenance_ = build_provenance();
  provenance_.seed = experiment_.file.trace.seed;
  provenance_.inputs = experiment_.inputs;
  for (const std::string& notice : experiment_.notices) console.line("note: " + notice);
  for (const std::string& warning : experiment_.warnings) console.line("WARNING: " + warning);
  const Console details = console.details();
  details.line("Sources");
  for (const std::string& text : beam_shape_lines(experiment_.beams)) details.line("  " + text);
}

size_t OpticalRun::add_receiver(NamedReceiver receiver) {
  experiment_.receivers.push_back(std::move(receiver));
  return experiment_.receivers.size() - 1;
}

void OpticalRun::keep_beams(const std::function<bool(const Beam&)>& wanted) {
  std::erase_if(experiment_.beams, [&](const Beam& beam) { return !wanted(beam); });
  const std::lock_guard lock(*bodies_mutex_);
  bodies_.reset();
}

// Created on first use.
std::shared_ptr<const WrenchGather> OpticalRun::bodies() const {
  const std::lock_guard lock(*bodies_mutex_);
  if (!bodies_) bodies_ = WrenchGather::make(scene_, experiment_.beams);
  return *bodies_;
}

OpticalResult OpticalRun::run(const RigidTransform& lab_from_body,
                              const std::function<void(double)>& progress,
                              std::optional<uint64_t> rays) const {
  if (experiment_.flow) {
    throw experiment_.file.settings.error("source", "a gas flow in its place",
                                          "at least one [[source]]; torque-map alone has gas");
  }
  const WallTime wall;
  const TraceEffort& effort = experiment_.file.effort;
  TraceOptions options = experiment_.file.trace;
  options.rays = rays.value_or(options.rays);
  // A Sobol sequence has at most 2^31 points (see trace()).
  const uint64_t max_rays =
      std::min<uint64_t>(1ull << 38, static_cast<uint64_t>(options.replicates) << 31);
  options.threads = threads_;
  options.progress = progress;
  const auto receivers = experiment_.receiver_pointers();
  for (;; options.rays *= 2) {
    const double before_s = wall.elapsed_s();
    OpticalResult result{trace(scene_, lab_from_body, experiment_.beams, receivers, options), {}};
    result.direct =
        gather_into(experiment_, scene_, bodies().get(), lab_from_body, options, result);
    result.worst_bin_error = worst_bin_error(experiment_, result);
    result.wall_s = wall.elapsed_s();
    const double next_s = 2.0 * (result.wall_s - before_s);
    const bool reached = !effort.target_error || result.worst_bin_error <= *effort.target_error;
    const bool late = effort.max_time_s && result.wall_s + next_s > *effort.max_time_s;
    if (reached || late || 2 * options.rays > max_rays) return result;
  }
}

namespace {

// Number of standard errors, from this number of replicates, that is exceeded by chance as rarely
// as 4 standard deviations of a normal variable (once in 16,000). By Student's distribution it is
// 5.5 for 16 replicates. Source: M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions"
// (1964), 26.7.5.
double notice_level_sigma(int replicates) {
  constexpr double z = 4.0, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  const double n = replicates - 1;
  return z + (z3 + z) / (4.0 * n) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n) +
         (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n * n * n);
}

}  // namespace

std::vector<std::string> OpticalRun::warnings(const OpticalResult& result) const {
  // Likely causes and remedies.
  constexpr const char* rarely_met =
      ": few rays contribute most of it; increase trace.rays until the difference decreases";
  constexpr const char* by_edges =
      ": parts too small for the rays, or light through gaps; raise trace.rays, or compare with "
      "trace.direct = \"rays\"";
  constexpr double lost = 1e-9;
  const double loud_sigma = notice_level_sigma(experiment_.file.trace.replicates);
  std::vector<std::string> lines = experiment_.warnings;
  const PowerBalance& power_balance = result.power_balance;
  if (power_balance.closure > lost) {
    lines.push_back("the power balance is off by " + show(power_balance.closure) +
                    " of what is emitted");
  }
  const double momentum = momentum_disagreement(*this, result);
  if (momentum > loud_sigma) {
    lines.push_back("force or torque summed over surfaces and from the rays differ by " +
                    show(momentum) + " standard errors" + rarely_met);
  }
  for (const DirectLight& direct : result.direct.gathered) {
    const double difference = std::abs(direct.difference_sigma);
    if (difference <= loud_sigma) continue;
    lines.push_back("direct light on " + direct.name + ": gathered " +
                    show(direct.gathered_W, "W") + " and by rays " + show(direct.rays_W, "W") +
                    " differ by " + show(difference) + " standard errors" + by_edges);
  }
  const auto warn_of = [&](const std::string& what, const std::vector<DirectTorque>& checks) {
    for (const DirectTorque& direct : checks) {
      if (direct.worst_sigma <= loud_sigma) continue;
      lines.push_back(what + " of direct light on " + direct.name +
                      ": quadrature and rays differ by " + show(direct.worst_sigma) +
                      " standard errors" + by_edges);
    }
  };
  warn_of("torque", result.direct.torques);
  warn_of("force or torque", result.direct.wrenches);
  return lines;
}

Provenance OpticalRun::provenance(const OpticalResult& result) const {
  Provenance stamped = provenance_;
  stamped.warnings = warnings(result);
  return stamped;
}

std::optional<size_t> OpticalRun::first_flux_map() const {
  const auto& receivers = experiment_.receivers;
  const auto found = std::ranges::find_if(
      receivers, [](const NamedReceiver& receiver) { return receiver.flux_map != nullptr; });
  if (found == receivers.end()) return std::nullopt;
  return static_cast<size_t>(found - receivers.begin());
}

size_t OpticalRun::flux_map_index(const std::string& name, const std::string& key) const {
  std::set<std::string> known;
  for (size_t i = 0; i < experiment_.receivers.size(); ++i) {
    const NamedReceiver& receiver = experiment_.receivers[i];
    if (!receiver.flux_map) continue;
    if (name.empty() || receiver.name == receiver_name(name)) return i;
    known.insert(receiver.name);
  }
  throw InputError({experiment_.file.path.string()}, key,
                   name.empty() ? "no receiver of kind \"flux_map\"" : "\"" + name + "\"",
                   known.empty() ? "a [[receiver]] of kind \"flux_map\""
                                 : "one of " + listed_names(known, name));
}

const WrenchReceiver& OpticalRun::wrench() const {
  return *experiment_.receivers[wrench_].wrench;
}

WrenchEstimate OpticalRun::wrench_of(const TraceResult& result) const {
  return wrench_about(wrench().total(result.sums[wrench_]), Vec3::Zero());
}

const FluxMapReceiver& OpticalRun::flux_map(size_t index) const {
  return *experiment_.receivers[index].flux_map;
}

std::string OpticalRun::inside_light(const TraceResult& result) const {
  if (!inside_light_) return "";
  return describe_inside_light(
      experiment_.scene, inside_light_->lit_inside(result.sums[inside_index_]), result.sent_W);
}

Product OpticalRun::product(const OpticalResult& result) const {
  const PowerBalance& power_balance = result.power_balance;
  Product product;
  product.quantities = {
      {"emitted_W", {power_balance.emitted_W, 0.0}},
      {"absorbed_W", power_balance.absorbed_W},
      {"escaped_W", power_balance.escaped_W},
      {"truncated_W", power_balance.truncated_W},
      {"ledger_closure", {power_balance.closure, 0.0}},
      {"momentum_disagreement_sigma", {momentum_disagreement(*this, result), 0.0}},
  };
  for (const DirectLight& direct : result.direct.gathered) {
    product.quantities.push_back({"direct_on_" + direct.name + "_W", direct.gathered_W});
    product.quantities.push_back({"direct_by_rays_on_" + direct.name + "_W", direct.rays_W});
  }
  Table parts = Table::of("absorbed_by_part", "Power absorbed by each part");
  for (size_t i = 0; i < power_balance.absorbed_by_instance_W.size(); ++i) {
    const Estimate& absorbed_W = power_balance.absorbed_by_instance_W[i];
    parts.row()
        .set("part", experiment_.scene.instances[i].path)
        .set("absorbed_W", absorbed_W.value)
        .set("standard_error_W", absorbed_W.standard_error);
  }
  product.tables = {beam_shape_table(experiment_.beams), std::move(parts)};
  for (size_t i = 0; i < experiment_.receivers.size(); ++i) {
    append(product, experiment_.receivers[i].receiver->product(result.sums[i]));
  }
  return product;
}

void Warnings::add(const std::vector<std::string>& warnings, const std::string& where) {
  constexpr size_t in_full = 3;
  for (const std::string& warning : warnings) {
    if (first_.size() < in_full) first_.push_back(where + ": " + warning);
    ++count_;
  }
}

std::vector<std::string> Warnings::lines() const {
  std::vector<std::string> all = first_;
  if (count_ > all.size()) all.push_back(std::to_string(count_ - all.size()) + " more of the kind");
  return all;
}

void Warnings::print(const Console& console) const {
  for (const std::string& line : lines()) console.line("WARNING: " + line);
}

Provenance Warnings::into(Provenance provenance) const {
  provenance.warnings = lines();
  return provenance;
}

namespace {

// Whether all light misses the scene. A perfect mirror absorbs nothing either, but light exerts a
// force on it.
bool misses_everything(const PowerBalance& balance) {
  return balance.absorbed_W.value == 0.0 && balance.truncated_W.value == 0.0 &&
         std::ranges::all_of(balance.force_N, [](const Estimate& f) { return f.value == 0.0; });
}

void print_direct_checks(const Console& console, const OpticalResult& result) {
  for (const DirectLight& direct : result.direct.gathered) {
    console.line("  direct light on " + direct.name + ": quadrature and rays differ by " +
                 show_brief(std::abs(direct.difference_sigma)) + " standard errors in all, " +
                 show_brief(std::sqrt(direct.mean_square)) + " (rms) in a bin");
  }
  const auto print = [&](const std::string& what, const std::vector<DirectTorque>& checks) {
    for (const DirectTorque& direct : checks) {
      console.line("  " + what + " of direct light on " + direct.name +
                   ": quadrature and rays differ by at most " + show_brief(direct.worst_sigma) +
                   " standard errors");
    }
  };
  print("torque", result.direct.torques);
  print("force and torque", result.direct.wrenches);
  console.line("  largest standard error of a bin above a tenth of the peak: " +
               show_brief(100.0 * result.worst_bin_error) + " %");
  console.line("  " + std::to_string(result.rays) + " rays, " + std::to_string(result.segments) +
               " segments in " + show_brief(result.wall_s) + " s (" +
               show_brief(static_cast<double>(result.segments) / result.wall_s / 1e6) +
               " million segments/s)");
}

// Whether a receiver whose direct light is traced by rays received none.
bool is_unmet(const std::string& name, const Estimate& power_W, const OpticalResult& result) {
  return power_W.value == 0.0 &&
         std::ranges::none_of(result.direct.gathered,
                              [&](const DirectLight& direct) { return direct.name == name; });
}

}  // namespace

void print_trace(const Console& console, const OpticalRun& run, const OpticalResult& result) {
  const PowerBalance& power_balance = result.power_balance;
  const auto row = [&](const std::string& name, const Estimate& power) {
    console.line("  " + padded(name, 24) + show(power, "W") + "  (" +
                 show_percent(power.value / power_balance.emitted_W) + ")");
  };
  console.heading("Power");
  row("emitted", {power_balance.emitted_W, 0.0});
  row("absorbed", power_balance.absorbed_W);
  row("escaped", power_balance.escaped_W);
  const bool loses = power_balance.truncated_W.value > 1e-9 * power_balance.emitted_W;
  if (loses) row("truncated", power_balance.truncated_W);
  if (misses_everything(power_balance)) {
    console.line(
        "  note: no light reaches the scene: check the position and direction of the sources");
  }
  for (size_t i = 0; i < run.experiment().receivers.size(); ++i) {
    const NamedReceiver& receiver = run.experiment().receivers[i];
    if (!receiver.flux_map) continue;
    const FluxMap map = receiver.flux_map->flux_map(result.sums[i]);
    row("on " + receiver.name, map.incident.power_W);
    if (is_unmet(receiver.name, map.incident.power_W, result)) {
      // The rule of three: with 95 % probability, less than 3/n of the light goes where none of n
      // rays went.
      console.line("  note: no ray met it: at most about " +
                   show_brief(3.0 * result.sent_W / static_cast<double>(result.rays)) + " W");
    }
    if (map.incident.power_W.value > (1.0 + 1e-6) * power_balance.emitted_W) {
      console.line("  note: more than is emitted: reflected light returns to it");
    }
  }
  const WrenchEstimate body = run.wrench_of(result);
  console.heading("Radiation pressure (body frame, about the centre of rotation)");
  for (int k = 0; k < 3; ++k) {
    console.line(std::string("  force ") + "xyz"[k] + "   " +
                 show(Estimate{body.mean.force_N[k], body.force_error_N()[k]}, "N"));
  }
  for (int k = 0; k < 3; ++k) {
    console.line(std::string("  torque ") + "xyz"[k] + "  " +
                 show(Estimate{body.mean.torque_N_m[k], body.torque_error_N_m()[k]}, "N m"));
  }
  const Console details = console.details();
  details.heading("Checks");
  details.line("  power: emitted = absorbed + escaped + truncated to " +
               show_brief(power_balance.closure));
  details.line("  momentum: surfaces and rays differ by at most " +
               show_brief(momentum_disagreement(run, result)) + " standard errors");
  print_direct_checks(details, result);
  const std::string inside = run.inside_light(result);
  if (!inside.empty()) console.line("note: " + inside);
  for (const std::string& notice : result.direct.notices) console.line("note: " + notice);
  for (const std::string& warning : run.warnings(result)) console.line("WARNING: " + warning);
}

void append(Product& product, Product more) {
  const auto move_all = [](auto& to, auto& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move_all(product.quantities, more.quantities);
  move_all(product.maps, more.maps);
  move_all(product.tables, more.tables);
  move_all(product.plots, more.plots);
}

}  // namespace photorque
