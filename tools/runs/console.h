// Terminal output of a run.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/product.h"

namespace photorque {

// Where the words of a run go; what is empty stays unsaid. All but `line` may be called from any
// thread.
struct ConsoleSinks {
  std::function<void(const std::string&)> line;  // text, a line at a time
  // A task and the fraction of it that is done, called often.
  std::function<void(const std::string& what, double fraction)> progress;
  std::function<void(const std::string&)> note;  // how far a long task is, in words
  std::function<void()> done;                    // the task of `progress` is over
  bool has_details = true;                       // details() are printed
};

class Console {
 public:
  // Without sinks a run is silent.
  explicit Console(ConsoleSinks sinks = {});

  void line(const std::string& text = "") const;
  void heading(const std::string& text) const;

  // For output of --verbose only: silent without it.
  Console details() const;

  // For TraceOptions::progress and the like; empty without a listener.
  std::function<void(double)> progress(const std::string& what) const;
  void note_progress(const std::string& text) const;
  void done() const;

 private:
  ConsoleSinks sinks_;
};

// "79.112 ± 0.004 W": as many digits as the error supports; exact numbers with six.
std::string show(const Estimate& estimate, const std::string& unit);
// "38.2 %" of a fraction, three digits.
std::string show_percent(double fraction);
// "3.4 h": seconds, minutes, hours or days, three digits.
std::string show_duration(double seconds);
// Three significant digits, for checks and percentages: "2.02".
std::string show_brief(double value);
// The number of letters of a text in UTF-8, which may have several bytes each.
size_t letters_of(std::string_view text);
// Filled up to `width` letters; at least one space at the end.
std::string padded(std::string text, size_t width);
// Six significant digits, exponents as ×10ⁿ: "1.127×10⁻⁹".
std::string show(double value);

}  // namespace photorque
