"""Common functions of the oracle scripts: tables are written, or recomputed and compared with the committed ones."""

import argparse
import csv
import sys


def same(ours, committed, tolerance, least):
    """Returns whether the cells of two tables agree: texts exactly, numbers (several are separated by `;`) within a
    tolerance, relative to their size or to `least`."""
    cells = lambda rows: [part for row in rows for cell in row for part in str(cell).split(";")]  # noqa: E731
    ours, committed = cells(ours), cells(committed)
    if len(ours) != len(committed):
        return False
    for x, y in zip(ours, committed):
        try:
            if abs(float(x) - float(y)) > tolerance * max(least, abs(float(y))):
                return False
        except ValueError:
            if x != y:
                return False
    return True


def main(doc, folder, tables, least):
    """`tables`: names, rows and tolerances."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    mode = parser.add_mutually_exclusive_group(required=True)
    mode.add_argument("--write", action="store_true")
    mode.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    fine = True
    for name, rows, tolerance in tables:
        path = folder / name
        if arguments.write:
            with path.open("w", newline="") as file:
                csv.writer(file, lineterminator="\n").writerows(rows)
            continue
        with path.open(newline="") as file:
            equal = same(rows, list(csv.reader(file)), tolerance, least)
        print(f"{name}: {'as committed' if equal else 'differs'}")
        fine &= equal
    sys.exit(0 if fine else 1)
