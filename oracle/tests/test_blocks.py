"""The exchange layout: what is written is read again, and nothing else is."""

from pathlib import Path

import numpy as np
import pytest

from gnomon_oracle import blocks
from gnomon_oracle.blocks import BlockError

ARRAYS = {
    "a": np.arange(5, dtype="u1"),
    "b": np.array([[1.5, -0.0, np.inf]], dtype="<f4"),
    "empty": np.zeros((0, 3), dtype="<f8"),
    "d": np.array([2**32 - 1], dtype="<u4"),
}


def test_what_is_written_is_read() -> None:
    read = blocks.decode(blocks.encode({"task": "rays"}, ARRAYS))
    assert read.about == {"task": "rays"}
    for name, array in ARRAYS.items():
        assert read.arrays[name].tobytes() == array.tobytes()
        assert read.arrays[name].shape == array.shape


def test_arrays_start_at_multiples_of_eight() -> None:
    data = blocks.encode({}, ARRAYS)
    at = data.index(ARRAYS["b"].tobytes())
    assert at % 8 == 0


@pytest.mark.parametrize("cut", [0, 4, 11, 40, -1])
def test_a_file_cut_off_is_refused(cut: int) -> None:
    data = blocks.encode({}, ARRAYS)
    with pytest.raises(BlockError):
        blocks.decode(data[:cut])


def test_a_foreign_file_is_refused() -> None:
    with pytest.raises(BlockError, match="not a gnomon block file"):
        blocks.decode(b"PK\x03\x04" + bytes(100))


@pytest.mark.parametrize("header", [b"[]", b'{"about": {}}', b'{"about": {}, "arrays": [{"name": 1}]}', b"\xff"])
def test_a_malformed_header_is_refused(header: bytes) -> None:
    data = blocks.MAGIC + len(header).to_bytes(4, "little") + header
    with pytest.raises(BlockError, match="malformed"):
        blocks.decode(data)


def test_arrays_are_asked_for_by_type_and_shape() -> None:
    read = blocks.decode(blocks.encode({}, ARRAYS))
    assert len(read.array("b", "f32", None, 3)) == 1
    for name, kind, shape in [("b", "f64", (None, 3)), ("b", "f32", (None, 4)), ("b", "f32", (3,)), ("c", "u8", ())]:
        with pytest.raises(BlockError):
            read.array(name, kind, *shape)


def test_files_appear_whole(tmp_path: Path) -> None:
    path = tmp_path / "x.answer"
    blocks.write(path, b"one")
    blocks.write(path, b"two")
    assert [file.name for file in tmp_path.iterdir()] == ["x.answer"]
    assert path.read_bytes() == b"two"
