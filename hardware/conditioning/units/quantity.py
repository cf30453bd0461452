"""What a column measures, by its name, and which units that can have."""

from __future__ import annotations

import re
import unicodedata

from simcompare import units
from simcompare.errors import InputError

#: SI units of a quantity -> words of names that say it
_WORDS = {
    ("1",): "humidity rh feuchte luftfeuchte luftfeuchtigkeit humidite",
    ("K",): "temperature temperatures temp temperatur tair tambient",
    ("N*m",): "torque drehmoment couple",
    ("N", "N*m"): "moment",
    ("N", "N*m", "kg"): "load",
    ("N",): "force kraft thrust schub poussee",
    ("Pa",): "pressure press druck luftdruck pression baro barometer",
    ("V",): "voltage volt volts vbat vbatt vcc uout uin",
    ("V", "Pa"): "spannung",
    ("V", "N", "N*m"): "tension",
    ("A",): "current strom courant amperage ibat",
    ("kg",): "mass masse",
    ("kg", "N"): "weight gewicht poids",
    ("rad",): "angle winkel roll yaw heading azimuth",
    ("m/s**2", "rad/s**2"): "acceleration accelerations accel accelerometer beschleunigung linacc"
    " ax ay az accx accy accz",
    ("m/s**2", "rad/s**2", "m"): "acc",
    ("rad/s", "rad"): "gyro gyroscope gyr gyrx gyry gyrz",
    ("rad/s",): "drehzahl rpm drehrate",
    ("tesla",): "magnetometer mag magx magy magz magnetic magnetfeld field bx by bz",
    ("m/s", "rad/s"): "speed velocity geschwindigkeit vitesse vel",
    ("N/m", "N*m/rad"): "stiffness steifigkeit federkonstante",
    ("m",): "coordinate coordinates distance dist height altitude alt abstand weg hoehe"
    " displacement",
    ("s",): "minute minutes hour hours",
    ("m/s**2", "m/s", "m"): "vibration shock",
    ("Hz", "rad/s"): "frequency frequenz frequence",
    ("W",): "power leistung puissance",
    ("J", "A*s"): "energy energie",
    ("A*s",): "charge ladung",
    ("m**3/s",): "flow durchfluss volumenstrom",
    ("rad", "m"): "position pos pitch",
}  # fmt: skip
#: SI units of what is called by one letter or a Greek one, as written
_SYMBOLS = {
    **dict.fromkeys("xyzhdrlsbe", ("m",)), "t": ("s",), "T": ("s", "K", "N*m", "N"),
    "v": ("m/s", "V"),
    "u": ("V", "m/s"), "U": ("V",), "V": ("V", "m**3"), "i": ("A",), "I": ("A",), "F": ("N",),
    "f": ("N", "Hz"), "M": ("N*m",), "n": ("rad/s", "Hz"), "w": ("rad/s",), "omega": ("rad/s",),
    "q": ("rad", "m", "A*s"), "p": ("Pa", "m"), "P": ("W",), "a": ("m/s**2",), "m": ("kg",),
    **dict.fromkeys(("theta", "phi", "alpha", "beta", "psi"), ("rad",)), "tau": ("N*m", "s"),
    "E": ("J", "V"), "B": ("tesla",), "R": ("ohm",), "L": ("H", "m"),
}  # fmt: skip
#: words of names that speak of a time
_TIMES = frozenset(
    ("time", "zeit", "dt", "t", "delay", "duration", "dauer", "age", "stamp", "timestamp", "period",
     "latency", "interval", "elapsed", "lag", "uptime", "clock", "seconds", "step")
)  # fmt: skip
#: German words that end longer ones, such as Motordrehmoment
_GERMAN = (
    "drehmoment", "drehzahl", "spannung", "strom", "temperatur", "druck", "kraft", "winkel",
    "geschwindigkeit", "beschleunigung", "leistung", "gewicht", "energie",
)  # fmt: skip
_QUANTITY = {word: si for si, words in _WORDS.items() for word in words.split()}
#: units of which a name can say that it has another; what a sensor gives before it is calibrated
#: (a voltage, a current, a plain number) and what belongs to a sample (a time) fits to any name
_JUDGED = frozenset(
    ("K", "N*m", "N", "Pa", "kg", "rad", "m", "m/s**2", "rad/s", "m/s", "tesla", "J", "W", "H",
     "A*s", "kg*m/s", "m**2", "m**3", "N/m", "m**3/s", "m/s**3", "K/s", "rad/s**2")
)  # fmt: skip
#: words that make another quantity of one, or that mean two things
OTHERWISE = frozenset(
    (
        "rate",
        "constant",
        "gradient",
        "per",
        "dot",
        "coefficient",
        "mag",
        "field",
        "by",
        "change",
        "current",
        "bearing",
    )
)
#: names of a speed of rotation, whose numbers "1/s" are turns in a second
_TURNS = frozenset(("n", "drehzahl", "speed", "rpm", "rev", "revs", "motor", "spindle", "wheel"))
#: and of a rate of an angle, whose numbers "1/s" are radians in a second
_RATES = frozenset(
    ("omega", "w", "angular", "gyro", "gyr", "gyroscope", "winkelgeschwindigkeit", "winkelgeschw",
     "kreisfrequenz", "drehrate")
)  # fmt: skip
#: names of what beats without turning
_BEATS = frozenset(("heart", "hr", "puls", "pulse", "beat", "beats", "breath", "count", "rate"))
#: columns whose name says that they measure an acceleration
_ACCELERATION = re.compile(
    r"acc|imu|specific.?force|(^|[_ ])a[xyz]?($|[_ ])|^g[xyz]?force", re.IGNORECASE
)
_NO_ACCELERATION = re.compile(r"gyr|mag|ang|rate|accura", re.IGNORECASE)
#: words of what sets a controller
GAINS = frozenset(("kp", "ki", "kd", "gain", "limit"))
#: names that end with one of them are of what was counted
_COUNTS = frozenset(("counts", "cnts", "ticks"))
#: words of what has the unit of a quantity and not its zero
_DIFFERENCES = frozenset(
    ("diff", "difference", "differenz", "delta", "sigma", "unc", "uncertainty", "unsicherheit",
     "err", "fehler", "stdev", "stddev", "deviation", "abweichung", "residual", "spread", "ecart",
     "erwarmung", "erwaermung", "anderung", "aenderung", "incertitude", "hysteresis", "tolerance")
)  # fmt: skip
_CHANGE = re.compile(r"[dD]_?T(?:emp|(?![A-Za-z]))|[uU]_?\(|u_?T(?![a-z])|u_|±")
#: words that may say so, as in temperature change, and in phase change temperature
_MAY_DIFFER = frozenset(("error", "std", "change", "rise", "drop", "offset", "noise", "rms", "sd"))
#: Greek letters that Unicode calls otherwise
_GREEK = {"LAMDA": "lambda"}
#: what a mass stands for in the name of a force
_WEIGHT = {"g": "gf", "kg": "kgf", "kgs": "kgf", "Kg": "kgf", "KG": "kgf"}
_PER_SECOND = re.compile(r"1 ?/ ?s(?:ec)?|s\^?-1|s⁻¹")
_PER_MINUTE = re.compile(r"1 ?/ ?min|min\^?-1|min⁻¹")


