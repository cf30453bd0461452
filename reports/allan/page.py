"""The page of an Allan analysis: the answer, the plot, the noises, and all deviations."""

from __future__ import annotations

from simcompare.reports.allan import figures, tables, words
from simcompare.reports.render.parts import Block, Part, part_of
from simcompare.results.records.allan import NoiseAnalysis


def block_of(found: NoiseAnalysis) -> Block:
    """What the page shows."""
    parts = (_answer(found), *_audit(found), _numbers(found), _all(found))
    return Block(
        "a1", "allan", f"Noise at rest: {found.title}", words.QUESTION, found.created,
        found.software.simcompare or "", parts,
    )  # fmt: skip


def _answer(found: NoiseAnalysis) -> Part:
    said = [*words.audit(found), *words.answer(found), *words.against(found)]
    return part_of("Answer", "answer", [figures.plot(found)], answer=said, notes=words.notes(found))


def _audit(found: NoiseAnalysis) -> list[Part]:
    if not found.audited:
        return []
    return [part_of("Audit", "audit", tables=[tables.of_findings(found), tables.of_matches(found)])]


def _numbers(found: NoiseAnalysis) -> Part:
    made = [tables.of_terms(found), tables.of_walks(found), tables.of_sheet(found)]
    return part_of("Noises", "noises", tables=made)


def _all(found: NoiseAnalysis) -> Part:
    return part_of(
        "All deviations", "deviations", tables=[tables.of_deviations(found)],
        notes=[
            "Degrees of freedom of the bounds: Greenhall and Riley, for the noise type told at each"
            " τ by the autocorrelation at lag 1 (NIST SP 1065). The noises were fitted by"
            " generalised least squares with the covariance of the Allan variances."
        ],
    )  # fmt: skip
