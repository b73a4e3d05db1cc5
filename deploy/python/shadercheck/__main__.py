"""``python -m shadercheck``."""

import sys

from . import run

if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]).returncode)
