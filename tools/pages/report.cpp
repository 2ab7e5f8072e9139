// Text of report.html, with its charts as static pictures.
#include <algorithm>
#include <cmath>

#include "core/text/format.h"
#include "images/browser/run_page.h"
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "tools/pages/charts.h"
#include "tools/pages/pages.h"
#include "tools/pages/parts.h"
#include "tools/runs/console.h"
#include "tools/sweeps/labels.h"

namespace photorque {
namespace report_text {

std::string tag(const std::string& name, const std::string& content,
                const std::string& css_class = "") {
  return "<" + name + (css_class.empty() ? "" : " class=\"" + css_class + "\"") + ">" + content +
         "</" + name + ">\n";
}

std::string table(const std::vector<std::string>& titles, const std::string& rows) {
  std::string head;
  for (const std::string& title : titles) head += tag("th", title);
  if (!head.empty()) head = tag("thead", tag("tr", head));
  return tag("div", tag("table", head + tag("tbody", rows)), "scroll");
}

std::string row(const std::vector<std::string>& cells) {
  std::string content;
  for (const std::string& cell : cells) content += cell.starts_with("<td") ? cell : tag("td", cell);
  return tag("tr", content);
}

// An element with a number of diagnosis.json; `key` is its path there.
std::string keyed(const std::string& element, const std::string& key, const Estimate& number,
                  const std::string& text) {
  return "<" + element + " class=\"number\" data-key=\"" + xml_text(key) + "\" data-value=\"" +
         round_trip_number(number.value) + "\" data-error=\"" +
         round_trip_number(number.standard_error) + "\">" + text + "</" + element + ">";
}

std::string estimate_text(const Estimate& number) {
  std::string text = with_true_minus(show(number, ""));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

std::string joined(const std::vector<std::string>& names) {
  return joined_text(names, ", ",
                     [](const std::string& name) { return xml_text(name_in_text(name)); });
}

std::string percent(double probability) {
  if (probability > 0.9995) return "&gt; 99.9 %";
  if (probability > 0.0 && probability < 0.001) return "&lt; 0.1 %";
  return readable_number(100.0 * probability, probability > 0.1 ? 3 : 2) + " %";
}

std::string count(int64_t number) {
  std::string digits = std::to_string(number);
  for (auto at = static_cast<ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3) {
    digits.insert(static_cast<size_t>(at), "\u202f");
  }
  return digits;
}

// Cards with the main figures of the finding.
std::string cards(const Diagnosis& d) {
  const auto card = [](const std::string& value, const std::string& meaning) {
    return tag("div", tag("b", value) + tag("span", meaning));
  };
  const auto chi2 = [](const std::string& part, double before, double after) {
    const std::string key = part + ".chi2_per_sample_";
    return keyed("i", key + "before", {before, 0.0}, readable_number(before, 3)) + " → " +
           keyed("i", key + "after", {after, 0.0}, readable_number(after, 3));
  };
  std::string all =
      card(keyed("i", "confidence", {d.confidence, 0.0}, readable_number(d.confidence, 3)),
           "confidence in the verdict");
  all += card(chi2("fit", d.chi2_per_sample_before, d.chi2_per_sample_after),
              "χ² per sample of the fitted data, before → after (1: noise only)");
  if (d.holdout) {
    all +=
        card(chi2("holdout", d.holdout->chi2_per_sample_before, d.holdout->chi2_per_sample_after),
             "χ² per sample of the held-out data, before → after");
  }
  return tag("div", all, "cards");
}

std::string head(const Diagnosis& d, const std::string& title) {
  struct Face {
    const char *css, *sign, *words;
  };
  const Face face = d.verdict == Verdict::consistent ? Face{"good", "✓", "Consistent"}
                    : d.verdict == Verdict::missing_physics
                        ? Face{"found", "◆", "Missing physics found"}
                    : d.effects.empty() ? Face{"open", "?", "Not explained by known physics"}
                                        : Face{"open", "?", "Partly explained by known physics"};
  std::string content = tag("h1", xml_text(title) + "<span class=\"verb\">diagnose</span>");
  content +=
      tag("div",
          tag("p", std::string("<span aria-hidden=\"true\">") + face.sign + "</span>" + face.words,
              "verdict-words") +
              tag("p", xml_text(d.sentence), "verdict-sentence"),
          std::string("verdict ") + face.css);
  if (!d.because.empty()) content += tag("p", "Why unexplained: " + xml_text(d.because) + ".");
  std::string notes;
  for (const std::string& warning : d.warnings) notes += tag("li", xml_text(warning));
  if (!notes.empty()) content += tag("div", "<b>Notes</b>" + tag("ul", notes), "warning");
  return tag("header", content + cards(d));
}

std::string parameter_table(const std::vector<FittedParameter>& parameters,
                            const std::string& where, const std::string& significance) {
  if (parameters.empty()) return "";
  std::string rows;
  for (const FittedParameter& p : parameters) {
    const AxisLabel label = label_of_figure(p.key);
    for (size_t i = 0; i < p.value.size(); ++i) {
      const std::string axis = p.value.size() == 1   ? ""
                               : p.value.size() == 3 ? std::string(" ") + "xyz"[i]
                                                     : " " + std::to_string(i + 1);
      const Estimate number{p.value[i], i < p.sigma.size() ? p.sigma[i] : 0.0};
      const double sigma = number.standard_error;
      rows += row(
          {xml_text(label.name + axis),
           keyed("td",
                 where + "." + p.key + (p.value.size() > 1 ? "[" + std::to_string(i) + "]" : ""),
                 number, estimate_text(number)),
           xml_text(label.unit),
           sigma > 0.0 ? readable_number(std::abs(number.value - p.neutral) / sigma, 2) + " σ"
                       : "–"});
    }
  }
  return table({"parameter", "value ± 1 σ", "unit", significance}, rows);
}

std::string effect_card(const FoundEffect& effect, const std::string& where) {
  std::string card = tag("h3", xml_text(name_in_text(effect.kind)) + "<small> probability " +
                                   percent(effect.probability) + "</small>");
  card += tag("p", xml_text(effect.explanation));
  for (const auto& [key, text] : effect.texts) {
    card += tag("p", xml_text(name_in_text(key)) + ": " + xml_text(text));
  }
  card += parameter_table(effect.parameters, where, "from no effect");
  for (const std::string& text : effect.known_together) {
    card += tag("p", "<b>Only the combination is identifiable:</b> " + xml_text(text));
  }
  if (!effect.indistinguishable_from.empty()) {
    card += tag("p", "<b>Indistinguishable in these recordings:</b> " +
                         joined(effect.indistinguishable_from) + ".");
  }
  return tag("article", card, "finding");
}

std::string manoeuvres(const Diagnosis& d) {
  if (d.manoeuvres.empty()) return "";
  std::string list;
  for (const Manoeuvre& m : d.manoeuvres) {
    std::string item = xml_text(m.text) + ".";
    if (!m.separates.empty()) item += " <i>Separates " + joined(m.separates) + ".</i>";
    if (m.log_evidence_expected > 0.0) {
      item += " Expected advantage of the correct explanation: " +
              readable_number(m.log_evidence_expected, 2) + " in the log evidence.";
    }
    list += tag("li", item);
  }
  return tag("h3", "Recordings that would separate them") + tag("ul", list);
}

std::string effects(const Diagnosis& d) {
  if (d.effects.empty() && d.manoeuvres.empty()) return "";
  std::string section = tag("h2", d.effects.empty() ? "Further recordings" : "Effects"), found;
  for (size_t i = 0; i < d.effects.size(); ++i) {
    found += effect_card(d.effects[i], "effects[" + std::to_string(i) + "].parameters");
  }
  section += tag("div", found, "findings");
  if (d.array) {
    const bool is_some = !d.array->suspects.empty() || !d.array->shadows.empty();
    section +=
        tag("figure", tag("figcaption", std::string("The array, cells by their numbers") +
                                            (is_some ? "; the affected cells are marked" : "")) +
                          array_html(*d.array));
  }
  return tag("section", section + manoeuvres(d));
}

std::string empirical(const Diagnosis& d) {
  if (d.empirical.empty()) return "";
  std::string section = tag("h2", "The part that no known law explains");
  for (const EmpiricalTorque& torque : d.empirical) {
    if (!torque.formula.empty()) section += tag("p", "<b>" + xml_text(torque.formula) + ".</b>");
    if (!torque.looks_like.empty()) {
      section += tag("p", "Commonly this is " + xml_text(torque.looks_like) + ".");
    }
    section += tag("p", "Torque as a function of " + xml_text(name_in_text(torque.variable)) +
                            ", fitted without any law; bands are ± 1 σ.");
    section += plot_html(empirical_plot(torque));
  }
  return tag("section", section);
}

std::string where_section(const Where& where) {
  std::string facts;
  if (!where.intervals_s.empty()) {
    const std::string text = joined_text(where.intervals_s, ", ", [&](const auto& i) {
      return readable_number(i.from) + " to " + readable_number(i.to) + " s";
    });
    facts += tag("li", "Strongest between " + text + ".");
  }
  if (where.band_Hz) {
    facts += tag("li", "In the band from " + readable_number(where.band_Hz->from, 2) + " to " +
                           readable_number(where.band_Hz->to, 2) + " Hz.");
  }
  std::string section = tag("h2", "Differences between recordings and nominal model");
  if (!facts.empty()) section += tag("ul", facts);
  if (!where.channels.empty()) section += bar_chart_html(misfit_chart(where));
  if (const BarChart dependence = dependence_chart(where); !dependence.bars.empty()) {
    section += tag("h3", "Dependence of the difference") + bar_chart_html(dependence);
  }
  return tag("section", section);
}

std::string ranking(const Diagnosis& d) {
  if (d.alternatives.empty()) return "";
  const std::string chosen =
      d.verdict == Verdict::unexplained && d.effects.empty()
          ? " No name was chosen: the model that is reported is bold and blue."
          : " The chosen one is bold and blue.";
  std::string section =
      tag("h2", "Ranking of the alternatives") +
      tag("p", "Further right is better; a lead of 3 makes the odds 20 to 1." + chosen);
  if (d.domains.empty()) section += bar_chart_html(ranking_chart(d));
  for (const DomainAnswer& domain : d.domains) {
    section += tag("figure", tag("figcaption", "Of the " + domain.of) +
                                 bar_chart_html(ranking_chart(d, domain.of)));
  }
  return tag("section", section);
}

std::string figure_of(const Plot& plot) {
  return tag("figure", tag("figcaption", xml_text(plot.title)) + plot_html(plot));
}

std::string first_of(const std::string& what, size_t all, size_t most) {
  return all <= most ? ""
                     : tag("p", "Of " + std::to_string(all) + " " + what + " the first " +
                                    std::to_string(most) + ".");
}

// Scans at each attitude: measured, nominal, and the residuals of both models.
std::string scan_figures(const RecordingSeries& recording, bool found) {
  constexpr size_t most = 6;  // number of attitudes
  std::string figures;
  const std::vector<RecordingSeries> alone = {recording};
  const std::vector<ScanGroup> groups = scan_groups(alone);
  for (size_t g = 0; g < std::min(most, groups.size()); ++g) {
    std::string maps;
    for (const ScanView& view : views_of_scans(found)) {
      maps += tag("figure", tag("figcaption", view.title) + map_html(scan_map(groups[g], view, g)));
    }
    figures += tag("p", "At " + attitude_words(groups[g].lab_from_body) +
                            ". Differences in grey are less than twice the error of a reading.");
    figures += tag("div", maps, "scans");
  }
  return figures + first_of("attitudes", groups.size(), most);
}

std::string sweep_figures(const RecordingSeries& recording, bool found) {
  constexpr size_t most = 8;
  std::string figures;
  const std::vector<int> sweeps = sweeps_of(*recording.light);
  for (size_t i = 0; i < std::min(most, sweeps.size()); ++i) {
    figures += figure_of(sweep_plot(recording, sweeps[i], found));
  }
  return figures + first_of("curves", sweeps.size(), most);
}

std::string priors(const Diagnosis& d) {
  if (d.priors_refined.empty()) return "";
  return tag("section",
             tag("h2", "Uncertain numbers of the nominal model, after these recordings") +
                 parameter_table(d.priors_refined, "priors_refined", "from zero"));
}

// The predictive check: held-out data against the prediction with its uncertainty.
std::string of_the_prediction(const Holdout& holdout) {
  if (!holdout.predictive) return "";
  return tag("p", "With the uncertainty of its parameters the model predicts these data to χ² = " +
                      readable_number(holdout.predictive->chi2_per_sample) + " per number, " +
                      readable_number(holdout.predictive->sigma, 2) +
                      " standard errors beyond what noise makes (up to 5 pass). Of what the "
                      "nominal model leaves of them beyond noise, " +
                      readable_number(100.0 * holdout.explained_fraction, 3) + " % are explained.");
}

std::string holdout_table(const Holdout& holdout) {
  if (holdout.rms_before.empty()) return "";
  const auto cell = [](const std::string& key, double rms) {
    return keyed("td", "holdout." + key, {rms, 0.0}, readable_number(rms, 3));
  };
  std::string rows;
  for (const auto& [channel, before] : holdout.rms_before) {
    const auto after = holdout.rms_after.find(channel);
    rows +=
        row({xml_text(channel), cell("rms_before." + channel, before),
             after == holdout.rms_after.end() ? "–" : cell("rms_after." + channel, after->second)});
  }
  return tag("section", tag("h2", "Prediction of data to which no parameter was fitted") +
                            tag("p",
                                "Root mean square of what the prediction misses, in the unit "
                                "that each channel's name ends in.") +
                            of_the_prediction(holdout) +
                            table({"channel", "RMS before", "RMS after"}, rows));
}

std::string data_section(const DataQuality& data) {
  std::string rows = row({"Rows in the files", count(data.rows)});
  rows += row({"Rows used", count(data.used)});
  for (const auto& [reason, n] : data.rejected) {
    rows += row({"Left out: " + xml_text(name_in_text(reason)), count(n)});
  }
  for (const auto& [reason, n] : data.repaired) {
    rows += row({"Repaired: " + xml_text(name_in_text(reason)), count(n)});
  }
  if (data.median_interval_s > 0.0) {
    rows += row({"Median interval", readable_number(data.median_interval_s, 3) + " s"}) +
            row({"Jitter (1 σ)", readable_number(data.jitter_s, 2) + " s"}) +
            row({"Longest gap", readable_number(data.max_gap_s, 2) + " s"});
  }
  return tag("section", tag("h2", "Data quality") + table({}, rows));
}

// All readings with the models.
std::string readings(const Diagnosis& d) {
  if (d.series.empty()) return "";
  std::string section = tag("h2", "Readings and models");
  section += tag("p",
                 "<span class=\"key dots\"></span> measured &emsp;"
                 "<span class=\"key before\"></span> nominal model &emsp;"
                 "<span class=\"key after\"></span> improved model &emsp;"
                 "<span class=\"key shade\"></span> held out &emsp;"
                 "<span class=\"key level\"></span> ± 2 σ of one reading");
  const bool found = d.verdict != Verdict::consistent;
  for (const RecordingSeries& recording : shown_recordings(d, SIZE_MAX)) {
    section += tag("h3", xml_text(recording.recording));
    for (const ChannelSeries& channel : recording.channels) {
      section += figure_of(channel_plot(channel, recording));
    }
    if (!recording.light) continue;
    section += recording.light->u_m.empty() ? sweep_figures(recording, found)
                                            : scan_figures(recording, found);
  }
  return tag("section", section);
}

}  // namespace report_text

std::string report_findings(const Diagnosis& d, const std::string& title) {
  return report_text::head(d, title) + report_text::effects(d) + report_text::empirical(d);
}

std::string report_evidence(const Diagnosis& d) {
  return report_text::where_section(d.where) + report_text::ranking(d) +
         (d.holdout ? report_text::holdout_table(*d.holdout) : "") + report_text::priors(d) +
         report_text::data_section(d.data);
}

std::string report_html(const Diagnosis& diagnosis, const Provenance& provenance,
                        const std::string& title) {
  const std::string footer =
      report_text::tag("footer", report_text::tag("p", xml_text(provenance.one_line())));
  return text_page_html("Diagnosis of " + title, provenance,
                        report_findings(diagnosis, title) + report_text::readings(diagnosis) +
                            report_evidence(diagnosis) + footer);
}

}  // namespace photorque
