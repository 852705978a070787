"""Which machine a program is for, or of: by name, format, content or certificate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from wedmcam import machines
from wedmcam.diag.run import WrongUse
from wedmcam.formats.names import FORMAT_OF_SUFFIX
from wedmcam.machines import Machine
from wedmcam.machines.write import as_toml
from wedmcam.targets import Target, target_of


def machine_for(to: str | None, profile: Machine | str | None) -> Machine:
    """Return the machine of a format and a profile.

    Raises:
        WrongUse: an unknown one, or a profile of another format.
    """
    if isinstance(profile, str):
        machine, findings = machines.find(profile)
        if machine is None:
            hint = f" ({findings[0].hint})" if findings[0].hint else ""
            raise WrongUse(findings[0].message + hint)
        profile = machine
    if profile is None:
        try:
            return machines.default(to or "3b")
        except KeyError:
            raise WrongUse(f"no program format is called '{to}'") from None
    if to is not None and not profile.is_of(to):
        raise WrongUse(f"the profile '{profile.name}' is for {profile.format}, not for {to}")
    return profile


def machine_issued(certificate: dict[str, Any]) -> Machine:
    """Return the machine that a certificate was issued for; it holds what is not built in.

    Raises:
        WrongUse: it names a profile that is not there.
    """
    name, text = str(certificate["profile"]), certificate.get("profile_toml")
    if text is None:
        return machine_for(None, name)
    machine, findings = machines.parse(str(text), name)
    if machine is None:
        raise WrongUse(f"the certificate's profile '{name}' cannot be used: {findings[0].message}")
    return machine


def starts_of(machine: Machine) -> dict[str, Any]:
    """Return what a certificate says of a machine beside its own, where starts are placed."""
    values: dict[str, Any] = {"starts_of": machine.name}
    if not machines.is_builtin(machine):
        values["starts_of_toml"] = as_toml(machine)
    return values


def targets_of(machine: Machine, certificate: dict[str, Any] | None) -> list[Target]:
    """Return the targets that a plan was made for: the machine's, and one whose starts it has."""
    targets = [target_of(machine)]
    name = (certificate or {}).get("starts_of")
    if name is not None and not targets[0].moves_starts:
        other = {"profile": name, "profile_toml": (certificate or {}).get("starts_of_toml")}
        targets.append(target_of(machine_issued(other)))
    return targets


def reader_machine(
    data: bytes, name: str, format_: str | None, profile: Machine | str | None
) -> Machine:
    """Return the machine of a program: of its profile, its format, its name or its content.

    Raises:
        WrongUse: as `machine_for`.
    """
    if format_ is None and profile is None:
        format_ = FORMAT_OF_SUFFIX.get(Path(name).suffix.lower())
        if format_ is None:
            from wedmcam.frontends.identify import identify  # reads ISO: not for every program

            seen = identify(data).format
            format_ = seen if seen in machines.DEFAULTS else "3b"
    if profile is None and format_ in machines.DEFAULTS:
        return machines.reading(format_)
    return machine_for(format_, profile)
