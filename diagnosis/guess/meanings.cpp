#include "diagnosis/guess/meanings.h"

namespace photorque {

std::string axis_of(const Words& words, const std::vector<Words>& siblings) {
  for (const std::string& word : words.all) {
    if (is_one_of(word, {"x", "y", "z"})) return word;
  }
  for (const std::string& word : words.all) {
    std::string last = word.substr(word.size() - 1);
    if (is_one_of(last, {"x", "y", "z"}) &&
        begins(word, {"w", "gyr", "omega", "acc", "mag", "rate", "angvel"})) {
      return last;
    }
  }
  // Numbers are axes if columns exist for all three, counted from 0 or from 1.
  for (size_t place = 0; place < words.all.size(); ++place) {
    if (!is_one_of(words.all[place], {"0", "1", "2", "3"})) continue;
    const auto has = [&](const char* number) {
      Words other = words;
      other.all[place] = number;
      return std::ranges::any_of(siblings, [&](const Words& w) { return w.all == other.all; });
    };
    const int number = words.all[place][0] - '0';
    if (!has("1") || !has("2") || !(has("0") || has("3"))) continue;
    const int index = has("0") ? number : number - 1;
    if (index < 3) return std::string(1, "xyz"[index]);
  }
  return "";
}

bool is_of_another_kind(const Words& words) {
  // "Time since first frame" is a time, "frame rate" is not.
  const bool is_frame = words.has_word_with_prefix({"frame"}) && words.all.front() != "time";
  // "dTime" and "d theta" are increments, "d theta / dt" is a rate.
  const bool is_increment =
      words.all.size() > 1 && words.all.front() == "d" && !words.any_is({"dt"});
  return is_frame || is_increment ||
         words.any_is({"err",     "error",  "errors",    "fehler", "errore",      "erreur",
                       "std",     "stdev",  "stddev",    "unc",    "incertitude", "variance",
                       "cov",     "target", "setpoint",  "soll",   "cmd",         "command",
                       "desired", "ref",    "reference", "goal",   "consigne",    "fft",
                       "delta",   "step",   "ddot",      "lat",    "lon",         "fps"}) ||
         words.has_word_with_prefix({"sigma", "uncert", "unsicher", "incert", "sollw", "latitud",
                                     "longitud", "temper", "sampl", "spectr"}) ||
         words.any_has({"moment", "torque", "impuls"});
}

namespace {

bool is_rate(const Words& words) {
  if (words.has_word_with_prefix({"gyr", "omega", "rate", "speed", "veloc", "vitesse", "rpm", "rps",
                                  "dps", "spin", "angvel"}) ||
      words.any_is({"w", "wx", "wy", "wz", "vel", "giri", "giros", "tours", "thetadot", "phidot",
                    "dtheta", "dphi"}) ||
      words.any_has({"geschw", "drehzahl", "umdrehung", "kreisfreq", "drehfreq", "winkelfreq",
                     "speed", "angvel", "velocity"})) {
    return true;
  }
  if (std::ranges::any_of(
          words.all, [](const std::string& w) { return w.size() > 4 && w.ends_with("rate"); })) {
    return true;
  }
  // A rate is also a derivative ("theta dot", "d phi / dt") or a frequency of rotation.
  if (words.any_is({"dot", "dt", "ableitung", "derivative"}) && words.all.size() > 1) return true;
  return words.has_word_with_prefix({"freq", "frec", "frequ"}) &&
         words.has_word_with_prefix({"rot", "spin", "giro", "angul"});
}

bool is_angle(const Words& words) {
  return words.any_has({"angle", "angul", "angol", "winkel", "theta"}) ||
         words.has_word_with_prefix({"phi", "varphi", "encod"});
}

}  // namespace

std::vector<Meaning> meanings(const Words& words, const std::string& axis, const HeaderCell& cell) {
  std::vector<Meaning> all;
  if (is_of_another_kind(words)) return all;
  const bool rate = is_rate(words), angle = is_angle(words);
  if (words.any_has({"wheel", "schwungrad"}) || words.has_word_with_prefix({"rotor"})) {
    if (!angle || rate) all.push_back({"wheel_" + (axis.empty() ? "z" : axis), "rad_s"});
  }
  if (!rate &&
      (words.has_word_with_prefix({"time", "elapsed", "clock", "temps", "tiempo", "tempo"}) ||
       words.any_has({"zeit", "timestamp"}) ||
       words.any_is(
           {"t", "sec", "secs", "second", "seconds", "millis", "micros", "tid", "tijd", "czas"}))) {
    const bool alone = words.all.size() == 1 || !words.any_is({"t"}) || cell.unit;
    if (alone || words.has_word_with_prefix({"time", "zeit", "temps", "tiempo", "tempo"})) {
      all.push_back({"t", "s"});
    }
  }
  const bool magnitude =
      cell.is_between_bars ||
      words.any_is({"magnitude", "norm", "absolute", "abs", "betrag", "total", "resultant"}) ||
      words.has_word_with_prefix({"modul"});
  const bool has_rate_unit = cell.unit && cell.unit->dimension == "angular rate";
  if (magnitude && (rate || has_rate_unit)) all.push_back({"rate_magnitude", "rad_s"});
  if (words.has_word_with_prefix({"acc", "acel", "beschl"}) && !angle && !axis.empty()) {
    all.push_back({"accel_" + axis, "m_s2"});
  }
  if (!axis.empty() && !magnitude &&
      (words.has_word_with_prefix({"mag"}) || (words.all.size() <= 2 && words.any_is({"b"})))) {
    all.push_back({"mag_" + axis, "T"});
  }
  // A coordinate: x, or "pos_x", "puck x".
  if (!rate && is_one_of(axis, {"x", "y"}) &&
      (words.all == std::vector<std::string>{axis} ||
       words.has_word_with_prefix({"pos", "coord", "koord", "place", "puck", "cent", "ort"}))) {
    all.push_back({axis, "m"});
  }
  if (words.all == std::vector<std::string>{"s"}) {
    all.push_back({"x", "m", "s beside another time counts as the distance x:"});
  }
  // The single coordinate of a body that moves on a line, and its speed.
  const bool is_long = !cell.unit || cell.unit->dimension == "length";
  if (!rate && !angle && axis.empty() && is_long &&
      (words.has_word_with_prefix({"posi", "displac", "distan", "abstand", "strecke", "auslenk",
                                   "elong", "deplac", "despl", "posic", "spost", "height", "altit",
                                   "hohe", "hauteur", "altura", "altezza"}) ||
       words.any_is({"weg", "ort", "pos"}))) {
    all.push_back({"x", "m", "a coordinate without a name counts as x:"});
  }
  if (cell.unit && cell.unit->dimension == "speed" && axis != "z") {
    const bool along_y = axis == "y" || words.any_is({"vy"});
    all.push_back({along_y ? "velocity_y" : "velocity_x", "m_s"});
  }
  const struct {
    bool is_there;
    const char *stem, *axis;
  } turns[] = {
      {words.any_is({"roll", "rollio", "roulis", "alabeo", "rolagem"}) ||
           words.any_has({"rollw", "rollr", "rollg"}),
       "roll", "x"},
      {words.has_word_with_prefix({"pitch", "nick", "tangage", "beccheggio", "cabeceo", "arfagem"}),
       "pitch", "y"},
      {words.has_word_with_prefix(
           {"yaw", "gier", "lacet", "imbardata", "guinada", "heading", "azimut"}),
       "yaw", "z"},
      {words.has_word_with_prefix({"tilt", "inclin", "neigung", "kipp"}), "tilt", ""}};
  for (const auto& turn : turns) {
    if (!turn.is_there) continue;
    if (rate || has_rate_unit) {
      all.push_back({*turn.axis != 0 ? std::string("gyro_") + turn.axis : "rate", "rad_s",
                     std::string("the rate of ") + turn.stem + " counts as that about body " +
                         (*turn.axis != 0 ? turn.axis : "axis") + " in"});
    } else {
      all.push_back({turn.stem, "rad"});
    }
  }
  // p, q and r are the rates of an aircraft about body x, y and z; n is a rotational speed.
  for (size_t k = 0; k < 3; ++k) {
    if (has_rate_unit && words.all == std::vector{std::string(1, "pqr"[k])}) {
      all.push_back({std::string("gyro_") + "xyz"[k], "rad_s",
                     "p, q and r count as rates about body x, y and z in"});
    }
  }
  const bool may_be_revolutions =
      has_rate_unit ||
      (cell.unit && (cell.unit->dimension == "frequency" || cell.unit->dimension == "per second"));
  if (words.any_is({"n"}) && axis.empty() && may_be_revolutions) all.push_back({"rate", "rad_s"});
  if (rate) {
    const bool is_linear_elsewhere =
        words.has_word_with_prefix({"speed", "veloc", "vel", "vitesse"}) && !angle && !cell.unit;
    if (axis.empty()) {
      all.push_back({"rate", "rad_s"});
    } else if (!is_linear_elsewhere || words.has_word_with_prefix({"gyr", "omega", "ang"})) {
      all.push_back({"gyro_" + axis, "rad_s"});
    }
  } else if (angle) {
    all.push_back({"angle", "rad"});
  }
  return all;
}

std::string quaternion_of(const std::vector<std::string>& words) {
  if (words.empty() || words[0][0] != 'q') return "";
  const std::string part = words[0].size() == 2 ? words[0].substr(1)
                           : words.size() > 1   ? words.back()
                                                : "";
  if (is_one_of(part, {"w", "x", "y", "z"})) return "q_" + part;
  if (is_one_of(part, {"0", "1", "2", "3"})) return std::string("q_") + "wxyz"[part[0] - '0'];
  return "";
}

}  // namespace photorque
