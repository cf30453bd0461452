"""How logs write units: each spelling with its SI value, or refused; nothing read as another."""

from __future__ import annotations

import math

import pytest

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning.units import endings, naming, quantity

G, DEG, RPM = 9.80665, math.pi / 180, math.pi / 30
INCH, FOOT, LBF = 0.0254, 0.3048, 4.4482216152605
OZF = LBF / 16

#: SI unit -> one of each spelling, in it
KNOWN = {
    "m": {
        1.0: "m meter metres Meter", 1e-3: "mm MM millimeter Millimeter", 1e-2: "cm CM centimetre",
        1e-6: "um µm μm micrometer", 1e-9: "nanometer", 1e3: "km KM kilometer",
        INCH: "in inch inches", FOOT: "ft feet foot", 1609.344: "mile mi",
    },
    "s": {
        1.0: "s sec SEC Sec. seconds Sekunden secondes", 1e-3: "ms msec millis milliseconds"
        " Millisekunden", 1e-6: "us µs μs usec micros microseconds", 1e-9: "ns nsec",
        60.0: "min Min minutes", 3600.0: "h hr hours Stunden", 86400.0: "day days",
    },
    "m/s": {
        1.0: "m/s|M/S|m s-1|m.s^-1|m·s⁻¹|mps|meters per second|m/sec",
        1 / 3.6: "km/h|kph|km/hr|kmh",
        1e-3: "mm/s|mms⁻¹", 1e-2: "cm/s|cms⁻¹|cms^-1", 1e3: "kms-1", 0.44704: "mph",
         1852 / 3600: "knots|kt|kts", FOOT: "ft/s|feet per second",
    },
    "m/s**2": {
        1.0: "m/s2|m/s^2|m/s**2|m/s²|m·s⁻²|m.s-2|m s-2|m s^-2|m*s^-2|m/s/s|m/(s^2)|m/s^{2}|mpss"
        "|meters per second squared|M/S^2|ms⁻²|ms-2|ms^-2|ms^{-2}|ms**-2|ms2|ms^2",
        G: "g_0|g0|gee", G / 1e3: "mg_0|millig_0|mgee", G / 1e6: "ug_0", 0.01: "Gal|cm/s2",
        1e-5: "mGal", FOOT: "ft/s^2", 1e-3: "mm/s^2",
    },
    "rad": {
        1.0: "rad|Radians|radian", 1e-3: "mrad", DEG: "deg|°|º|˚|Grad|degrees|Deg",
        DEG / 1e3: "mdeg|m°", math.pi / 200: "gon",
        2 * math.pi: "turn|turns|rev|revolutions", DEG / 60: "arcmin", DEG / 3600: "arcsec",
    },
    "rad/s": {
        1.0: "rad/s|rads⁻¹|rads-1|rad s-1|rad.s^-1|radians per second|RAD/S", 1e-3: "mrad/s",
        DEG: "deg/s|degs^-1|°s⁻¹|°/s|º/s|dps|DPS|deg/sec|Grad/s|°·s⁻¹|degrees per second|Â°/s",
        DEG / 1e3: "mdeg/s|mdps|m°/s", DEG / 3600: "deg/h|°/h",
        RPM: "rpm|RPM|U/min|tr/min|r/min|rev/min|1/min|min^-1|min-1|min⁻¹|turn/min"
        "|u/min|UpM|Umdrehungen pro Minute|tours/min|revolutions per minute",
        1e3 * RPM: "krpm", 2 * math.pi: "rps|rev/s|revs^-1|turn/s",
    },
    "N/m": {1.0: "N/m|Nm⁻¹|N m^-1", 1e3: "N/mm|kN/m"},
    "K/s": {1.0: "K/s|°C/s", 1 / 60: "K/min"}, "m/s**3": {1.0: "m/s³|m/s^3"},
    "m**3/s": {1e-3: "l/s", 1e-3 / 60: "l/min|lpm|LPM|L/min"}, "kg*m**2/s": {1.0: "N m s|J*s"},
    "rad/s**2": {1.0: "rad/s²|rads⁻²|rad/s^2", DEG: "deg/s^2|°/s²"},
    "N": {
        1.0: "N|Newton|newtons", 1e-3: "mN", 1e3: "kN", 10.0: "daN", G: "kgf|kp", G / 1e3: "gf",
        LBF: "lbf", OZF: "ozf",
    },
    "N*m": {
        1.0: "N*m|N.m|N-m|N·m|N m|Nm|Newton-meters|newton meters|N⋅m", 1e-3: "mNm|mN·m|Nmm|N*mm",
        1e-2: "Ncm|cNm|N.cm", 1e3: "kNm|kN·m",
        INCH * OZF: "oz-in|ozf.in|oz·in|ozf·in|ozf-in|oz-in.",
        INCH * LBF: "in-lb|lb-in|in·lbf|lbf.in|in-lbs",
        FOOT * LBF: "ft-lb|lb-ft|ft·lbf|lbf-ft|ft-lbs",
        G / 100: "kgf.cm|kg-cm|kg·cm|kgf·cm|kgcm", G / 1e5: "g-cm|gf·cm",
    },
    "Pa": {
        1.0: "Pa|pa|Pascal", 100.0: "hPa|hpa|mbar|mBar", 1e3: "kPa|KPa|kpa|kilopascal", 1e6: "MPa",
        1e-3: "mPa", 1e5: "bar", 101325.0: "atm", 6894.757293168: "psi|lb/in2|lbf/in^2",
        133.322387415: "mmHg|mm Hg", 98066.5: "kgf/cm2|kg/cm²",
    },
    "K": {1.0: "K|Kelvin"},
    "V": {1.0: "V|Volt|VOLTS", 1e-3: "mV|millivolts", 1e-6: "uV|µV", 1e3: "kV"},
    "A": {1.0: "A|Amp|amps", 1e-3: "mA", 1e-6: "uA|µA"},
    "A*s": {1.0: "A*s|As|coulomb", 3600.0: "Ah", 3.6: "mAh"},
    "tesla": {
        1.0: "T|tesla", 1e-3: "mT", 1e-6: "uT|µT|μT|microTesla", 1e-9: "nT", 1e-4: "gauss|Gauss",
        1e-7: "mgauss|milligauss",
    },
    "W": {1.0: "W|Watt|watts", 1e-3: "mW", 1e3: "kW", 735.49875: "PS"},
    "J": {1.0: "J|Joules|Ws", 3600.0: "Wh", 3.6e6: "kWh", 1e-3: "mJ", 4184.0: "kcal",
          1.602176634e-19: "eV"},
    "Hz": {1.0: "Hz|hz|1/s|s^-1|s-1|s⁻¹", 1e3: "kHz|khz", 1e6: "MHz|Mhz", 1 / 60: "bpm"},
    "ohm": {1.0: "ohm|Ohm|Ω|Ω|ohms", 1e3: "kΩ|kOhm", 1e6: "MOhm|MΩ", 1e-3: "mOhm"},
    "kg": {1.0: "kg|Kg|kilogram", 1e-3: "gram|grams", 453.59237e-3: "pound"},
    "m**3": {1e-3: "L|l|liter", 1e-6: "mL|ml"},
    "kg*m**2": {1.0: "kg*m2|kg-m2|kg m²|kg·m^2"},
    "N*m/A": {1.0: "N*m/A|Nm/A"},
    "N*m*s/rad": {1.0: "N*m*s/rad|N*m/(rad/s)"},
    "1": {
        1.0: "1|-|–|none", 0.01: "%|percent|%RH|% RH|%rH|%rF|% r.H.|Prozent",
        1e-3: "‰", 1e-6: "ppm",
    },
}  # fmt: skip
ROWS = [
    (text, factor, si)
    for si, factors in KNOWN.items()
    for factor, spellings in factors.items()
    for text in (spellings.split("|") if "|" in spellings or si not in ("m", "s") else
                 spellings.split())
]  # fmt: skip


