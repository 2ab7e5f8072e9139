#include "tools/coupling/couple.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "attitude/propagation/recorded.h"
#include "attitude/propagation/time_history.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/provenance.h"
#include "core/snapshot.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "tools/coupling/report.h"

namespace photorque {

namespace {

constexpr const char* checkpoint_format = "photorque checkpoint 1";
constexpr uint64_t largest_checkpoint_bytes = 1ull << 36;

// The text up to the next line end; moves `at` behind it.
std::string next_line(const std::string& text, size_t& at) {
  const size_t end = text.find('\n', at);
  if (end == std::string::npos) return {};
  std::string line = text.substr(at, end - at);
  at = end + 1;
  return line;
}

std::string hash_of_run(const std::string& identity, const std::string& tilt) {
  return content_hash(identity + tilt);
}

}  // namespace

CheckpointFile::CheckpointFile(std::filesystem::path path, double every_s)
    : path_(std::move(path)),
      every_(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
          std::chrono::duration<double>(every_s))) {
  wait();
}

void CheckpointFile::wait() {
  next_ = std::chrono::steady_clock::now() + every_;
}

std::optional<CheckpointFile::Kept> CheckpointFile::read(const std::string& identity) {
  std::error_code none;
  if (!std::filesystem::exists(path_, none)) return {};
  std::string all = read_file(path_, largest_checkpoint_bytes);
  const auto refuse = [&](const char* found) {
    throw InputError(
        {path_.string()}, "", found,
        "a checkpoint of this run. Use another --out, or remove the file to start again");
  };
  size_t at = 0;
  if (next_line(all, at) != checkpoint_format) refuse("another file");
  const std::string tilt = next_line(all, at);
  const std::optional<double> tilt_rad = number_in(tilt);
  if (next_line(all, at) != hash_of_run(identity, tilt)) {
    refuse("a checkpoint of another program, experiment, seed or input file");
  }
  const std::string hash = next_line(all, at);
  all.erase(0, at);
  if (!tilt_rad || content_hash(all) != hash) refuse("a damaged checkpoint");
  return Kept{*tilt_rad, std::move(all)};
}

void CheckpointFile::write(const std::string& identity, double table_tilt_rad,
                           const std::string& state) {
  const std::string tilt = shortest(table_tilt_rad);
  const std::string head = std::string(checkpoint_format) + "\n" + tilt + "\n" +
                           hash_of_run(identity, tilt) + "\n" + content_hash(state) + "\n";
  // Restarts the interval first, so that a failed write is not repeated immediately.
  wait();
  write_file_whole(path_, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    for (const std::string* part : {&head, &state}) {
      out.write(part->data(), static_cast<std::streamsize>(part->size()));
    }
    out.close();
    if (!out) throw InputError({path_.string()}, "", "a write that failed", "space and permission");
  });
  wait();
}

void require_light_once(const ExperimentFile& file) {
  const bool has_array = !file.others("array").empty();
  for (const Settings& disturbance : file.others("disturbance")) {
    const std::string kind = disturbance.text_or("kind", "");
    if (kind == "radiation_pressure") {
      throw disturbance.error(
          "kind", "\"radiation_pressure\" beside a scene with sources",
          "one of them: the traced light also exerts pressure ([light] mode = \"off\" "
          "leaves the scene out)");
    }
    if (kind == "power_balance" && has_array) {
      throw disturbance.error("kind", "\"power_balance\" beside [array]",
                              "one of them: [array.day] states load and battery of the array "
                              "([light] mode = \"off\" leaves the array out)");
    }
  }
}

