// report.html: complete, self-contained, well-formed.
#include "diagnosis/report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <vector>

#include "diagnosis/report/chart.h"
#include "diagnosis/report/text.h"
#include "tests/diagnosis/sample_diagnosis.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string report(const Diagnosis& d) {
  return report_html(d, "lab/experiment", build_provenance());
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

TEST(Report, SizeDoesNotGrowWithTheRecording) {
  Diagnosis once = sample_diagnosis(), longer = sample_diagnosis();
  ChannelSeries& c = longer.series[0].channels[0];
  const ChannelSeries pattern = c;
  for (int copy = 1; copy < 40; ++copy) {
    for (size_t i = 0; i < pattern.time_s.size(); ++i) {
      c.time_s.push_back(pattern.time_s[i] + 200.0 * copy);
      c.measured.push_back(pattern.measured[i]);
      c.before.push_back(pattern.before[i]);
      c.after.push_back(pattern.after[i]);
      c.residual_before.push_back(pattern.residual_before[i]);
      c.residual_after.push_back(pattern.residual_after[i]);
    }
  }
  EXPECT_LT(report(longer).size(), 3 * report(once).size());
}

// Numbers "x y" of every path in a chart.
std::vector<std::pair<double, double>> points(const std::string& svg) {
  static const std::regex pair(R"([ML](-?[0-9.]+) (-?[0-9.]+))");
  std::vector<std::pair<double, double>> all;
  for (std::sregex_iterator it(svg.begin(), svg.end(), pair), end; it != end; ++it) {
    all.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return all;
}

TEST(ReportChart, KeepsASpikeThatOneOfAHundredThousandSamplesHolds) {
  LineChart chart{.y_label = "y", .x_label = "x", .height = 100.0};
  ChartLine line{.colour = "#000"};
  for (int i = 0; i < 100000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i == 54321 ? 1.0 : 0.0);
  }
  chart.lines = {line};
  const auto drawn = points(line_chart_svg(chart, "spike"));
  EXPECT_LT(drawn.size(), 5000u);
  double highest = 1e9, lowest = -1e9;
  for (const auto& [x, y] : drawn) {
    highest = std::min(highest, y);
    lowest = std::max(lowest, y);
  }
  // The margin is a twentieth of the range on either side.
  EXPECT_NEAR(lowest - highest, 100.0 / 1.1, 0.2);
}

TEST(ReportChart, BreaksTheLineAtAGap) {
  LineChart chart{.y_label = "y", .x_label = "x"};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  chart.lines = {{.colour = "#000", .x = {0, 1, 2, 3, 4}, .y = {1, 2, nan, 2, 1}}};
  const std::string svg = line_chart_svg(chart, "gap");
  const std::string path = svg.substr(svg.find("<path"));
  EXPECT_EQ(std::ranges::count(path.substr(0, path.find("/>")), 'M'), 2);
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