def counts(name: str) -> bool:
    """Whether a column holds numbers of counts, such as ``TargetCounts``: plain numbers."""
    return bool(_COUNTS & {*words(name)[-1:]})


def latin(name: str) -> str:
    """A name in letters of ASCII; Greek ones are spelled: ``ω_1`` becomes ``omega_1``."""
    spelled = "".join(_spelled_letter(sign) for sign in name)
    return unicodedata.normalize("NFKD", spelled).encode("ascii", "ignore").decode()


def _spelled_letter(sign: str) -> str:
    greek = re.fullmatch(r"GREEK (?:SMALL|CAPITAL) LETTER (?:FINAL )?([A-Z]+)", _called(sign))
    if greek is None or sign == "Ω":  # which is written for the ohm
        return sign
    return f" {_GREEK.get(greek[1], greek[1].lower())} "


def _called(sign: str) -> str:
    return "" if sign.isascii() else unicodedata.name(unicodedata.normalize("NFC", sign), "")


def is_difference(name: str) -> bool:
    """Whether a name speaks of a difference or an uncertainty, which has no zero of its own."""
    said = {*words(name)}
    return bool(said & _DIFFERENCES) or bool(_CHANGE.match(name.strip()))


def may_differ(name: str, unit: str) -> str:
    """Why a column in degrees may be of temperatures or of differences, empty where it is told."""
    if not units.si_of(unit, "")[1] or is_difference(name) or not _MAY_DIFFER & {*words(name)}:
        return ""
    return "may be a temperature or a difference of two; write K for a difference in °C"


