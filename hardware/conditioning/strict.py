"""What strict reading says of a repair that is not wanted."""

from __future__ import annotations

from simcompare.model.recording import Repair

#: what to do by hand, where it is plain
_CURES = {"stale_first_row": "delete it"}


def refused(repair: Repair) -> str:
    """Place, text and rule of a repair."""
    places = [f"column {repair.channel!r}" if repair.channel else ""]
    if repair.rows:
        first, last = repair.rows[0]
        more = f" and {repair.count - (last - first + 1)} more" if len(repair.rows) > 1 else ""
        places.append(f"rows {first} to {last}{more}" if last > first else f"row {first}{more}")
    where = ", ".join(place for place in places if place)
    cure = f"; {_CURES[repair.rule]}" if repair.rule in _CURES else ""
    told = f"{repair.text}{cure} ({repair.rule}; refused by --strict)"
    return f"{where}: {told}" if where else told
