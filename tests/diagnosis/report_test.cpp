// report.html: complete, self-contained, well-formed.
#include "diagnosis/report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <vector>

#include "diagnosis/report/charts.h"
#include "diagnosis/report/text.h"
#include "tests/diagnosis/sample_diagnosis.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::Pointwise;

// In place of a drawing engine: what a chart says in words.
std::string words_of(const Plot& plot) {
  return "<svg>" + plot.title + " " + plot.shaded_label + "</svg>";
}
std::string words_of_bars(const BarChart& chart) {
  std::string words = "<svg>" + chart.title;
  for (const BarChart::Bar& bar : chart.bars) words += " " + bar.label + ": " + bar.note;
  return words + "</svg>";
}

std::string words_of_map(const Map& map) {
  std::string words = "<svg>" + map.title + ":";
  for (const double value : map.value) words += " " + std::to_string(std::lround(value));
  return words + "</svg>";
}

std::string report(const Diagnosis& d) {
  return report_html(d, "lab/experiment", build_provenance(),
                     {words_of, words_of_bars, words_of_map});
}

// A scan of 3 × 2 places, read in a serpentine, and an array of two cells.
Diagnosis diagnosis_of_light() {
  Diagnosis d = sample_diagnosis();
  LightSeries scan;
  scan.name = "irradiance_W_m2";
  scan.u_m = {0.0, 0.1, 0.2, 0.2, 0.1, 0.0};
  scan.v_m = {0.0, 0.0, 0.0, 0.1, 0.1, 0.1};
  scan.lab_from_body.assign(6, Quat::Identity());
  scan.measured = {10, 20, 30, 40, 50, 60};
  scan.before = {9, 18, 27, 36, 45, 54};
  scan.after = {10, 20, 30, 40, 49, 60};
  RecordingSeries recording;
  recording.recording = "scan1.csv";
  recording.light = scan;
  d.series = {recording};
  d.array =
      DrawnArray{{{0.0, 0.1, 0.0, 0.1}, {0.1, 0.2, 0.0, 0.1}}, {1}, {{0.05, 0.15, 0.0, 0.02}}};
  return d;
}

