"""The memory of the ZD-065 as a file: what stands in it, where block N is, data moved, cleared.

An image holds the bytes of the memory for data. What is done to it is the auxiliary software of the
machine (`controllers.zd065.memory`), with one difference: nothing of a file is ever cleared unless
that was asked for. Addresses are the machine's; the first byte of an image stands at its base.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from wedmcam import machines
from wedmcam.controllers.zd065 import memory
from wedmcam.diag import ByteSpan, Diagnostic, FileSpan, Severity, error, note, warning
from wedmcam.diag.run import WrongUse
from wedmcam.files import Source, bytes_of
from wedmcam.formats import compact, compensation, rotation
from wedmcam.frontends import decoder
from wedmcam.frontends.identify import Identification, identify, identify_memory, longest_run
from wedmcam.frontends.zd065.memory import addresses

#: Format of data in the memory -> bytes of the block that each instruction opens, 0 for none.
FORMATS = {
    "compact": compact.LENGTH,
    "rotation": rotation.LENGTH,
    "compensation": compensation.LENGTH,
}
#: So many blocks in a row are no chance: random bytes of a whole memory make three in one of 10^10.
NO_CHANCE = 3


@dataclass(frozen=True, slots=True)
class Image:
    """The memory for data, whole.

    Attributes:
        data: `controllers.zd065.memory.SIZE` bytes.
        base: address of the first one.
        name: of the file.
    """

    data: bytes
    base: int = 0
    name: str = ""

    @property
    def last(self) -> int:
        """Address of the last byte."""
        return self.base + len(self.data) - 1

    def index(self, address: int) -> int:
        """Return where in the data an address is.

        Raises:
            WrongUse: it is outside of the memory.
        """
        if not self.base <= address <= self.last:
            raise WrongUse(
                f"the address {address:#06x} is outside of the memory, which has {self.base:#06x} "
                f"to {self.last:#06x}"
            )
        return address - self.base

    def span(self, first: int, last: int) -> ByteSpan:
        """Return the span of a range of addresses, both inclusive."""
        return ByteSpan(self.name, first, last + 1)


@dataclass(frozen=True, slots=True)
class Recognition:
    """What stands in the memory (数据类型的智能识别).

    Attributes:
        format: one of `FORMATS`; "random" for what is no data, "cleared" for 0 alone.
        blocks: that are good, from the first on.
        first: address of the first block; None where there is none.
        last: of the end byte, or of the last byte of the last good block.
        bad: of the first byte that does not fit; None where all fit.
        certain: no other format would do.
        reason: one sentence for people.
        starts: address of each block that its instruction opens, good or with a bad digit.
    """

    format: str
    blocks: int
    first: int | None
    last: int | None
    bad: int | None
    certain: bool
    reason: str
    starts: tuple[int, ...] = ()

    @property
    def known(self) -> bool:
        """Whether it is one of the three formats."""
        return FORMATS.get(self.format) is not None


@dataclass(frozen=True, slots=True)
class Block:
    """A block of data in the memory.

    Attributes:
        number: 1-based.
        address: of its instruction.
        data: its bytes.
        format: of the data.
    """

    number: int
    address: int
    data: bytes
    format: str

    @property
    def last(self) -> int:
        """Address of its last byte."""
        return self.address + len(self.data) - 1

    @property
    def instruction(self) -> str:
        """Its instruction in words: L1, SR2, NR3, move L4, thread point or pause."""
        code = self.data[0]
        quadrant = code & 0x0F
        names = {compact.LINE: "L", compact.CW: "SR", compact.CCW: "NR", compact.MOVE: "move L"}
        controls = {compact.THREAD: "thread point", compact.PAUSE: "pause"}
        return controls.get(code) or f"{names[code & 0xF0]}{quadrant}"


@dataclass(frozen=True, slots=True)
class Move:
    """Data that were moved within the memory.

    Attributes:
        image: afterwards.
        first, last: addresses of the range, both inclusive.
        to: address of its first byte afterwards.
        cleared: ranges that hold 0 now, both ends inclusive.
        there: what stands at the new place.
    """

    image: Image
    first: int
    last: int
    to: int
    cleared: tuple[tuple[int, int], ...]
    there: Recognition


def read_image(
    source: Source, base: int = 0, name: str | None = None
) -> tuple[Image | None, list[Diagnostic]]:
    """Return a memory image.

    Args:
        source: a path or bytes; of fewer bytes than the memory has, which is a note: what follows
            is 0, as in a memory that was cleared before.
        base: address of the first byte.
        name: in findings.

    Raises:
        WrongUse: the memory would reach beyond the last address of the machine.
        OSError: the path cannot be read.
    """
    data, name = bytes_of(source, name)
    most = memory.LAST_ADDRESS + 1 - memory.SIZE
    if not 0 <= base <= most:
        raise WrongUse(
            f"the memory has {memory.SIZE} bytes and the machine addresses to "
            f"{memory.LAST_ADDRESS:#06x}: its base is {most:#06x} at most, not {base:#06x}"
        )
    sizes = {"bytes": len(data), "most": memory.SIZE}
    if not data or len(data) > memory.SIZE:
        text = "{bytes} bytes; the memory holds {most}"
        hint = "an image is what the memory holds, and nothing else"
        if data:
            span = ByteSpan(name, base + memory.SIZE, base + len(data))
        return None, [
            error("image-size", text, span if data else FileSpan(name), hint=hint, **sizes)
        ]
    findings = []
    if len(data) < memory.SIZE:
        text = "{bytes} bytes; the memory holds {most}: what follows is taken to be 0"
        findings.append(note("image-size", text, FileSpan(name), **sizes))
    return Image(data.ljust(memory.SIZE, b"\0"), base, name), findings


def show(
    image: Image, first: int | None = None, last: int | None = None
) -> list[tuple[int, bytes]]:
    """Return what the six digits show of a range, group after group: address and bytes.

    Args:
        image: the memory.
        first, last: addresses, both inclusive; None for all of the memory.

    Raises:
        WrongUse: the range is none, or outside of the memory.
    """
    low = 0 if first is None else image.index(first)
    high = len(image.data) - 1 if last is None else image.index(last)
    _check_range(image, low, high)
    return [(image.base + at, group) for at, group in memory.display(image.data, low, high)]


def recognise(
    image: Image, at: int | None = None, format: str | None = None
) -> tuple[Recognition, list[Diagnostic]]:
    """Return what stands in the memory, and everything that is wrong with it, with its address.

    Args:
        image: the memory.
        at: where the data begin; None for the first byte that is not 0.
        format: one of `FORMATS`, where it is known: lines alone do in two of them.

    Raises:
        WrongUse: ``at`` is outside of the memory.
    """
    begin = _begin(image, at)
    if begin is None:
        where = "" if at is None else f" from {at:#06x} on"
        reason = f"cleared: {len(image.data)} bytes, all 0{where}"
        if where:
            reason = f"no data{where}"
        return Recognition("cleared", 0, None, None, None, True, reason), []
    data, address = image.data[begin:], image.base + begin
    if _is_text(data):
        return _random(image, begin)
    seen = identify_memory(data, format)
    if seen.format == "unknown":
        return _damaged(image, begin, format) or _random(image, begin)
    starts, end = addresses(data, FORMATS[seen.format])
    known = Recognition(
        seen.format,
        seen.blocks,
        address,
        None if seen.last_address is None else address + seen.last_address,
        None if seen.bad_address is None else address + seen.bad_address,
        seen.certain,
        _without_places(seen),
        tuple((starts + address).tolist()),
    )
    return known, _faults(image, begin, end, known)


def find_block(
    image: Image, number: int, at: int | None = None, format: str | None = None
) -> tuple[Block | None, list[Diagnostic]]:
    """Return block N of the data in the memory, 1-based; None where it cannot be found.

    Arguments as of `recognise`. Blocks before a damaged place are found, and the place is reported.
    """
    seen, findings = recognise(image, at, format)
    if not seen.known or not 1 <= number <= len(seen.starts):
        return None, [*findings, *_not_there(image, seen, number)]
    where = seen.starts[number - 1]
    begin = image.index(where)
    length = FORMATS[seen.format][image.data[begin]]
    return Block(number, where, image.data[begin : begin + length], seen.format), findings


def move(
    image: Image, first: int, last: int, to: int, format: str | None = None
) -> tuple[Move, list[Diagnostic]]:
    """Return the memory in which a range stands elsewhere; where it was is cleared (数据搬移).

    Args:
        image: the memory.
        first, last: addresses of the range, both inclusive.
        to: address of its first byte afterwards.
        format: of the data, where it is known.

    Where both ranges overlap, only what is not overwritten is cleared. Data that are overwritten,
    and a range that ends within a block, are warnings.

    Raises:
        WrongUse: the range is none, or does not fit the memory at one of its places.
    """
    low, high, there = image.index(first), image.index(last), image.index(to)
    _check_range(image, low, high)
    count = high + 1 - low
    if there + count > len(image.data):
        raise WrongUse(
            f"{count} bytes from {to:#06x} on would reach to {to + count - 1:#06x}; the memory "
            f"ends at {image.last:#06x}"
        )
    findings = [*_parted(image, first, last, format), *_overwritten(image, low, high, there)]
    after = replace(image, data=memory.moved(image.data, low, high, there))
    left = [(low, min(high, there - 1))] if there > low else [(max(low, there + count), high)]
    cleared = tuple((image.base + a, image.base + b) for a, b in left if a <= b and there != low)
    seen, more = recognise(after, to, format)
    # Bytes are moved as they are: what is wrong with the data there is for their user to know.
    findings += [replace(d, severity=min(d.severity, Severity.WARNING)) for d in more]
    return Move(after, first, last, to, cleared, seen), findings


def clear(image: Image, at: int | None = None) -> tuple[Image | None, list[Diagnostic]]:
    """Return the memory cleared, as the machine does where it recognises random data.

    Returns:
        None, and the reason as an error, where the memory holds data, damaged or not, or nothing.
    """
    seen, findings = recognise(image, at)
    if seen.format == "random":
        return replace(image, data=bytes(len(image.data))), [
            replace(d, severity=Severity.WARNING) for d in findings
        ]
    text = "nothing is cleared: {reason}"
    span = FileSpan(image.name)
    hint = "random memory is cleared, and nothing else"
    return None, [*findings, error("not-random", text, span, hint=hint, reason=seen.reason)]


def _check_range(image: Image, low: int, high: int) -> None:
    """Refuse a range that ends before it begins.

    Raises:
        WrongUse: with its addresses.
    """
    if low > high:
        first, last = image.base + low, image.base + high
        raise WrongUse(f"the range {first:#06x} to {last:#06x} ends before it begins")


def _begin(image: Image, at: int | None) -> int | None:
    """Return where data begin: as stated, else at the first byte that is not 0; None for none."""
    first = 0 if at is None else image.index(at)
    rest = image.data[first:]
    if at is not None and rest[:1] == b"\0":
        return None
    blank = len(rest) - len(rest.lstrip(b"\0"))
    return None if blank == len(rest) else first + blank


def _without_places(seen: Identification) -> str:
    """Return what was identified, without places: they count from the first block there."""
    reason, _, _ = seen.reason.partition(", then the data stop")
    reason, _, _ = reason.partition("; then other data")
    return reason.partition(", damaged at")[0]


def _is_text(data: bytes) -> bool:
    """Return whether data are a text: letters and digits of ASCII do as data of the machine."""
    return all(0x20 <= b < 0x7F or b in b"\t\r\n" for b in data.rstrip(b"\0"))


def _random(image: Image, begin: int) -> tuple[Recognition, list[Diagnostic]]:
    """Return what to say of what is no data of the machine."""
    data, address = image.data[begin:].rstrip(b"\0"), image.base + begin
    seen = identify(data)
    what = "random data"
    if _is_text(data):
        what = "a text, and no data of the machine"
        if seen.format != "unknown":
            what = f"{what}: {seen.reason}"
    text = "{what}: byte {byte:#04x} at {address:#06x} begins no data"
    hint = "nothing was cleared; identify --clear -o FILE writes a cleared memory"
    values = {"what": what, "byte": data[0], "address": address}
    found = error("random-memory", text, image.span(address, address), hint=hint, **values)
    return Recognition("random", 0, None, None, address, True, what), [found]


def _damaged(
    image: Image, begin: int, format: str | None
) -> tuple[Recognition, list[Diagnostic]] | None:
    """Return what to say of data whose first block is damaged; None where no blocks follow.

    A damaged byte is no reason to call a program random, and to clear it.
    """
    data, address = image.data[begin:], image.base + begin
    _, blocks, found = longest_run(data, 0, format)
    if blocks < NO_CHANCE:
        return None
    starts, end = addresses(data, FORMATS[found])
    rows = tuple((starts + address).tolist())
    reason = f"data in the {found} format, damaged in the first block"
    seen = Recognition(found, 0, address, None, address, False, reason, rows)
    findings = _faults(image, begin, end, seen)
    bad = [d.values["address"] for d in findings if d.code in ("bad-digit", "bad-instruction")]
    return replace(seen, bad=min(bad, default=address)), findings


def _faults(image: Image, begin: int, end: int, seen: Recognition) -> list[Diagnostic]:
    """Return what the reader of the format finds wrong with data, at addresses of the memory.

    Args:
        image: the memory.
        begin: index of the first block.
        end: from there, of the byte behind the last block.
        seen: what was recognised.
    """
    data, address = image.data[begin:], image.base + begin
    _, read = decoder(seen.format)(data, machines.reading(seen.format), image.name)
    findings = [_at_base(d, address) for d in read if d.severity > Severity.NOTE]
    if end >= len(data) or data[end] == compact.END:
        return findings
    at, blocks, _ = longest_run(data, end + 1, seen.format)
    if blocks < NO_CHANCE:
        return findings
    good = len(seen.starts)
    damaged = error(
        "image-damaged",
        "the data are damaged at {address:#06x}, behind block {good}; {blocks} blocks follow each "
        "other again from {next:#06x} on"
        if good
        else "the data are damaged at {address:#06x}, in the first block; {blocks} blocks follow "
        "each other again from {next:#06x} on",
        image.span(address + end, address + end),
        hint="put right what stands between; --at {next:#06x} reads the blocks behind it",
        address=address + end,
        good=good,
        blocks=blocks,
        next=address + at,
    )
    return [*findings, damaged]


def _at_base(d: Diagnostic, address: int) -> Diagnostic:
    """Return a finding of a reader with places that count from the address of its first byte."""
    values = dict(d.values)
    if "address" in values:
        values["address"] += address
    span = d.span
    if isinstance(span, ByteSpan):
        span = ByteSpan(span.file, span.start + address, span.end + address)
    return replace(d, span=span, values=values)


def _not_there(image: Image, seen: Recognition, number: int) -> list[Diagnostic]:
    """Return why a block cannot be found."""
    values = {"number": number, "blocks": len(seen.starts)}
    if not seen.known:
        text = "there is no block {number}: {reason}"
        return [error("no-such-block", text, FileSpan(image.name), reason=seen.reason, **values)]
    last = seen.last if seen.last is not None else seen.first
    assert last is not None
    text = "there is no block {number}: the data have {blocks}, to {last:#06x}"
    return [error("no-such-block", text, image.span(last, last), last=last, **values)]


def _parted(image: Image, first: int, last: int, format: str | None) -> list[Diagnostic]:
    """Return a warning for each end of a range that lies within a block."""
    seen, _ = recognise(image, None, format)
    if not seen.known:
        return []
    findings = []
    lengths = FORMATS[seen.format]
    for number, start in enumerate(seen.starts, 1):
        end = start + lengths[image.data[start - image.base]] - 1
        for cut, where in ((start < first <= end, "begins"), (start <= last < end, "ends")):
            if cut:
                findings.append(
                    warning(
                        "block-parted",
                        "the range {where} within block {number}, which has {first:#06x} to "
                        "{last:#06x}",
                        image.span(start, end),
                        hint="wedmcam zd065 find tells where a block begins",
                        where=where,
                        number=number,
                        first=start,
                        last=end,
                    )
                )
    return findings


def _overwritten(image: Image, low: int, high: int, there: int) -> list[Diagnostic]:
    """Return a warning for bytes other than 0 that a range is moved onto."""
    count = high + 1 - low
    lost = [k for k in range(there, there + count) if not low <= k <= high and image.data[k]]
    if not lost:
        return []
    first, last = image.base + lost[0], image.base + lost[-1]
    return [
        warning(
            "memory-overwritten",
            "{bytes} bytes other than 0 stood at {first:#06x} to {last:#06x} and are overwritten",
            image.span(first, last),
            bytes=len(lost),
            first=first,
            last=last,
        )
    ]
