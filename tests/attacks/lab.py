"""A whole class at once: each client runs and fits; how long it waits, and whether any is lost.

python -m tests.attacks.lab [CLIENTS] [--folder FOLDER] [--scenario ball] [--engines a,b]
"""

import argparse
import asyncio
import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import httpx
import numpy as np

SOUND = Path(__file__).parents[2] / "examples" / "ball.wav"
#: longest wait for one job [s]
PATIENCE_S = 600.0


@dataclass
class Seen:
    """What one client saw: seconds until each answer, and what went wrong."""

    first_s: list[float] = field(default_factory=list)
    run_s: float = float("nan")
    heard_s: float = float("nan")
    fit_s: float = float("nan")
    faults: list[str] = field(default_factory=list)


@contextlib.contextmanager
def opened(folder):
    """An open lab in a process of its own; its address."""
    command = [sys.executable, "-m", "simcompare", "lab", "--port", "0", "--folder", str(folder)]
    lab = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True)
    try:
        yield address_in(lab.stdout)
    finally:
        lab.send_signal(signal.SIGTERM)
        lab.wait(30)


def address_in(lines):
    """The address that a lab says it is open at."""
    for line in lines:
        for word in line.split():
            if word.startswith(("http://127.", "https://127.")) and "teacher" not in word:
                return word
    raise AssertionError("the lab did not open")


async def ended(client, seen, what):
    """Sends a job and waits until it has ended: seconds that it took."""
    begun = time.perf_counter()
    answer = await client.post("/api/jobs", json=what)
    if answer.status_code != 202:
        seen.faults.append(answer.text)
        return float("nan")
    job_id = answer.json()["id"]
    told = (await client.get(f"/api/jobs/{job_id}")).json()
    seen.first_s.append(time.perf_counter() - begun)
    while told["state"] not in ("done", "failed"):
        if time.perf_counter() - begun > PATIENCE_S:
            seen.faults.append(f"{what['kind']} is lost")
            break
        told = (await client.get(f"/api/jobs/{job_id}?wait=20")).json()
    seen.faults += [f"{what['kind']}: {fault}" for fault in told.get("faults", [])]
    return time.perf_counter() - begun


async def student(address, number, scenario, engines):
    """One client: a page, a run, a recording and its fit."""
    seen, group = Seen(), f"group {number}"
    async with httpx.AsyncClient(base_url=address, timeout=PATIENCE_S) as client:
        begun = time.perf_counter()
        await client.get("/")
        seen.first_s.append(time.perf_counter() - begun)
        asked = {"group": group, "scenario": scenario, "engines": engines}
        levels = ["default", "tuned"]
        seen.run_s = await ended(client, seen, {**asked, "kind": "run", "levels": levels})
        begun = time.perf_counter()
        query = {"group": group, "name": SOUND.name, "kind": "sound"}
        answer = await client.post("/api/recordings", params=query, content=SOUND.read_bytes())
        seen.heard_s = time.perf_counter() - begun
        if answer.status_code != 200:
            seen.faults.append(f"recording: {answer.text}")
            return seen
        recording = answer.json()["id"]
        seen.fit_s = await ended(client, seen, {**asked, "kind": "fit", "recording": recording})
    return seen


async def a_class(address, count, scenario, engines):
    """All clients at once."""
    return await asyncio.gather(*(student(address, i, scenario, engines) for i in range(count)))


def told(name, seconds):
    """A line of times."""
    known = np.array([one for one in seconds if np.isfinite(one)])
    if not len(known):
        return f"{name:26} none"
    shown = f"median {np.median(known):6.2f} s, p95 {np.quantile(known, 0.95):6.2f} s"
    return f"{name:26} {shown}, longest {known.max():6.2f} s ({len(known)})"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clients", nargs="?", type=int, default=20)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--scenario", default="ball")
    parser.add_argument("--engines", default="")
    chosen = parser.parse_args()
    engines = [name for name in chosen.engines.split(",") if name]
    with tempfile.TemporaryDirectory() as made, opened(chosen.folder or made) as address:
        begun = time.perf_counter()
        seen = asyncio.run(a_class(address, chosen.clients, chosen.scenario, engines))
        whole_s = time.perf_counter() - begun
    print(f"{chosen.clients} clients on {os.cpu_count()} cores, all done in {whole_s:.1f} s")
    print(told("first answer", [one for client in seen for one in client.first_s]))
    print(told("run, until its picture", [client.run_s for client in seen]))
    print(told("recording, until heard", [client.heard_s for client in seen]))
    print(told("fit, until its values", [client.fit_s for client in seen]))
    faults = [fault for client in seen for fault in client.faults]
    print(f"{len(faults)} faults", *sorted(set(faults))[:20], sep="\n  ")
    raise SystemExit(bool(faults))


if __name__ == "__main__":
    main()
