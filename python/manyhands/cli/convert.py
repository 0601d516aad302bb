"""The command `manyhands convert`: a robot or scene from one format to another."""

import argparse
import sys
import warnings
from pathlib import Path

from manyhands._core import LoadReport, Model, load_mjcf, load_urdf, save_mjcf, save_urdf

EXAMPLES = """\
examples:
  manyhands convert robot.urdf robot.xml          URDF to MJCF, which MuJoCo reads
  manyhands convert scene.xml arm.urdf            MJCF to URDF, if URDF can say all that moves
  manyhands convert scene.xml arm.urdf --allow-loss    ... or without what it cannot say
  manyhands convert scene.xml plain.xml           one file without includes, defaults and degrees
  manyhands convert dog.urdf dog.xml --floating   its root floats

The ending tells the format: .urdf, or .xml and .mjcf for MJCF. Meshes (OBJ) and images go to the folder OUT_assets
beside OUT; only OUT is overwritten. What was repaired, said otherwise or left out is printed.
"""
_MJCF = (".xml", ".mjcf")
_URDF = ".urdf"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands convert`."""
    parser.add_argument("source", metavar="IN", type=Path, help="FILE.urdf, FILE.xml or FILE.mjcf")
    parser.add_argument("target", metavar="OUT", type=Path, help="likewise; overwritten if it is there")
    parser.add_argument(
        "--allow-loss", action="store_true", help="write OUT even where it moves or touches otherwise than IN"
    )
    parser.add_argument("--floating", action="store_true", help="let the root of a URDF float; default: it is fixed")
    parser.add_argument(
        "--package-path", type=Path, action="append", default=[], metavar="DIR", help="where packages of a URDF lie"
    )
    parser.add_argument("--allow-outside", action="store_true", help="read meshes outside IN's package, too")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def run(arguments: argparse.Namespace) -> int:
    """Loads one file and writes the other."""
    source, target = arguments.source, arguments.target
    save = save_urdf if _is_urdf(target) else save_mjcf
    if target.exists() and source.exists() and target.samefile(source):
        raise ValueError(f"{target} is the file to be read; name another to write")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the report says it all
        model, read = _loaded(arguments)
    written = save(model, target, allow_loss=arguments.allow_loss)
    if not arguments.quiet:
        for title, report in ((f"reading {source}", read), (f"writing {target}", written)):
            if len(report):
                print(f"{title}: {report}", file=sys.stderr)
        print(f"{target}: {len(model.links) - 1} links, nq {model.nq}, nv {model.nv}")
    return 0


def _is_urdf(path: Path) -> bool:
    ending = path.suffix.lower()
    if ending != _URDF and ending not in _MJCF:
        raise ValueError(f"{path} ends in {ending or 'nothing'}; expected .urdf, or .xml or .mjcf for MJCF")
    return ending == _URDF


def _loaded(arguments: argparse.Namespace) -> tuple[Model, LoadReport]:
    if not _is_urdf(arguments.source):
        return load_mjcf(arguments.source, allow_outside_package=arguments.allow_outside)
    return load_urdf(
        arguments.source, fixed_base=not arguments.floating, package_paths=arguments.package_path,
        allow_outside_package=arguments.allow_outside,
    )  # fmt: skip
