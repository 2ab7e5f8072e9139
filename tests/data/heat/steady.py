"""Steady temperature and power of lit cells: the numbers of tests/photovoltaics/heat_test.cpp.

SciPy's bracketed solvers on one cell's circuit and on a plate's balance of heat, written from the textbooks:
one diode (De Soto and others 2006) with Bishop's reverse term; Churchill and Chu 1975 for the air; Sutherland's laws.
Prints one line a case: name, temperature [K], power of twelve cells [W], its slope [W/K].
"""

import numpy as np
from scipy.constants import Boltzmann, Stefan_Boltzmann, elementary_charge, g
from scipy.optimize import brentq, minimize_scalar

CELLS, SIDE_CM2, AREA_M2 = 12, 100.0, 0.12


def cell_power_W(irradiance_W_m2, kelvin):
    """Interdigitated silicon: 0.700 V at 40 mA/cm2 and 298.15 K, 0.5 ohm cm2, 1e4 ohm cm2; 0.55 A/W."""
    volt = Boltzmann * kelvin / elementary_charge
    cold = Boltzmann * 298.15 / elementary_charge
    gap = 1.121 * (1 - 0.0002677 * (kelvin - 298.15))
    dark = 0.04 / np.expm1(0.7 / cold) * (kelvin / 298.15) ** 3 * np.exp(1.121 / cold - gap / volt)
    lit = 0.55 * irradiance_W_m2 * 1e-4

    def current(v):
        shunt = v / 1e4 * (1 + 2e-3 * (1 + v / 15.0) ** -3)
        return lit - dark * np.expm1(v / volt) - shunt

    best = minimize_scalar(lambda v: -(v - 0.5 * current(v)) * current(v), bounds=(0.2, 0.8), method="bounded",
                           options={"xatol": 1e-12})
    return -best.fun * SIDE_CM2


def still_air_W_m2_K(kelvin, air_K, pressure_Pa=101325.0):
    film = 0.5 * (kelvin + air_K)
    viscosity = 1.716e-5 * (film / 273.15) ** 1.5 * (273.15 + 110.4) / (film + 110.4)
    conductivity = 0.0241 * (film / 273.15) ** 1.5 * (273.15 + 194.0) / (film + 194.0)
    density = pressure_Pa / 287.05 / film
    kinematic, diffusivity = viscosity / density, conductivity / density / 1007.0
    height = np.sqrt(AREA_M2)
    rayleigh = g * abs(kelvin - air_K) * height**3 / film / kinematic / diffusivity
    bracket = (1 + (0.492 * diffusivity / kinematic) ** (9 / 16)) ** (8 / 27)
    return (0.825 + 0.387 * rayleigh ** (1 / 6) / bracket) ** 2 * conductivity / height


def case(name, irradiance=1000.0, air=293.15, sky=293.15, faces=2, emissivity=0.84, absorptance=0.93, wind=None,
         pressure=101325.0):
    def power(kelvin):
        return CELLS * cell_power_W(irradiance, kelvin)

    def rest(kelvin):
        convection = still_air_W_m2_K(kelvin, air, pressure) if wind is None else wind
        away = faces * (convection * (kelvin - air) + emissivity * Stefan_Boltzmann * (kelvin**4 - sky**4))
        return absorptance * irradiance - power(kelvin) / AREA_M2 - away

    kelvin = brentq(rest, 240.0, 460.0, xtol=1e-11)
    step = 0.5
    print("%-16s %.7f %.7f %.6f" % (name, kelvin, power(kelvin), (power(kelvin + step) - power(kelvin - step)) / 2 / step))


case("still_air")
case("dim", irradiance=150.0)
case("one_face", faces=1)
case("wind", air=308.15, sky=303.15, wind=15.0)
case("thin_air", pressure=5000.0, emissivity=0.3, absorptance=0.7)
case("vacuum", irradiance=1361.0, sky=2.725, wind=0.0)
