"""Numbers of a range sensor of many zones, from its data sheet, and what follows from them.

A zone sees a target by the light that comes back: ρ·cos θ/R² of a matt surface of reflectance ρ at
the distance R. The sheet's largest distances tell how much is needed. In the dark that is the same
for its white and for its grey target, within 7 %; in ambient light it is what stands out of the
scatter of the background, which grows with the root of light and reflectance: √(a² + b²·ρ·E). That
zones at the corners see less far needs no number of its own: their rays are longer, and aslant.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path

from simcompare.errors import InputError, unknown_or_missing
from simcompare.hardware.sensors import sheet_reading, sheets
from simcompare.hardware.sensors.sheet_file import ZoneFile

_NO_ZONES = (
    "it says nothing of zones, which a range sensor of many zones needs; give a sheet that does,"
    " such as vl53l5cx"
)


@dataclass(frozen=True)
class ZoneNumbers:
    """Numbers of one mode; distances [m], accuracies of far distances as parts of these.

    Attributes:
        rate_Hz: most frames in a second.
        reach_m: largest distance that is told.
        nearest_m: least distance for which an accuracy is stated.
        count_m: size of one count.
        white: reflectance of the white target.
        grey: of the grey target, at the sensor's wavelength.
        white_dark_m: largest distance of the white target in the dark, inner zones.
        grey_dark_m: of the grey one.
        white_ambient_m: of the white target in ambient light.
        grey_ambient_m: of the grey one.
        corner_white_dark_m: the same in the zones at the corners; the model is checked with these.
        corner_grey_dark_m: the same.
        corner_white_ambient_m: the same.
        corner_grey_ambient_m: the same.
        ambient_klux: of that ambient light.
        detection_rate: part of the frames in which a target there is found.
        near_m: accuracy of near distances.
        far: accuracy in the dark.
        far_white_ambient: of the white target in ambient light.
        far_grey_ambient: of the grey one.
        sigmas: standard deviations that an accuracy is.
        drift_m_per_K: of the offset.
        nominal_C: where it is 0.
        targets: most targets in a zone.
        separation_m: least distance between two of them.
        noise_floor_m: scatter of near readings.
        noise_dark: scatter in the dark on the grey target, part of the distance.
        background_sigmas: by which a signal must stand out.
        pulse_m: spread in a zone from which on a reading is marked.
        shared: part of the variance of what stays that all zones share.
    """

    rate_Hz: float
    reach_m: float
    nearest_m: float
    count_m: float
    white: float
    grey: float
    white_dark_m: float
    grey_dark_m: float
    white_ambient_m: float
    grey_ambient_m: float
    corner_white_dark_m: float
    corner_grey_dark_m: float
    corner_white_ambient_m: float
    corner_grey_ambient_m: float
    ambient_klux: float
    detection_rate: float
    near_m: float
    far: float
    far_white_ambient: float
    far_grey_ambient: float
    sigmas: float
    drift_m_per_K: float
    nominal_C: float
    targets: float
    separation_m: float
    noise_floor_m: float
    noise_dark: float
    background_sigmas: float
    pulse_m: float
    shared: float

    @functools.cached_property
    def least_signal(self) -> float:
        """Signal ρ/R² that is found in the dark [1/m²]; a target at the reach may tell no more."""
        seen = [(self.white, self.white_dark_m), (self.grey, self.grey_dark_m)]
        found = [rho / far**2 for rho, far in seen if far < self.reach_m]
        return math.exp(sum(map(math.log, found)) / len(found))

    @functools.cached_property
    def background(self) -> float:
        """Signal that stands out of a background ρ·E of 1 klux, white target [1/(m²·√klux)]."""
        seen = ((self.white, self.white_ambient_m), (self.grey, self.grey_ambient_m))
        found = [
            math.sqrt(((rho / far**2) ** 2 - self.least_signal**2) / (rho * self.ambient_klux))
            for rho, far in seen
        ]
        return math.sqrt(math.prod(found))

    @functools.cached_property
    def stays_far(self) -> float:
        """Standard deviation over devices of what stays, part of a far distance."""
        return math.sqrt((self.far / self.sigmas) ** 2 - self.noise_dark**2)

    @functools.cached_property
    def stays_near_m(self) -> float:
        """Standard deviation over devices of what stays near by."""
        return math.sqrt((self.near_m / self.sigmas) ** 2 - self.noise_floor_m**2)

    @functools.cached_property
    def dark_scatter_m(self) -> float:
        """Scatter by a signal of 1/m² in the dark, which falls with its root."""
        return self.noise_dark * math.sqrt(self.grey)

    @functools.cached_property
    def ambient_scatter_m(self) -> float:
        """Scatter by ambient light, σ = this·√(ρ·E)/signal; accuracies hold at the farthest."""
        found = []
        for rho, far_m, whole in (
            (self.white, self.white_ambient_m, self.far_white_ambient),
            (self.grey, self.grey_ambient_m, self.far_grey_ambient),
        ):
            more_m = math.sqrt(whole**2 - self.far**2) / self.sigmas * far_m
            found.append(more_m * rho / far_m**2 / math.sqrt(rho * self.ambient_klux))
        return math.sqrt(math.prod(found))


@dataclass(frozen=True)
class ZoneSheet:
    """A data sheet of a range sensor of many zones.

    Attributes:
        name: of its file.
        chip: what the maker calls it.
        document: of the maker.
        rows: zones in a row -> every number with its source.
    """

    name: str
    chip: str
    document: str
    rows: dict[int, tuple[ZoneFile, ...]]

    def numbers(self, zones: int) -> ZoneNumbers:
        """Numbers of the mode with so many zones in a row."""
        return ZoneNumbers(**{row.term: row.value for row in self.rows[zones]})


def load(name_or_path: str | Path) -> ZoneSheet:
    """The sheet of that name, or the user's own.

    Raises:
        UnknownName: no sheet is called so.
        NoSuchFile: there is no such file.
        InputError: it has no zones, or not all of their numbers; all faults at once.
    """
    path = sheets.files().get(str(name_or_path).lower(), Path(name_or_path))
    if not path.is_file():
        raise unknown_or_missing("data sheet", str(name_or_path), sheets.files())
    return _loaded(path, path.stat().st_mtime_ns)


@functools.lru_cache
def _loaded(path: Path, changed_ns: int) -> ZoneSheet:
    """The sheet as it was at that instant; devices are drawn from it anew in every episode."""
    del changed_ns
    content, _ = sheet_reading.read(path)
    if content.zones is None:
        raise InputError(f"sheet {path.stem}", [_NO_ZONES])
    modes = {4: content.zones.four, 8: content.zones.eight}
    rows = {count: (*content.zones.both, *own) for count, own in modes.items()}
    known, faults = [field.name for field in fields(ZoneNumbers)], []
    for count, all_rows in rows.items():
        said = [row.term for row in all_rows]
        faults += [f"zones of {count}: {n} is not a term; known: {', '.join(known)}"
                   for n in said if n not in known]  # fmt: skip
        faults += [f"zones of {count}: {n} is said twice" for n in {*said} if said.count(n) > 1]
        faults += [f"zones of {count}: {n} is missing" for n in known if n not in said]
        faults += [f"zones of {count}: {row.term} is {row.value:g}; expected more than 0"
                   f"{'' if row.value <= 0 else f', at most {_most(row.term):g}'}"
                   for row in all_rows if not 0 < row.value <= _most(row.term)]  # fmt: skip
    if faults:
        raise InputError(str(path), faults)
    found = ZoneSheet(path.stem, content.name, sheet_reading.document(content.source), rows)
    faults = [f"zones of {count}: {one}" for count in rows for one in _apart(found.numbers(count))]
    if faults:
        raise InputError(str(path), faults)
    return found


#: parts of a whole
_PARTS = ("white", "grey", "detection_rate", "shared", "noise_dark")
#: more than any of the other numbers is, in SI; and less, where one is a divisor
_MOST, _LEAST = 1e6, 1e-6
#: targets of a zone: no more than it has rays
_MOST_TARGETS = 25


def _most(term: str) -> float:
    return 1.0 if term in _PARTS else _MOST_TARGETS if term == "targets" else _MOST


def _apart(n: ZoneNumbers) -> Iterator[str]:
    """Numbers that do not go together: the model would need a root of less than 0."""
    names = (field.name for field in fields(n) if field.name != "drift_m_per_K")
    small = [name for name in names if getattr(n, name) < _LEAST]
    yield from (f"{name} is {getattr(n, name):g}; expected at least {_LEAST:g}" for name in small)
    if not small:
        yield from _of_distances(n)
        yield from _of_accuracies(n)
    if n.detection_rate >= 1:
        yield "detection_rate is 1; expected less: nothing is found in every frame"
    if n.targets != int(n.targets):
        yield f"targets is {n.targets:g}; expected a whole number"


def _of_accuracies(n: ZoneNumbers) -> Iterator[str]:
    """Accuracies that leave no room for the scatter, or for ambient light."""
    for whole, part in (("near_m", "noise_floor_m"), ("far", "noise_dark")):
        if not (one := getattr(n, whole) / n.sigmas) > getattr(n, part):
            yield (
                f"{whole} / sigmas is {one:.4g}; expected more than {part}, which is"
                f" {getattr(n, part):g}: the accuracy holds with the scatter"
            )
    for name in ("far_white_ambient", "far_grey_ambient"):
        if getattr(n, name) < n.far:
            yield f"{name} is {getattr(n, name):g}; expected at least far, which is {n.far:g}"


def _of_distances(n: ZoneNumbers) -> Iterator[str]:
    """Largest distances that tell nothing, or more in ambient light than in the dark."""
    if min(n.white_dark_m, n.grey_dark_m) >= n.reach_m:
        yield (
            f"white_dark_m and grey_dark_m are not below reach_m, which is {n.reach_m:g};"
            " expected one of them to be"
        )
    else:
        for target in ("white", "grey"):
            far_m, most_m = (
                getattr(n, f"{target}_ambient_m"), math.sqrt(getattr(n, target) / n.least_signal)
            )  # fmt: skip
            if far_m >= most_m:
                yield (
                    f"{target}_ambient_m is {far_m:g}; expected less than {most_m:.4g}, from where"
                    " it is found in the dark"
                )
