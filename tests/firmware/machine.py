"""The ZD-065 as hardware: its cutting program, assembled, in an emulated 6502 with its ports.

The emulator is py65's. What counts is its speed, so memory is a plain list, and the one instruction
that reaches the ports, STA absolute, is the only one that is watched.

As a command: ``python tests/firmware/machine.py PROGRAM.zd`` runs a program and tells its figures.
"""

import contextlib
import subprocess
import sys
import tempfile
import warnings
from dataclasses import dataclass
from itertools import repeat
from pathlib import Path

import numpy as np

with warnings.catch_warnings():  # old escapes and imports are no faults of ours
    warnings.simplefilter("ignore")
    from py65.devices.mpu6502 import MPU

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "firmware" / "zd065" / "main.s"
ROM = 0xE000
#: Bytes that stand for one step: F, J and the number of the block, as in map.s.
RECORD = slice(0x10, 0x1B)
#: The flags of a 6522 while a feed edge waits: bit 7 any that is enabled, bit 1 CA1.
FEED = 0x82
ALWAYS = 2**63
#: Instructions between two looks at where the machine is.
CHUNK = 2000


@dataclass(frozen=True)
class Image:
    """The assembled program.

    Attributes:
        rom: 8,192 bytes from `ROM` on.
        names: labels and aliases of the source, lower case.
        size: bytes that are used, tables and vectors included.
    """

    rom: bytes
    names: dict[str, int]
    size: int


