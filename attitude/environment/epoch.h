// Calendar times of CCSDS messages.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace photorque {

// A calendar time as days and seconds, so that differences over years keep their microseconds. Days
// have 86400 s: leap seconds are not counted.
struct Epoch {
  long day = 0;         // since 1970-01-01
  double second = 0.0;  // of the day, in [0, 86401)

  double seconds_since(const Epoch& other) const;
  Epoch after(double seconds) const;
};

// "2000-01-01T11:59:28.000" or "2000-001T11:59:28", with or without a final Z; nothing for other
// texts.
std::optional<Epoch> parse_epoch(std::string_view text);
// "2000-01-01T11:59:28.000000", rounded to the microsecond.
std::string epoch_text(const Epoch& epoch);

}  // namespace photorque
