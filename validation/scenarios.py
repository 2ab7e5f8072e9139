"""The cases of a plan: which effects, on which platform, how strong."""


def case_count(plan):
    """How many cases a plan has."""


def make_case(plan, index, folder):
    """Makes the case `index` (0-based) of a plan in `folder`: the same plan gives the same cases, in
    whatever order they are made. MotionError where none that shows is found.

    validation.light has functions of the same names and arguments for plans `of = "light"`."""