namespace {

Battery battery_of(const ExperimentFile& file, const DaySettings& day, const Platform& platform) {
  Battery battery = day.battery;
  if (!platform.battery_capacity_C) return battery;
  const double own_J = *platform.battery_capacity_C * platform.battery_voltage_V;
  const Settings array = file.others("array")[0];
  const Settings table = array.table("day");
  if (table.has("battery_J") && std::abs(battery.capacity_J - own_J) > 0.01 * own_J) {
    throw table.error(
        "battery_Wh", std::to_string(battery.capacity_J / 3600.0) + " Wh",
        std::to_string(own_J / 3600.0) +
            " Wh as [platform] says (battery_capacity_Ah times battery_voltage_V), or none");
  }
  battery.capacity_J = own_J;
  return battery;
}

// An upper bound of the photocurrents of all cells in the run, with a margin.
double max_photocurrent_A(const LightModel& light, const RotationTable* table,
                          const PropagationRun& run) {
  double most = 0.0;
  const auto look = [&](const std::vector<double>& channels) {
    for (size_t cell = 0; cell < light.cells(); ++cell) {
      double sum = 0.0;
      for (const LightModel::Group& group : light.groups()) {
        sum += channels[group.first + 6 + cell];
      }
      most = std::max(most, sum);
    }
  };
  if (table != nullptr)
    return 1.2 * static_cast<double>(light.groups().size()) * table->error().scale[2];
  for (const double tilt : {0.0, 0.1, 0.2, 0.3}) {
    look(light.trace(lab_from_body_at(tilt, 0.0).rotation).value);
  }
  look(light.trace(run.initial.lab_from_body).value);
  return 2.0 * most;
}

std::optional<PowerSupply> supply_of(const ExperimentFile& file, const LightModel& light,
                                     const RotationTable* table, PropagationRun& run) {
  if (!light.array()) return {};
  SupplyDesign design{.array = *light.array(), .cell_area_m2 = light.cell_area_m2()};
  design.max_photocurrent_A = max_photocurrent_A(light, table, run);
  design.tracker = light.tracker();
  double stored_J = 0.0;
  if (light.day()) {
    const DaySettings& day = *light.day();
    design.battery = battery_of(file, day, run.model.platform);
    design.converter_efficiency = day.converter_efficiency;
    design.load_W = day.load_W;
    const double volts = run.model.platform.battery_voltage_V;
    const double capacity_J = design.battery->capacity_J;
    stored_J = capacity_J * day.battery.charge;
    if (run.initial.charge_drawn_C != 0.0) {
      stored_J = std::clamp(capacity_J - run.initial.charge_drawn_C * volts, 0.0, capacity_J);
    }
    run.initial.charge_drawn_C = (capacity_J - stored_J) / volts;
  }
  return PowerSupply(std::move(design), stored_J);
}

std::vector<LampGroup> lamp_groups(const std::vector<GroupOutput>& outputs) {
  std::vector<LampGroup> groups;
  for (const GroupOutput& one : outputs) {
    std::vector<double> switches_s = one.output->switches_s();
    switches_s.insert(switches_s.end(), one.corners_s.begin(), one.corners_s.end());
    std::ranges::sort(switches_s);
    groups.push_back({.first_channel = one.group.first,
                      .output = [one](double time_s) { return one.at(time_s); },
                      .switches_s = std::move(switches_s),
                      .in_orbit = one.group.is_sun});
  }
  return groups;
}

// Merges the events of lamps, light and battery into those of the motion.
void add_events(PropagationResult& result, const CoupledRun& beside) {
  std::vector<Event>& events = result.events;
  const double end_s = result.states.back().time_s;
  const auto add = [&](const Event& event) {
    if (event.time_s <= end_s) events.push_back(event);
  };
  for (const Event& event : beside.events()) add(event);
  if (beside.supply()) {
    for (const SupplyEvent& event : beside.supply()->events()) {
      add({event.name, event.time_s, true});
    }
  }
  std::ranges::stable_sort(events, {}, &Event::time_s);
  std::erase_if(result.product.tables, [](const Table& one) { return one.name == "events"; });
  if (!events.empty()) result.product.tables.push_back(event_table(events));
}

bool hits_tilt_limit(const PropagationResult& result) {
  return std::ranges::any_of(result.events,
                             [](const Event& event) { return event.name == "tilt_stop"; });
}

// Upper bound of the attitude error, if the largest error of a component occurs in each group of
// lamps in the worst direction all the time.
std::optional<double> attitude_error_rad(const PropagationRun& run, const RotationTable& table,
                                         size_t groups) {
  // For longer runs the derivatives take more time than the run.
  constexpr double longest_s = 3600.0;
  if (run.duration_s > longest_s) return {};
  const double torque_N_m = std::sqrt(3.0) * static_cast<double>(groups) * table.error().max[0];
  const double bound_rad = attitude_error_bound_rad(
      Dynamics(run.model), run.initial, run.initial.time_s + run.duration_s, torque_N_m);
  if (!std::isfinite(bound_rad)) return {};
  return bound_rad;
}

// Messages for quantities whose deviation exceeds both the tolerance of the table and the noise.
// Deviations have the noise of a trace and of the table: 1.4 times that of one trace on average,
// five times for the largest of some dozens.
std::vector<std::string> missed_tolerance(const RotationTable& table, double tolerance) {
  constexpr double mean_noises = 2.0, most_noises = 5.0;
  const RotationTableError& error = table.error();
  std::string off;
  for (size_t g = 0; g < error.scale.size(); ++g) {
    const bool misses = error.max[g] > tolerance * error.scale[g] + most_noises * error.noise[g];
    if (!misses || error.rms[g] <= mean_noises * error.noise[g]) continue;
    off += (off.empty() ? "" : ", ") + std::string(LightModel::quantities[g]) + " by up to " +
           readable_number(100.0 * error.max[g] / error.scale[g], 3) + " %";
  }
  if (off.empty()) return {};
  return {"the errors of the table of light exceed light.tolerance = " + shortest(tolerance) +
          " of the largest: " + off + "; increase light.max_traces or light.rays"};
}

// The checkpoint of a run, and messages about it.
class KeptState {
 public:
  KeptState(const Console& console, CheckpointFile* file, std::string identity)
      : console_(console), file_(file), identity_(std::move(identity)) {
    if (file_ != nullptr) kept_ = file_->read(identity_);
  }

