#include "diagnosis/guess/header.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <span>

#include "core/settings/settings.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

constexpr const char* greek[] = {"alpha",   "beta", "gamma", "delta",  "epsilon", "zeta", "eta",
                                 "theta",   "iota", "kappa", "lambda", "mu",      "nu",   "xi",
                                 "omicron", "pi",   "rho",   "sigma",  "sigma",   "tau",  "upsilon",
                                 "phi",     "chi",  "psi",   "omega"};
// U+00C0 to U+00FF without accents.
constexpr std::string_view latin =
    "AAAAAAACEEEEIIIIDNOOOOO OUUUUYTsaaaaaaaceeeeiiiidnooooo/ouuuuyty";

// ASCII for one other character. Greek letters become words.
std::string in_ascii(uint32_t code, bool of_unit) {
  switch (code) {
    case 0xB0:
    case 0xBA:   // ordinal indicator
    case 0x2DA:  // ring above
      return "deg";
    case 0xB5:
    case 0x3BC:
      if (of_unit) return "u";
      break;
    case 0xB9:
      return "1";
    case 0xB2:
      return "2";
    case 0xB3:
      return "3";
    case 0x207B:  // superscript minus, minus, dashes
    case 0x2212:
    case 0x2010:
    case 0x2011:
    case 0x2013:
    case 0x2014:
      return "-";
    case 0x2044:
    case 0x2215:
      return "/";
    case 0x3D1:
      return " theta ";
    case 0x3D5:
      return " phi ";
    case 0x3A9:
    case 0x2126:  // ohm sign
      return of_unit ? "ohm" : " omega ";
    // Subscripts and superscripts. Unicode has no subscript y; a small gamma serves as one.
    case 0x2B8:
    case 0x1D67:
      return "y";
    case 0x2E3:
    case 0x1D6A:
      return "x";
    case 0x1DBB:
      return "z";
    case 0x307:  // combining dots: derivatives
      return " dot ";
    default:
      break;
  }
  if (code >= 0x2080 && code <= 0x2089) return std::string(1, "0123456789"[code - 0x2080]);
  if (code >= 0x2090 && code <= 0x209C) return std::string(1, "aeoxehklmnpst"[code - 0x2090]);
  if (code >= 0x1D62 && code <= 0x1D65) return std::string(1, "iruv"[code - 0x1D62]);
  if (code >= 0xC0 && code <= 0xFF) return std::string(1, latin[code - 0xC0]);
  if (code >= 0x391 && code <= 0x3A9) return std::string(" ") + greek[code - 0x391] + " ";
  if (code >= 0x3B1 && code <= 0x3C9) return std::string(" ") + greek[code - 0x3B1] + " ";
  if (code >= 0x300 && code <= 0x36F) return "";
  return " ";
}

std::string ascii_of(std::string_view text, bool of_unit) {
  std::string ascii;
  bool after_greek = false;
  for (size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const size_t length = byte < 0x80 ? 1 : byte < 0xE0 ? 2 : byte < 0xF0 ? 3 : 4;
    uint32_t code = length == 1 ? byte : byte & (0xFFU >> (length + 1));
    for (size_t k = 1; k < length && i + k < text.size(); ++k) {
      code = code << 6U | (static_cast<unsigned char>(text[i + k]) & 0x3FU);
    }
    i += length;
    if (code < 0x80) {
      ascii += static_cast<char>(code);
    } else if (code == 0x308 && after_greek) {
      ascii += " ddot ";
    } else {
      ascii += in_ascii(code, of_unit);
    }
    after_greek = code >= 0x391 && code <= 0x3D5;
  }
  return ascii;
}

// Spellings of a unit, with commas between them.
struct Spelling {
  const char *suffix, *dimension, *words;
};

