"""Keeps what the fuzzer found: `python3 fuzz/keep.py FOLDER`, of inputs that were merged before.

`cargo +nightly fuzz run read FOLDER fuzz/corpus/read fuzz/seeds -- -merge=1 -use_counters=0` leaves in FOLDER the smallest inputs that reach
all code that any of them reaches.
"""

import pathlib
import sys

# XML has no such character; an input that has one is not kept.
SEPARATOR = "\x1e"


def texts(folder: pathlib.Path) -> list[str]:
    found = []
    for path in folder.iterdir():
        try:
            found.append(path.read_bytes().decode())
        except UnicodeDecodeError:
            continue
    return sorted((text for text in found if SEPARATOR not in text), key=lambda text: (len(text), text))


kept = texts(pathlib.Path(sys.argv[1]))
pathlib.Path(__file__).with_name("corpus.txt").write_bytes(SEPARATOR.join(kept).encode())
print(f"{len(kept)} inputs are kept")