def test_the_table_is_long_enough_to_matter():
    assert len({text for text, _, _ in ROWS}) >= 200


@pytest.mark.parametrize(("text", "factor", "si"), ROWS)
def test_a_spelling_has_its_value_in_si(text, factor, si):
    found, offset, unit = units.si_of(text, "here")
    # 1e-9: constants such as that of the pound are rounded here
    assert (unit, offset, found) == (si, 0.0, pytest.approx(factor, rel=1e-9))


@pytest.mark.parametrize(
    "text", ["°C", "degC", "deg C", "ºC", "℃", "Celsius", "Grad Celsius", "'C", "Â°C"]
)
def test_degrees_of_celsius_have_their_offset(text):
    assert units.si_of(text, "") == (pytest.approx(1.0), pytest.approx(273.15), "K")


@pytest.mark.parametrize("text", ["°F", "degF", "deg F"])
def test_degrees_of_fahrenheit_have_their_offset(text):
    factor, offset, unit = units.si_of(text, "")
    assert (100 * factor + offset, unit) == (pytest.approx(310.928, abs=1e-3), "K")


@pytest.mark.parametrize(
    "text",
    ["a", "k", "c", "e", "d", "t", "M", "Mg", "MS", "mS", "S", "S/s", "RH", "mhz", "MV", "U", "r",
     "tr", "year", "J/kg K", "W/m.K", "m/s-1", "rad/s)", "m)", "2m", "furlong", "gradian", "fps",
     "cd", "As-1", "Nm2", "kg ms-2", "rpm-1"],
)  # fmt: skip
def test_what_may_be_anything_is_no_unit(text):
    with pytest.raises(InputError, match="is not a unit"):
        units.si_of(text, "")


