"""Configuration files to parameters and back.

`config/gearbox.yaml` holds every value with its unit and source; presets and users' files are laid over it.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from nw_gear_common import names, share
from nw_gear_common.errors import InputError
from nw_gear_common.quantities import optional, quantities
from nw_gear_sim import configfile, nondimensional
from nw_gear_sim.kinematics import Kinematics, derive
from nw_gear_sim.params import Configuration

BASE = "config/gearbox.yaml"


def load(source: str | Path | None = None, *, base: Path | None = None) -> Configuration:
    """Load the configuration: the base file with another one laid over it.

    Args:
        source: path of a YAML file, the name of a preset (names.PRESETS), or None or "" for the base alone.
        base: the complete file underneath (None = the installed `config/gearbox.yaml`).

    Raises:
        InputError: a file is missing or wrong, a key is missing in the base, or the gearbox can't be assembled.
    """
    base_path = share.find(BASE) if base is None else base
    values = configfile.read(base_path, sources=True)
    _refuse_missing(str(base_path), values)
    place = str(base_path)
    if source is not None and str(source):
        path = _path(source)
        values |= configfile.read(path)
        place = str(path)
    return _assemble(values, place)


def from_yaml(text: str, place: str = "configuration") -> Configuration:
    """Read a complete configuration, as `to_yaml` writes it.

    Raises:
        InputError: wrong text, a missing key, or a gearbox that can't be assembled.
    """
    values = configfile.parse(text, place)
    _refuse_missing(place, values)
    return _assemble(values, place)


def to_yaml(configuration: Configuration) -> str:
    """Write the resolved configuration as YAML in SI units; `from_yaml` gives back an equal one."""
    return yaml.safe_dump(_plain(configuration), sort_keys=False, allow_unicode=True)


def with_values(values: Mapping[str, Any], base: Configuration) -> Configuration:
    """Return a configuration with some values replaced.

    Args:
        values: by dotted key, such as {"mesh.I.backlash": 45e-6}, in SI units; or as a pure number (see
            `nondimensional.UNITS`), such as {"nondimensional.mesh.I.backlash": 1}.
        base: the configuration to start from.

    Raises:
        InputError: unknown key, wrong type, out of range, or a gearbox that can't be assembled.
    """
    known = configfile.leaves()
    flat = {key: _get(base, key) for key in known}
    for key, value in values.items():
        pure = key.removeprefix(f"{configfile.NONDIMENSIONAL}.")
        if pure != key and pure in known:
            flat[pure] = configfile.scaled(key, value)
            continue
        if key not in known:
            raise configfile.unknown_key("configuration", key, list(known))
        flat[key] = configfile.check_leaf(key, value, known[key])
    return _assemble(flat, "configuration")


def _path(source: str | Path) -> Path:
    if str(source) in names.PRESETS:
        return share.find(f"config/{source}.yaml")
    path = Path(source)
    if not path.is_file():
        expected = "a YAML file or one of the presets " + ", ".join(names.PRESETS)
        raise InputError(str(source), expected, "a folder" if path.is_dir() else "no such file")
    return path


def _refuse_missing(place: str, values: Mapping[str, Any]) -> None:
    missing = [key for key in configfile.leaves() if key not in values]
    if missing:
        more = f" and {len(missing) - 1} more keys" if len(missing) > 1 else ""
        raise InputError(place, f"a value for {missing[0]}{more}", "none")


def _assemble(values: Mapping[str, Any], place: str) -> Configuration:
    configuration: Configuration = _build(Configuration, _resolved(values, place), "")
    turbine = configuration.turbine
    if not turbine.cut_in_wind < turbine.rated_wind < turbine.cut_out_wind:
        got = f"{turbine.cut_in_wind:g}, {turbine.rated_wind:g}, {turbine.cut_out_wind:g} m/s"
        raise InputError(f"{place}: turbine", "cut_in_wind < rated_wind < cut_out_wind", got)
    _derive(configuration, place)
    return configuration


def _derive(configuration: Configuration, place: str) -> Kinematics:
    try:
        return derive(configuration)
    except InputError as error:
        raise InputError(f"{place}: {error.place}", error.expected, error.got) from error


def _resolved(values: Mapping[str, Any], place: str) -> dict[str, Any]:
    """Turn values of the nondimensional form into SI; the scales don't depend on what may be given in them."""
    pure = {key: value for key, value in values.items() if isinstance(value, configfile.Scaled)}
    if not pure:
        return dict(values)
    for key, value in pure.items():
        if key not in nondimensional.UNITS:
            listed = "`nw_gear equilibrium --nondimensional` lists them"
            raise InputError(value.place, f"a parameter that has a nondimensional form ({listed})", repr(key))
    draft: Configuration = _build(Configuration, {**values, **dict.fromkeys(pure, 1.0)}, "")
    kinematics, known = _derive(draft, place), configfile.leaves()
    out = dict(values)
    for key, value in pure.items():
        in_si = value.value * nondimensional.unit(key, draft, kinematics)
        try:
            out[key] = configfile.check_leaf(value.place, in_si, known[key])
        except InputError as error:
            raise InputError(value.place, error.expected, f"{value.value:g}, which is {in_si:g}") from error
    return out


def _build(cls: type, values: Mapping[str, Any], prefix: str) -> Any:
    nested = {name: _build(section, values, f"{prefix}{name}.") for name, section in configfile.sections(cls).items()}
    own = {name: values[prefix + name] for name, _kind, _default, _description in quantities(cls)}
    return cls(**nested, **own)


def _get(owner: Any, key: str) -> Any:
    for name in key.split("."):
        owner = getattr(owner, name)
    return owner


def _plain(owner: Any) -> dict[str, Any]:
    """Nested dictionaries in the order of declaration, numbers with a dimension as texts with their SI unit."""
    out: dict[str, Any] = {}
    for name, kind, _default, description in quantities(owner):
        value = getattr(owner, name)
        dimensional = description.unit and optional(kind)[0] is float and value is not None
        out[name] = f"{value!r} {description.unit}" if dimensional else value
    return out | {name: _plain(getattr(owner, name)) for name in configfile.sections(type(owner))}
