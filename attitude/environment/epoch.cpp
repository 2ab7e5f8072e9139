#include "attitude/environment/epoch.h"

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace photorque {
namespace {

constexpr double day_s = 86400.0;

template <class Number>
bool take_number(std::string_view& text, size_t length, Number& value) {
  if (text.size() < length) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + length, value);
  if (error != std::errc() || end != text.data() + length) return false;
  text.remove_prefix(length);
  return true;
}

bool take(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

// "01-01" or "001" of a year, as a day.
std::optional<long> take_day(std::string_view& text, int year) {
  using namespace std::chrono;
  const std::chrono::year y{year};
  if (text.size() > 3 && text[3] == 'T') {
    int of_year = 0;
    const int length = y.is_leap() ? 366 : 365;
    if (!take_number(text, 3, of_year) || of_year < 1 || of_year > length) return std::nullopt;
    return (sys_days{y / January / 1} + days{of_year - 1}).time_since_epoch().count();
  }
  unsigned month = 0, day = 0;
  if (!take_number(text, 2, month) || !take(text, '-') || !take_number(text, 2, day)) {
    return std::nullopt;
  }
  const year_month_day date = y / std::chrono::month{month} / std::chrono::day{day};
  if (!date.ok()) return std::nullopt;
  return sys_days{date}.time_since_epoch().count();
}

}  // namespace

double Epoch::seconds_since(const Epoch& other) const {
  return day_s * static_cast<double>(day - other.day) + (second - other.second);
}

Epoch Epoch::after(double seconds) const {
  const double whole_days = std::floor((second + seconds) / day_s);
  return {day + static_cast<long>(whole_days), second + seconds - whole_days * day_s};
}

std::optional<Epoch> parse_epoch(std::string_view text) {
  if (text.ends_with('Z')) text.remove_suffix(1);
  int year = 0, hour = 0, minute = 0;
  if (!take_number(text, 4, year) || !take(text, '-')) return std::nullopt;
  const std::optional<long> day = take_day(text, year);
  if (!day || !take(text, 'T') || !take_number(text, 2, hour) || !take(text, ':') ||
      !take_number(text, 2, minute) || !take(text, ':')) {
    return std::nullopt;
  }
  double second = 0.0;
  if (text.size() < 2 || !take_number(text, text.size(), second)) return std::nullopt;
  // 60 s and more: a leap second.
  if (hour < 0 || hour > 23 || minute < 0 || minute > 59 || !(second >= 0.0 && second < 61.0)) {
    return std::nullopt;
  }
  return Epoch{*day, 3600.0 * hour + 60.0 * minute + second};
}

std::string epoch_text(const Epoch& epoch) {
  using namespace std::chrono;
  long day = epoch.day;
  long long microseconds = std::llround(epoch.second * 1e6);
  constexpr long long day_us = 86400000000LL;
  if (microseconds >= day_us) {
    microseconds -= day_us;
    ++day;
  }
  const year_month_day date{sys_days{days{day}}};
  const long long seconds = microseconds / 1000000;
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02lld:%02lld:%02lld.%06lld",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), seconds / 3600, seconds / 60 % 60, seconds % 60,
                microseconds % 1000000);
  return text;
}

}  // namespace photorque
