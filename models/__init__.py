"""MJCF of the robot and of the field it drives on.

The numbers of the vehicle (mass, geometry, friction, motor constants) are stated in these files and nowhere else;
`dynabot_mj.plants.scene` reads them back from the compiled model.
"""

from pathlib import Path

_FOLDER = Path(__file__).resolve().parent


def path(name: str) -> Path:
    """Returns the path of an MJCF file of this package, in a checkout and in an installed wheel alike.

    Args:
        name: File name without its folder, e.g. `"dynabot.xml"`.

    Raises:
        FileNotFoundError: If there is no such file; the message lists those that exist.
    """
    file = _FOLDER / name
    if not file.is_file():
        known = ", ".join(sorted(p.name for p in _FOLDER.glob("*.xml")))
        raise FileNotFoundError(f"no MJCF file {name!r} among the models; there are: {known}")
    return file
