#include "tools/runs/console.h"

#include <algorithm>
#include <cmath>

#include "core/text/format.h"

namespace photorque {
namespace {

std::string fixed(double value, int decimals) {
  return printed("%.*f", std::clamp(decimals, 0, 15), value);
}

int magnitude(double value) {
  return static_cast<int>(std::floor(std::log10(std::abs(value))));
}

}  // namespace

Console::Console(ConsoleSinks sinks) : sinks_(std::move(sinks)) {}

void Console::line(const std::string& text) const {
  if (sinks_.line) sinks_.line(text);
}

void Console::heading(const std::string& text) const {
  line();
  line(text);
}

Console Console::details() const {
  if (sinks_.has_details) return *this;
  ConsoleSinks sinks = sinks_;
  sinks.line = {};
  return Console(std::move(sinks));
}

std::function<void(double)> Console::progress(const std::string& what) const {
  if (!sinks_.progress) return {};
  return [progress = sinks_.progress, what](double fraction) { progress(what, fraction); };
}

void Console::note_progress(const std::string& text) const {
  if (sinks_.note) sinks_.note(text);
}

void Console::done() const {
  if (sinks_.done) sinks_.done();
}

std::string show(double value) {
  if (!std::isfinite(value)) return "not a number";
  if (value == 0.0) return "0";
  const int exponent = magnitude(value);
  if (exponent >= -3 && exponent < 6) {
    std::string text = fixed(value, 5 - exponent);
    if (text.find('.') != std::string::npos) {
      text.erase(text.find_last_not_of('0') + 1);
      if (text.back() == '.') text.pop_back();
    }
    return text;
  }
  return fixed(value / std::pow(10.0, exponent), 4) + "×" + power_of_ten(exponent);
}

std::string show(const Estimate& estimate, const std::string& unit) {
  const double error = estimate.standard_error;
  const std::string end = unit.empty() ? "" : " " + unit;
  if (std::isinf(error)) return show(estimate.value) + end + " (undetermined)";
  // The scatter of equal samples due to rounding is not an error.
  const double rounding = 1e-12 * std::abs(estimate.value);
  if (!(error > rounding)) return show(estimate.value) + end;
  // Two digits of the rounded error determine the number of digits of the value, up to eight.
  const double largest = std::max(std::abs(estimate.value), error);
  const int exponent = magnitude(largest);
  const int last = std::max(magnitude(error / 0.995) - 1, exponent - 7);
  if (exponent >= -3 && exponent < 6) {
    const double shown = std::max(error, std::pow(10.0, last));
    return fixed(estimate.value, std::max(0, -last)) + " ± " + fixed(shown, std::max(0, -last)) +
           end;
  }
  const double scale = std::pow(10.0, exponent);
  const int decimals = exponent - last;
  return "(" + fixed(estimate.value / scale, decimals) + " ± " + fixed(error / scale, decimals) +
         ")×" + power_of_ten(exponent) + end;
}

std::string show_percent(double fraction) {
  const double percent = 100.0 * fraction;
  // A fraction slightly below 1 must not be printed as 100 %.
  const bool is_nearly_all = percent != 100.0 && show_brief(percent) == "100";
  return (is_nearly_all ? show(1e-3 * std::round(1e3 * percent)) : show_brief(percent)) + " %";
}

std::string show_brief(double value) {
  if (value == 0.0 || !std::isfinite(value)) return show(value);
  const int exponent = magnitude(value);
  if (exponent >= 6 || exponent < -3)
    return fixed(value / std::pow(10.0, exponent), 1) + "×" + power_of_ten(exponent);
  const double unit = std::pow(10.0, exponent - 2);
  return show(std::round(value / unit) * unit);
}

std::string show_duration(double seconds) {
  const double size = std::abs(seconds);
  if (size < 120.0) return show_brief(seconds) + " s";
  if (size < 7200.0) return show_brief(seconds / 60.0) + " min";
  if (size < 259200.0) return show_brief(seconds / 3600.0) + " h";
  return show_brief(seconds / 86400.0) + " d";
}

size_t letters_of(std::string_view text) {
  return static_cast<size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

std::string padded(std::string text, size_t width) {
  const size_t letters = letters_of(text);
  return letters < width ? text + std::string(width - letters, ' ') : text + " ";
}

}  // namespace photorque
