#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "tools/pages/charts.h"
#include "tools/pages/parts.h"

namespace photorque {
namespace {

constexpr size_t most_diagnosed_states = 4000;  // of all recordings together

const ChannelSeries* series_channel(const RecordingSeries& recording, const std::string& name) {
  const auto at = std::ranges::find(recording.channels, name, &ChannelSeries::name);
  return at == recording.channels.end() || at->time_s.empty() ? nullptr : &*at;
}

double series_at(const ChannelSeries* channel, const std::vector<double> ChannelSeries::*values,
                 double time_s) {
  if (channel == nullptr || (channel->*values).empty()) return NAN;
  return (channel->*values)[nearest_instant(channel->time_s, time_s)];
}

std::string rate_channel(int axis) {
  return std::string("gyro_") + "xyz"[axis] + "_rad_s";
}

// Instants of the attitude; without attitude, those of the first channel with readings.
const std::vector<double>& own_instants(const RecordingSeries& recording) {
  if (!recording.attitude.time_s.empty()) return recording.attitude.time_s;
  return std::ranges::find_if(recording.channels, [](const auto& c) { return !c.time_s.empty(); })
      ->time_s;
}

// Instants of the slider: those of a single recording, or equally spaced over the longest of
// several recordings, each from its start.
std::vector<double> instants(const std::vector<RecordingSeries>& recordings,
                             const std::vector<Where::Interval>& spans) {
  const size_t most = std::clamp<size_t>(most_diagnosed_states / recordings.size(), 100, 1500);
  std::vector<double> at;
  if (recordings.size() == 1) {
    const std::vector<double>& own = own_instants(recordings.front());
    for (const size_t i : even_indices(own.size(), most)) {
      if (at.empty() || own[i] > at.back()) at.push_back(own[i]);
    }
    return at;
  }
  double longest_s = 0.0;
  for (const auto& [from, to] : spans) longest_s = std::max(longest_s, to - from);
  for (size_t i = 0; i < most; ++i) {
    at.push_back(longest_s * static_cast<double>(i) / static_cast<double>(most - 1));
  }
  return at;
}

// Almost the largest magnitude of some numbers: the 99th percentile, without outliers.
double nearly_largest(std::vector<double> lengths) {
  std::erase_if(lengths, [](double length) { return !std::isfinite(length); });
  for (double& length : lengths) length = std::abs(length);
  if (lengths.empty()) return 0.0;
  const auto at =
      lengths.begin() + static_cast<ptrdiff_t>(0.99 * static_cast<double>(lengths.size() - 1));
  std::ranges::nth_element(lengths, at);
  return *at;
}

std::vector<double> lengths_of(const std::vector<RecordingSeries>& recordings,
                               const std::vector<Vec3> AttitudeSeries::*of) {
  std::vector<double> lengths;
  for (const RecordingSeries& recording : recordings) {
    for (const Vec3& v : recording.attitude.*of) lengths.push_back(v.norm());
  }
  return lengths;
}

// Factor (1, 2, 5, 10 …) that makes differences visible: differences become at most 10 deg, noise
// at most 1 deg.
double enlargement(double largest_rad, double noise_rad) {
  const double most = std::min(10.0 * degree_rad / std::max(largest_rad, 1e-12),
                               1.0 * degree_rad / std::max(noise_rad, 1e-12));
  double factor = 1.0;
  for (const double next :
       {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0}) {
    if (next <= most) factor = next;
  }
  return factor;
}

void add_attitude_figures(const RecordingSeries& recording, const Quat& q, double time_s,
                          StageState& state) {
  const Vec3 up_lab = q * Vec3::UnitZ();
  state.figures.push_back({std::atan2(up_lab.head<2>().norm(), up_lab.z()) / degree_rad, 0.0});
  state.figures.push_back({std::atan2(up_lab.y(), up_lab.x()) / degree_rad, 0.0});
  for (int k = 0; k < 3; ++k) {
    const ChannelSeries* channel = series_channel(recording, rate_channel(k));
    state.figures.push_back({series_at(channel, &ChannelSeries::measured, time_s),
                             channel == nullptr ? 0.0 : channel->noise});
  }
}

// Mean of the rotation vectors near an instant, and its standard error from the noise of the camera
// or from their scatter, whichever is larger.
struct MeanRotation {
  Vec3 mean_rad = Vec3::Zero(), error_rad = Vec3::Zero();
};

MeanRotation mean_about(const AttitudeSeries& a, const std::vector<Vec3>& off_rad, size_t at) {
  const double half_s = 0.0025 * (a.time_s.back() - a.time_s.front());
  const size_t from = nearest_instant(a.time_s, a.time_s[at] - half_s),
               to = nearest_instant(a.time_s, a.time_s[at] + half_s) + 1;
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero(), variance = Vec3::Zero();
  double count = 0.0;
  for (size_t i = from; i < to; ++i) {
    if (!off_rad[i].allFinite()) continue;
    sum += off_rad[i];
    squares += off_rad[i].cwiseAbs2();
    variance += a.error_rad[i].cwiseAbs2();
    count += 1.0;
  }
  if (!(count > 0.0)) return {Vec3::Constant(NAN), Vec3::Zero()};
  const Vec3 mean = sum / count;
  const Vec3 scatter = (squares / count - mean.cwiseAbs2()).cwiseMax(0.0);
  return {mean, (variance / count).cwiseMax(scatter).cwiseSqrt() / std::sqrt(count)};
}

// Slider over several recordings, the second axis of the stage; numbered from 1.
StageAxis recording_axis(const std::vector<RecordingSeries>& recordings) {
  StageAxis axis{"recording", "", {}};
  for (const RecordingSeries& recording : recordings) {
    axis.values.push_back(static_cast<double>(axis.values.size() + 1));
    axis.names.push_back(recording.recording + (recording.is_held_out ? ", held out" : ""));
  }
  return axis;
}

class MotionStage {
 public:
  MotionStage(const std::vector<RecordingSeries>& recordings, bool found, SceneStage& stage)
      : recordings_(recordings), found_(found), stage_(stage) {
    for (const RecordingSeries& recording : recordings) spans_.push_back(span_of(recording));
    has_attitude_ = std::ranges::all_of(recordings, [](const RecordingSeries& r) {
      return !r.attitude.measured.empty() && !r.attitude.off_before_rad.empty();
    });
  }

