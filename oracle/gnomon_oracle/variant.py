"""Which Mitsuba is used: the vectorised variant where a libLLVM that works is found, else the scalar one.

Mitsuba's area lights abort the process with libLLVM 15 and 16, so only versions from 17 on are taken; whoever sets
``DRJIT_LIBLLVM_PATH`` decides alone.
"""

import os
import re
from pathlib import Path
from typing import Any

OLDEST_LLVM = 17
FOLDERS = ("/usr/lib", "/usr/lib64", "/usr/local/lib", "/opt/homebrew/lib")
_NAME = re.compile(r"^libLLVM(?:-|\.so\.)(\d+)(?:\.so)?(?:\.\d+)*$")


def newest_llvm(folders: tuple[str, ...] = FOLDERS) -> Path | None:
    """Return the newest libLLVM that works with Mitsuba, if there is one."""
    found: list[tuple[int, str]] = []
    for folder in folders:
        for pattern in ("libLLVM*", "*/libLLVM*", "llvm-*/lib/libLLVM*"):
            for path in Path(folder).glob(pattern):
                name = _NAME.match(path.name)
                if name and int(name[1]) >= OLDEST_LLVM:
                    found.append((int(name[1]), str(path)))
    return Path(max(found)[1]) if found else None


def start(*, scalar: bool = False) -> Any:
    """Import Mitsuba and choose the variant; of a broken libLLVM only Mitsuba's own error is left to tell."""
    library = os.environ.get("DRJIT_LIBLLVM_PATH") or newest_llvm()
    if library:
        os.environ["DRJIT_LIBLLVM_PATH"] = str(library)
    import mitsuba as mi  # noqa: PLC0415 - the environment decides what it loads

    mi.set_variant("llvm_ad_rgb" if library and not scalar else "scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    return mi


def is_scalar(mi: Any) -> bool:
    """Whether every ray needs its own call."""
    return str(mi.variant()).startswith("scalar")
