"""What strict reading says of a repair that is not wanted."""

from __future__ import annotations

from simcompare.model.recording import Repair


def refused(repair: Repair) -> str:
    """Place, text and rule of a repair."""
    places = [f"column {repair.channel!r}" if repair.channel else ""]
    if repair.rows:
        first, last = repair.rows[0]
        more = f" and {repair.count - (last - first + 1)} more" if len(repair.rows) > 1 else ""
        places.append(f"rows {first} to {last}{more}" if last > first else f"row {first}{more}")
    where = ", ".join(place for place in places if place)
    return f"{where}{': ' if where else ''}{repair.text} ({repair.rule}; refused by --strict)"