def words(name: str) -> list[str]:
    """Words of a name in small letters, however they are joined."""
    plain = latin(name)
    split = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", " ", plain)
    return [word.lower() for word in re.findall(r"[A-Za-z]+", split)]


def measures_acceleration(name: str) -> bool:
    """Whether a name says that its column is an acceleration."""
    return bool(_ACCELERATION.search(name)) and not _NO_ACCELERATION.search(name)


def measured(name: str) -> frozenset[str]:
    """SI units that a quantity of that name can have; none where the name does not say."""
    return _said(name) | ({"m/s**2"} if measures_acceleration(name) else frozenset())


def _said(name: str) -> frozenset[str]:
    return frozenset(si for word in words(name) for si in _units_of(word))


def _units_of(word: str) -> tuple[str, ...]:
    """Units of what a word says, also at the end of a German one: Motordrehmoment."""
    ending = next((known for known in _GERMAN if word.endswith(known)), "")
    return _QUANTITY.get(word) or _QUANTITY.get(ending, ())


def is_time(name: str) -> bool:
    """Whether a name speaks of a time."""
    return bool(_TIMES & {*words(name)})


def meant(name: str, unit: str) -> str:
    """A unit as it is meant in a column of that name; itself where the name does not decide."""
    unit = _rate(name, unit)
    several, fitting_name = units.ways(unit), possible(name)
    if unit == "m" and {"minute", "minutes"} & {*words(name)}:
        return "min"
    if unit == "ms" and "m/s" in fitting_name and not _TIMES & {*words(name)}:
        return "m/s"  # as in speed_ms
    if fitting_name == {"N"}:  # a force in kg is the weight of them
        unit = _WEIGHT.get(unit.strip(), unit)
    fitting = [way for way in several if si_of(way) in fitting_name]
    return fitting[0] if len(fitting) == 1 and len(several) > 1 else unit


def possible(name: str) -> frozenset[str]:
    """SI units that what is called by words or by one letter can have, none if nothing is said."""
    return measured(name) or of_letter(name)


def of_letter(name: str) -> frozenset[str]:
    """SI units of what is called by one letter."""
    parts = [part.rstrip("0123456789") for part in name.split()] or [""]
    alike = len({part.lower() for part in parts}) == 1
    return frozenset(_SYMBOLS.get(parts[0], ()) if alike else ())


def contradiction(name: str, si: str) -> str:
    """Why a quantity of that name cannot be in that SI unit, empty where it can."""
    possible = _said(name) or frozenset(_SYMBOLS["T"] if name == "T" else ())
    if not possible or si in possible or si not in _JUDGED or OTHERWISE & {*words(name)}:
        return ""
    named = " or ".join(_spoken(one) for one in sorted(possible))
    return f"is in {_spoken(si)}, but by its name in {named}"


def _spoken(si: str) -> str:
    return "a plain number" if si == "1" else units.symbol(si)


def _rate(name: str, unit: str) -> str:
    said = {*words(name)}
    if _PER_SECOND.fullmatch(unit.strip()):
        return "rad/s" if said & _RATES else "turn/s" if said & _TURNS else unit
    if _PER_MINUTE.fullmatch(unit.strip()) and said & _BEATS and not said & _TURNS:
        return "bpm"
    return unit


def to_si(name: str, unit: str) -> tuple[float, float, str]:
    """Factor, offset and SI unit of a column; a difference of temperatures has no offset.

    Raises:
        InputError: the unit is none.
    """
    factor, offset, si = units.si_of(unit, "")
    return factor, 0.0 if offset and is_difference(name) else offset, si


def si_of(unit: str) -> str:
    """The SI unit of what is in a unit, empty where that is none."""
    try:
        return units.si_of(unit, "")[2]
    except InputError:
        return ""
