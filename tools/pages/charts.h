// Charts of a diagnosis as plain data: readings, models, ranking, scans and sweeps.
#pragma once

#include <optional>

#include "core/product.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Converts "magnetic_dipole" to "magnetic dipole".
std::string name_in_text(std::string name);

// In every chart and in the legend of the page, blue is the improved model, vermilion the nominal
// model, grey the measurement. The colours are distinct for colour-blind readers: M. Okabe and K.
// Ito, "Color Universal Design" (2008).

// Empirical torque about the three axes, with bands of one standard error.
Plot empirical_plot(const EmpiricalTorque& torque);

// chi² per reading of every channel under the nominal model.
BarChart misfit_chart(const Where& where);
// The variables on which the difference depends.
BarChart dependence_chart(const Where& where);

// Log evidence of the best alternatives, without those that the recordings rule out. `of`: the
// domain, if motion and light were recorded together.
BarChart ranking_chart(const Diagnosis& diagnosis, const std::string& of = {});

// Readings with both models, if the channel has them, above the residuals of both. Held-out data
// are shaded; dotted lines show twice the noise of a reading.
Plot channel_plot(const ChannelSeries& channel, const RecordingSeries& recording);

// Text such as "tilt 12 deg, heading 60 deg".
std::string attitude_words(const Quat& lab_from_body);

// Rows of a scan at one attitude.
struct ScanGroup {
  const RecordingSeries* recording;
  Quat lab_from_body;
  std::vector<size_t> rows;
  std::string name() const { return recording->recording + ", " + attitude_words(lab_from_body); }
};
// Groups of the scans of all recordings; the recordings must outlive them.
std::vector<ScanGroup> scan_groups(const std::vector<RecordingSeries>& recordings);

// One axis of a regular grid: its first position and its step.
struct Steps {
  double first = 0.0, step = 1.0;
  size_t count = 1;
  double low() const { return first - 0.5 * step; }
  double high() const { return first + (static_cast<double>(count) - 0.5) * step; }
  std::optional<size_t> at(double value) const;
};
// Grid of the positions of a scan. If they do not lie on a grid, the number of cells follows from
// the number of readings.
struct ScanGrid {
  Steps u, v;
};
ScanGrid grid_of(const ScanGroup& group);

// Maps of a scan: readings, models, differences.
struct ScanView {
  const char* name;
  const char* title;
  bool is_difference;
  double (*value)(const LightSeries&, size_t);
};
// The residuals of the improved model, the last view, are included only if an effect was found.
std::vector<ScanView> views_of_scans(bool something_was_found);

// Map of one view of a scan; `number` makes its name unique.
Map scan_map(const ScanGroup& group, const ScanView& shown, size_t number);

// Numbers of the sweeps in a recording.
std::vector<int> sweeps_of(const LightSeries& light);
// Plot of a sweep: points with both models, and their residuals.
Plot sweep_plot(const RecordingSeries& recording, int sweep, bool something_was_found);

// HTML of the array seen from its front, with the numbers of the cells. Cells affected by a found
// effect are marked.
std::string array_html(const DrawnArray& array);

}  // namespace photorque