  // Range of the table of light in the interrupted run.
  std::optional<double> table_tilt_rad() const {
    return kept_ ? std::optional(kept_->table_tilt_rad) : std::nullopt;
  }
  // Returns the stored state once: only the first run continues from it.
  std::optional<std::string> take() {
    if (!kept_) return {};
    console_.line("goes on from " + file_->path().string());
    std::string state = std::move(kept_->state);
    kept_.reset();
    return state;
  }
  bool due() const { return file_ != nullptr && file_->due(); }
  // A disk that is full for a while must not end a long run.
  void write(double table_tilt_rad, double time_s, const std::string& state) const {
    try {
      file_->write(identity_, table_tilt_rad, state);
    } catch (const InputError& error) {
      console_.line("note: no checkpoint at " + show(time_s) + " s: " + error.what());
    }
  }

 private:
  const Console& console_;
  CheckpointFile* file_;
  std::string identity_;
  std::optional<CheckpointFile::Kept> kept_;
};

// Propagates one run: the motion and, if present, light and power.
PropagationResult step_through(const PropagationRun& run, const Console& console,
                               CoupledRun* beside, double table_tilt_rad, KeptState& kept) {
  RecordedRun recorded(run, console.progress("propagating"),
                       beside != nullptr ? &beside->power() : nullptr);
  const auto keep = [&](Snapshot& snapshot) {
    recorded.keep(snapshot);
    if (beside != nullptr) beside->keep(snapshot);
  };
  if (const std::optional<std::string> state = kept.take()) {
    Snapshot snapshot(*state);
    keep(snapshot);
    if (!snapshot.is_whole()) {
      throw InputError({}, "", "a state that does not fit the run", "one of an equal run");
    }
  }
  if (beside != nullptr && !beside->has_begun()) beside->begin(recorded.motion());
  while (recorded.advance()) {
    if (beside != nullptr) beside->follow(recorded.motion());
    recorded.record();
    if (!kept.due()) continue;
    Snapshot snapshot;
    keep(snapshot);
    kept.write(table_tilt_rad, recorded.motion().step_end_s(), snapshot.bytes());
  }
  return recorded.result();
}

// One run with a table of light up to a tilt; the run stops at this tilt.
void attempt(CoupledResult& result, const Console& console, const ExperimentFile& file,
             const LightSettings& settings, PropagationRun run, double table_tilt_rad,
             KeptState& kept) {
  const std::vector<GroupOutput> outputs =
      group_outputs(*result.light, settings, run.initial.time_s);
  if (settings.mode == LightSettings::Mode::table) {
    result.table = result.light->make_table(console, table_tilt_rad);
    result.warnings = missed_tolerance(*result.table, settings.tolerance);
    print_light_table(console.details(), *result.table);
    run.model.disturbances.push_back(light_from_table(result.table, lamp_groups(outputs)));
    if (!result.light->sun_direction_lab() && table_tilt_rad < pi) {
      auto& limit_rad = run.model.platform.tilt_limit_rad;
      limit_rad = std::min(limit_rad.value_or(pi), table_tilt_rad);
    }
  } else {
    run.model.disturbances.push_back(light_from_tracer(lamp_groups(outputs)));
  }
  std::optional<PowerSupply> supply = supply_of(file, *result.light, result.table.get(), run);
  result.beside.reset();
  if (supply || !result.table) {
    result.beside =
        std::make_unique<CoupledRun>(*result.light, result.table, outputs, std::move(supply),
                                     settings, run, run.model.platform.battery_voltage_V);
  }
  result.motion = step_through(run, console, result.beside.get(), table_tilt_rad, kept);
  if (result.table && !hits_tilt_limit(result.motion)) {
    result.attitude_error_rad = attitude_error_rad(run, *result.table, outputs.size());
  }
  console.done();
}

}  // namespace

