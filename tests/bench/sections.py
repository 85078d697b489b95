"""A section of a Markdown file that a script writes anew."""

import re
from pathlib import Path


def write_section(path: Path, title: str, lines: list[str]):
    """Puts `lines` under `title` in the file, in place of what is there."""
    section = '\n'.join([title, '', *lines]) + '\n'
    text = path.read_text() if path.exists() else '# Nesting figures\n'
    old = re.compile(re.escape(title) + r'\n.*?(?=\n## |\Z)', re.S)
    text = old.sub(lambda _: section, text) if old.search(text) else f'{text.rstrip()}\n\n{section}'
    path.write_text(text.rstrip('\n') + '\n')
