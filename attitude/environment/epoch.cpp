#include "attitude/environment/epoch.h"

#include <array>
#include <charconv>
#include <chrono>
#include <cmath>

#include "core/constants.h"
#include "core/text/format.h"

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

// Parses "01-01" or "001" of a year. Returns the day since 1970-01-01.
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
  // Seconds from 60 on are a leap second.
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
  return printed("%04d-%02u-%02uT%02lld:%02lld:%02lld.%06lld", static_cast<int>(date.year()),
                 static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                 seconds / 3600, seconds / 60 % 60, seconds % 60, microseconds % 1000000);
}

namespace {

// First days on which TAI − UTC is 10 s, 11 s, and so on.
constexpr std::array leap_days = {
    "1972-01-01", "1972-07-01", "1973-01-01", "1974-01-01", "1975-01-01", "1976-01-01",
    "1977-01-01", "1978-01-01", "1979-01-01", "1980-01-01", "1981-07-01", "1982-07-01",
    "1983-07-01", "1985-07-01", "1988-01-01", "1990-01-01", "1991-01-01", "1992-07-01",
    "1993-07-01", "1994-07-01", "1996-01-01", "1997-07-01", "1999-01-01", "2006-01-01",
    "2009-01-01", "2012-07-01", "2015-07-01", "2017-01-01"};

double tai_minus_utc_s(const Epoch& tai) {
  constexpr double first_s = 10.0;
  double difference_s = first_s;
  for (size_t i = 1; i < leap_days.size(); ++i) {
    const Epoch midnight = *parse_epoch(std::string(leap_days[i]) + "T00:00:00");
    // The second before the new difference is the leap second.
    const double next_s = first_s + static_cast<double>(i);
    if (tai.seconds_since(midnight) >= next_s) difference_s = next_s;
  }
  return difference_s;
}

double days_since_J2000(const Epoch& epoch) {
  return epoch.seconds_since(*parse_epoch("2000-01-01T12:00:00")) / day_s;
}

double within_one_turn(double turns) {
  return 2.0 * pi * (turns - std::floor(turns));
}

}  // namespace

std::optional<Epoch> to_utc(const Epoch& epoch, std::string_view system) {
  constexpr double tt_minus_tai_s = 32.184, tai_minus_gps_s = 19.0;
  double to_tai_s = 0.0;
  if (system == "UTC" || system == "UT1") return epoch;
  if (system == "TT" || system == "TDT") {
    to_tai_s = -tt_minus_tai_s;
  } else if (system == "GPS") {
    to_tai_s = tai_minus_gps_s;
  } else if (system != "TAI") {
    return std::nullopt;
  }
  const Epoch tai = epoch.after(to_tai_s);
  return tai.after(-tai_minus_utc_s(tai));
}

double earth_rotation_angle_rad(const Epoch& ut1) {
  const double days = days_since_J2000(ut1), whole = std::floor(days);
  return within_one_turn(0.7790572732640 + (days - whole) + 0.00273781191135448 * days);
}

double greenwich_sidereal_time_rad(const Epoch& ut1) {
  const double centuries = days_since_J2000(ut1) / 36525.0;
  const double precession_arcsec =
      0.014506 + centuries * (4612.156534 + centuries * (1.3915817 - 4.4e-7 * centuries));
  return within_one_turn(earth_rotation_angle_rad(ut1) / (2.0 * pi) +
                         precession_arcsec / (360.0 * 3600.0));
}

}  // namespace photorque
