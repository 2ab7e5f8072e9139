// A run as one HTML page that needs neither network nor other files: the scene in three dimensions,
// maps and curves with values under the pointer, where the power went, figures with errors, and
// what made them. What moves on it stands in script/, as page.min.js.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/browser/stage.h"

namespace photorque {

// A headline figure as people read it.
struct PageFigure {
  std::string key;  // as in summary.json
  std::string label;
  std::string unit;
  Estimate estimate;
};

// One stage of the way that the power takes; the first is where it starts.
struct PowerStage {
  std::string label;      // "absorbed by plate"
  Estimate power_W;       // that is lost here, or at the start and the end, that is there
  bool is_total = false;  // start, end, and what is left between
};

// A plot whose x axis is that of the slider: a line follows it.
struct PlotCursor {
  std::string plot;
  size_t axis = 0;
  double x_per_unit = 1.0;  // x of the plot over the value of the axis
  double x_from = 0.0;      // x where the value is 0
  // Only while another axis has this value.
  std::optional<std::pair<size_t, double>> only_at = {};
};

// What a run concludes, in the strongest words of the page.
struct PageVerdict {
  enum class Face { good, found, open };
  Face face = Face::good;
  std::string words;     // "Missing physics found"
  std::string sentence;  // that says which
};

// Something that was found, with its numbers.
struct PageFinding {
  std::string title;   // "magnetic dipole"
  std::string remark;  // "probability 99 %"
  std::vector<std::string> texts = {};
  std::vector<PageFigure> figures = {};
  bool from_zero = true;  // how many standard errors the figures are from zero means something
};

struct RunPage {
  std::string title;    // "nominal"
  std::string verb;     // "trace"
  std::string command;  // that makes it again
  std::string headline = {};
  std::vector<PageFigure> headlines = {};  // the few that stand at the top
  std::vector<PageFigure> figures = {};
  std::string figures_file = "summary.json";  // that has them too
  std::vector<PowerStage> power = {};
  std::optional<PageVerdict> verdict = {};
  std::string findings_title = {};
  std::vector<PageFinding> findings = {};
  std::vector<std::string> next_steps = {};  // what would tell more
  std::vector<BarChart> charts = {};
  std::vector<std::string> notes = {};
  std::optional<SceneStage> stage = {};
  std::vector<PlotCursor> cursors = {};
  Product product;  // its maps, plots and tables; quantities are not read
  Provenance provenance;
  std::optional<uint64_t> rays = {};
};

// Limits of what a page holds; what is beyond them is thinned or left to the other files, and the
// page says so.
struct PageLimits {
  size_t map_bins = 1u << 17;  // of all maps of the product together
  size_t table_rows = 200;     // of one table
  size_t curve_points = 1500;  // of one curve
  size_t triangles = 400'000;  // of the scene
};

// Equal arguments give equal bytes. Names may hold anything: none of them becomes markup or script.
std::string page_html(const RunPage& page, const PageLimits& limits = {});

}  // namespace photorque
