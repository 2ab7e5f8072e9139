// Charts of a diagnosis: locations of findings on the array, and readings of light and power with
// both models.
#include <algorithm>

#include "diagnosis/light/findings.h"
#include "scenes/effects/kind.h"

namespace photorque {
namespace {

// Cells of one string, or of one bypass diode, by its number along the serpentine.
std::vector<size_t> wired_cells(const ArrayWiring& wiring, bool of_string, size_t number) {
  std::vector<size_t> cells;
  size_t string = 0, bypass = 0;
  for (const ArrayWiring::String& s : wiring.strings) {
    for (const ArrayWiring::Substring& part : s.substrings) {
      if ((of_string ? string : bypass) == number) {
        for (const CellGroup& row : part.rows) {
          row.for_each_cell([&](int cell) { cells.push_back(static_cast<size_t>(cell)); });
        }
      }
      ++bypass;
    }
    ++string;
  }
  return cells;
}

const std::vector<double>* found_numbers(const FoundEffect& effect, const std::string& key) {
  const auto found = std::ranges::find(effect.parameters, key, &FittedParameter::key);
  return found == effect.parameters.end() ? nullptr : &found->value;
}

using Expected = std::vector<LightRun::Expected>;

void add_channels(const FittedRun& run, const Expected& before, const Expected& after,
                  RecordingSeries& series) {
  const LightRecording& r = run.run->recording();
  const LightNoise& noise = run.run->lab().noise();
  for (const LightRun::Channel& read : run.run->channels()) {
    const bool is_voltage = read.expected == &LightRun::Expected::voltage_V;
    ChannelSeries channel;
    channel.name = read.name;
    channel.label = is_voltage ? "Voltage of the array" : "Current of the array";
    channel.unit = channel.residual_unit = is_voltage ? "V" : "A";
    channel.time_s = r.time_s;
    channel.measured = r.*read.measured;
    channel.noise = is_voltage ? noise.voltage_V : noise.current_A;
    for (size_t i = 0; i < r.rows(); ++i) {
      channel.before.push_back(before[i].*read.expected);
      channel.after.push_back(after[i].*read.expected);
      channel.residual_before.push_back(channel.measured[i] - channel.before.back());
      channel.residual_after.push_back(channel.measured[i] - channel.after.back());
    }
    series.channels.push_back(std::move(channel));
  }
  series.attitude.time_s = r.time_s;
  series.attitude.measured = r.lab_from_body;
}

LightSeries rows_of(const FittedRun& run, const Expected& before, const Expected& after) {
  const LightRecording& r = run.run->recording();
  const LightRun::Channel& read = run.run->channels().front();
  LightSeries rows;
  rows.name = read.name;
  rows.u_m = r.u_m;
  rows.v_m = r.v_m;
  rows.voltage_V = r.voltage_V;
  rows.sweep = r.sweep;
  rows.lab_from_body = r.lab_from_body;
  rows.measured = r.*read.measured;
  for (size_t i = 0; i < r.rows(); ++i) {
    rows.before.push_back(before[i].*read.expected);
    rows.after.push_back(after[i].*read.expected);
    rows.noise.push_back(r.kind == LightRecording::Kind::scan ? run.run->row_noise(i)
                                                              : run.run->lab().noise().current_A);
  }
  return rows;
}

}  // namespace

std::optional<DrawnArray> drawn_array(const LightLab& lab,
                                      const std::vector<FoundEffect>& effects) {
  if (!lab.has_array() || effects.empty()) return std::nullopt;
  DrawnArray array;
  for (const LightCell& cell : lab.cells()) {
    const CellRectangle& r = cell.rectangle;
    array.cells.push_back({r.u_low, r.u_high, r.v_low, r.v_high});
  }
  const std::vector<LightEffectKind> kinds = all_light_effect_kinds();
  for (const FoundEffect& effect : effects) {
    const auto *u = found_numbers(effect, "u_m"), *v = found_numbers(effect, "v_m");
    if (u != nullptr && v != nullptr && u->size() == 2 && v->size() == 2) {
      array.shadows.push_back({(*u)[0], (*u)[1], (*v)[0], (*v)[1]});
    }
    const std::vector<double>* index = found_numbers(effect, "index");
    if (index == nullptr) continue;
    const auto number = static_cast<size_t>(index->front());
    const auto kind = std::ranges::find(kinds, effect.kind, &LightEffectKind::name);
    const auto of = kind == kinds.end() ? LightEffectKind::Index::none : kind->index;
    if (of == LightEffectKind::Index::cell) array.suspects.push_back(number);
    const bool of_string = of == LightEffectKind::Index::string;
    if (!of_string && of != LightEffectKind::Index::bypass) continue;
    const std::vector<size_t> cells = wired_cells(lab.design().wiring, of_string, number);
    array.suspects.insert(array.suspects.end(), cells.begin(), cells.end());
  }
  return array;
}

RecordingSeries light_series(const LightAnswer& answer, const FittedRun& run, bool is_held_out) {
  const LightRecording& r = run.run->recording();
  const Expected before = run.run->expected(state_of(answer.trials.front(), answer.all)),
                 after = run.run->expected(state_of(answer.chosen(), answer.all));
  RecordingSeries series;
  series.recording = r.name;
  series.is_held_out = is_held_out;
  if (r.kind == LightRecording::Kind::run) {
    add_channels(run, before, after, series);
    if (is_held_out) series.held_out_s = {{r.time_s.front(), r.time_s.back()}};
  } else {
    series.light = rows_of(run, before, after);
  }
  return series;
}

}  // namespace photorque
