"""The program shadercheck, and its reference data as NumPy arrays.

    >>> import shadercheck
    >>> data = shadercheck.read("sphere.npz")           # written by `shadercheck refdata generate`
    >>> data.expected["gl_Position"].shape, data.within(mine, "gl_Position").mean()

``binary()`` is the path of the program and ``run(["lint", "shaders"])`` starts it.
"""

import os
import subprocess
import sys
import sysconfig

__all__ = ["RefData", "binary", "read", "run"]


def __getattr__(name):
    # NumPy is needed for reference data alone.
    if name in ("RefData", "read"):
        from . import refdata

        return getattr(refdata, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def binary():
    """Path of the program that came with this package."""
    name = "shadercheck" + (sysconfig.get_config_var("EXE") or "")
    places = [sysconfig.get_path("scripts"), sysconfig.get_path("scripts", f"{os.name}_user"), os.path.dirname(sys.executable)]
    for folder in places:
        path = os.path.join(folder, name)
        if os.path.isfile(path):
            return path
    raise FileNotFoundError(f"{name} is in none of {', '.join(places)}; install the package again")


def run(arguments, **options):
    """Runs the program; ``options`` are those of :func:`subprocess.run`. Status 1 means findings and is no error."""
    return subprocess.run([binary(), *arguments], **options)
