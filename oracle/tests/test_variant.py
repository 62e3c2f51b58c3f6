"""Which libLLVM is taken."""

from pathlib import Path

from gnomon_oracle.variant import newest_llvm


def test_versions_that_abort_mitsuba_are_passed_over(tmp_path: Path) -> None:
    for name in ("libLLVM-15.so", "libLLVM-16.so.1", "libLLVM.so", "libLLVMSomething.so"):
        (tmp_path / name).touch()
    assert newest_llvm((str(tmp_path),)) is None
    (tmp_path / "x86_64-linux-gnu").mkdir()
    for name in ("libLLVM-17.so.1", "libLLVM.so.19.1"):
        (tmp_path / "x86_64-linux-gnu" / name).touch()
    assert newest_llvm((str(tmp_path),)) == tmp_path / "x86_64-linux-gnu" / "libLLVM.so.19.1"
