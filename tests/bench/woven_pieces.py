#!/usr/bin/env python3
"""Writes the section "Pieces of woven models" of nesting.md: sheets and density of three models' pieces
beside libnest2d on the same pieces and beside the area bound.

usage: woven_pieces.py LEAFCUTTER SHARED_DIR [PEER_LIBNEST2D] [--time SECONDS]
"""
import argparse
import json
import math
import re
import subprocess
import tempfile
from pathlib import Path

from sections import write_section

MODELS = ['eight-7k.off', 'hand-6-boundaries.obj', 'face-gu.off']
TITLE = '## Pieces of woven models'
MARGIN_MM, SPACING_MM = 5.0, 1.0


def area(ring):
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, ring[1:] + ring[:1]))) / 2


def perimeter(ring):
    return sum(math.dist(a, b) for a, b in zip(ring, ring[1:] + ring[:1]))


def bound(pieces, sheets, gap, edge):
    """Sheets needed if pieces and half their gaps filled the usable area whole, by family."""
    count = 0
    for family in {sheet['family'] for sheet in sheets}:
        mine = [s for s in sheets if s['family'] == family]
        ids = {p['piece'] for s in mine for p in s['placements']}
        need = sum(area(p['outline']) + gap / 2 * perimeter(p['outline']) for p in pieces if p['id'] in ids)
        room = (mine[0]['width_mm'] - 2 * edge + gap) * (mine[0]['height_mm'] - 2 * edge + gap)
        count += math.ceil(need / room)
    return count


def used_length(sheet, outlines):
    """How far the last sheet is used along its better axis, as a share."""
    xs, ys = [], []
    for p in sheet['placements']:
        c, s = math.cos(math.radians(p['rotation_deg'])), math.sin(math.radians(p['rotation_deg']))
        for x, y in outlines[p['piece']]:
            xs.append(c * x - s * y + p['x_mm'])
            ys.append(s * x + c * y + p['y_mm'])
    return min(max(xs) / sheet['width_mm'], max(ys) / sheet['height_mm'])


def peer_row(peer, package, gap, edge):
    if not peer:
        return '–', '–', '–'
    text = subprocess.run([peer, str(edge), str(gap), str(package)], capture_output=True, text=True, check=True).stdout
    _, _, sheets, density, _, seconds, _ = [cell.strip() for cell in text.splitlines()[-1].split('|')]
    return sheets, density, seconds


def row(model, args, directory):
    package = Path(directory) / model
    subprocess.run([args.leafcutter, 'weave', Path(args.shared) / 'data/meshes' / model, '-o', package,
                    '--set', f'nesting.time_s={args.time}'], check=True, capture_output=True)
    layout = json.loads((package / 'layout.json').read_text())
    pieces = json.loads((package / 'strips.json').read_text())['pieces']
    kerf = json.loads((package / 'report.json').read_text())['materials'][0]['kerf_mm']
    gap, edge = SPACING_MM + kerf, MARGIN_MM + kerf / 2
    outlines = {p['id']: p['outline'] for p in pieces}
    sheets = layout['sheets']
    last = {s['family']: s for s in sheets}
    share = len(sheets) - sum(1 - used_length(s, outlines) for s in last.values())
    filled = sum(area(p['outline']) for p in pieces) / (share * sheets[0]['width_mm'] * sheets[0]['height_mm'])
    peer = peer_row(args.peer, package, gap, edge)
    return (f'| {model} | {len(pieces)} | {len(sheets)} ({share:.2f} used) | {layout["density_percent"]:.1f} | '
            f'{100 * filled:.1f} | {layout["smallest_gap_mm"]:.4f} | {peer[0]} | {peer[1]} | '
            f'{bound(pieces, sheets, gap, edge)} |')


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('leafcutter')
    parser.add_argument('shared')
    parser.add_argument('peer', nargs='?')
    parser.add_argument('--time', type=float, default=10)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        rows = [row(model, args, directory) for model in MODELS]
    write_section(Path(__file__).with_name('nesting.md'), TITLE, [
        f'All pieces of a model (defaults, {args.time:g} s of nesting), weft and warp on sheets of their own. "Used" counts the last',
        'sheet of each material by the part that the pieces take; density over that part is "filled". libnest2d nests the',
        'convex hulls of the same pieces (it takes no others) on the same sheets, margins and gap; the bound is the pieces\' area',
        'with half the gap around, over the usable area, rounded up for each material.', '',
        '| model | pieces | sheets | density % | filled % | smallest gap mm | libnest2d sheets | its density % | bound |',
        '|---|--:|--:|--:|--:|--:|--:|--:|--:|', *rows])


main()
