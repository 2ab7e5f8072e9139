#include "diagnosis/report/page.h"

#include <algorithm>
#include <cmath>

#include "core/text/format.h"
#include "diagnosis/report/charts.h"
#include "diagnosis/report/light_charts.h"
#include "diagnosis/report/style.h"
#include "diagnosis/report/text.h"

namespace photorque {
namespace {

std::string tag(const std::string& name, const std::string& content,
                const std::string& css_class = "") {
  return "<" + name + (css_class.empty() ? "" : " class=\"" + css_class + "\"") + ">" + content +
         "</" + name + ">\n";
}

std::string row(const std::vector<std::string>& cells, const std::string& cell = "td") {
  std::string content;
  for (const std::string& c : cells) content += "<" + cell + ">" + c + "</" + cell + ">";
  return tag("tr", content);
}

std::string joined(const std::vector<std::string>& names, const std::string& between) {
  std::string text;
  for (const std::string& name : names)
    text += (text.empty() ? "" : between) + xml_text(spoken(name));
  return text;
}

std::string percent(double probability) {
  if (probability > 0.9995) return "&gt; 99.9 %";
  if (probability > 0.0 && probability < 0.001) return "&lt; 0.1 %";
  return html_number(100.0 * probability, probability > 0.1 ? 3 : 2) + " %";
}

std::string count(int64_t number) {
  std::string digits = std::to_string(number);
  for (auto at = static_cast<ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3) {
    digits.insert(static_cast<size_t>(at), "\u202f");
  }
  return digits;
}

// The figures that say at a glance what the finding rests on.
std::string headline_figures(const Diagnosis& d) {
  const auto figure = [](const std::string& value, const std::string& meaning) {
    return tag("div", tag("b", value) + tag("span", meaning), "figure");
  };
  std::string figures = figure(percent(d.confidence), "confidence in the verdict");
  figures +=
      figure(html_number(d.chi2_per_sample_before) + " → " + html_number(d.chi2_per_sample_after),
             "χ² per number in the fitted data, before → after (1 is noise)");
  if (d.holdout) {
    figures += figure(html_number(d.holdout->chi2_per_sample_before) + " → " +
                          html_number(d.holdout->chi2_per_sample_after),
                      "χ² per number in data never fitted, before → after");
  }
  return tag("div", figures, "figures");
}

std::string head(const Diagnosis& d, const std::string& title) {
  struct Face {
    const char* css;
    const char* sign;
    const char* words;
  };
  const Face face = d.verdict == Verdict::consistent ? Face{"good", "✓", "Consistent"}
                    : d.verdict == Verdict::missing_physics
                        ? Face{"found", "◆", "Missing physics found"}
                        : Face{"open", "?", "Not explained by known physics"};
  std::string page = tag("p", xml_text(title), "title");
  page +=
      tag("div", std::string("<span aria-hidden=\"true\">") + face.sign + "</span> " + face.words,
          std::string("verdict ") + face.css);
  page += tag("h1", xml_text(d.sentence));
  page += headline_figures(d);
  for (const std::string& warning : d.warnings) {
    page += tag("p", "<b>Check first:</b> " + xml_text(warning), "warning");
  }
  return tag("header", page);
}

std::string parameter_rows(const std::vector<FittedParameter>& parameters) {
  std::string rows;
  for (const FittedParameter& p : parameters) {
    static const char* const axes[] = {" x", " y", " z"};
    for (size_t i = 0; i < p.value.size(); ++i) {
      const std::string index = p.value.size() == 1   ? ""
                                : p.value.size() == 3 ? axes[i]
                                                      : " " + std::to_string(i + 1);
      const double sigma = i < p.sigma.size() ? p.sigma[i] : 0.0;
      const std::string significance =
          sigma > 0.0 ? html_number(std::abs(p.value[i] - p.neutral) / sigma, 2) + " σ" : "–";
      rows += row({spoken_key(p.key) + index, html_estimate(p.value[i], sigma), spoken_unit(p.key),
                   significance});
    }
  }
  return rows;
}

std::string parameter_table(const std::vector<FittedParameter>& parameters,
                            const char* significance) {
  if (parameters.empty()) return "";
  return tag(
      "table",
      row({"Parameter", "Value ± 1 σ", "Unit", significance}, "th") + parameter_rows(parameters),
      "numbers");
}

std::string effect_card(const FoundEffect& effect) {
  std::string card = tag("h3", xml_text(spoken(effect.kind)) + " <small>probability " +
                                   percent(effect.probability) + "</small>");
  card += tag("p", xml_text(effect.explanation));
  card += parameter_table(effect.parameters, "From no effect");
  for (const std::string& text : effect.known_together) {
    card += tag("p", "<b>Known together, none by itself:</b> " + xml_text(text));
  }
  if (!effect.indistinguishable_from.empty()) {
    card += tag("p",
                "<b>These recordings cannot tell it from:</b> " +
                    joined(effect.indistinguishable_from, ", ") + ".",
                "group");
  }
  return tag("div", card, "card");
}

std::string manoeuvres(const Diagnosis& d) {
  if (d.manoeuvres.empty()) return "";
  std::string list;
  for (const Manoeuvre& m : d.manoeuvres) {
    std::string item = xml_text(m.text) + ".";
    if (!m.separates.empty()) item += " <i>Separates " + joined(m.separates, ", ") + ".</i>";
    if (m.log_evidence_expected > 0.0) {
      item += " Expected lead of the right one: " + html_number(m.log_evidence_expected, 2) +
              " in the log evidence.";
    }
    list += tag("li", item);
  }
  return tag("h3", "What would tell them apart") + tag("ul", list);
}

std::string effects(const Diagnosis& d) {
  if (d.effects.empty() && d.manoeuvres.empty()) return "";
  std::string section = tag("h2", d.effects.empty() ? "What would tell more" : "What acts");
  for (const FoundEffect& effect : d.effects) section += effect_card(effect);
  const std::string drawing = array_drawing(d);
  if (!drawing.empty()) {
    const bool is_some = !d.array->suspects.empty() || !d.array->shadows.empty();
    section += tag("figure", tag("figcaption", std::string("The array, cells by their numbers") +
                                                   (is_some ? ", those concerned marked" : "")) +
                                 drawing);
  }
  return tag("section", section + manoeuvres(d));
}

std::string empirical(const Diagnosis& d, const ChartDrawer& draw) {
  if (d.empirical.empty()) return "";
  std::string section = tag("h2", "The part that no known law explains");
  for (const EmpiricalTorque& torque : d.empirical) {
    if (!torque.formula.empty()) section += tag("p", "<b>" + xml_text(torque.formula) + ".</b>");
    if (!torque.looks_like.empty()) {
      section += tag("p", "Commonly this is " + xml_text(torque.looks_like) + ".");
    }
    section += tag("p", "Torque as a function of " + xml_text(spoken(torque.variable)) +
                            ", fitted without any law; bands are ± 1 σ.");
    section += draw.plot(empirical_plot(torque));
  }
  return tag("section", section);
}

std::string where_section(const Where& where, const ChartDrawer& draw) {
  std::string facts;
  if (!where.intervals_s.empty()) {
    std::string text;
    for (const auto& i : where.intervals_s) {
      text += (text.empty() ? "" : ", ") + html_number(i.from, 4) + " to " + html_number(i.to, 4) +
              " s";
    }
    facts += tag("li", "Strongest between " + text + ".");
  }
  if (where.band_Hz) {
    facts += tag("li", "In the band from " + html_number(where.band_Hz->from, 2) + " to " +
                           html_number(where.band_Hz->to, 2) + " Hz.");
  }
  std::string section = tag("h2", "Where the recordings differ from the nominal model");
  if (!facts.empty()) section += tag("ul", facts);
  if (!where.channels.empty()) section += draw.bars(misfit_chart(where));
  if (!where.depends_on.empty()) {
    section += tag("h3", "What the difference depends on") + draw.bars(dependence_chart(where));
  }
  return tag("section", section);
}

std::string ranking(const Diagnosis& d, const ChartDrawer& draw) {
  if (d.alternatives.empty()) return "";
  const std::string chosen =
      d.verdict == Verdict::unexplained
          ? " No name was chosen: the model that is reported is bold and blue."
          : " The chosen one is bold and blue.";
  std::string section =
      tag("h2", "Ranking of the alternatives") +
      tag("p", "Further right is better; a lead of 3 makes the odds 20 to 1." + chosen);
  if (d.domains.empty()) section += draw.bars(ranking_chart(d));
  for (const DomainAnswer& domain : d.domains) {
    section += tag("figure", tag("figcaption", "Of the " + domain.of) +
                                 draw.bars(ranking_chart(d, domain.of)));
  }
  return tag("section", section);
}

std::string channel_figure(const ChannelSeries& channel, const RecordingSeries& recording,
                           const ChartDrawer& draw) {
  const Plot plot = channel_plot(channel, recording);
  return tag("figure", tag("figcaption", xml_text(plot.title)) + draw.plot(plot));
}

// Scans at each attitude: measured, nominal, and what either model leaves.
std::string scan_figures(const RecordingSeries& recording, bool found, const ChartDrawer& draw) {
  constexpr size_t most = 6;  // attitudes
  std::string figures;
  const std::vector<RecordingSeries> alone = {recording};
  const std::vector<ScanGroup> groups = scan_groups(alone);
  for (size_t g = 0; g < std::min(most, groups.size()); ++g) {
    std::string maps;
    for (const ScanView& view : views_of_scans(found)) {
      maps += tag("figure", tag("figcaption", view.title) + draw.map(scan_map(groups[g], view, g)));
    }
    figures += tag("p", "At " + attitude_words(groups[g].lab_from_body) +
                            ". Differences in grey are less than twice the error of a reading.");
    figures += tag("div", maps, "maps");
  }
  if (groups.size() > most) {
    figures += tag("p", "Of " + std::to_string(groups.size()) + " attitudes the first " +
                            std::to_string(most) + ".");
  }
  return figures;
}

std::string sweep_figures(const RecordingSeries& recording, bool found, const ChartDrawer& draw) {
  constexpr size_t most = 8;
  std::string figures;
  const std::vector<int> sweeps = sweeps_of(*recording.light);
  for (size_t i = 0; i < std::min(most, sweeps.size()); ++i) {
    const Plot plot = sweep_plot(recording, sweeps[i], found);
    figures += tag("figure", tag("figcaption", xml_text(plot.title)) + draw.plot(plot));
  }
  if (sweeps.size() > most) {
    figures += tag("p", "Of " + std::to_string(sweeps.size()) + " curves the first " +
                            std::to_string(most) + ".");
  }
  return figures;
}

std::string light_figures(const RecordingSeries& recording, bool found, const ChartDrawer& draw) {
  if (!recording.light) return "";
  return recording.light->u_m.empty() ? sweep_figures(recording, found, draw)
                                      : scan_figures(recording, found, draw);
}

std::string overlays(const Diagnosis& d, const ChartDrawer& draw) {
  if (d.series.empty()) return "";
  std::string section = tag("h2", "Readings and models");
  section += tag("p",
                 std::string("<span class=\"key dots\"></span> measured &emsp;"
                             "<span class=\"key before\"></span> nominal model &emsp;"
                             "<span class=\"key after\"></span> with what was found &emsp;"
                             "<span class=\"key shade\"></span> held out, never fitted &emsp;"
                             "<span class=\"key level\"></span> ± 2 σ of one reading"),
                 "legend");
  for (const RecordingSeries& recording : d.series) {
    section += tag("h3", xml_text(recording.recording));
    for (const ChannelSeries& channel : recording.channels) {
      section += channel_figure(channel, recording, draw);
    }
    section += light_figures(recording, d.verdict != Verdict::consistent, draw);
  }
  return tag("section", section);
}

std::string priors(const Diagnosis& d) {
  if (d.priors_refined.empty()) return "";
  return tag("section", tag("h2", "What the nominal model left uncertain, after these recordings") +
                            parameter_table(d.priors_refined, "From zero"));
}

// What the gate asks: the same data against the prediction with its uncertainty.
std::string of_the_prediction(const Holdout& holdout) {
  if (!holdout.predictive) return "";
  return tag("p", "With the uncertainty of its parameters the model predicts these data to χ² = " +
                      html_number(holdout.predictive->chi2_per_sample, 4) + " per number, " +
                      html_number(holdout.predictive->sigma, 2) +
                      " standard errors beyond what noise makes (up to 5 pass). Of what the "
                      "nominal model leaves of them beyond noise, " +
                      html_number(100.0 * holdout.explained_fraction, 3) + " % are explained.");
}

std::string holdout_table(const Holdout& holdout) {
  if (holdout.rms_before.empty()) return "";
  std::string rows = row({"Channel", "RMS before", "RMS after"}, "th");
  for (const auto& [channel, before] : holdout.rms_before) {
    const auto after = holdout.rms_after.find(channel);
    rows += row({xml_text(channel), html_number(before),
                 after == holdout.rms_after.end() ? "–" : html_number(after->second)});
  }
  return tag("section", tag("h2", "Prediction of data to which no parameter was fitted") +
                            tag("p",
                                "Root mean square of what the prediction misses, in the unit "
                                "that each channel's name ends in.") +
                            of_the_prediction(holdout) + tag("table", rows, "numbers"));
}

std::string data_section(const DataQuality& data) {
  std::string rows = row({"Rows in the files", count(data.rows)});
  rows += row({"Rows used", count(data.used)});
  for (const auto& [reason, n] : data.rejected) {
    rows += row({"Left out: " + xml_text(spoken(reason)), count(n)});
  }
  for (const auto& [reason, n] : data.repaired) {
    rows += row({"Repaired: " + xml_text(spoken(reason)), count(n)});
  }
  rows += row({"Median interval", html_number(data.median_interval_s) + " s"});
  rows += row({"Jitter (1 σ)", html_number(data.jitter_s, 2) + " s"});
  rows += row({"Longest gap", html_number(data.max_gap_s, 2) + " s"});
  return tag("section", tag("h2", "Data quality") + tag("table", rows, "numbers"));
}

}  // namespace

std::string report_html(const Diagnosis& d, const std::string& title, const Provenance& provenance,
                        const ChartDrawer& draw) {
  std::string page = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<title>Diagnosis of " + xml_text(title) + "</title>\n<style>" + report_style +
          "</style>\n</head>\n<body>\n<main>\n";
  page += head(d, title) + effects(d) + empirical(d, draw) + where_section(d.where, draw) +
          ranking(d, draw);
  if (d.holdout) page += holdout_table(*d.holdout);
  page += overlays(d, draw) + priors(d) + data_section(d.data);
  page += tag("footer", xml_text(provenance.one_line()));
  return page + "</main>\n</body>\n</html>\n";
}

}  // namespace photorque
