#include "tools/pages/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "attitude/estimation/nominal_model.h"
#include "core/text/display.h"
#include "diagnosis/report/charts.h"
#include "scenes/experiment/toml_reader.h"
#include "tools/pages/diagnosed.h"
#include "tools/pages/platform.h"
#include "tools/pages/stage.h"
#include "tools/runs/attitude_run.h"
#include "tools/sweeps/labels.h"

namespace photorque {
namespace {

constexpr size_t most_recordings = 8;

std::string bare_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string spaced(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

std::string joined_words(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + spaced(name);
  return text;
}

std::string percent_words(double probability) {
  if (probability > 0.9995) return "more than 99.9 %";
  if (probability < 0.001) return "less than 0.1 %";
  return readable_number(100.0 * probability, 3) + " %";
}

PageVerdict verdict_of_page(const Diagnosis& d) {
  switch (d.verdict) {
    case Verdict::consistent:
      return {PageVerdict::Face::good, "Consistent", d.sentence};
    case Verdict::missing_physics:
      return {PageVerdict::Face::found, "Missing physics found", d.sentence};
    case Verdict::unexplained:
      break;
  }
  return {PageVerdict::Face::open, "Not explained by known physics", d.sentence};
}

// Keys as they lead through diagnosis.json.
std::vector<PageFigure> parameter_figures(const std::vector<FittedParameter>& parameters,
                                          const std::string& where) {
  std::vector<PageFigure> figures;
  for (const FittedParameter& p : parameters) {
    const AxisLabel label = label_of_figure(p.key);
    for (size_t i = 0; i < p.value.size(); ++i) {
      const bool many = p.value.size() > 1;
      const std::string axis = p.value.size() == 3 ? std::string(" ") + "xyz"[i]
                               : many              ? " " + std::to_string(i + 1)
                                                   : "";
      figures.push_back({where + "." + p.key + (many ? "[" + std::to_string(i) + "]" : ""),
                         label.name + axis,
                         label.unit,
                         {p.value[i], i < p.sigma.size() ? p.sigma[i] : 0.0}});
    }
  }
  return figures;
}

PageFinding finding_of(const FoundEffect& effect, const std::string& where) {
  PageFinding finding{spaced(effect.kind), "probability " + percent_words(effect.probability)};
  finding.texts.push_back(effect.explanation);
  for (const auto& [key, text] : effect.texts) finding.texts.push_back(spaced(key) + ": " + text);
  if (!effect.indistinguishable_from.empty()) {
    finding.texts.push_back("These recordings cannot tell it from: " +
                            joined_words(effect.indistinguishable_from) + ".");
  }
  finding.figures = parameter_figures(effect.parameters, where);
  return finding;
}

void add_findings(const Diagnosis& d, RunPage& page) {
  const bool acts = !d.effects.empty() || !d.empirical.empty();
  page.findings_title = acts                   ? "What acts"
                        : d.manoeuvres.empty() ? "After these recordings"
                                               : "What would tell more";
  for (size_t i = 0; i < d.effects.size(); ++i) {
    page.findings.push_back(
        finding_of(d.effects[i], "effects[" + std::to_string(i) + "].parameters"));
  }
  for (size_t i = 0; i < d.empirical.size(); ++i) {
    const EmpiricalTorque& torque = d.empirical[i];
    PageFinding finding{"a torque without a name", "over " + spaced(torque.variable)};
    if (!torque.formula.empty()) finding.texts.push_back(torque.formula + ".");
    if (!torque.looks_like.empty()) {
      finding.texts.push_back("Commonly this is " + torque.looks_like + ".");
    }
    page.findings.push_back(std::move(finding));
    page.product.plots.push_back(empirical_plot(torque));
    page.product.plots.back().name += "_" + std::to_string(i + 1);
  }
  if (!d.priors_refined.empty()) {
    page.findings.push_back({"what the nominal model left uncertain",
                             "after these recordings",
                             {},
                             parameter_figures(d.priors_refined, "priors_refined"),
                             false});
  }
  for (const Manoeuvre& manoeuvre : d.manoeuvres) {
    std::string text = manoeuvre.text + ".";
    if (!manoeuvre.separates.empty()) {
      text += " Separates " + joined_words(manoeuvre.separates) + ".";
    }
    page.next_steps.push_back(std::move(text));
  }
}

void add_figures(const Diagnosis& d, RunPage& page) {
  page.figures_file = "diagnosis.json";
  const auto add = [&](const char* key, const char* label, double value, bool is_headline) {
    page.figures.push_back({key, label, "", {value, 0.0}});
    if (is_headline) page.headlines.push_back(page.figures.back());
  };
  add("confidence", "confidence in the verdict", d.confidence, true);
  add("fit.chi2_per_sample_before", "χ² per number fitted, nominal (1 is noise)",
      d.chi2_per_sample_before, true);
  add("fit.chi2_per_sample_after", "χ² per number fitted, with what was found",
      d.chi2_per_sample_after, true);
  if (!d.holdout) return;
  add("holdout.chi2_per_sample_before", "χ² per number never fitted, nominal",
      d.holdout->chi2_per_sample_before, true);
  add("holdout.chi2_per_sample_after", "χ² per number never fitted, with what was found",
      d.holdout->chi2_per_sample_after, true);
  for (const auto* rms : {&d.holdout->rms_before, &d.holdout->rms_after}) {
    const bool before = rms == &d.holdout->rms_before;
    for (const auto& [channel, value] : *rms) {
      const AxisLabel label = label_of_figure(channel);
      page.figures.push_back(
          {std::string("holdout.rms_") + (before ? "before." : "after.") + channel,
           "RMS never fitted, " + label.name + (before ? ", nominal" : ", with what was found"),
           label.unit,
           {value, 0.0}});
    }
  }
}

void add_charts(const Diagnosis& d, RunPage& page) {
  if (!d.where.channels.empty()) page.charts.push_back(misfit_chart(d.where));
  if (!d.where.depends_on.empty()) page.charts.push_back(dependence_chart(d.where));
  if (d.domains.empty() && !d.alternatives.empty()) page.charts.push_back(ranking_chart(d));
  for (const DomainAnswer& domain : d.domains) {
    page.charts.push_back(ranking_chart(d, domain.of));
    page.charts.back().title += ", of the " + domain.of;
  }
}

void add_notes(const Diagnosis& d, RunPage& page) {
  if (!d.because.empty()) page.notes.push_back("Why unexplained: " + d.because + ".");
  for (const std::string& warning : d.warnings)
    page.notes.push_back("Check first: " + warning + ".");
  page.notes.push_back(std::to_string(d.data.rows) + " rows were read, " +
                       std::to_string(d.data.used) + " of them used.");
  for (const auto& [reason, count] : d.data.rejected) {
    if (count > 0)
      page.notes.push_back(spaced(reason) + ": " + std::to_string(count) + " left out.");
  }
  for (const auto& [reason, count] : d.data.repaired) {
    if (count > 0)
      page.notes.push_back(spaced(reason) + ": " + std::to_string(count) + " repaired.");
  }
  const size_t files = shown_recordings(d, SIZE_MAX).size();
  if (files > most_recordings) {
    page.notes.push_back("Shown are the first " + std::to_string(most_recordings) + " of " +
                         std::to_string(files) + " recordings or stretches; report.html has all.");
  }
}

template <class Value>
void append_values(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_channel(ChannelSeries& to, const ChannelSeries& from) {
  append_values(to.time_s, from.time_s);
  append_values(to.measured, from.measured);
  append_values(to.before, from.before);
  append_values(to.after, from.after);
  append_values(to.residual_before, from.residual_before);
  append_values(to.residual_after, from.residual_after);
}

// The end of a recording behind its beginning.
void append_recording(RecordingSeries& to, const RecordingSeries& from) {
  for (size_t c = 0; c < to.channels.size(); ++c) append_channel(to.channels[c], from.channels[c]);
  append_values(to.attitude.time_s, from.attitude.time_s);
  append_values(to.attitude.measured, from.attitude.measured);
  append_values(to.attitude.off_before_rad, from.attitude.off_before_rad);
  append_values(to.attitude.off_after_rad, from.attitude.off_after_rad);
  append_values(to.attitude.error_rad, from.attitude.error_rad);
  append_values(to.held_out_s, from.held_out_s);
  if (!to.light || !from.light) return;
  append_values(to.light->u_m, from.light->u_m);
  append_values(to.light->v_m, from.light->v_m);
  append_values(to.light->voltage_V, from.light->voltage_V);
  append_values(to.light->sweep, from.light->sweep);
  append_values(to.light->lab_from_body, from.light->lab_from_body);
  append_values(to.light->measured, from.light->measured);
  append_values(to.light->before, from.light->before);
  append_values(to.light->after, from.light->after);
  append_values(to.light->noise, from.light->noise);
}

double first_time_s(const RecordingSeries& recording) {
  for (const ChannelSeries& c : recording.channels) {
    if (!c.time_s.empty()) return c.time_s.front();
  }
  return 0.0;
}

double last_time_s(const RecordingSeries& recording) {
  double last = -1e300;
  for (const ChannelSeries& c : recording.channels) {
    if (!c.time_s.empty()) last = std::max(last, c.time_s.back());
  }
  return last;
}

// Whether `held` is the part of `recording` that was held out.
bool is_rest_of(const RecordingSeries& held, const RecordingSeries& recording) {
  return held.is_held_out && !recording.is_held_out && held.recording == recording.recording &&
         held.channels.size() == recording.channels.size() && recording.held_out_s.empty() &&
         held.light.has_value() == recording.light.has_value() &&
         (held.light || first_time_s(held) > last_time_s(recording));
}

// The scene with lamps of an experiment that has one; null otherwise.
std::unique_ptr<OpticalRun> optics_of(const RunOptions& options) {
  const ExperimentFile file =
      read_experiment_text(options.experiment, options.experiment_text(), options.all_overrides());
  if (!file.scene_file || file.sources.empty()) return nullptr;
  return std::make_unique<OpticalRun>(options, Console());
}

bool is_of_module(const RunOptions& options) {
  return Settings(std::make_shared<const SettingsNode>(
                      parse_toml(options.experiment_text(), options.experiment.string())))
      .has("module");
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
    const std::string name = bare_name(series.recording);
    series.recording = name;
    for (int k = 2; !names.insert(series.recording).second; ++k) {
      series.recording = name + " (" + std::to_string(k) + ")";
    }
  }
  return shown;
}

RunFile diagnosis_page(const Diagnosis& d, const Provenance& provenance, bool of_light,
                       const RunOptions& options, const PageHead& head) {
  RunPage page;
  page.title = head.title;
  page.verb = head.verb;
  page.command = head.command;
  page.provenance = provenance;
  page.verdict = verdict_of_page(d);
  add_figures(d, page);
  add_charts(d, page);
  add_notes(d, page);
  const std::vector<RecordingSeries> recordings = shown_recordings(d, most_recordings);
  const bool found = !d.effects.empty() || !d.empirical.empty() || !d.unnamed.empty();
  const std::unique_ptr<OpticalRun> optics = is_of_module(options) ? nullptr : optics_of(options);
  if (of_light) {
    show_light(recordings, found, optics.get(), page);
  } else if (!recordings.empty()) {
    const AttitudeExperiment experiment(options);
    show_motion(recordings, found,
                optics ? stage_of(*optics, StageMaps::own)
                       : platform_stage(read_attitude_model(experiment.settings()).model.platform),
                page);
  }
  add_findings(d, page);
  return page_file(std::move(page));
}

}  // namespace photorque
