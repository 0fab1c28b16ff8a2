"""Installs the package into this Python with a library that cargo has built, as `pip install .` would.

python bindings/tests/install.py target/debug
"""

import os
import shutil
import sys
import sysconfig
from pathlib import Path

import maturin

ROOT = Path(__file__).resolve().parents[2]
#: What cargo calls the library on Linux, macOS and Windows.
LIBRARIES = ("lib_native.so", "lib_native.dylib", "_native.dll")


def main(built: Path) -> None:
    """Replaces what is installed, with the metadata that pip would have written."""
    library = next((built / name for name in LIBRARIES if (built / name).exists()), None)
    if library is None:
        raise SystemExit(f"{built} has none of {', '.join(LIBRARIES)}; build the workspace first")
    site = Path(sysconfig.get_path("purelib"))
    for old in (site / "myoenv", *site.glob("myoenv-*.dist-info")):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(
        ROOT / "bindings/python/myoenv", site / "myoenv", ignore=shutil.ignore_patterns("__pycache__", "*.so", "*.pyd")
    )
    shutil.copy2(library, site / "myoenv" / ("_native.pyd" if library.suffix == ".dll" else "_native.abi3.so"))
    os.chdir(ROOT)
    # It asks for its own program by name.
    os.environ["PATH"] = os.pathsep.join([sysconfig.get_path("scripts"), os.environ.get("PATH", "")])
    maturin.prepare_metadata_for_build_wheel(str(site))


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