constexpr Spelling spellings[] = {
    {"rpm", "angular rate", "rpm,upm"},
    {"rev_s", "angular rate", "rps"},
    {"deg_s", "angular rate", "dps"},
    {"mdeg_s", "angular rate", "mdps"},
    {"", "angle", "gon,mgon,count,counts,tick,ticks,lsb"},
    {"", "length", "au"},
    {"rev_s", "frequency", "hz,hertz"},
    {"m_s2", "acceleration", "m/s2,m/s/s,m s-2,ms-2"},
    {"", "acceleration", "g,mg"},
    {"", "angular acceleration", "rad/s2,rad/s/s,deg/s2,deg/s/s,rad s-2,deg s-2"},
    {"mph", "speed", "mph"},
    {"km_h", "speed", "kmh,kph"},
    {"", "speed", "knots"},
    {"", "power", "watt,watts,milliwatt,milliwatts"},
    {"", "resistance", "ohm,ohms,kohm,mohm"},
    {"", "illuminance", "lux,lx,klx"},
    {"V", "voltage", "volt,volts,voltios"},
    {"mV", "voltage", "millivolt,millivolts"},
    {"A", "current", "amp,amps,ampere,amperes,amperios"},
    {"mA", "current", "milliampere,milliamps"},
    {"s", "time",
     "s,sec,secs,second,seconds,sek,sekunde,sekunden,seconde,secondes,seg,segs,segundo,segundos,"
     "secondo,secondi"},
    {"ms", "time",
     "ms,msec,msecs,millis,millisecond,milliseconds,millisekunde,millisekunden,milliseconde,"
     "millisecondes,milisegundo,milisegundos,millisecondo,millisecondi,milissegundo,"
     "milissegundos"},
    {"us", "time",
     "us,usec,usecs,micros,microsecond,microseconds,mikrosekunde,mikrosekunden,microseconde,"
     "microsecondes,microsegundo,microsegundos,microsecondo,microsecondi,microssegundos"},
    {"min", "time", "min,mins,mn,minute,minutes,minuten,minuto,minutos,minuti"},
    {"h", "time", "h,hr,hrs,hour,hours,std,stunde,stunden,heure,heures,hora,horas,ora,ore"},
    {"rad", "angle",
     "rad,rads,radian,radians,radiant,radianten,radianes,radianti,radiano,radianos,bogenmass"},
    {"mrad", "angle", "mrad,mrads,milliradian,milliradians"},
    {"urad", "angle", "urad,urads,microradian,microradians"},
    {"mdeg", "angle", "mdeg,mdegs,millideg,millidegs,millidegree,millidegrees"},
    {"deg", "angle",
     "deg,degs,degree,degrees,grad,graden,grader,stopni,grados,grado,gradi,graus,grau,degre,"
     "degres"},
    {"arcsec", "angle", "arcsec,arcsecs,arcsecond,arcseconds,bogensekunde,bogensekunden"},
    {"arcmin", "angle", "arcmin,arcmins,arcminute,arcminutes,bogenminute,bogenminuten"},
    {"rev", "angle",
     "rev,revs,revolution,revolutions,turn,turns,umdrehung,umdrehungen,vuelta,vueltas"},
    {"m", "length", "m,meter,meters,metre,metres,metro,metros,metri"},
    {"cm", "length",
     "cm,centimeter,centimeters,centimetre,centimetres,zentimeter,centimetros,centimetri"},
    {"mm", "length", "mm,millimeter,millimeters,millimetre,millimetres,milimetros,millimetri"},
    {"um", "length", "um,micron,microns"},
    {"km", "length", "km,kilometer,kilometers,kilometre,kilometres,kilometros,chilometri"}};

// The case of these letters determines the unit.
constexpr Spelling cased[] = {
    {"T", "magnetic field", "T"},   {"uT", "magnetic field", "uT"},
    {"nT", "magnetic field", "nT"}, {"", "magnetic field", "mT,G,gauss,Gauss"},
    {"V", "voltage", "V"},          {"mV", "voltage", "mV"},
    {"A", "current", "A"},          {"mA", "current", "mA"},
    {"nm", "length", "nm"},         {"", "power", "W,mW,uW,kW,Wh,J"}};

constexpr std::string_view turns =
    "r,u,rev,revs,revolution,revolutions,rot,rotation,rotations,turn,turns,umdr,umd,umdrehung,"
    "umdrehungen,tr,trs,tour,tours,giro,giri,giros,vuelta,vueltas,volta,voltas,revolucion,"
    "revoluciones,rotacoes,rotacao,rotazioni,cycle,cycles";

std::optional<HeaderUnit> spelled(std::string_view word, std::span<const Spelling> table) {
  for (const Spelling& one : table) {
    if (is_listed(word, one.words)) return HeaderUnit{one.suffix, one.dimension};
  }
  return std::nullopt;
}

// The suffix of the unit of this dimension that is written so; empty if there is none.
std::string suffix_of(const std::string& word, const char* dimension) {
  const auto unit = spelled(word, spellings);
  return unit && unit->dimension == dimension ? unit->suffix : "";
}

// A unit of this quantity. Channels can have it if keys can.
HeaderUnit unit_if_known(const std::string& suffix, const std::string& dimension) {
  const KeyUnit known = unit_of_key("x_" + suffix);
  const bool is_known = known.unit == suffix && known.dimension == dimension;
  return {is_known ? suffix : "", dimension};
}

