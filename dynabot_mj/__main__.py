"""`python -m dynabot_mj`, the same as the command `dynabot`."""

import sys

from dynabot_mj.cli import main

if __name__ == "__main__":
    sys.exit(main())
