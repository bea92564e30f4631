"""Formation control under limited computation and communication, with point-mass and rigid-body robots.

Importing the package imports nothing heavy; start from `dynabot_mj.study`.
"""

from pathlib import Path as _Path

__version__ = "0.1.0"

# In a checkout these are links to folders beside the package; wheels have the folders themselves.
for _leaf in ("models", "controllers", "estimation"):
    if not (_Path(__file__).parent / _leaf).is_dir():
        raise ImportError(
            f"{_Path(__file__).parent / _leaf} is no folder: a checkout of dynabot-mj has symbolic links there, which "
            "this one lacks; check out again with `git config core.symlinks true`, or install a wheel"
        )
