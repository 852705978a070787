"""What is keyed in after a function is chosen: numbers of fixed lengths, so no key ends them."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Field:
    """A number that is keyed in.

    Attributes:
        name: what it is, for people.
        digits: how many.
        is_hex: an address or a byte, else decimal.
        most: largest value.
    """

    name: str
    digits: int
    is_hex: bool = False
    most: int = 99_999_999

    def value(self, text: str) -> int:
        """Return the number that digits are."""
        return int(text, 16 if self.is_hex else 10)


@dataclass(frozen=True, slots=True)
class Entry:
    """Numbers that are being keyed in.

    Attributes:
        fields: all of them.
        values: those that are there.
        typed: digits of the next one.
    """

    fields: tuple[Field, ...]
    values: tuple[int, ...] = ()
    typed: str = ""

    @property
    def field(self) -> Field | None:
        """The number that is keyed in next; None where all are there."""
        at = len(self.values)
        return self.fields[at] if at < len(self.fields) else None

    def with_digit(self, digit: str) -> Entry | str:
        """Return the entry with one digit more, or why it cannot be.

        >>> gap = Entry((Field("gap", 2, most=50),))
        >>> gap.with_digit("A")
        'gap takes decimal digits'
        >>> gap.with_digit("6").with_digit("0")
        'gap is 60: the largest is 50'
        >>> gap.with_digit("0").with_digit("7").values
        (7,)
        """
        field = self.field
        assert field is not None
        if not field.is_hex and not digit.isdecimal():
            return f"{field.name} takes decimal digits"
        typed = self.typed + digit
        if len(typed) < field.digits:
            return replace(self, typed=typed)
        value = field.value(typed)
        if value > field.most:
            most = f"{field.most:X}" if field.is_hex else str(field.most)
            return f"{field.name} is {typed.lstrip('0')}: the largest is {most}"
        return Entry(self.fields, (*self.values, value))
