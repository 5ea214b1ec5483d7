"""`python -m underbrush` is the command `underbrush`."""
import sys

from .cli import main

sys.exit(main())
