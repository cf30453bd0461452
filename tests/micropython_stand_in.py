"""Stand-ins for what a program finds under MicroPython: pins, a bus, a clock, and its line."""

from __future__ import annotations

import io
from types import SimpleNamespace


class Pin:
    OUT, IN, IRQ_RISING = "out", "in", "rising"
    made: dict[int, Pin] = {}  # noqa: RUF012

    def __init__(self, number, mode=None):
        self.number, self.mode, self.level, self.handler = number, mode, 0, None
        Pin.made[number] = self

    def value(self, level):
        assert self.mode == Pin.OUT
        self.level = int(level)

    def irq(self, handler, trigger):
        assert (self.mode, trigger) == (Pin.IN, Pin.IRQ_RISING)
        self.handler = handler


class PWM:
    def __init__(self, pin, freq, duty_u16):
        pin.pwm, self.duty = self, duty_u16

    def duty_u16(self, duty):
        assert 0 <= duty <= 65535
        self.duty = duty


class I2C:
    """A bus with an MPU-6050 that rests, and turns with one degree a second about z."""

    raw = bytes([0, 0, 0, 0, 0x40, 0, 1, 2, 0, 0, 0, 0, 0, 131])

    def __init__(self, number, sda, scl, freq):
        self.pins, self.woken = (sda.number, scl.number), False

    def writeto_mem(self, address, register, content):
        assert (address, register, content) == (0x68, 0x6B, b"\0")
        self.woken = True

    def readfrom_mem(self, address, register, count):
        assert self.woken
        assert (address, register, count) == (0x68, 0x3B, 14)
        return self.raw


class Clock:
    """A clock that turns back to 0 as MicroPython's does, and moves only while one sleeps."""

    PERIOD = 2**30

    def __init__(self, start_us):
        self.us, self.on_sleep = start_us, lambda: None

    def ticks_us(self):
        return self.us % self.PERIOD

    def ticks_ms(self):
        return self.us // 1000 % self.PERIOD

    def ticks_diff(self, now, then):
        half = self.PERIOD // 2
        return (now - then + half) % self.PERIOD - half

    def sleep_ms(self, ms):
        self.us += 1000 * ms
        self.on_sleep()


class Line:
    """The serial line: what the program reads is ``typed``, what it writes is in ``out``."""

    POLLIN = 1

    def __init__(self):
        self.typed, self.out = "", io.StringIO()

    def read(self, count):
        letters, self.typed = self.typed[:count], self.typed[count:]
        return letters

    def poll(self, _=None):
        if _ is None:
            return SimpleNamespace(register=lambda *_: None, poll=lambda _: bool(self.typed))
        return bool(self.typed)
