"""The verb ``list``: scenarios, engines and published measurements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from simcompare.arguments import checked
from simcompare.engine import elsewhere, engines
from simcompare.hardware.recordings import published
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.scenarios import catalogue


@dataclass(frozen=True, repr=False)
class Listing(Shown):
    """What there is; ``table()`` has a row for each scenario.

    Attributes:
        scenarios: name -> title and question.
        engines: names.
        variants: engine -> its variants; "mujoco:rk4" is one.
        engines_elsewhere: engines that cannot run here.
        measurements: published measurements, for ``run(…, against=…)``.
    """

    scenarios: Mapping[str, str]
    engines: tuple[str, ...]
    variants: Mapping[str, tuple[str, ...]]
    engines_elsewhere: tuple[str, ...]
    measurements: tuple[str, ...]

    def __repr__(self) -> str:
        width = max(map(len, self.scenarios), default=0)
        rows = [f"{name:<{width}}  {text}" for name, text in self.scenarios.items()]
        return "\n".join(["Scenarios:", *(f"  {row}" for row in rows), *self._others()])

    def _glance(self) -> Glance:
        columns = (Column("scenario", text=True), Column("what it asks", text=True))
        scenarios = Table("", columns, (Group("", tuple(self.scenarios.items())),))
        more = "More: simcompare.show(NAME), simcompare.run(NAME)"
        return Glance("What there is", table=scenarios, notes=self._others(), more=more)

    def _others(self) -> tuple[str, ...]:
        variants = [f"{engine}:{one}" for engine, many in self.variants.items() for one in many]
        return (
            f"Engines: {', '.join(self.engines)}",
            f"Variants: {', '.join(variants)}",
            f"Engines that cannot run here: {', '.join(self.engines_elsewhere)}",
            f"Published measurements: {', '.join(self.measurements)}",
        )


@checked
def listing() -> Listing:
    """Scenarios, engines and published measurements.

    ::

        simcompare.list()
        simcompare.list().engines
        simcompare.list().table()
    """
    names = engines.names()
    return Listing(
        scenarios=dict(catalogue.summaries()),
        engines=tuple(names),
        variants={name: many for name in names if (many := (*engines.quick_variants(name),))},
        engines_elsewhere=tuple(elsewhere.names(names)),
        measurements=tuple(published.tables()),
    )
