// Calendar times of CCSDS messages.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace photorque {

// A calendar time as days and seconds, so that differences over years are accurate to microseconds.
// Days have 86400 s: leap seconds are not counted.
struct Epoch {
  long day = 0;         // since 1970-01-01
  double second = 0.0;  // of the day, in [0, 86401)

  double seconds_since(const Epoch& other) const;
  Epoch after(double seconds) const;
};

// Parses "2000-01-01T11:59:28.000" or "2000-001T11:59:28", with or without a final Z; nullopt for
// other texts.
std::optional<Epoch> parse_epoch(std::string_view text);
// "2000-01-01T11:59:28.000000", rounded to the microsecond.
std::string epoch_text(const Epoch& epoch);

// Converts a calendar time in `system` to UTC. Systems: UTC, UT1 (treated as UTC, within 0.9 s),
// TAI, TT (also TDT) and GPS; nullopt for others. Leap seconds as of 2017; before 1972 TAI − UTC is
// 10 s. Source: IERS Bulletin C.
std::optional<Epoch> to_utc(const Epoch& epoch, std::string_view system);

// Angle of the Earth's zero meridian from the celestial intermediate origin at `ut1`, in [0, 2π).
// Source: IERS Conventions 2010, eq. 5.15.
double earth_rotation_angle_rad(const Epoch& ut1);
// Angle of the zero meridian from the mean equinox of date: Greenwich mean sidereal time, in [0,
// 2π). The precession uses UT1 instead of TT (error 1e-9 rad). Source: IERS Conventions 2010, eq.
// 5.32.
double greenwich_sidereal_time_rad(const Epoch& ut1);

}  // namespace photorque