  const std::vector<Where::Interval>& spans() const { return spans_; }

  void fill() {
    stage_.paintings.clear();
    stage_.lamps.clear();
    stage_.states.clear();
    stage_.arrows.clear();
    has_attitude_ ? prepare_attitude() : prepare_rates();
    const std::vector<double> at = instants(recordings_, spans_);
    const bool several = recordings_.size() > 1;
    for (size_t r = 0; r < recordings_.size(); ++r) {
      for (const double time_s : at) {
        const double own_s = several ? std::min(spans_[r].from + time_s, spans_[r].to) : time_s;
        stage_.states.push_back(has_attitude_ ? attitude_state(recordings_[r], own_s)
                                              : rate_state(recordings_[r], own_s));
      }
    }
    stage_.axes = {{several ? "time from its start" : "time", "s", at, true}};
    if (several) stage_.axes.push_back(recording_axis(recordings_));
  }

 private:
  void prepare_attitude() {
    const double largest_rad = std::max(
        nearly_largest(lengths_of(recordings_, &AttitudeSeries::off_before_rad)),
        found_ ? nearly_largest(lengths_of(recordings_, &AttitudeSeries::off_after_rad)) : 0.0);
    const double noise_rad = nearly_largest(lengths_of(recordings_, &AttitudeSeries::error_rad));
    factor_ = enlargement(largest_rad, noise_rad);
    in_degrees_ = largest_rad > 2.0 * degree_rad;
    const std::string times = factor_ > 1.0 ? ", difference × " + factor_text() : "";
    stage_.bodies = {"measured", "nominal" + times};
    if (found_) stage_.bodies.push_back("found" + times);
    add_difference_arrows(in_degrees_ ? "deg" : "arcsec", largest_rad / unit_rad());
    stage_.figures = {{"tilt, measured", "deg"}, {"heading, measured", "deg"}};
    for (const char axis : {'x', 'y', 'z'}) {
      stage_.figures.push_back({std::string("rate about body ") + axis + ", measured", "rad/s"});
    }
    add_sentence(stage_.remark,
                 "Arrows: the turn from a model to what was measured, a mean over 1/200 of the "
                 "recording about the instant; found: the improved model.");
    if (factor_ > 1.0) {
      add_sentence(stage_.remark,
                   "The models are drawn with their difference from what was "
                   "measured enlarged, " +
                       factor_text() + " times.");
    }
  }

