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
  bool is_total = false;  // start, end, and the remainders between
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

// Text that the program writes itself, as HTML: before and after what the script draws, which is
// then the scene, maps and curves alone.
struct ReportText {
  std::string before, after;
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
  std::optional<ReportText> text = {};
  std::vector<std::string> notes = {};
  std::optional<SceneStage> stage = {};
  std::vector<PlotCursor> cursors = {};
  Product product;  // its maps, plots and tables; quantities are not read
  Provenance provenance;
  std::optional<uint64_t> rays = {};
};

// Limits of what a page holds; what is beyond them is thinned or left to the other files, and the
// page notes it.
struct PageLimits {
  size_t map_bins = 1u << 17;  // of all maps of the product together
  size_t table_rows = 200;     // of one table
  size_t curve_points = 1500;  // of one curve
  size_t triangles = 400'000;  // of the scene
};

// Equal arguments give equal bytes. Names may hold anything: none of them becomes markup or script.
std::string page_html(const RunPage& page, const PageLimits& limits = {});

// A page of text and drawn pictures (HTML in `body`), with the same look and without a script.
std::string text_page_html(const std::string& title, const Provenance& provenance,
                           const std::string& body);

}  // namespace photorque
