// A run as one HTML page without network access or other files: the scene in three dimensions, maps
// and curves with values under the pointer, the power balance, figures with errors, and the
// provenance. Its script is script/page.min.js.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "images/browser/stage.h"

namespace photorque {

// A main figure with its printed label.
struct PageFigure {
  std::string key;  // as in summary.json
  std::string label;
  std::string unit;
  Estimate estimate;
};

// One stage of the waterfall of power; the first is the start.
struct PowerStage {
  std::string label;      // "absorbed by plate"
  Estimate power_W;       // power lost at this stage; for totals, the power at this point
  bool is_total = false;  // start, end, and subtotals between
};

// A plot whose x axis is that of a slider; a line in the plot follows the slider.
struct PlotCursor {
  std::string plot;
  size_t axis = 0;
  double x_per_unit = 1.0;  // scale from the value of the axis to x of the plot
  double x_from = 0.0;      // x at the value 0
  // If set: only while another axis (first) has this value (second).
  std::optional<std::pair<size_t, double>> only_at = {};
};

// HTML text of the program before and after the elements that the script draws. With it, the script
// draws only the scene, maps and curves.
struct ReportText {
  std::string before, after;
};

struct RunPage {
  std::string title;    // "nominal"
  std::string verb;     // "trace"
  std::string command;  // command that reproduces the run
  std::string headline = {};
  std::vector<PageFigure> headlines = {};  // the few figures at the top
  std::vector<PageFigure> figures = {};
  std::string figures_file = "summary.json";  // file that contains the figures, too
  std::vector<PowerStage> power = {};
  std::optional<ReportText> text = {};
  std::vector<std::string> notes = {};
  std::optional<SceneStage> stage = {};
  std::vector<PlotCursor> cursors = {};
  Product product;  // maps, plots and tables are shown; quantities are not read
  Provenance provenance;
  std::optional<uint64_t> rays = {};
};

// Limits of the content of a page. Content beyond them is thinned or only in the other files, with
// a note on the page.
struct PageLimits {
  size_t map_bins = 1u << 17;  // of all maps together
  size_t table_rows = 200;     // per table
  size_t curve_points = 1500;  // per curve
  size_t triangles = 400'000;  // of the scene
};

// Equal arguments give equal bytes. Names may contain any characters; they never become markup or
// script.
std::string page_html(const RunPage& page, const PageLimits& limits = {});

// A page of text and pictures (HTML in `body`), with the same style and without a script.
std::string text_page_html(const std::string& title, const Provenance& provenance,
                           const std::string& body);

}  // namespace photorque