  void prepare_rates() {
    double largest = 0.0;
    for (const RecordingSeries& recording : recordings_) {
      for (int k = 0; k < 3; ++k) {
        const ChannelSeries* channel = series_channel(recording, rate_channel(k));
        if (channel == nullptr) continue;
        largest = std::max(largest, nearly_largest(channel->residual_before));
        if (found_) largest = std::max(largest, nearly_largest(channel->residual_after));
      }
    }
    stage_.bodies = {"platform"};
    add_difference_arrows("rad/s", largest);
    stage_.arrows.push_back({"measured rate", "rad/s", StageArrow::Kind::turn});
    add_sentence(stage_.remark,
                 "The recordings show no attitude: the body is drawn in its own "
                 "axes, with its rate as an arrow.");
  }

  void add_difference_arrows(const std::string& unit, double largest) {
    // Both arrows have the same scale, so that the decrease of the residuals is visible.
    const double m_per_unit = largest > 0.0 ? 0.95 * stage_.radius_m / largest : 0.0;
    stage_.arrows.push_back({"measured − nominal", unit, StageArrow::Kind::turn, m_per_unit});
    if (found_) {
      stage_.arrows.push_back({"measured − found", unit, StageArrow::Kind::turn, m_per_unit});
    }
  }

  double unit_rad() const { return in_degrees_ ? degree_rad : arcsecond_rad; }
  std::string factor_text() const { return std::to_string(static_cast<int>(factor_)); }

  StageState attitude_state(const RecordingSeries& recording, double time_s) const {
    const AttitudeSeries& a = recording.attitude;
    const size_t i = nearest_instant(a.time_s, time_s);
    const Quat& q = a.measured[i];
    const Mat3 body_from_lab = q.conjugate().toRotationMatrix();
    StageState state;
    state.lab_from_body.push_back(q);
    const auto add = [&](const std::vector<Vec3>& off) {
      const auto [off_rad, error_rad] = mean_about(a, off, i);
      const Vec3 shown_rad = off_rad.allFinite() ? Vec3(factor_ * off_rad) : Vec3::Zero();
      state.lab_from_body.push_back((turn_by(-shown_rad) * q).normalized());
      const bool is_known = off_rad.allFinite();
      state.arrow_body.push_back(is_known ? Vec3(body_from_lab * off_rad / unit_rad())
                                          : Vec3::Zero());
      state.arrow_error_body.push_back(
          is_known
              ? Vec3((body_from_lab.cwiseAbs2() * error_rad.cwiseAbs2()).cwiseSqrt() / unit_rad())
              : Vec3::Zero());
    };
    add(a.off_before_rad);
    if (found_) add(a.off_after_rad);
    add_attitude_figures(recording, q, time_s, state);
    return state;
  }

  StageState rate_state(const RecordingSeries& recording, double time_s) const {
    StageState state;
    state.lab_from_body.push_back(Quat::Identity());
    Vec3 noise = Vec3::Zero();
    const auto add = [&](const std::vector<double> ChannelSeries::*of) {
      Vec3 value = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        const ChannelSeries* channel = series_channel(recording, rate_channel(k));
        const double read = series_at(channel, of, time_s);
        if (std::isfinite(read)) value[k] = read;
        noise[k] = channel == nullptr ? 0.0 : channel->noise;
      }
      state.arrow_body.push_back(value);
      state.arrow_error_body.push_back(noise);
    };
    add(&ChannelSeries::residual_before);
    if (found_) add(&ChannelSeries::residual_after);
    add(&ChannelSeries::measured);
    return state;
  }

