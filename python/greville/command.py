"""Shared by the commands of this package. Each is main(program) of a module."""
import argparse
import sys
from pathlib import Path

from .results import ResultsError


def parser_of(program, text, folders="results of a run"):
    """Return a parser that takes folders of runs; text is the help."""
    parser = argparse.ArgumentParser(prog=program, description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help=folders)
    return parser


def run_command(parser, action):
    """Call the action with the command-line arguments. An error ends the program with its message."""
    arguments = parser.parse_args()
    try:
        action(arguments)
    except ResultsError as error:
        sys.exit(f"{parser.prog}: {error}")
    except OSError as error:
        sys.exit(f"{parser.prog}: {error.filename}: {error.strerror}.")
