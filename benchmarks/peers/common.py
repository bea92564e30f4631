"""What both comparisons print."""

import importlib.metadata
import platform

import dynabot_mj as dy


def versions(*libraries: str) -> str:
    """Returns what was compared."""
    named = [f"{name} {importlib.metadata.version(name)}" for name in libraries]
    return ", ".join([f"dynabot-mj {dy.__version__}", f"python {platform.python_version()}", *named])
