// report.html: complete, self-contained, well-formed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <vector>

#include "tests/diagnosis/sample_diagnosis.h"
#include "tests/files.h"
#include "tools/pages/charts.h"
#include "tools/pages/pages.h"
#include "tools/runs/console.h"
#include "tools/sweeps/labels.h"
#include "tools/verbs/attitude/diagnose.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::Pointwise;

std::string report(const Diagnosis& d) {
  return report_html(d, build_provenance(), "experiment");
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

// Without the pictures in it, whose length std::regex does not stand.
std::string without_pictures(std::string page) {
  const std::string begin = "\"data:";
  for (size_t at = 0; (at = page.find(begin, at)) != std::string::npos;) {
    page.erase(at + 1, page.find('"', at + 1) - at - 1);
  }
  return page;
}

// The first tag that is closed wrongly, or that is never closed; empty if all is well.
std::string unbalanced(const std::string& whole_page) {
  const std::string page = without_pictures(whole_page);
  static const std::regex tags(R"(<(/?)([a-zA-Z][a-zA-Z0-9]*)([^<>]*?)(/?)>)");
  std::vector<std::string> open;
  for (std::sregex_iterator it(page.begin(), page.end(), tags), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if (name == "meta" || name == "img" || !(*it)[4].str().empty()) continue;
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

// The part that was held out belongs to its recording, which is called by the name of its file.
TEST(Report, NamesEveryRecordingOnceByItsFile) {
  Diagnosis d = sample_diagnosis();
  RecordingSeries fitted = d.series.front(), held = d.series.front();
  fitted.recording = held.recording = "/home/someone/lab/run7.csv";
  fitted.held_out_s.clear();
  held.is_held_out = true;
  for (ChannelSeries& channel : held.channels) {
    for (double& time_s : channel.time_s) time_s += 1e4;
  }
  d.series = {fitted, held};
  const std::string page = report(d);
  EXPECT_EQ(occurrences(page, "<h3>run7.csv</h3>"), 1u);
  EXPECT_THAT(page, Not(HasSubstr("/home/someone")));
}

TEST(Report, ShowsScansBesideTheirModels) {
  const Diagnosis d = diagnosis_of_light();
  const std::string page = report(d);
  EXPECT_EQ(unbalanced(page), "");
  EXPECT_THAT(page, HasSubstr("At tilt 0."));
  const std::vector<ScanGroup> groups = scan_groups(d.series);
  ASSERT_EQ(groups.size(), 1u);
  // In the order of the places, v upwards.
  const std::vector<std::vector<double>> expected = {
      {10, 20, 30, 60, 50, 40}, {9, 18, 27, 54, 45, 36}, {1, 2, 3, 6, 5, 4}, {0, 0, 0, 0, 1, 0}};
  const std::vector<ScanView> views = views_of_scans(true);
  ASSERT_EQ(views.size(), expected.size());
  for (size_t i = 0; i < views.size(); ++i) {
    const Map map = scan_map(groups[0], views[i], 0);
    EXPECT_EQ(map.value, expected[i]) << views[i].title;
    EXPECT_THAT(page, HasSubstr(std::string("<figcaption>") + views[i].title));
    EXPECT_THAT(page, HasSubstr("alt=\"" + map.title + "\""));
  }
}

TEST(Report, DrawsTheArrayWithTheFindings) {
  const std::string page = report(diagnosis_of_light());
  EXPECT_THAT(page, HasSubstr("The array, cells by their numbers; the affected cells are marked"));
  EXPECT_THAT(page, HasSubstr("alt=\"the array\""));
  EXPECT_THAT(report(sample_diagnosis()), Not(HasSubstr("\" alt=\"the array\"")));
}

TEST(Report, StatesTheFindingFirstAndEscapesIt) {
  const std::string page = report(sample_diagnosis());
  const size_t at = page.find(">A magnetic dipole acts &amp; &lt;explains&gt; what differs.</p>");
  ASSERT_NE(at, std::string::npos);
  EXPECT_LT(at, page.find("<h2>"));
  EXPECT_THAT(page, HasSubstr("Missing physics found"));
}

// An error of 9.96 in its last digit is 10 after rounding.
TEST(Console, ErrorsHaveTwoDigits) {
  EXPECT_EQ(show(Estimate{-4.427642e-8, 9.96e-13}, "N"), "(-4.42764 ± 0.00010)×10⁻⁸ N");
  EXPECT_EQ(show(Estimate{2.437440412, 9.94e-6}, "W"), "2.4374404 ± 0.0000099 W");
  EXPECT_EQ(show(Estimate{6.0, 0.0}, ""), "6");
}

TEST(Report, NeedsNothingElse) {
  const std::string page = report(sample_diagnosis());
  for (const char* outside : {"http://", "https://", "href=", "@import", "<script", "url("}) {
    EXPECT_THAT(page, Not(HasSubstr(outside))) << outside;
  }
  EXPECT_GT(occurrences(page, "src="), 3u);
  EXPECT_EQ(occurrences(page, "src="), occurrences(page, "src=\"data:image/svg+xml;base64,"));
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
  EXPECT_THAT(page, HasSubstr("eddy damping: 20.0, would feed energy"));
  EXPECT_THAT(page, HasSubstr("held out"));
  EXPECT_THAT(page, HasSubstr("the clock jumps at 12 s"));
  EXPECT_THAT(page, HasSubstr("outlier"));
}

TEST(ReportCharts, PutReadingsAboveResidualsAndShadeHeldOutData) {
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

TEST(ReportCharts, RankingOmitsRejectedTrialsAndMarksTheChosen) {
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

TEST(Report, WritesUnitsAsPeopleReadThem) {
  EXPECT_EQ(printed_unit("A_m2"), "A m²");
  EXPECT_EQ(printed_unit("N_m_s2"), "N m s²");
  EXPECT_EQ(printed_unit("N_m_s_per_T2"), "N m s/T²");
  EXPECT_EQ(printed_unit("m_s2"), "m/s²");
  EXPECT_EQ(printed_unit("kg_s"), "kg/s");
  EXPECT_EQ(printed_unit("kg_m"), "kg/m");
  EXPECT_EQ(printed_unit("kg_m2"), "kg m²");
}

// Scripts find every number of diagnosis.json by its key, with all of its digits.
TEST(Report, NumbersCarryTheirKeys) {
  const std::string page = report(sample_diagnosis());
  EXPECT_THAT(page, HasSubstr("data-key=\"effects[0].parameters.dipole_A_m2[1]\" "
                              "data-value=\"0.0288\" data-error=\"3e-04\">0.02880 ± 0.00030"));
  EXPECT_THAT(page, HasSubstr("data-key=\"holdout.chi2_per_sample_after\" data-value=\"1.02\""));
  EXPECT_THAT(page, HasSubstr("data-key=\"holdout.rms_before.attitude_z_arcsec\""));
  EXPECT_THAT(page, HasSubstr("(1.000 ± 0.010)×10⁻⁶"));
}

}  // namespace
}  // namespace photorque