// The first tag that is closed wrongly, or that is never closed; empty if all is well.
std::string unbalanced(const std::string& page) {
  static const std::regex tags(R"(<(/?)([a-zA-Z][a-zA-Z0-9]*)([^<>]*?)(/?)>)");
  std::vector<std::string> open;
  for (std::sregex_iterator it(page.begin(), page.end(), tags), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if (name == "meta" || !(*it)[4].str().empty()) continue;
    if ((*it)[1].str().empty()) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + ">";
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

// In the order of the places, v upwards.
TEST(Report, ShowsScansBesideTheirModels) {
  const std::string page = report(diagnosis_of_light());
  EXPECT_EQ(unbalanced(page), "");
  EXPECT_THAT(page, HasSubstr("At tilt 0."));
  EXPECT_THAT(page, HasSubstr("<svg>Measured: scan1.csv, tilt 0: 10 20 30 60 50 40</svg>"));
  EXPECT_THAT(page, HasSubstr("<svg>Nominal model: scan1.csv, tilt 0: 9 18 27 54 45 36</svg>"));
  EXPECT_THAT(page, HasSubstr("<svg>Measured minus nominal model: scan1.csv, tilt 0: 1 2 3 6 5 4"));
  EXPECT_THAT(page, HasSubstr("found: scan1.csv, tilt 0: 0 0 0 0 1 0</svg>"));
}

// Cell 1, on the right, is marked; the shadow is the lowest fifth of the middle.
TEST(Report, DrawsTheArrayWithWhatWasFound) {
  const std::string page = report(diagnosis_of_light());
  EXPECT_THAT(page, HasSubstr("The array, cells by their numbers, those concerned marked"));
  EXPECT_THAT(
      page,
      HasSubstr(R"(<rect class="cell" x="8.0000" y="8.0000" width="272.00" height="272.00"/>)"));
  EXPECT_THAT(
      page,
      HasSubstr(R"(<rect class="suspect" x="280.00" y="8.0000" width="272.00" height="272.00"/>)"));
  EXPECT_THAT(
      page,
      HasSubstr(R"(<rect class="shadow" x="144.00" y="225.60" width="272.00" height="54.400"/>)"));
  EXPECT_THAT(report(sample_diagnosis()), Not(HasSubstr("class=\"chart array\"")));
}

TEST(Report, SaysTheFindingFirstAndEscapesIt) {
  const std::string page = report(sample_diagnosis());
  const size_t at =
      page.find("<h1>A magnetic dipole acts &amp; &lt;explains&gt; what differs.</h1>");
  ASSERT_NE(at, std::string::npos);
  EXPECT_LT(at, page.find("<h2>"));
  EXPECT_THAT(page, HasSubstr("Missing physics found"));
}

TEST(Report, NeedsNothingElse) {
  const std::string page = report(sample_diagnosis());
  for (const char* outside :
       {"http://", "https://", "src=", "href=", "@import", "<script", "url("}) {
    EXPECT_THAT(page, Not(HasSubstr(outside))) << outside;
  }
}

TEST(Report, IsWellFormedForEveryVerdict) {
  for (const Verdict verdict :
       {Verdict::consistent, Verdict::missing_physics, Verdict::unexplained}) {
    Diagnosis d = sample_diagnosis();
    d.verdict = verdict;
    EXPECT_EQ(unbalanced(report(d)), "");
    Diagnosis empty;
    empty.verdict = verdict;
    EXPECT_EQ(unbalanced(report(empty)), "");
  }
  EXPECT_EQ(unbalanced("<p><b>x</p></b>"), "</p>");
}

TEST(Report, HoldsNumbersWithTheirErrorsAndUnits) {
  const std::string page = report(sample_diagnosis());
  EXPECT_THAT(page, HasSubstr("0.01260 ± 0.00020"));
  EXPECT_THAT(page, HasSubstr("A m²"));
  EXPECT_THAT(page, HasSubstr("room draft"));
  EXPECT_THAT(page, HasSubstr("Turn the coils off."));
  EXPECT_THAT(page, HasSubstr("would feed energy"));
  EXPECT_THAT(page, HasSubstr("held out, never fitted"));
  EXPECT_THAT(page, HasSubstr("the clock jumps at 12 s"));
  EXPECT_THAT(page, HasSubstr("outlier"));
}

TEST(ReportCharts, PutReadingsAboveResidualsAndShadeWhatWasHeldOut) {
  const RecordingSeries recording = sample_diagnosis().series.at(0);
  const ChannelSeries& channel = recording.channels.at(0);
  const Plot plot = channel_plot(channel, recording);
  ASSERT_EQ(plot.curves.size(), 3u);
  EXPECT_THAT(plot.curves[0].y, Pointwise(testing::NanSensitiveDoubleEq(), channel.measured));
  EXPECT_TRUE(plot.curves[0].dots);
  EXPECT_TRUE(plot.curves[1].dashed);
  ASSERT_EQ(plot.below.size(), 1u);
  EXPECT_THAT(plot.below[0].curves.at(1).y,
              Pointwise(testing::NanSensitiveDoubleEq(), channel.residual_after));
  EXPECT_EQ(plot.below[0].levels, (std::vector<double>{-2.0 * channel.noise, 2.0 * channel.noise}));
  ASSERT_EQ(plot.shaded.size(), recording.held_out_s.size());
  EXPECT_EQ(plot.shaded[0].to, recording.held_out_s[0].to);

  ChannelSeries residuals_only = channel;
  residuals_only.measured.clear();
  const Plot one_panel = channel_plot(residuals_only, recording);
  EXPECT_TRUE(one_panel.below.empty());
  EXPECT_EQ(one_panel.curves.at(0).y, channel.residual_before);
}

TEST(ReportCharts, RankingLeavesOutWhatIsRuledOutAndMarksTheChosen) {
  Diagnosis d;
  d.alternatives = {{.kinds = {"tether"}, .log_evidence_relative = 120.0, .chosen = true},
                    {.kinds = {"room_draft", "tether"}, .log_evidence_relative = 117.0},
                    {.kinds = {}, .log_evidence_relative = 0.0},
                    {.kinds = {"sag"}, .log_evidence_relative = -80.0}};
  const BarChart chart = ranking_chart(d);
  ASSERT_EQ(chart.bars.size(), 3u);
  EXPECT_TRUE(chart.bars[0].highlighted);
  EXPECT_EQ(chart.bars[1].label, "room draft + tether");
  EXPECT_EQ(chart.bars[1].note, "−3.00 to the best");
  EXPECT_FALSE(chart.bars[1].highlighted);
  EXPECT_EQ(chart.bars[2].label, "nothing missing");
}

TEST(ReportText, WritesNumbersAsPeopleReadThem) {
  EXPECT_EQ(html_number(-1.1273e-9), "−1.13&nbsp;×&nbsp;10<sup>−9</sup>");
  EXPECT_EQ(html_number(0.0), "0");
  EXPECT_EQ(html_number(812.34, 4), "812.3");
  EXPECT_EQ(html_number(std::numeric_limits<double>::quiet_NaN()), "–");
  EXPECT_EQ(html_estimate(0.01264, 0.00021), "0.01264 ± 0.00021");
  EXPECT_EQ(html_estimate(3.23e-6, 4e-8), "(3.230 ± 0.040)&nbsp;×&nbsp;10<sup>−6</sup>");
  EXPECT_EQ(spoken_unit("dipole_A_m2"), "A m²");
  EXPECT_EQ(spoken_unit("coefficient_N_m_s2"), "N m s²");
  EXPECT_EQ(spoken_unit("coefficient_N_m_s_per_T2"), "N m s/T²");
  EXPECT_EQ(spoken_key("coefficient_N_m_s2"), "coefficient");
  EXPECT_EQ(spoken_key("dipole_A_m2"), "dipole");
}

}  // namespace
}  // namespace photorque
