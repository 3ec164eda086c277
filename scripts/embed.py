#!/usr/bin/python3
"""embed.py OUTPUT FILE...: writes kernel_source.c, the table of name, folder and text of each FILE
that src/device/kernel_source.h declares."""
import pathlib
import sys

ESCAPES = {"\\": "\\\\", '"': '\\"', "\t": "\\t", "?": "\\?"}  # \?: no trigraphs


def literal(line):
    return '        "' + "".join(ESCAPES.get(c, c) for c in line) + '\\n"'


entries = []
for path in sorted(map(pathlib.Path, sys.argv[2:]), key=lambda p: p.name):
    lines = "\n".join(map(literal, path.read_text(encoding="ascii").splitlines()))
    entries.append(f'    {{"{path.name}", "{path.parent.name}",\n{lines}}},\n')
text = (
    '#include "device/kernel_source.h"\n\nconst struct kernel_source kernel_source_table[] = {\n'
    + "".join(entries)
    + "    {0, 0, 0},\n};\n"
)
pathlib.Path(sys.argv[1]).write_text(text, encoding="ascii")
