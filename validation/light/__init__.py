"""Cases of light and power: lamps over a solar array, effects on them, and recordings of both.

Laws are those of docs/light_diagnosis.md and docs/photovoltaic.md, implemented independently of the program.
"""

from .scenarios import case_count, make_case

__all__ = ["case_count", "make_case"]
