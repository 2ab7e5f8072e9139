// Keys of [sweep].
#pragma once

#include "core/numerics/quadrature.h"
#include "core/settings/typed_keys.h"
#include "tools/sweeps/values.h"

namespace photorque {

// Keys of [[sweep.axis]], `mean_over`, `worst_over` and `tolerance`.
namespace axis_key {
inline constexpr auto most_designs = static_cast<int64_t>(max_designs);

inline constexpr TextKey key(
    "key",
    "any key outside `[sweep]`, as in `--set`: `source[0].power_W`, `source[0].position_m[2]`");
inline constexpr TextKey name("name", "", "name of the axis in pictures, such as `\"standoff\"`");
inline constexpr OtherKey values("values", Key::an_array,
                                 "list of the values (numbers, strings or arrays); *or*",
                                 {.optional = true});
inline constexpr NumbersKey weights("weights", Range::not_negative(), "weight of each value",
                                    {.usually = "equal"});
inline constexpr NumberKey from(
    "from", {},
    "first value, in the unit of `key`; a random plan draws uniformly between `from` and `to`",
    {.optional = true});
inline constexpr NumberKey to("to", {}, "last value", {.optional = true});
inline constexpr IntegerKey count(
    "count", 2, most_designs,
    "number of values including both ends; not used in a random plan or by `optimise`",
    {.optional = true});
inline constexpr IntegerKey nodes(
    "count", 1, static_cast<int64_t>(max_gauss_nodes),
    "number of Gauss–Legendre points; exact for polynomials of degree 2 `count` − 1",
    {.optional = true});
inline constexpr ChoiceKey spacing("spacing",
                                   {{"linear", "equal steps"},
                                    {"logarithmic", "equal factors, ends above 0"}},
                                   0, "spacing of the values");
inline constexpr NumberKey mean("mean", {},
                                "mean of a normal distribution in a random plan, with `sigma`",
                                {.optional = true});
inline constexpr NumberKey sigma("sigma", Range::positive(), "standard deviation",
                                 {.optional = true});
inline constexpr NumberKey half_width("half_width", Range::positive(),
                                      "uniform within ± this; *or*", {.optional = true});
inline constexpr FlagKey seed(
    "seed", false,
    "true: the key is set to the number of the copy (1, 2, …), such as `source[0].spread_seed` for "
    "LEDs with `power_spread` and `aim_spread_deg`");
inline constexpr FlagKey relative("relative", false,
                                  "true: `sigma` and `half_width` are fractions of the value");
}  // namespace axis_key

namespace constraint_key {
inline constexpr TextKey figure("figure", "a name in `summary.json`, or `\"\\|NAME\\|\"`");
inline constexpr NumberKey at_least("at_least", {}, "lower limit, in the unit of the figure",
                                    {.usually = "none"});
inline constexpr NumberKey at_most("at_most", {}, "upper limit, in the unit of the figure",
                                   {.usually = "none"});
}  // namespace constraint_key

namespace sweep_key {
inline constexpr TextKey verb("verb", "power",
                              "command of every design: `trace`, `power`, `torque-map`, `budget`, "
                              "`balance`, `propagate`, `fit-cell`");
inline constexpr TextsKey figures(
    "figures",
    "names of figures in `summary.json`, which become columns of `sweep.csv` and are plotted",
    {.usually = "all"});
inline constexpr OtherKey maximise(
    "maximise", Key::a_text | Key::an_array,
    "one or several figures to maximise; `\"\\|NAME\\|\"` is the absolute value of a figure. The "
    "first objective ranks the designs, several give the Pareto front",
    {.optional = true});
inline constexpr OtherKey minimise("minimise", Key::a_text | Key::an_array,
                                   "figures to minimise, as in `maximise`", {.optional = true});
inline constexpr IntegerKey designs(
    "designs", 2, axis_key::most_designs,
    "number of points of a random plan (Owen-scrambled Sobol sequence)", {.usually = "a grid"});
inline constexpr IntegerKey seed("seed", 1, 0, INT64_MAX,
                                 "seed of a random plan (`--seed` is that of the rays)");
inline constexpr TablesKey axis("axis", "axes of the plan, at least one; the last varies fastest");
inline constexpr TablesKey mean_over(
    "mean_over",
    "key that takes several values within each design; the figures are means over these");
inline constexpr TablesKey worst_over(
    "worst_over",
    "key that takes the values of a grid axis within each design. Objectives and constrained "
    "figures are taken at their worst value, other figures where the first objective (else the "
    "first constrained figure) is worst");
inline constexpr TablesKey constraint("constraint",
                                      "limit of a figure, required at every value of `worst_over`");
inline constexpr TablesKey tolerance(
    "tolerance", "a manufacturing tolerance: every number of the key has a separate random error");
inline constexpr IntegerKey built_copies("built_copies", 100, 2, 100000,
                                         "copies of a design, each with its own draws; the n-th "
                                         "copy has the same draws in every design");
inline constexpr NumberKey built_fraction("built_fraction", {0.5, 1.0, false, true},
                                          "fraction of the copies that reach the stated value",
                                          {.optional = true});
inline constexpr ChoiceKey built_of("built_of",
                                    {{"best", "copies of the best and the nominal design"},
                                     {"every",
                                      "copies of every design; designs are then ranked by the "
                                      "value that the fraction reaches (column `p95_FIGURE`)"}},
                                    0, "designs of which copies are computed");
inline constexpr IntegerKey built_seed("built_seed", 1, 0, INT64_MAX, "seed of the random copies");
inline constexpr IntegerKey global("global", 100, 0, 100000,
                                   "`optimise`: number of evaluations of the global search");
inline constexpr IntegerKey local(
    "local", 100, 0, 100000, "number of evaluations of the local search from the best of these");
inline constexpr NumberKey precision(
    "precision", {1e-8, 0.1},
    "`optimise`: step at which the search ends, relative to the range of each axis",
    {.optional = true});
inline constexpr TableKey sweep("sweep", "one command over many designs");
}  // namespace sweep_key

Key sweep_table();

}  // namespace photorque
