"""Spellings of units in logs and on sheets, as data. What does not stand here is no unit.

pint alone reads far more, and much of it as nobody means it: ``a`` as a year, ``k`` as Boltzmann's
constant, ``%RH`` as a product of henries, ``gal`` as a gallon.
"""

from __future__ import annotations

PREFIXES = {
    "p": "pico", "n": "nano", "u": "micro", "μ": "micro", "m": "milli", "c": "centi", "d": "deci",
    "h": "hecto", "k": "kilo", "M": "mega", "G": "giga",
}  # fmt: skip
#: symbol -> unit of pint, and the prefixes that are used with it
SYMBOLS = {
    "m": ("meter", "pnuμmcdk"), "s": ("second", "pnuμm"), "g": ("gram", "uμm"),
    "N": ("newton", "nuμmckM"), "Pa": ("pascal", "uμmhkMG"), "bar": ("bar", "uμmk"),
    "V": ("volt", "nuμmk"), "A": ("ampere", "pnuμmk"), "W": ("watt", "nuμmkMG"),
    "J": ("joule", "uμmkM"), "Hz": ("hertz", "mkMG"), "T": ("tesla", "pnuμm"),
    "rad": ("radian", "nuμmk"), "deg": ("degree", "uμmk"), "°": ("degree", "m"),
    "K": ("kelvin", "uμmk"), "Ω": ("ohm", "uμmkMG"), "ohm": ("ohm", "uμmkMG"),
    "H": ("henry", "nuμm"), "Wh": ("(watt*hour)", "mkM"), "Ah": ("(ampere*hour)", "m"),
    "Nm": ("(newton*meter)", "uμmck"), "As": ("(ampere*second)", "mk"),
    "Ws": ("(watt*second)", "mk"), "rps": ("(turn/second)", ""), "dps": ("(degree/second)", "mk"),
    "rpm": ("(turn/minute)", "mk"), "g_0": ("standard_gravity", "nuμmk"),
    "gee": ("standard_gravity", "m"), "Gal": ("galileo", "uμm"), "gf": ("force_gram", "k"),
    "gauss": ("log_gauss", "uμmk"), "Gs": ("log_gauss", "m"), "turn": ("turn", "mk"),
    "L": ("liter", "uμmcd"), "l": ("liter", "uμmcd"),
}  # fmt: skip
#: unit of pint -> what else is written for it; with three letters or more in any case of them
WORDS = {
    "second": "sec secs second seconds seconde secondes sekunde sekunden sek segundos",
    "millisecond": "msec msecs millis", "microsecond": "usec usecs μsec micros",
    "nanosecond": "nsec nsecs nanos", "minute": "min mins minute minutes minuten",
    "hour": "h hr hrs hour hours std stunde stunden heure heures", "day": "day days tag tage",
    "meter": "meter meters metre metres mtr", "centimeter": "CM Cm", "millimeter": "MM Mm",
    "kilometer": "KM Km", "gram": "gram grams gramm gramme grammes", "kilogram": "kg kgs KG Kg",
    "tonne": "tonne tonnes", "newton": "newton newtons", "decanewton": "daN",
    "pascal": "pascal pascals pa", "hectopascal": "HPA HPa Hpa hpa",
    "kilopascal": "KPA KPa Kpa kpa", "millibar": "mbar mb mB", "volt": "volt volts VDC VAC Vrms",
    "ampere": "amp amps ampere amperes ampère", "watt": "watt watts", "joule": "joule joules",
    "hertz": "hertz hz HZ", "kilohertz": "KHz Khz khz", "megahertz": "Mhz", "tesla": "tesla",
    "kelvin": "kelvin kelvins", "ohm": "ohms", "radian": "rads radian radians radiant",
    "degree": "degree degrees degs grad", "arcminute": "arcmin", "arcsecond": "arcsec ″",
    "turn": "U u tr r turns tour tours rev revs revolution revolutions rot umdr umdrehung"
    " umdrehungen", "standard_gravity": "g0 gn gees g_n gforce",
    "percent": "% pct percent prozent pourcent %rh %rf rh%", "permille": "‰ permille",
    "ppm": "ppm με microstrain ustrain", "grade": "gon", "degree_Celsius": "°C degC oC celsius",
    "degree_Fahrenheit": "°F degF fahrenheit", "inch": "in inch inches", "foot": "ft foot feet",
    "yard": "yd yard yards", "mile": "mi mile miles", "knot": "kt kts knot knots",
    "force_pound": "lbf", "force_ounce": "ozf", "force_kilogram": "kp kilopond",
    "pound": "lb lbs pound", "ounce": "oz ounce", "psi": "psi", "(kip/inch**2)": "ksi",
    "standard_atmosphere": "atm",
    "torr": "torr", "(1/minute)": "bpm", "(turn/minute)": "upm",
    "millimeter_Hg": "mmHg", "inch_Hg": "inHg", "horsepower": "hp", "metric_horsepower": "PS",
    "(mile/hour)": "mph", "(kilometer/hour)": "kph kmh kmph", "(meter/second)": "mps",
    "(meter/second**2)": "mpss mps2", "(newton*centimeter)": "Ncm", "(newton*millimeter)": "Nmm",
    "(millinewton*millimeter)": "mNmm", "(force_kilogram*centimeter)": "kgcm kgfcm",
    "(force_gram*centimeter)": "gcm gfcm", "(force_ounce*inch)": "ozin",
    "(force_pound*inch)": "inlb inlbs lbin inlbf lbfin",
    "(force_pound*foot)": "ftlb ftlbs lbft ftlbf lbfft", "gallon": "gallon gallons",
    "liter": "liter liters litre litres",
    "(liter/minute)": "lpm", "kilocalorie": "kcal", "electron_volt": "eV",
    "coulomb": "coulomb", "farad": "farad", "nanometer": "nanometer", "milligram": "milligram",
    "microgram": "microgram",
}  # fmt: skip
#: what else is written for one of the next
SAME = {
    "lbs": "lb", "LBS": "lb", "Lbs": "lb", "LB": "lb", "pounds": "lb", "ounces": "oz", "g's": "g",
    "G's": "g", "μg": "ug", "gs": "g", "Gs": "G", "mGs": "mG", "NM": "nm", "M/s": "m/s",
    "M/s2": "m/s2", "M/s^2": "m/s2",
    "KN": "kn", "ms2": "m/s2", "ms^2": "m/s2",
}  # fmt: skip
#: spelling with several meanings -> how each is written without doubt
AMBIGUOUS = {
    "g": ("gram", "g_0"), "mg": ("milligram", "mg_0"), "ug": ("microgram", "ug_0"),
    "G": ("g_0", "gauss"), "mG": ("mg_0", "mgauss"), "C": ("degC", "coulomb"),
    "F": ("degF", "farad"), "lb": ("pound", "lbf"), "oz": ("ounce", "ozf"),
    "nm": ("nanometer", "N*m"), "kn": ("knot", "kN"), "gal": ("Gal", "gallon"),
    "ms^-1": ("1/ms", "m/s"), "rads": ("rad/s", "rad"), "degs": ("deg/s", "deg"),
    "revs": ("turn/s", "turn"),
}  # fmt: skip
#: what they are called in words
SPOKEN = {
    "g_0": "standard gravity", "mg_0": "thousandth of standard gravity",
    "ug_0": "millionth of standard gravity", "degC": "degree Celsius",
    "degF": "degree Fahrenheit", "lbf": "pound of force", "ozf": "ounce of force",
    "N*m": "newton metre", "kN": "kilonewton",
    "mgauss": "milligauss", "pound": "pound of mass", "ounce": "ounce of mass",
    "Gal": "gal (cm/s²)",
}  # fmt: skip
_COUNTS = "write the unit and the scale, the size of one count; or 1 for a plain number"
#: what stands in the place of a unit and is none -> what to do
NO_UNITS = {
    **dict.fromkeys(("px", "pix", "pixel", "pixels"), "write unit: m, scale: metres per pixel"),
    **dict.fromkeys(
        ("LSB", "LSBs", "lsb", "count", "counts", "cts", "ticks", "digit", "digits", "steps", "bit",
         "bits", "raw", "ADU", "ADC"), _COUNTS),
    **dict.fromkeys(
        ("dB", "dBm", "dBV", "dBFS", "dBA", "dB SPL"), "a level; write 1 for a plain number"),
    **dict.fromkeys(
        ("ERPM", "eRPM", "erpm"),
        "a motor turns slower by its pole pairs: write unit: rpm, scale: 1/pole pairs"),
    **dict.fromkeys(
        ("lx", "lux", "a.u.", "au", "arb", "pH"), "no place for it; write 1 for a plain number"),
}  # fmt: skip
#: what says that a number has no unit
PLAIN = ("", "1", "-", "–", "—", "none", "None", "bool", "boolean", "unitless", "dimensionless")
ANGLES = ("radian", "degree", "grade", "turn", "arcminute", "arcsecond")
ENERGIES = ("joule", "watt*hour", "watt*second", "calorie", "electron_volt")
#: alone they have an offset, in products they are differences
TEMPERATURES = {
    "degree_Celsius": "delta_degree_Celsius", "degree_Fahrenheit": "delta_degree_Fahrenheit",
}  # fmt: skip
#: a mass that is multiplied with a length, or divided by a small area, is meant as its weight
WEIGHTS = {
    "gram": "force_gram", "kilogram": "force_kilogram", "pound": "force_pound",
    "ounce": "force_ounce",
}  # fmt: skip
LENGTHS = ("meter", "centimeter", "millimeter", "inch", "foot")
#: what means something else when it stands alone
ONLY_IN_PRODUCTS = ("U", "u", "tr", "r")
