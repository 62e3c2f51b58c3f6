"""The one binary layout in which gnomon and the oracle exchange arrays: little-endian, read and written whole.

A file is the magic, the length of a JSON header as u32, the header, then the arrays one after another, each starting at
a multiple of 8 bytes from the file's beginning. The header holds ``about``, any JSON object, and ``arrays``, a list of
``{"name", "type", "shape"}`` in the order in which they lie.
"""

import json
import os
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC = b"gnomon\x00\x01"
ALIGNMENT = 8
TYPES: dict[str, np.dtype[Any]] = {
    "u8": np.dtype("u1"),
    "u32": np.dtype("<u4"),
    "f32": np.dtype("<f4"),
    "f64": np.dtype("<f8"),
}
# A header is a few hundred bytes; more is not one of ours.
LARGEST_HEADER = 1 << 20


class BlockError(Exception):
    """The file is not what it should be."""


@dataclass(frozen=True)
class Blocks:
    """What a file holds."""

    about: dict[str, Any]
    arrays: dict[str, NDArray[Any]]

    def array(self, name: str, kind: str, *shape: int | None) -> NDArray[Any]:
        """Return the array of that name; its type and every side of its shape that is not ``None`` must match."""
        found = self.arrays.get(name)
        if found is None:
            raise BlockError(f"no array '{name}'")
        sides_fit = len(found.shape) == len(shape) and all(
            side in (None, actual) for side, actual in zip(shape, found.shape, strict=True)
        )
        if found.dtype != TYPES[kind] or not sides_fit:
            raise BlockError(f"array '{name}' is {found.dtype} {found.shape}, not {kind} {shape}")
        return found


def decode(data: bytes) -> Blocks:
    """Read a file's bytes."""
    start = len(MAGIC) + 4
    if data[: len(MAGIC)] != MAGIC or len(data) < start:
        raise BlockError("not a gnomon block file")
    (length,) = struct.unpack_from("<I", data, len(MAGIC))
    if length > LARGEST_HEADER or start + length > len(data):
        raise BlockError("the header is cut off")
    try:
        header = json.loads(data[start : start + length])
        about, listed = dict(header["about"]), list(header["arrays"])
        entries = [(str(a["name"]), TYPES[a["type"]], tuple(int(side) for side in a["shape"])) for a in listed]
    except (ValueError, KeyError, TypeError) as error:
        raise BlockError(f"the header is malformed: {error!r}") from error
    arrays: dict[str, NDArray[Any]] = {}
    at = _aligned(start + length)
    for name, kind, shape in entries:
        count = int(np.prod(shape, dtype=np.uint64))
        if any(side < 0 for side in shape) or at + count * kind.itemsize > len(data):
            raise BlockError(f"array '{name}' is cut off")
        arrays[name] = np.frombuffer(data, kind, count, at).reshape(shape)
        at = _aligned(at + count * kind.itemsize)
    return Blocks(about, arrays)


def encode(about: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Lay out a file's bytes."""
    names = {kind: name for name, kind in TYPES.items()}
    listed = [{"name": name, "type": names[a.dtype], "shape": list(a.shape)} for name, a in arrays.items()]
    header = json.dumps({"about": about, "arrays": listed}).encode()
    parts = [MAGIC, struct.pack("<I", len(header)), header]
    size = sum(map(len, parts))
    for array in arrays.values():
        padding = _aligned(size) - size
        body = array.tobytes()
        parts += [b"\x00" * padding, body]
        size += padding + len(body)
    return b"".join(parts)


def write(path: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    part = path.with_name(path.name + ".part")
    part.write_bytes(data)
    os.replace(part, path)


def _aligned(size: int) -> int:
    return -(-size // ALIGNMENT) * ALIGNMENT