std::string of_inputs(const std::vector<std::pair<std::string, std::string>>& inputs) {
  std::string all;
  for (const auto& [name, hash] : inputs) all += name + ":" + hash + "\n";
  return all;
}

CoupledResult propagate_in_light(const RunOptions& options, const Console& console,
                                 const ExperimentFile& file, const PropagationRun& run,
                                 CheckpointFile* checkpoint, const std::string& identity) {
  CoupledResult result;
  const LightSettings settings = has_light(file) ? read_light(file) : LightSettings{};
  if (!has_light(file) || settings.mode == LightSettings::Mode::off) {
    KeptState kept(console, checkpoint, identity);
    result.motion = step_through(run, console, nullptr, 0.0, kept);
    console.done();
    return result;
  }
  require_light_once(file);
  result.light = std::make_unique<LightModel>(options, console, settings, run.model.platform);
  const bool is_live = static_cast<bool>(run.commander);
  const double limit_rad = result.light->max_angle_rad();
  double tilt_now_rad = result.light->first_angle_rad(tilt_rad(run.initial), is_live);
  KeptState kept(console, checkpoint, identity + of_inputs(result.light->inputs()));
  if (kept.table_tilt_rad()) tilt_now_rad = *kept.table_tilt_rad();
  for (;;) {
    try {
      attempt(result, console, file, settings, run, tilt_now_rad, kept);
      const bool wider =
          result.table && tilt_now_rad < limit_rad && !is_live && hits_tilt_limit(result.motion);
      if (!wider) break;
    } catch (const BeyondTable&) {
      if (is_live || tilt_now_rad >= pi) throw;
      console.done();
    }
    console.line("the motion left the range of the table of light, " +
                 show(tilt_now_rad / degree_rad) +
                 " deg of tilt: the run is repeated with a wider table");
    tilt_now_rad = std::min(tilt_now_rad < limit_rad ? limit_rad : pi, 2.0 * tilt_now_rad);
  }
  if (result.beside) add_events(result.motion, *result.beside);
  return result;
}

}  // namespace photorque
