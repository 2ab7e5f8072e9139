// Terminal output of a run.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/product.h"

namespace photorque {

// Destinations of a run's output; output without a destination is dropped. All except `line` may be
// called from any thread.
struct ConsoleSinks {
  std::function<void(const std::string&)> line;  // text, one line per call
  // A task and its completed fraction; called often.
  std::function<void(const std::string& what, double fraction)> progress;
  std::function<void(const std::string&)> note;  // progress of a long task as text
  std::function<void()> done;                    // the task of `progress` is finished
  bool has_details = true;                       // details() are printed
};

class Console {
 public:
  // Without sinks a run has no output.
  explicit Console(ConsoleSinks sinks = {});

  void line(const std::string& text = "") const;
  void heading(const std::string& text) const;

  // Console for details that are printed only with --verbose.
  Console details() const;

  // Function for TraceOptions::progress and similar; empty without a receiver of progress.
  std::function<void(double)> progress(const std::string& what) const;
  void note_progress(const std::string& text) const;
  void done() const;

 private:
  ConsoleSinks sinks_;
};

// "79.112 ± 0.004 W": the error determines the number of digits; exact numbers have six.
std::string show(const Estimate& estimate, const std::string& unit);
// A fraction in percent with three digits: "38.2 %".
std::string show_percent(double fraction);
// A duration in seconds, minutes, hours or days with three digits: "3.4 h".
std::string show_duration(double seconds);
// Three significant digits, for checks and percentages: "2.02".
std::string show_brief(double value);
// Number of characters of a UTF-8 text.
size_t letters_of(std::string_view text);
// Pads a text to `width` characters; at least one space at the end.
std::string padded(std::string text, size_t width);
// Six significant digits, with exponents as ×10ⁿ: "1.127×10⁻⁹".
std::string show(double value);

}  // namespace photorque
