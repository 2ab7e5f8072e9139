// What a person sees while the program works.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "core/estimate.h"
#include "tools/runs/verb.h"

namespace photorque {

// Text on standard output; silent with --quiet, and with --json, where only the summary appears.
class Console {
 public:
  explicit Console(const CommandLine& line);

  void line(const std::string& text = "") const;
  void heading(const std::string& text) const;

  // A progress bar on standard error for TraceOptions::progress; nothing when that is not a
  // terminal, or when silent.
  std::function<void(double)> progress(const std::string& what);
  // The same as a line of its own on standard error where there is no terminal for a bar, at most
  // every ten seconds.
  void note_progress(const std::string& text);
  // Removes the bar.
  void done();

 private:
  bool silent_;
  bool bar_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point last_;
};

// "79.112 ± 0.004 W": as many digits as the error supports; exact numbers with six.
std::string show(const Estimate& estimate, const std::string& unit);
// "38 %" of a fraction.
std::string show_percent(double fraction);
// Filled up to `width` letters, which may have several bytes; at least one space at the end.
std::string padded(std::string text, size_t width);
// Six significant digits, exponents as ×10ⁿ: "1.127×10⁻⁹".
std::string show(double value);

}  // namespace photorque
