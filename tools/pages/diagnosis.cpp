#include <algorithm>
#include <filesystem>
#include <set>

#include "attitude/propagation/run.h"
#include "scenes/experiment/toml.h"
#include "tools/pages/charts.h"
#include "tools/pages/parts.h"
#include "tools/runs/attitude_run.h"

namespace photorque {
namespace {

constexpr size_t most_recordings = 8;

template <class Value>
void append_values(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// Appends the held-out end of a recording to its beginning.
void append_recording(RecordingSeries& to, const RecordingSeries& from) {
  using Channel = ChannelSeries;
  for (size_t c = 0; c < to.channels.size(); ++c) {
    for (const auto of : {&Channel::time_s, &Channel::measured, &Channel::before, &Channel::after,
                          &Channel::residual_before, &Channel::residual_after}) {
      append_values(to.channels[c].*of, from.channels[c].*of);
    }
  }
  append_values(to.attitude.time_s, from.attitude.time_s);
  append_values(to.attitude.measured, from.attitude.measured);
  append_values(to.attitude.off_before_rad, from.attitude.off_before_rad);
  append_values(to.attitude.off_after_rad, from.attitude.off_after_rad);
  append_values(to.attitude.error_rad, from.attitude.error_rad);
  append_values(to.held_out_s, from.held_out_s);
  if (!to.light || !from.light) return;
  using Light = LightSeries;
  for (const auto of : {&Light::u_m, &Light::v_m, &Light::voltage_V, &Light::measured,
                        &Light::before, &Light::after, &Light::noise}) {
    append_values(*to.light.*of, *from.light.*of);
  }
  append_values(to.light->sweep, from.light->sweep);
  append_values(to.light->lab_from_body, from.light->lab_from_body);
}

// Whether `held` is the held-out part of `recording`.
bool is_rest_of(const RecordingSeries& held, const RecordingSeries& recording) {
  return held.is_held_out && !recording.is_held_out && held.recording == recording.recording &&
         held.channels.size() == recording.channels.size() && recording.held_out_s.empty() &&
         held.light.has_value() == recording.light.has_value() &&
         (held.light || span_of(held).from > span_of(recording).to);
}

// The optical run of an experiment with a scene and lamps; null otherwise.
std::unique_ptr<OpticalRun> optics_of(const RunOptions& options) {
  const ExperimentFile file =
      read_experiment_text(options.experiment, options.experiment_text(), options.all_overrides());
  if (!file.scene_file || file.sources.empty()) return nullptr;
  return std::make_unique<OpticalRun>(options, Console());
}

bool found_something(const Diagnosis& d) {
  return !d.effects.empty() || !d.empirical.empty() || !d.unnamed.empty();
}

}  // namespace

std::vector<RecordingSeries> shown_recordings(const Diagnosis& d, size_t most) {
  std::vector<RecordingSeries> shown;
  for (const RecordingSeries& series : d.series) {
    const auto whole = std::ranges::find_if(
        shown, [&](const RecordingSeries& known) { return is_rest_of(series, known); });
    if (whole != shown.end()) {
      append_recording(*whole, series);
    } else {
      shown.push_back(series);
    }
  }
  if (shown.size() > most) shown.resize(most);
  std::set<std::string> names;
  for (RecordingSeries& series : shown) {
    const std::string name = std::filesystem::path(series.recording).filename().string();
    series.recording = name;
    for (int k = 2; !names.insert(series.recording).second; ++k) {
      series.recording = name + " (" + std::to_string(k) + ")";
    }
  }
  return shown;
}

Product diagnosis_figures(const Diagnosis& d, bool of_light) {
  const std::vector<RecordingSeries> recordings = shown_recordings(d, most_recordings);
  RunPage page;
  if (of_light) {
    show_light(recordings, found_something(d), nullptr, page);
  } else {
    for (size_t r = 0; r < recordings.size(); ++r) {
      const std::string suffix =
          recordings.size() == 1 ? "" : "_of_recording_" + std::to_string(r + 1);
      add_curves(recordings[r], suffix, std::nullopt, page);
    }
  }
  for (Plot& plot : page.product.plots) {  // the first panel has the legend
    for (Plot::Panel& panel : plot.below) {
      for (Plot::Curve& curve : panel.curves) curve.label.clear();
    }
  }
  for (size_t e = 0; e < d.empirical.size(); ++e) {
    Plot plot = empirical_plot(d.empirical[e]);
    if (e > 0) plot.name += "_" + std::to_string(e + 1);
    page.product.plots.push_back(std::move(plot));
  }
  return std::move(page.product);
}

std::string interactive_report_html(const Diagnosis& d, const Provenance& provenance, bool of_light,
                                    const RunOptions& options, const PageHead& head) {
  RunPage page;
  page.title = head.title;
  page.verb = head.verb;
  page.command = head.command;
  page.provenance = provenance;
  page.text = ReportText{report_findings(d, head.title), report_evidence(d)};
  const std::vector<RecordingSeries> recordings = shown_recordings(d, most_recordings);
  if (const size_t files = shown_recordings(d, SIZE_MAX).size(); files > most_recordings) {
    page.notes.push_back("Shown are the first " + std::to_string(most_recordings) + " of " +
                         std::to_string(files) +
                         " recordings or segments; a report without --page has all.");
  }
  const bool found = found_something(d);
  const bool is_of_module =
      Settings(parse_toml(options.experiment_text(), options.experiment.string())).has("module");
  const std::unique_ptr<OpticalRun> optics = is_of_module ? nullptr : optics_of(options);
  if (of_light) {
    show_light(recordings, found, optics.get(), page);
  } else if (!recordings.empty()) {
    const AttitudeExperiment experiment(options);
    show_motion(recordings, found,
                optics ? stage_of(*optics, StageMaps::own)
                       : platform_stage(read_attitude_model(experiment.settings()).model.platform),
                page);
  }
  return page_html(page);
}

}  // namespace photorque
