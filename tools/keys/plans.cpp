// [fit] and [prove].
#include "photovoltaics/fit/rated_keys.h"
#include "tools/keys/tables.h"

namespace photorque {

Key fit_table() {
  const auto rounding = [](const char* name, const char* what) {
    return Key::number(name, Range::not_negative(), what)
        .usually_is("the last decimal that any of them has");
  };
  return Key::table(
      "fit",
      joined(
          {{Key::texts("curves",
                       "files of `voltage_V,current_A` (or `V,I`); several are repeats "
                       "under the same light; *or*")
                .optional(),
            Key::tables("datasheet", rated_point_keys(),
                        "one to several points at one temperature"),
            Key::integer_or("cells_in_series", 1, 1, 2000, "of the device"),
            Key::number_or("temperature_K", 298.15, {1.0, 1000.0},
                           "of the curves; with a datasheet it belongs to each of its points")},
           rated_slope_keys(),
           {rounding("rounding_A", "step of a datasheet's currents"),
            rounding("rounding_V", "step of its voltages"),
            Key::number_or("tolerance", 0.0, {0.0, 0.5},
                           "a fraction of every figure of it, one sigma"),
            Key::number_or("current_noise", 1e-3, {1e-12, 1.0},
                           "of curves: fraction of each reading (with `substrings`, of the "
                           "short-circuit current)"),
            Key::number_or("voltage_noise", 5e-4, {1e-12, 1.0}, "fraction of each reading"),
            Key::number_or("correlation_points", 0.0, Range::not_negative(),
                           "readings over which the noise of the current falls off (slow drift of "
                           "the light)"),
            Key::integer_or(
                "substrings", 0, 0, 100,
                "instead: one curve of a partly shaded string; 0: a whole string in even "
                "light"),
            Key::flag_or("even_voltage_steps", false,
                         "repeats of one even ramp: averages the noise of the voltages away")}}),
      "parameters of cells from measurements");
}

Key prove_table() {
  constexpr int64_t most = 100000;
  const auto count = [](const char* name, const char* what) {
    return Key::integer(name, 0, most, what).optional();
  };
  const auto fraction = [](const char* name, const char* what) {
    return Key::number(name, Range::fraction(), what).optional();
  };
  const Range seconds{20.0, 1e5, false, false};
  return Key::table(
      "prove",
      {Key::choice_or("of", {{"motion", "attitude and rates"}, {"light", "light and power"}}, 0,
                      "what is diagnosed"),
       Key::integer_or("seed", 1, 0, INT64_MAX, "of all that is drawn"),
       count("per_kind", "recordings of every kind of the catalogue"),
       count("none", "with nothing missing"),
       count("pairs", "with two effects at once"),
       count("triples", "with three"),
       count("below", "of light, with one effect below what shows"),
       count("outside", "of every law outside the catalogue"),
       count("known_unknown", "with one effect of the catalogue and one law outside"),
       count("noise_none", "with nothing missing, noise not as stated"),
       count("noise_effect", "with one effect under correlated noise"),
       fraction("strong_share", "of the strong single effects: gains of 1e5 to 1e9"),
       fraction("second_maker_share", "of all cases: other platforms, motions and instruments"),
       Key::number("duration_s", seconds, "of a recording").optional(),
       Key::number("holdout_s", seconds, "of the recording held out").optional(),
       Key::numbers("rates_Hz", {1.0, 1000.0, false, false}, "of the instruments").optional(),
       fraction("dirty_share",
                "of the cases have drop-outs, gaps, outliers, jitter and sign flips"),
       Key::flag_or("oracle", true, "also diagnose with the truth told, for the held-out error"),
       Key::flag_or("replay", true, "also propagate every `improved.toml`"),
       Key::integer_or("at_once", 1, 1, 1024, "diagnoses side by side"),
       Key::number_or("longest_s", 900.0, Range::positive(), "for one diagnosis"),
       Key::integer_or("most_cases", most, 1, most, "in all"),
       Key::text_or("section", "prove", "of the document"),
       Key::text("document", "a page whose section is written anew").usually_is("none")},
      "what `prove` injects");
}

}  // namespace photorque