@pytest.mark.parametrize(
    ("text", "ways"),
    [
        ("g", "gram or g_0"), ("mg", "milligram or mg_0"), ("µg", "microgram or ug_0"),
        ("G", "g_0 or gauss"), ("mG", "mg_0 or mgauss"), ("Gs", "g_0 or gauss"),
        ("C", "degC or coulomb"), ("F", "degF or farad"), ("lb", "pound or lbf"),
        ("lbs", "pound or lbf"), ("oz", "ounce or ozf"), ("nm", "nanometer or N[*]m"),
        ("kn", "knot or kN"), ("gal", "Gal or gallon"),
        ("ms⁻¹", "1/ms or m/s"), ("ms-1", "1/ms or m/s"), ("ms^-1", "1/ms or m/s"),
        ("rads", "rad/s or rad"), ("degs", "deg/s or deg"), ("KN", "knot or kN"),
    ],
)  # fmt: skip
def test_a_spelling_of_two_units_is_asked_for_with_what_to_write(text, ways):
    with pytest.raises(InputError, match=f"may be .* write {ways}$"):
        units.si_of(text, "")


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("px", "unit: m, scale: metres per pixel"), ("px/s", "metres per pixel"),
        ("LSB", "the size of one count"), ("counts", "the size of one count"),
        ("bit", "the size of one count"), ("dB", "a level"), ("eRPM", "pole pairs"),
    ],
)  # fmt: skip
def test_what_counts_is_told_what_to_write(text, hint):
    with pytest.raises(InputError, match=hint):
        units.si_of(text, "")


@pytest.mark.parametrize(
    ("name", "unit", "meant"),
    [
        ("ax", "mg", "mg_0"), ("a_x", "mg", "mg_0"), ("acc_z", "g", "g_0"), ("Acc X", "G", "g_0"),
        ("mass", "mg", "milligram"), ("weight", "g", "gram"), ("Gewicht", "g", "gram"),
        ("temp", "C", "degC"), ("T_motor temperature", "F", "degF"), ("magX", "mG", "mgauss"),
        ("Bx", "G", "gauss"), ("thrust", "lbs", "lbf"), ("mass", "lb", "pound"),
        ("weight", "lb", "lb"),
        ("torque", "nm", "N*m"), ("wind speed", "kn", "knot"),
        ("thrust", "g", "gf"), ("force", "kg", "kgf"), ("Motordrehmoment", "NM", "N*m"),
        ("load", "g", "gram"),
        ("T", "C", "degC"), ("m", "g", "gram"), ("F t", "kg", "kg"), ("F f", "kg", "kgf"),
        ("B", "mG", "mgauss"), ("T t", "nm", "N*m"), ("v", "ms", "m/s"), ("lap time", "ms", "ms"),
        ("force", "kn", "kN"), ("F", "KN", "kN"), ("v2", "kn", "knot"),
        ("v", "ms⁻¹", "m/s"), ("speed", "ms^-1", "m/s"), ("sample rate", "ms^-1", "ms^-1"),
        ("angle", "rads", "rad"), ("omega", "rads", "rad/s"), ("gyro", "rads", "rads"),
        ("Drehzahl", "1/s", "turn/s"), ("omega", "1/s", "rad/s"), ("heart rate", "1/min", "bpm"),
        ("motor speed", "1/min", "1/min"), ("x", "g", "g"), ("x-axis", "mg", "mg"), ("n", "V", "V"),
    ],
)  # fmt: skip
def test_the_name_of_a_column_decides_between_two_meanings(name, unit, meant):
    assert quantity.meant(name, unit) == meant


@pytest.mark.parametrize(
    ("name", "si"),
    [("humidity", "H"), ("Motordrehmoment", "K"), ("T", "rad"),
     ("temperature", "N*m"), ("Drehmoment", "K"),
     ("force", "m"), ("ax", "kg"),
     ("pressure", "kg"), ("speed", "N"), ("Winkel", "m"), ("mass", "m/s**2"), ("power", "J")],
)  # fmt: skip
def test_a_quantity_cannot_have_just_any_unit(name, si):
    assert "by its name" in quantity.contradiction(name, si)


@pytest.mark.parametrize(
    ("name", "si"),
    [("torque", "V"), ("force", "1"), ("pressure", "A"), ("yaw rate", "rad/s"), ("acc time", "s"),
     ("temperature gradient", "K/W"), ("torque constant", "N*m/A"),
     ("moment of inertia", "kg*m**2"),
     ("gyro temp", "K"), ("mag", "m/s**2"), ("position rate", "m/s"), ("hAcc", "m"), ("foo", "H"),
     ("a", "rad"), ("Extension", "m"), ("T", "N"),
     ("imu roll", "rad")],
)  # fmt: skip
def test_what_a_sensor_gives_besides_is_not_refused(name, si):
    assert quantity.contradiction(name, si) == ""


