#!/usr/bin/env python3
"""Writes the section "Instances" of nesting.md: densities of the public and our own instances.

instance_table.py BENCH_NEST SHARED [--seconds 60] [--seeds 5] [--only NAME...]
"""

import argparse
import subprocess
from pathlib import Path

from sections import write_section

TITLE = '## Instances'
INSTANCES = ['dagli', 'marques', 'shapes1', 'fu', 'gardeyn0', 'strips60_mild', 'strips60_bent']


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('bench_nest')
    parser.add_argument('shared')
    parser.add_argument('--seconds', type=float, default=60)
    parser.add_argument('--seeds', type=int, default=5)
    parser.add_argument('--only', nargs='+', default=INSTANCES)
    args = parser.parse_args()
    files = [Path(args.shared) / 'data/nesting' / f'{name}.json' for name in args.only]
    out = subprocess.run([args.bench_nest, str(args.seconds), str(args.seeds), *files], check=True,
                         capture_output=True, text=True).stdout
    # The last column is the course of the first seed.
    rows = ['|'.join(line.split('|')[:6]) + '|' for line in out.splitlines()]
    write_section(Path(__file__).with_name('nesting.md'), TITLE, [
        f'Density of {args.seeds} seeds, {args.seconds:g} s of two threads each (processor time).', '', *rows])


main()
