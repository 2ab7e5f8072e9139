#include "diagnosis/report/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/settings/settings.h"
#include "core/text/format.h"

namespace photorque {
namespace {

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", std::clamp(decimals, 0, 15), value);
  std::string shown = text;
  if (shown[0] == '-') shown = "−" + shown.substr(1);
  return shown;
}

int magnitude(double value) {
  return value == 0.0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-12));
}

bool reads_plain(double value) {
  const int exponent = magnitude(value);
  return exponent >= -3 && exponent < 5;
}

std::string integer(int value) {
  return (value < 0 ? "−" : "") + std::to_string(std::abs(value));
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

std::string html_number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  if (reads_plain(value)) return fixed(value, std::max(0, digits - 1 - magnitude(value)));
  const int exponent = magnitude(value);
  return fixed(value / std::pow(10.0, exponent), digits - 1) + "&nbsp;×&nbsp;10<sup>" +
         integer(exponent) + "</sup>";
}

std::string html_estimate(double value, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma) || !std::isfinite(value)) {
    const bool is_whole = value == std::round(value) && std::abs(value) < 1e5;
    return is_whole ? fixed(value, 0) : html_number(value, 4);
  }
  const int last = magnitude(sigma) - 1;
  const double largest = std::max(std::abs(value), sigma);
  if (reads_plain(largest) && last >= -6 && last <= 0) {
    return fixed(value, -last) + " ± " + fixed(sigma, -last);
  }
  const int exponent = magnitude(largest);
  const double scale = std::pow(10.0, exponent);
  const int decimals = exponent - last;
  return "(" + fixed(value / scale, decimals) + " ± " + fixed(sigma / scale, decimals) +
         ")&nbsp;×&nbsp;10<sup>" + integer(exponent) + "</sup>";
}

std::string spoken(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

std::string spoken_key(const std::string& key) {
  std::string stem = unit_of_key(key).stem;
  if (stem.empty()) stem = key;
  return xml_text(spoken(stem));
}

std::string spoken_unit(const std::string& key) {
  std::string unit = unit_of_key(key).unit;
  replace_all(unit, "_per_", "/");
  if (unit.starts_with("per_")) unit = "1/" + unit.substr(4);
  for (const char digit : {'2', '3'}) {
    replace_all(unit, std::string(1, digit), digit == '2' ? "²" : "³");
  }
  replace_all(unit, "rad_s", "rad/s");
  replace_all(unit, "N_m_s²", "N m s²");
  replace_all(unit, "m_s²", "m/s²");
  return xml_text(spoken(unit));
}

}  // namespace photorque
