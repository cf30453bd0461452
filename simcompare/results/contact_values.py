"""What each engine's own contact parameters were in a fit, as text to copy from."""

from __future__ import annotations

from pathlib import Path

from simcompare.model.audit import AuditRow
from simcompare.model.settings import TUNED
from simcompare.results import fit_file


def contact_values(path: Path) -> str:
    """What each engine's own contact parameters were in the fit, as text to copy from.

    Raises:
        InputError: the file is no fit.
    """
    fit = fit_file.read(path)
    how = (
        f"for a plain loop of one fixed step of {1e3 * fit.engine_step_s:.6g} ms"
        if fit.contact == TUNED
        else f"with {fit.step_s:g} s between samples and our helps ({fit.assist}); not for a plain"
        " loop"
    )
    lines = [
        f"# {fit.scenario}, fitted at {fit.speed_m_s[0]:.2f} to {fit.speed_m_s[1]:.2f} m/s, {how}"
    ]
    drag = {name: value for name, value in fit.closed.items() if "drag" in name and value}
    lines += [
        f"# fitted with air drag, {name} = {value:.6g}: a force -c·|v|·v of your own in each step"
        for name, value in drag.items()
    ]
    if fit.one_number is not None:
        lines.append(
            "# one restitution for all speeds, where the ball's own depends on them:"
            f" {fit.one_number.value:.4g} differs from the ball's {fit.one_number.off}"
        )
    for source in fit.sources:
        if source.status != "ok":
            why = source.reason or source.status or "failed"
            lines.append(f"# {source.name}: {why.removeprefix(f'{source.name}: ')}")
        lines += [_line(source.name, row) for row in source.native if _held(row) is not None]
    return "\n".join(lines) + "\n"


def _held(row: AuditRow) -> float | None:
    """What the engine held, or was given where it cannot be read."""
    return row.set_value if row.read_value is None else row.read_value


def _line(name: str, row: AuditRow) -> str:
    unit = "" if row.unit in ("", "1") else f" {row.unit}"
    note = f"  # {row.note}" if row.note else ""
    # all digits: a spring's two numbers belong together
    return f"{name}: {row.engine_parameter} = {_held(row)!r}{unit}{note}"
