"""Films of a ball before a wall, made by formula."""

from __future__ import annotations

from pathlib import Path

import numpy as np

GRAVITY = 9.80665
#: size of a film [px], pixels of a metre, and the ball's radius [m]
WIDTH, HEIGHT, METRE_PX, RADIUS_M = 240, 192, 300.0, 0.02
#: of the floor, from the top [px]
FLOOR_PX = 180.0


def height(time_s, drop_m: float = 0.5, restitution: float = 0.8, begin_s: float = 0.15):
    """Height of the ball's lowest point at each time [m]."""
    found = np.full(np.shape(time_s), drop_m)
    speed = np.sqrt(2 * GRAVITY * drop_m)
    at = begin_s + speed / GRAVITY
    falling = (time_s > begin_s) & (time_s <= at)
    found = np.where(falling, drop_m - GRAVITY * (time_s - begin_s) ** 2 / 2, found)
    found = np.where(time_s > at, 0.0, found)
    for _ in range(30):
        speed *= restitution
        long = 2 * speed / GRAVITY
        own = (time_s > at) & (time_s <= at + long)
        since = time_s - at
        found = np.where(own, speed * since - GRAVITY * since**2 / 2, found)
        at += long
    return found


def drawn(wall, centres, colour=(40, 90, 230), *, shadow=False):
    """One exposure: the ball at some places during it, the mean of which is seen."""
    radius, ys = RADIUS_M * METRE_PX, [y for _, y in centres]
    top, bottom = max(int(min(ys) - 5 * radius), 0), min(int(max(ys) + 5 * radius), HEIGHT)
    left = int(centres[0][0] - 3 * radius)
    rows, columns = slice(top, bottom), slice(left, left + int(9 * radius))
    y, x = np.mgrid[rows, columns].astype(np.float32)
    cover, dark = np.zeros_like(x), np.zeros_like(x)
    for cx, cy in centres:
        cover += np.clip(radius - np.hypot(x - cx, y - cy) + 0.5, 0, 1) / len(centres)
        far = np.hypot(x - cx - 2.5 * radius, y - cy - radius) / (1.3 * radius)
        dark += np.clip(1.4 - far, 0, 1) / len(centres) * shadow
    seen = wall[rows, columns] * (1 - 0.35 * np.clip(dark, 0, 1))[..., None]
    made = wall.copy()
    made[rows, columns] = seen * (1 - cover)[..., None] + np.array(colour) * cover[..., None]
    return made


def film(
    path: Path, *, rate_hz: float = 60.0, seconds: float = 2.2, restitution: float = 0.8,
    exposure: float = 0.5, noise: float = 3.0, shadow: bool = False, second: bool = False,
    ball: bool = True, shake: float = 0.0, seed: int = 1,
) -> Path:  # fmt: skip
    """Writes a film with blur, noise and, where wanted, a shadow or a second ball."""
    import cv2

    random = np.random.default_rng(seed)
    grain = random.normal(0, 400 if shake else 6, (HEIGHT, WIDTH, 1)).astype(np.float32)
    plain_wall = np.clip(205 + cv2.GaussianBlur(grain, (7, 7), 0)[..., None], 0, 255)
    wall = np.repeat(plain_wall, 3, axis=2)
    static = random.normal(0, noise, wall.shape)
    coding = cv2.VideoWriter.fourcc(*("MJPG" if path.suffix == ".avi" else "mp4v"))
    out = cv2.VideoWriter(str(path), coding, rate_hz, (WIDTH, HEIGHT))
    for number in range(round(seconds * rate_hz)):
        inside = (number + exposure * (np.arange(8) + 0.5) / 8) / rate_hz
        made = wall.copy()
        if ball:
            made = drawn(made, _places(inside, 70, restitution), shadow=shadow)
        if second:
            places = _places(inside - 0.21, 160, 0.65)
            made = drawn(made, places, (60, 170, 60))
        made = made + np.roll(static, random.integers(0, HEIGHT, 2), axis=(0, 1))
        if shake:
            made = np.roll(made, np.round(random.normal(0, shake, 2)).astype(int), axis=(0, 1))
        out.write(np.clip(made, 0, 255).astype(np.uint8))
    out.release()
    return path


def _places(times_s, x_px: float, restitution: float):
    """Centres of the ball during an exposure [px]."""
    low = height(np.asarray(times_s), restitution=restitution)
    return [(x_px, FLOOR_PX - METRE_PX * (RADIUS_M + h)) for h in low]