// The unit "above per below": radians per second for "rad" and "s".
std::optional<HeaderUnit> ratio(const std::string& above, const std::string& below) {
  const std::string time = suffix_of(below, "time"), angle = suffix_of(above, "angle");
  if (time.empty()) return std::nullopt;
  if (!angle.empty() && angle != "rev") return unit_if_known(angle + "_" + time, "angular rate");
  if (is_listed(above, turns) || above == "1") {
    if (time == "min") return HeaderUnit{"rpm", "angular rate"};
    if (time == "s" && above == "1") return HeaderUnit{"", "per second"};
    return HeaderUnit{time == "s" ? "rev_s" : "", "angular rate"};
  }
  const std::string length = suffix_of(above, "length");
  if (!length.empty()) return unit_if_known(length + "_" + time, "speed");
  return std::nullopt;
}

// A unit as plain text, "rad/s": lower case, one blank between words, no blanks at a slash.
std::string plain_unit(std::string_view text) {
  std::string kept;
  for (const char c : lower_case(ascii_of(text, true))) {
    constexpr std::string_view marks = ".^{}$\\()[]\"'";
    if (marks.find(c) != std::string_view::npos) continue;
    kept += c == '*' || c == '_' ? ' ' : c;
  }
  std::string plain;
  for (const std::string_view word : words_of(kept)) {
    constexpr std::string_view per[] = {"per", "pro", "par", "por", "al", "a", "je"};
    const bool is_per = std::ranges::find(per, word) != std::end(per);
    const std::string_view one = is_per && !plain.empty() ? "/" : word;
    if (!plain.empty() && !plain.ends_with('/') && !one.starts_with('/')) plain += ' ';
    plain += one;
  }
  return plain;
}

std::optional<HeaderUnit> with_exponent(std::string plain) {
  if (!plain.ends_with("-1")) return std::nullopt;
  plain = trimmed(std::string_view(plain).substr(0, plain.size() - 2));
  const size_t blank = plain.rfind(' ');
  if (blank != std::string::npos) return ratio(plain.substr(0, blank), plain.substr(blank + 1));
  if (const auto unit = ratio("1", plain)) return unit;
  // A unit without a separator: "rads-1".
  for (size_t k = plain.size(); k-- > 1;) {
    if (const auto unit = ratio(plain.substr(0, k), plain.substr(k))) return unit;
  }
  return std::nullopt;
}

}  // namespace

std::optional<HeaderUnit> unit_written(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with("in ")) text.remove_prefix(3);  // "Voltage (in V)"
  const std::string as_written(trimmed(ascii_of(text, true))), plain = plain_unit(text);
  if (const auto unit = spelled(as_written, cased)) return unit;
  if (const auto unit = spelled(plain, spellings)) return unit;
  const size_t slash = plain.find('/');
  if (slash != std::string::npos && plain.find('/', slash + 1) == std::string::npos) {
    return ratio(plain.substr(0, slash), plain.substr(slash + 1));
  }
  if (const auto unit = with_exponent(plain)) return unit;
  // An underscore or a blank may replace the slash: "mrad_s".
  const size_t blank = plain.find(' ');
  if (blank == std::string::npos || (blank == 1 && plain[0] != 'm')) return std::nullopt;
  return ratio(plain.substr(0, blank), plain.substr(blank + 1));
}

std::vector<std::string> words_of_header(std::string_view text) {
  std::vector<std::string> words;
  char before = ' ';
  for (const char c : ascii_of(text, false)) {
    const auto u = static_cast<unsigned char>(c);
    const bool letter = std::isalpha(u) != 0, digit = std::isdigit(u) != 0;
    if (letter || digit) {
      const auto b = static_cast<unsigned char>(before);
      const bool goes_on =
          letter ? std::isalpha(b) != 0 && !(std::isupper(u) != 0 && std::islower(b) != 0)
                 : std::isdigit(b) != 0;
      if (!goes_on) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(u));
    }
    before = c;
  }
  return words;
}