def assemble(folder):
    """Return the `Image`, assembled into a folder."""
    out, table = Path(folder) / "zd065.bin", Path(folder) / "zd065.map"
    script = "import sys; from Ophis.Main import run_ophis; sys.exit(run_ophis(sys.argv[1:]))"
    # A branch out of reach is to be an error, not two instructions without a word.
    options = ["-q", "--no-branch-extend", "-m", str(table), "-o", str(out), str(SOURCE)]
    done = subprocess.run([sys.executable, "-c", script, *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    names = {}
    for line in table.read_text().splitlines():
        address, name, _ = line.split("|")
        names[name.strip()] = int(address.strip().lstrip("$"), 16)
    rom = out.read_bytes()
    return Image(rom, names, names["code_end"] - ROM + 6)


class Machine:
    """One ZD-065, switched on: it stands, and waits for the operator.

    Attributes:
        memory: 65,536 bytes.
        writes: (steps made, address, byte) of every other write to a port.
        timed: cycles are counted, which takes half as long again.
    """

    def __init__(self, image, timed=False):
        self.names, self.timed = image.names, timed
        self.memory = [0] * 0x10000
        self.memory[ROM:] = list(image.rom)
        self.mpu = MPU(self.memory, None)
        self._ports, self._zero_page = bytearray(), bytearray()
        self._cycles, self.writes, self._most = [], [], None
        self.pulses_left, self.presses_left = 0, 0
        self.mpu.instruct = [*MPU.instruct]
        self.mpu.instruct[0x8D] = self._store()
        self.mpu.reset()
        self._until("key_loop")
        self.first_phases = self._ports[-1]
        self.forget()

    def __getitem__(self, name):
        return self.memory[self.names[name]]

    def __setitem__(self, name, value):
        self.memory[self.names[name]] = value

    def number(self, name, size=1, signed=False):
        """Return a binary number of zero page, low byte first."""
        at = self.names[name]
        return int.from_bytes(bytes(self.memory[at : at + size]), "little", signed=signed)

    def put(self, name, value, size):
        """Store a binary number in zero page, low byte first."""
        at = self.names[name]
        signed = value < 0
        self.memory[at : at + size] = list(value.to_bytes(size, "little", signed=signed))

    def feed(self, pulses=ALWAYS):
        """Let the feed signal come so often, each time when the pulse before is taken."""
        self.pulses_left = pulses
        self["flags"] = self["flags"] & 0x10 | (FEED if pulses else 0)

    def press(self, times=ALWAYS):
        """Let the operator press the key so often, each time when the machine waits for it."""
        self.presses_left = times - 1
        self["flags"] |= self.names["key"]

    def forget(self):
        """Empty the record of steps and writes; the motors stay as they are."""
        if self._ports:
            self.first_phases = self._ports[-1]
        self._ports.clear()
        self._zero_page.clear()
        self._cycles.clear()
        self.writes.clear()

    def load(self, data, play=(0, 0)):
        """Put a program into memory, enter play, and let feed and operator never wait."""
        at = self.names["data"]
        self.memory[at : at + len(data)] = list(data)
        self["play_x"], self["play_y"] = play
        self["entered"] = 1
        self.feed()
        self.press()

    def run(self, most=None, instructions=20_000_000):
        """Run until the program has ended, an error, or ``most`` steps are recorded.

        A program that goes wrong may never end: so many instructions are 600,000 steps.

        Returns:
            Whether it stopped by itself.
        """
        ends = {self.names["program_end"], self.names["error_end"]}
        self._most = most
        go = self._timed if self.timed else self._fast
        with contextlib.suppress(StopIteration):
            for done in range(0, instructions, CHUNK):
                if self.mpu.pc in ends:
                    break
                go(min(CHUNK, instructions - done))
        return self.mpu.pc in ends

    def jump(self, name):
        """Go on at a label of the interpolator, where Y is what the motors' port shows."""
        self.mpu.pc = self.names[name]
        self.mpu.y = self["motors"]

    def record(self):
        """Return what is recorded since `forget`, a row a step."""
        return Record.of(self.first_phases, self._ports, self._zero_page, self._cycles)

    def _until(self, name):
        while self.mpu.pc != self.names[name]:
            self.mpu.step()

    def _fast(self, count):
        mpu, memory, instruct = self.mpu, self.memory, self.mpu.instruct
        for _ in repeat(None, count):
            pc = mpu.pc
            mpu.pc = pc + 1
            instruct[memory[pc]](mpu)

    def _timed(self, count):
        mpu, memory, instruct = self.mpu, self.memory, self.mpu.instruct
        for _ in repeat(None, count):
            pc = mpu.pc
            code = memory[pc]
            mpu.pc = pc + 1
            mpu.excycles = 0
            mpu.addcycles = mpu.extracycles[code]
            instruct[code](mpu)
            mpu.processorCycles += mpu.cycletime[code] + mpu.excycles

    def _store(self):
        """Return STA absolute, which also is what the ports do."""
        memory, ports, zero_page = self.memory, self._ports, self._zero_page
        motors, here = self.names["motors"], self

        def store(mpu):
            pc = mpu.pc
            address = memory[pc] | memory[pc + 1] << 8
            mpu.pc = pc + 2
            if address == motors:
                memory[address] = mpu.a
                ports.append(mpu.a)
                zero_page.extend(memory[RECORD])
                if here.timed:
                    here._cycles.append(mpu.processorCycles)
                here._take_feed()
                if len(ports) == here._most:
                    raise StopIteration  # so many steps as were asked for
            else:
                here._write(address, mpu.a)

        return store

    def _take_feed(self):
        """Put the flag of the feed out; the next pulse sets it again, if there is one."""
        if self.pulses_left != ALWAYS:
            self.feed(max(self.pulses_left - 1, 0))

    def _write(self, address, value):
        """Store at another port: a flag goes out where a 1 is written."""
        if address == self.names["flags"]:
            if value & self.names["feed"]:
                self._take_feed()
            value = self.memory[address] & ~(value & self.names["key"])
            if self.presses_left:
                self.presses_left -= 1
                value |= self.names["key"]
        else:
            self.writes.append((len(self._ports), address, value))
        self.memory[address] = value


@dataclass(frozen=True)
class Record:
    """What the ports and zero page showed at every step; one entry a step.

    Attributes:
        dx, dy: -1, 0 or 1, from the patterns of the rings.
        f: bytes as a signed number, of 4 bytes. f3: of 3 bytes, as lines have it.
        j, number: the BCD as decimal numbers.
        cycles: at each step; empty when not timed.
    """

    dx: np.ndarray
    dy: np.ndarray
    f: np.ndarray
    f3: np.ndarray
    j: np.ndarray
    number: np.ndarray
    cycles: np.ndarray

    @classmethod
    def of(cls, before, ports, zero_page, cycles):
        """Decode what was recorded; asserts that every write steps one motor by one step."""
        rows = np.frombuffer(bytes(zero_page), np.uint8).reshape(-1, RECORD.stop - RECORD.start)
        patterns = np.frombuffer(bytes([before, *ports]), np.uint8)
        dx, dy = turns(patterns & 7), turns(patterns >> 3)
        assert ((dx == 0) != (dy == 0)).all()
        f = np.ascontiguousarray(rows[:, :4]).view("<i4")[:, 0].astype(np.int64)
        low = f & 0xFFFFFF
        f3 = low - ((low >> 23) << 24)
        return cls(dx, dy, f, f3, decimal(rows[:, 4:7]), decimal(rows[:, 8:11]), np.array(cycles))


#: Pattern of three phases, A in bit 0 -> its place on the ring A, AB, B, BC, C, CA.
RING = np.full(32, -100)
RING[[0b001, 0b011, 0b010, 0b110, 0b100, 0b101]] = range(6)


def turns(patterns):
    """Return the steps between patterns of one motor: 0, +1 forwards, -1 backwards."""
    places = RING[patterns]
    assert (places >= 0).all()
    change = (np.diff(places) + 1) % 6 - 1
    assert (np.abs(change) <= 1).all()
    return change


def decimal(columns):
    """Return the value of each row of packed BCD, high byte first."""
    assert (columns >> 4 < 10).all()
    assert (columns & 15 < 10).all()
    value = np.zeros(len(columns), np.int64)
    for column in columns.T:
        value = 100 * value + 10 * (column >> 4) + (column & 15)
    return value


def main(path):
    """Run a program, and print what the machine did."""
    with tempfile.TemporaryDirectory() as folder:
        machine = Machine(assemble(folder), timed=True)
    machine.load(Path(path).read_bytes())
    machine.run()
    done = machine.record()
    steps = len(done.dx)
    print(f"steps     {steps}, to ({done.dx.sum() / 1000:.3f}, {done.dy.sum() / 1000:.3f}) mm")
    if machine["error"]:
        print(f"error     {machine['error']} in block {decimal(_number(machine))[0]}")
    if steps:
        cycles = machine.mpu.processorCycles
        print(
            f"cycles    {cycles / steps:.1f} a step; {cycles / 1e6:.1f} s at 1 MHz without waiting"
        )
    return 1 if machine["error"] else 0


def _number(machine):
    at = machine.names["number"]
    return np.array([machine.memory[at : at + 3]], np.uint8)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
