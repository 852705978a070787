"""Blocks of the cutting format as bytes, and a machine that runs them."""

from wedmcam.formats.compact import to_bcd


def arc(group, quadrant, x, y, count):
    return bytes([group + quadrant]) + to_bcd(x, 4) + to_bcd(y, 4) + to_bcd(count, 3)


def line(group, quadrant, x, y):
    return bytes([group + quadrant]) + to_bcd(x, 3) + to_bcd(y, 3)


def cut(machine, data, most=None):
    """Run a program, or its first steps, and return the record."""
    machine.load(data + b"\0")
    machine.run(most)
    return machine.record()
