"""``python -m meshdepict``."""

import sys

from meshdepict.cli import main

if __name__ == "__main__":
    sys.exit(main())
