"""Shell completion of names; it runs at every press of the key, so it only looks at folders."""

from __future__ import annotations

from simcompare.scenarios import catalogue


def scenarios(incomplete: str) -> list[str]:
    """Names of scenarios."""
    return [name for name in catalogue.names() if name.startswith(incomplete)]


def engines(incomplete: str) -> list[str]:
    """Names of engines and of their variants, also as the next one of a list with commas."""
    from simcompare.engine import engines as known

    before, comma, last = incomplete.rpartition(",")
    taken = before.split(",")
    names = known.names()
    engine, colon, _ = last.partition(known.VARIANT)
    if colon and engine in names:
        names = [f"{engine}{colon}{one}" for one in known.quick_variants(engine)]
    names = [name for name in names if name not in taken]
    if not comma and not colon:
        names.append("all")
    return [f"{before}{comma}{name}" for name in names if name.startswith(last)]


def contact_levels(incomplete: str) -> list[str]:
    """Contact levels."""
    modes = ("default", "coefficients", "tuned", "assisted", "default,tuned,assisted")
    return [mode for mode in modes if mode.startswith(incomplete)]


def own_values(incomplete: str) -> list[str]:
    """Contact values of engines, such as "pymunk.elasticity="."""
    from simcompare.engine import by_hand, engines

    names = [f"{engine}.{one.name}=" for engine in engines.names() for one in by_hand.known(engine)]
    return [name for name in names if name.startswith(incomplete)]


def tables(incomplete: str) -> list[str]:
    """Published tables of measured bounces; the shell itself adds files."""
    from simcompare.hardware.recordings import published

    return [name for name in published.tables() if name.startswith(incomplete)]


def sheets(incomplete: str) -> list[str]:
    """Data sheets of sensors; the shell itself adds files."""
    from simcompare.hardware.sensors import sheets as known

    return [name for name in known.names() if name.startswith(incomplete)]


def sensors(incomplete: str) -> list[str]:
    """Data sheets behind the name of a sensor and =."""
    name, equals, begun = incomplete.partition("=")
    return [f"{name}={sheet}" for sheet in sheets(begun)] if equals else []


def recordings(incomplete: str) -> list[str]:
    """Public recordings."""
    from simcompare.hardware.recordings import registry

    return [name for name in registry.files() if name.startswith(incomplete)]


def experiments(incomplete: str) -> list[str]:
    """Experiments of a characterization, also as the next one of a list with commas."""
    before, comma, last = incomplete.rpartition(",")
    names = ["bounce", "friction", "joint", "force", *([] if comma else ["all"])]
    free = [name for name in names if name not in before.split(",")]
    return [f"{before}{comma}{name}" for name in free if name.startswith(last)]


def estimators(incomplete: str) -> list[str]:
    """Estimators."""
    from simcompare.estimation.estimators import ESTIMATORS

    return [name for name in ESTIMATORS if name.startswith(incomplete)]


def words(incomplete: str) -> list[str]:
    """Words that are explained."""
    from simcompare import glossary

    return [one.word for one in glossary.terms() if one.word.startswith(incomplete)]


def worked_examples(incomplete: str) -> list[str]:
    """Worked examples that are recomputed."""
    from simcompare.gauging import registry

    return [name for name in registry.names() if name.startswith(incomplete)]
