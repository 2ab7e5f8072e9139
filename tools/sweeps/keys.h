// The keys of [sweep].
#pragma once

#include "core/numerics/quadrature.h"
#include "core/settings/typed_keys.h"
#include "tools/sweeps/values.h"

namespace photorque {

// Of an axis, of a key over which a design takes the mean or the worst, and of a tolerance.
namespace axis_key {
inline constexpr auto most_designs = static_cast<int64_t>(max_designs);

inline constexpr TextKey key(
    "key", "as in `--set`, any outside `[sweep]`: `source[0].power_W`, `source[0].position_m[2]`");
inline constexpr TextKey name("name", "", "name in pictures: `\"standoff\"`");
inline constexpr OtherKey values("values", Key::an_array, "numbers, texts, arrays; *or*",
                                 {.optional = true});
inline constexpr NumbersKey weights("weights", Range::not_negative(), "of the values",
                                    {.usually = "equal"});
inline constexpr NumberKey from(
    "from", {}, "the first, in the unit of the axis' key; a random plan draws uniformly",
    {.optional = true});
inline constexpr NumberKey to("to", {}, "last value", {.optional = true});
inline constexpr IntegerKey count(
    "count", 2, most_designs,
    "of values in equal steps, both ends included; none in a random plan or for `optimise`",
    {.optional = true});
inline constexpr IntegerKey nodes(
    "count", 1, static_cast<int64_t>(max_gauss_nodes),
    "number of Gauss–Legendre points; exact for polynomials of degree 2 `count` − 1",
    {.optional = true});
inline constexpr ChoiceKey spacing("spacing",
                                   {{"linear", "equal steps"},
                                    {"logarithmic", "equal factors, ends above 0"}},
                                   0, "of the values");
inline constexpr NumberKey mean("mean", {}, "of a random plan: normal, with `sigma`",
                                {.optional = true});
inline constexpr NumberKey sigma("sigma", Range::positive(), "standard deviation",
                                 {.optional = true});
inline constexpr NumberKey half_width("half_width", Range::positive(),
                                      "uniform within ± this; *or*", {.optional = true});
inline constexpr FlagKey seed("seed", false,
                              "the key takes the copy's number (1, 2, …): `source[0].spread_seed` "
                              "of LEDs that differ by `power_spread` and `aim_spread_deg`");
inline constexpr FlagKey relative("relative", false, "relative to the value");
}  // namespace axis_key

namespace constraint_key {
inline constexpr TextKey figure("figure", "a name in `summary.json`, or `\"\\|NAME\\|\"`");
inline constexpr NumberKey at_least("at_least", {}, "in the figure's unit", {.usually = "none"});
inline constexpr NumberKey at_most("at_most", {}, "likewise", {.usually = "none"});
}  // namespace constraint_key

namespace sweep_key {
inline constexpr TextKey verb("verb", "power",
                              "command of every design: `trace`, `power`, `torque-map`, `budget`, "
                              "`balance`, `propagate`, `fit-cell`");
inline constexpr TextsKey figures(
    "figures", "names in its `summary.json`: columns of `sweep.csv`, plotted too",
    {.usually = "all"});
inline constexpr OtherKey maximise(
    "maximise", Key::a_text | Key::an_array,
    "a figure, or several; `\"\\|NAME\\|\"` is its absolute value: the objectives; the first ranks "
    "the designs, several give the Pareto front",
    {.optional = true});
inline constexpr OtherKey minimise("minimise", Key::a_text | Key::an_array, "likewise",
                                   {.optional = true});
inline constexpr IntegerKey designs(
    "designs", 2, axis_key::most_designs,
    "number of points of a random plan (Owen-scrambled Sobol sequence)", {.usually = "a grid"});
inline constexpr IntegerKey seed("seed", 1, 0, INT64_MAX,
                                 "of a random plan (`--seed` is that of the light)");
inline constexpr TablesKey axis("axis", "at least one; the last varies fastest");
inline constexpr TablesKey mean_over(
    "mean_over", "takes several values within each design; figures are their mean");
inline constexpr TablesKey worst_over(
    "worst_over",
    "takes the values of a grid axis within each design; an objective or a constrained figure "
    "counts where it is worst, any other figure where the first objective (else the first "
    "constrained figure) is");
inline constexpr TablesKey constraint("constraint", "held at every value of `worst_over`");
inline constexpr TablesKey tolerance(
    "tolerance", "a manufacturing tolerance: every number of the key has a separate random error");
inline constexpr IntegerKey built_copies("built_copies", 100, 2, 100000,
                                         "copies of a design, each with its own draws; the n-th "
                                         "copy has the same draws in every design");
inline constexpr NumberKey built_fraction("built_fraction", {0.5, 1.0, false, true},
                                          "fraction of the copies that reach the stated value",
                                          {.optional = true});
inline constexpr ChoiceKey built_of(
    "built_of",
    {{"best", "copies of the best and the nominal design"},
     {"every",
      "of every design, which are then judged by what the fraction reaches (column `p95_FIGURE`)"}},
    0, "designs of which copies are computed");
inline constexpr IntegerKey built_seed("built_seed", 1, 0, INT64_MAX, "of the draws");
inline constexpr IntegerKey global("global", 100, 0, 100000,
                                   "`optimise`: evaluations over the whole box");
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