namespace {

// The name without a slash or "in" at its end, which precede the unit.
std::string_view before_unit(std::string_view name) {
  name = trimmed(name);
  while (name.ends_with('/') || name.ends_with(',') || name.ends_with(':')) {
    name = trimmed(name.substr(0, name.size() - 1));
  }
  for (const std::string_view in : {" in", " en", " em", "_in"}) {
    if (name.ends_with(in)) return trimmed(name.substr(0, name.size() - in.size()));
  }
  return name;
}

// The content of the last brackets, and the text without brackets.
struct Brackets {
  std::string name, inside;
};

Brackets brackets_in(std::string_view text) {
  Brackets result;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '(' && text[i] != '[' && text[i] != '{') {
      result.name += text[i];
      continue;
    }
    size_t end = i + 1;
    for (int depth = 1; end < text.size(); ++end) {
      if (text[end] == '(' || text[end] == '[' || text[end] == '{') ++depth;
      if ((text[end] == ')' || text[end] == ']' || text[end] == '}') && --depth == 0) break;
    }
    const std::string inside(trimmed(text.substr(i + 1, end - i - 1)));
    const bool is_index = inside.size() == 1 &&
                          (std::isdigit(static_cast<unsigned char>(inside[0])) != 0 ||
                           std::string_view("xyzwXYZW").find(inside[0]) != std::string_view::npos);
    result.name += is_index ? " " + inside + " " : " ";
    if (!is_index && inside != "t") result.inside = inside;
    i = end;
  }
  return result;
}

// Reads the unit at the end of a name: the longest piece after a blank or a mark that is a unit.
bool take_last_words(std::string_view text, HeaderCell& cell, std::string& name) {
  constexpr std::string_view marks = " _,:;-|=";
  for (size_t i = 1; i < text.size(); ++i) {
    if (marks.find(text[i]) == std::string_view::npos) continue;
    const std::string_view rest = trimmed(text.substr(i + 1));
    if (rest.empty() || rest.front() == '/') continue;
    const auto unit = unit_written(rest);
    if (!unit) continue;
    const std::string_view before = trimmed(text.substr(0, i));
    cell.unit = unit;
    cell.unit_text = rest;
    cell.may_be_subscript = rest.size() == 1 && rest != "V" && !before.ends_with('/');
    name = before_unit(before);
    return true;
  }
  return false;
}

bool take_after_slash(std::string_view text, HeaderCell& cell, std::string& name) {
  for (size_t i = text.find('/'); i != std::string_view::npos; i = text.find('/', i + 1)) {
    const std::string_view rest = trimmed(text.substr(i + 1));
    const auto unit = unit_written(rest);
    if (!unit && i != text.find('/')) continue;
    const bool is_derivative = rest.starts_with("dt") && text.find('/', i + 1) == text.npos;
    if (!unit && is_derivative) return false;
    // The first piece is kept as an unknown unit until a later one is recognised.
    if (!unit) {
      cell.unit_text = rest;
      name = before_unit(text.substr(0, i));
      continue;
    }
    cell.unit = unit;
    cell.unit_text = rest;
    name = before_unit(text.substr(0, i));
    return true;
  }
  return !cell.unit_text.empty();
}

bool is_bare_unit(std::string_view text) {
  if (text.empty() || !unit_written(text)) return false;
  constexpr std::string_view brackets = "([{";
  // Single letters are names of quantities, except s for seconds and W for watts.
  return text.size() > 1 ? brackets.find(text.front()) != std::string_view::npos ||
                               text.find(" / ") == std::string_view::npos
                         : text == "s" || text == "W";
}

}  // namespace

HeaderCell read_header_cell(const std::string& in_file) {
  const std::string_view text = trimmed(in_file);
  HeaderCell cell;
  cell.is_between_bars = text.starts_with('|') && text.find('|', 1) != std::string_view::npos;
  if (is_bare_unit(text)) {
    cell.unit = unit_written(text);
    cell.unit_text = text;
    cell.is_bare_unit = true;
    return cell;
  }
  std::string name(text);
  const Brackets brackets = brackets_in(text);
  if (!brackets.inside.empty()) {
    name = before_unit(brackets.name);
    cell.unit_text = brackets.inside;
    cell.unit = unit_written(brackets.inside);
    const size_t comma = brackets.inside.find_last_of(",;");
    if (!cell.unit && comma != std::string::npos) {
      // The unit may follow a comma: "Gyroscope (x, rad/s)".
      cell.unit = unit_written(std::string_view(brackets.inside).substr(comma + 1));
      name += " " + brackets.inside.substr(0, comma);
    }
  } else if (const KeyUnit key = unit_of_key(trimmed(brackets.name));
             !key.unit.empty() && unit_written(key.unit)) {
    cell.unit = HeaderUnit{key.unit, key.dimension};
    cell.unit_text = key.unit;
    cell.may_be_subscript = key.unit.size() == 1 && key.unit != "V";
    name = key.stem;
  } else {
    const std::string plain(trimmed(brackets.name));
    name = plain;
    if (!take_last_words(plain, cell, name)) take_after_slash(plain, cell, name);
  }
  cell.words = words_of_header(name);
  return cell;
}

}  // namespace photorque
