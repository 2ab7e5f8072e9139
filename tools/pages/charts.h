// The charts of a diagnosis as plain data: readings, models, ranking, scans and sweeps.
#pragma once

#include <optional>

#include "core/product.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// "magnetic_dipole" as "magnetic dipole".
std::string name_in_text(std::string name);

// Blue is the improved model, vermilion the nominal model, grey the measurement: in every chart and
// in the legend of the page. Colours that are distinct for colour-blind readers: M. Okabe and K.
// Ito, "Color Universal Design" (2008).

// Torque without a law about the three axes, with bands of one standard error.
Plot empirical_plot(const EmpiricalTorque& torque);

// chi² per reading of every channel under the nominal model.
BarChart misfit_chart(const Where& where);
// The variable of which the difference is a function.
BarChart dependence_chart(const Where& where);

// Log evidence of the best alternatives; those that the recordings rule out are left out.
// `of`: which domain's, where motion and light were recorded together.
BarChart ranking_chart(const Diagnosis& diagnosis, const std::string& of = {});

// Readings with both models, if the channel has them, above the residuals of both. Held-out data
// are shaded; dotted lines show twice the noise of a reading.
Plot channel_plot(const ChannelSeries& channel, const RecordingSeries& recording);

// "tilt 12 deg, heading 60 deg"
std::string attitude_words(const Quat& lab_from_body);

// The rows of a scan at one attitude.
struct ScanGroup {
  const RecordingSeries* recording;
  Quat lab_from_body;
  std::vector<size_t> rows;
  std::string name() const { return recording->recording + ", " + attitude_words(lab_from_body); }
};
// The groups of scans of all recordings, which must outlive them.
std::vector<ScanGroup> scan_groups(const std::vector<RecordingSeries>& recordings);

// One direction of a regular grid: its first position and its step.
struct Steps {
  double first = 0.0, step = 1.0;
  size_t count = 1;
  double low() const { return first - 0.5 * step; }
  double high() const { return first + (static_cast<double>(count) - 0.5) * step; }
  std::optional<size_t> at(double value) const;
};
// The places of a scan, or, where they lie on no grid, as many as there are readings.
struct ScanGrid {
  Steps u, v;
};
ScanGrid grid_of(const ScanGroup& group);

// The maps of a scan: readings, models, differences.
struct ScanView {
  const char* name;
  const char* title;
  bool is_difference;
  double (*value)(const LightSeries&, size_t);
};
// The last, residuals of the improved model, only where an effect was found.
std::vector<ScanView> views_of_scans(bool something_was_found);

Map scan_map(const ScanGroup& group, const ScanView& shown, size_t number);

// The curves that a sweep holds, by their numbers.
std::vector<int> sweeps_of(const LightSeries& light);
// A plot of a sweep: points with both models, and their residuals.
Plot sweep_plot(const RecordingSeries& recording, int sweep, bool something_was_found);

// The array from its front as an element of a page, cells by their numbers, those that something
// found acts on marked.
std::string array_html(const DrawnArray& array);

}  // namespace photorque