  const std::vector<RecordingSeries>& recordings_;
  bool found_;
  SceneStage& stage_;
  std::vector<Where::Interval> spans_;
  bool has_attitude_ = false, in_degrees_ = false;
  double factor_ = 1.0;
};

}  // namespace

std::vector<size_t> even_indices(size_t count, size_t most) {
  const size_t shown = std::min(count, most);
  std::vector<size_t> indices;
  for (size_t i = 0; i < shown; ++i) {
    indices.push_back(shown == 1 ? 0 : i * (count - 1) / (shown - 1));
  }
  return indices;
}

Where::Interval span_of(const RecordingSeries& recording) {
  Where::Interval span{1e300, -1e300};
  const auto extend = [&](const std::vector<double>& time_s) {
    if (time_s.empty()) return;
    span = {std::min(span.from, time_s.front()), std::max(span.to, time_s.back())};
  };
  extend(recording.attitude.time_s);
  for (const ChannelSeries& channel : recording.channels) extend(channel.time_s);
  return span;
}

size_t nearest_instant(const std::vector<double>& time_s, double at_s) {
  const auto after = std::ranges::lower_bound(time_s, at_s);
  if (after == time_s.begin()) return 0;
  const auto i = static_cast<size_t>(after - time_s.begin());
  return i == time_s.size() || at_s - time_s[i - 1] < time_s[i] - at_s ? i - 1 : i;
}

void add_sentence(std::string& text, const std::string& sentence) {
  text += (text.empty() ? "" : " ") + sentence;
}

void add_curves(const RecordingSeries& recording, const std::string& suffix,
                const std::optional<PlotCursor>& cursor, RunPage& page) {
  static constexpr const char* models[] = {"nominal model", "improved model"};
  const auto name_residuals = [](std::vector<Plot::Curve>& curves) {
    for (size_t i = 0; i < curves.size(); ++i) {
      curves[i].label = std::string("residual, ") + (i == 0 ? "nominal" : "improved");
    }
  };
  for (const ChannelSeries& channel : recording.channels) {
    if (channel.time_s.empty()) continue;
    Plot plot = channel_plot(channel, recording);
    plot.name = channel.name + suffix;
    if (!suffix.empty()) plot.title += ", " + recording.recording;
    if (channel.measured.empty()) {
      name_residuals(plot.curves);
    } else {
      plot.curves[0].label = "measured";
      for (size_t i = 0; i < 2; ++i) plot.curves[i + 1].label = models[i];
      name_residuals(plot.below.front().curves);
    }
    if (cursor) {
      page.cursors.push_back(*cursor);
      page.cursors.back().plot = plot.name;
    }
    page.product.plots.push_back(std::move(plot));
  }
}

void show_motion(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                 SceneStage stage, RunPage& page) {
  std::vector<RecordingSeries> drawn;
  for (const RecordingSeries& recording : recordings) {
    const Where::Interval span = span_of(recording);
    if (span.from < span.to) drawn.push_back(recording);
  }
  if (drawn.empty()) return;
  MotionStage motion(drawn, something_was_found, stage);
  motion.fill();
  page.stage = std::move(stage);
  if (drawn.size() == 1) {
    add_curves(drawn.front(), "", PlotCursor{"", 0}, page);
    return;
  }
  for (size_t r = 0; r < drawn.size(); ++r) {
    PlotCursor cursor{"", 0, 1.0, motion.spans()[r].from};
    cursor.only_at = {1, static_cast<double>(r + 1)};
    add_curves(drawn[r], "_of_recording_" + std::to_string(r + 1), cursor, page);
  }
}

}  // namespace photorque
