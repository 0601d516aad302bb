"""Prints the sizes of wheels by part, and fails where one is above 15 MB: python tools/wheels/sizes.py WHEEL..."""

import sys
from collections import Counter
from pathlib import Path, PurePosixPath
from zipfile import ZipFile

MOST = 15_000_000  # bytes


def part_of(name: str) -> str:
    """What a file belongs to."""
    path = PurePosixPath(name)
    if ".so" in path.suffixes:
        return "/".join(path.parts[1:]).partition(".")[0]
    return {"assets": "assets", "policies": "policies"}.get(path.parts[1] if len(path.parts) > 1 else "", "Python")


def main(wheels: list[str]) -> int:
    """Prints a line for each wheel and each part of it: compressed and unpacked size."""
    for wheel in map(Path, wheels):
        packed, unpacked = Counter[str](), Counter[str]()
        with ZipFile(wheel) as files:
            for info in files.infolist():
                packed[part_of(info.filename)] += info.compress_size
                unpacked[part_of(info.filename)] += info.file_size
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB, unpacked {unpacked.total() / 1e6:.1f} MB")
        for part, size in packed.most_common():
            print(f"  {part:<20} {size / 1e6:6.2f} MB, unpacked {unpacked[part] / 1e6:6.2f} MB")
    return int(any(Path(wheel).stat().st_size > MOST for wheel in wheels))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