@pytest.mark.parametrize("text", ["Hz/s", "1/s²", "m/rev"])
def test_an_angle_is_neither_added_nor_lost(text):
    with pytest.raises(InputError, match="has no place here"):
        units.si_of(text, "here")


@pytest.mark.parametrize(
    ("name", "unit"),
    [("motor_torque_nm", "N*m"), ("current_a", "A"), ("voltage_v", "V"), ("temp_c", "degC"),
     ("Engine RPM", "RPM"), ("rpm", "rpm"), ("battery volts", "volts"), ("x_s", ""), ("enc_a", ""),
     ("speed_set", ""), ("u_in", ""), ("pos_x", ""), ("angle_a", ""),
     ("vel_rev_s", "rev/s"), ("vel_turns_per_s", "turns/s"), ("speed_m_per_s", "m/s"),
     ("rate_rad_per_s", "rad/s"), ("omega_rev_s", "rev/s"), ("speed_counts_s", "counts/s"),
     ("flow_l_s", "l/s"), ("speed_km_h", "km/h"), ("k_Nm_A", "Nm/A"), ("tau_mN_m", "mN*m"),
     ("torque_oz_in", "oz*in"), ("torque_N_mm", "N*mm"), ("stiffness_N_mm", "N/mm"),
     ("acc_m_s_2_", "m/s2"), ("theta_rad_", "rad"), ("thetadot_rad_s_", "rad/s"),
     ("torque_Nm_", "Nm"), ("angle°", "°"), ("v m/s", "m/s"), ("current_ma", "mA"),
     ("voltage_mv", "mV"), ("dist_ft", "ft"), ("x_px", "px"), ("time_in_s", "s"),
     ("t_min_s", "s"), ("T_min_K", "K"), ("phase_A_V", "V"), ("motor_L_rad_s", "rad/s"),
     ("leg_l_mm", "mm"), ("lap_time_s", "s"), ("accel_g_m_s2", "m/s**2")],
)  # fmt: skip
def test_a_name_may_say_its_unit_where_nothing_else_can_be_meant(name, unit):
    assert endings.of(name).unit == unit


@pytest.mark.parametrize(
    ("name", "proposed"),
    [("x_per_s", ""), ("clicks_per_s", ""), ("tick_rate_s", "s"), ("speed_s", "s"),
     ("current_mA_s", "mA*s"), ("kv_rpm_V", ""), ("ke_mV_rpm", ""), ("x_kN_m", "kN*m"),
     ("k_N_mm", "N*mm"), ("arm_l_s", "l/s"), ("x_cm_s", "cm/s"), ("dose_g_s", "g/s"),
     ("flux_W_m2", ""), ("inertia_kg_cm2", ""),
     ("dist_in", "in"), ("drift_deg_s_K", ""), ("pressure_mpa", "MPa"), ("sens_mV_g", "")],
)  # fmt: skip
def test_a_name_that_may_end_otherwise_has_no_unit_but_a_proposal(name, proposed):
    end = endings.of(name)
    assert (end.unit, end.proposed) == ("", proposed)


@pytest.mark.parametrize(
    ("name", "is_one"),
    [("dT", True), ("ΔT", True), ("temp_diff", True), ("Temperature difference", True),
     ("Differenz", True), ("u(Temp)", True), ("σ_T", True), ("dTemp", True), ("Erwärmung", True),
     ("T", False), ("Temperature", False), ("T_u", False), ("dew point", False), ("dut", False)],
)  # fmt: skip
def test_a_difference_of_temperatures_has_no_offset(name, is_one):
    assert quantity.to_si(name, "°C") == (1.0, 0.0 if is_one else pytest.approx(273.15), "K")


def test_what_may_be_a_difference_is_asked_for():
    assert "write K for a difference" in quantity.may_differ("temperature change", "°C")
    assert quantity.may_differ("temperature change", "K") == ""


def test_greek_letters_are_spelled():
    assert quantity.words("ω1 Δx") == ["omega", "delta", "x"]
    assert quantity.meant("ω", "1/s") == quantity.meant("Winkelgeschw.", "1/s") == "rad/s"
    assert naming.slug("θ_2 [°]") == "theta_2"


@pytest.mark.parametrize("text", ["m0", "s^0", "K^-0", "m*s0"])
def test_a_power_of_zero_is_no_unit(text):
    with pytest.raises(InputError, match="is not a unit"):
        units.si_of(text, "here")
