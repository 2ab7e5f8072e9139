"""Maximum power, short circuit and open circuit of a module by the model of De Soto.

W. De Soto, S. A. Klein, W. A. Beckman, Solar Energy 80, 78 (2006), eq. 1, 8, 10, 11, 12 and 13, as
pvlib.pvsystem.calcparams_desoto() and singlediode() compute it: the parameters follow irradiance
and temperature, and the circuit's equation is solved by bracketed roots. Writes
electrical/de_soto.csv. The module is of 96 cells, its parameters those of the CEC library for the
Canadian Solar CS5P-220M.
"""

import math

from scipy.optimize import brentq, minimize_scalar

K_EV = 8.617333262e-05
REFERENCE_K = 298.15
MODULE = {"alpha": 0.004539, "a": 2.6373, "light": 5.114, "dark": 8.196e-10, "rs": 1.065, "rsh": 381.68}
GAP_EV, GAP_SLOPE = 1.121, -0.0002677


def parameters(irradiance, kelvin):
    """Photocurrent, saturation current, n N_s V_t and shunt at a condition."""
    m, warmer = MODULE, kelvin - REFERENCE_K
    gap = GAP_EV * (1 + GAP_SLOPE * warmer)
    light = irradiance / 1000 * (m["light"] + m["alpha"] * warmer)
    dark = m["dark"] * (kelvin / REFERENCE_K) ** 3
    dark *= math.exp(GAP_EV / (K_EV * REFERENCE_K) - gap / (K_EV * kelvin))
    return light, dark, m["a"] * kelvin / REFERENCE_K, m["rsh"] * 1000 / irradiance


def figures(irradiance, kelvin):
    """I_sc, V_oc and P_mp."""
    light, dark, a, rsh = parameters(irradiance, kelvin)

    def current(volt):
        def left(amp):
            diode = volt + amp * MODULE["rs"]
            return light - dark * math.expm1(diode / a) - diode / rsh - amp

        return brentq(left, -volt / MODULE["rs"] - 1, 1.1 * light, xtol=1e-14, rtol=1e-14)

    open_v = brentq(current, 1.0, 120.0, xtol=1e-12, rtol=1e-14)
    best = minimize_scalar(
        lambda v: -v * current(v), bounds=(0.5 * open_v, open_v), method="bounded",
        options={"xatol": 1e-9},
    )
    return current(0.0), open_v, -best.fun


if __name__ == "__main__":
    with open("electrical/de_soto.csv", "w", encoding="utf-8") as out:
        out.write("irradiance_W_m2,temperature_K,short_circuit_A,open_circuit_V,maximum_W\n")
        for g in (1000, 800, 400, 200, 100):
            for t in (273.15, 298.15, 323.15, 348.15):
                isc, voc, pmp = figures(g, t)
                out.write(f"{g},{t},{isc:.10f},{voc:.10f},{pmp:.9f}\n")
