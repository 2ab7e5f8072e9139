// [sweep].
#include "tools/keys/tables.h"
#include "tools/sweeps/plan.h"
#include "tools/sweeps/values.h"

namespace photorque {
namespace {

constexpr auto most_designs = static_cast<int64_t>(max_designs);

Key axis_key() {
  return Key::text("key",
                   "as in `--set`, any outside `[sweep]`: `source[0].power_W`, "
                   "`source[0].position_m[2]`");
}

Key end_key(const char* name, const char* what) {
  return Key::number(name, {}, what).optional();
}

std::vector<Key> grid_keys() {
  return {
      Key::other("values", Key::an_array, "numbers, texts, arrays; *or*").optional(),
      end_key("from", "the first, in the unit of the axis' key; a random plan draws uniformly"),
      end_key("to", "the last"),
      Key::integer("count", 2, most_designs,
                   "of values in equal steps, both ends included; none "
                   "in a random plan or for `optimise`")
          .optional(),
      Key::choice_or("spacing",
                     {{"linear", "equal steps"}, {"logarithmic", "equal factors, ends above 0"}}, 0,
                     "of the values")};
}

Key mean_table() {
  return Key::tables(
      "mean_over",
      {axis_key(), Key::other("values", Key::an_array, "numbers; *or*").optional(),
       Key::numbers("weights", Range::not_negative(), "of the values").usually_is("equal"),
       end_key("from", "of an interval, by the Gauss–Legendre rule"), end_key("to", "its end"),
       Key::integer("count", 1, 64, "of its points, exact for polynomials of degree 2 `count` − 1")
           .optional()},
      "takes several values within each design; figures are their mean");
}

Key constraint_table() {
  const auto bound = [](const char* name, const char* what) {
    return Key::number(name, {}, what).usually_is("none");
  };
  return Key::tables("constraint",
                     {Key::text("figure", "a name in `summary.json`, or `\"\\|NAME\\|\"`"),
                      bound("at_least", "in the figure's unit"), bound("at_most", "likewise")},
                     "held at every value of `worst_over`");
}

Key tolerance_table() {
  return Key::tables(
      "tolerance",
      {axis_key(),
       Key::number("sigma", Range::positive(), "normal with this standard deviation; *or*")
           .optional(),
       Key::number("half_width", Range::positive(), "uniform within ± this; *or*").optional(),
       Key::flag_or(
           "seed", false,
           "the key takes the copy's number (1, 2, …): `source[0].spread_seed` of LEDs that "
           "differ by `power_spread` and `aim_spread_deg`"),
       Key::flag_or("relative", false, "in parts of the value, not in the key's unit")},
      "what is not built as drawn: every number of the key is off by a draw of its own");
}

}  // namespace

Key sweep_table() {
  const BuiltCopies built;
  const SearchPlan search;
  const auto figures = [](const char* name, const char* what) {
    return Key::other(name, Key::a_text | Key::an_array, what).optional();
  };
  return Key::table(
      "sweep",
      {Key::text_or("verb", "power",
                    "what every design runs: `trace`, `power`, `torque-map`, `budget`, `balance`, "
                    "`propagate`, `fit-cell`"),
       Key::texts("figures", "names in its `summary.json`: columns of `sweep.csv`, plotted too")
           .usually_is("all"),
       figures("maximise",
               "a figure, or several; `\"\\|NAME\\|\"` is its absolute value: what the "
               "best design is best in (the first counts); several: the Pareto front"),
       figures("minimise", "likewise"),
       Key::integer("designs", 2, most_designs,
                    "a random plan instead: so many points of an Owen-scrambled Sobol sequence")
           .usually_is("a grid"),
       Key::integer_or("seed", 1, 0, INT64_MAX, "of a random plan (`--seed` is that of the light)"),
       Key::tables(
           "axis",
           joined({{axis_key(), Key::text_or("name", "", "what pictures call it: `\"standoff\"`")},
                   grid_keys(),
                   {Key::number("mean", {}, "of a random plan: normal, with `sigma`").optional(),
                    Key::number("sigma", Range::positive(), "of it").optional()}}),
           "at least one; the last runs fastest"),
       mean_table(),
       Key::tables("worst_over", joined({{axis_key()}, grid_keys()}),
                   "takes the values of a grid axis within each design; an objective or a "
                   "constrained figure counts where it is worst, any other figure where the first "
                   "objective (else the first constrained figure) is"),
       constraint_table(), tolerance_table(),
       Key::integer_or("built_copies", 100, 2, 100000,
                       "copies of a design, each with its own draws; the n-th copy has the same "
                       "draws in every design"),
       Key::number_or("built_fraction", built.fraction, {0.5, 1.0, false, true},
                      "of the copies are to be at least so good"),
       Key::choice_or("built_of",
                      {{"best", "copies of the best design and of the experiment as it stands"},
                       {"every",
                        "of every design, which are then judged by what the fraction "
                        "reaches (column `p95_FIGURE`)"}},
                      0, "what is built"),
       Key::integer_or("built_seed", 1, 0, INT64_MAX, "of the draws"),
       Key::integer_or("global", 100, 0, 100000, "`optimise`: evaluations over the whole box"),
       Key::integer_or("local", 100, 0, 100000, "and from the best of them"),
       Key::number_or("precision", search.precision, {1e-8, 0.1},
                      "`optimise`: ends when steps are so small, in parts of each axis' range")},
      "one command over many designs");
}

}  // namespace photorque
