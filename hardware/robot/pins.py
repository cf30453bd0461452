"""What a pin can do, and how a wire is written in the file of a robot."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

#: how a pin is written
_PIN = r"[A-Za-z0-9_+-]{1,12}"
Pin = Annotated[str, Field(pattern=f"^{_PIN}$")]
#: what a pin of the controller can do; a strapping pin decides how the controller starts
Role = Literal["power", "ground", "io", "input", "strapping", "flash", "serial"]
#: where a wire leads, and what it is for: out of the controller, into it, its bus, or power
Wire = tuple[
    Annotated[str, Field(pattern=rf"^[A-Za-z_]\w*\.{_PIN}$")],
    Literal["out", "in", "sda", "scl", "power", "ground", "motor"],
]
