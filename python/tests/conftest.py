"""Lets the tests run from a checkout as well as against the installed package."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
try:
    import underbrush.formats  # noqa: F401
except ImportError:
    sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
