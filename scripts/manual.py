#!/usr/bin/python3
"""manual.py program|scene|tools|completion DESCRIPTION: democles(1), democles-scene(5),
democles-tools(1), or the completion of bash.

DESCRIPTION is what src/app/describe.c prints, the tables behind --help and `explain`. What the
tools do stands above their modules."""
import ast
import pathlib
import re
import sys

TOOLS = pathlib.Path(__file__).resolve().parent / "democles"


class Description:
    """`commands`: name -> (usage, text, options [(name, value, text)]); `codes` of exit; `keys` of
    scenes: rows of columns; `notes` below them."""

    def __init__(self, text):
        *commands, program, scene = text.split("\f")
        self.commands = {}
        for help_text in commands:
            usage, text, _, *rows = help_text.splitlines()
            words = [re.match(r" +(\S+)(?: (\S+))? {2,}(.*)", row).groups() for row in rows]
            self.commands[usage.split()[2]] = usage.removeprefix("usage: "), text, words
        self.title = program.splitlines()[0]
        self.codes = re.findall(r"(\d+) ([^,]+)", re.search(r"exit codes: (.*)", program)[1])
        table, _, self.notes = scene.partition("\n\n")
        head, *rows = table.splitlines()
        at = [head.index(word) for word in ("key", "type", "unit", "default")]
        self.keys = []
        for row in rows:
            fixed = [row[a:b].strip() for a, b in zip(at, at[1:])]
            self.keys.append((*fixed, *re.split(r" {2,}", row[at[3] :].strip(), maxsplit=1)))

    def words(self, key):
        """That a key can be."""
        text = next(row[4] for row in self.keys if row[0] == key)
        return re.search(r"\[(.*)\]$", text)[1].split(", ")


def roff(text):
    """Text that no character of turns into a request."""
    escaped = (
        text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")
    )
    return "\n".join(
        "\\&" + line if line.startswith(".") else line for line in escaped.splitlines()
    )


def page(name, section, title, parts):
    lines = [
        f'.TH {name.upper()} {section} "" democles "democles"',
        ".SH NAME",
        f"{name} \\- {roff(title)}",
    ]
    return "\n".join([*lines, *parts]) + "\n"


def program_page(d):
    version, title = d.title.split(": ", 1)
    parts = [
        ".SH SYNOPSIS",
        *(line for usage, _, _ in d.commands.values() for line in (f".B {roff(usage)}", ".br")),
        ".SH DESCRIPTION",
        f"This is {roff(version)}. Particles and solids as lattices, described by a scene in "
        "YAML; see",
        ".BR democles-scene (5)",
        "for its keys, and",
        ".BR democles-tools (1)",
        "for pictures and plots of the results.",
        ".SH COMMANDS",
    ]
    for usage, text, options in d.commands.values():
        parts += [f".SS {roff(usage)}", roff(text)]
        for name, value, meaning in options:
            parts += [
                ".TP",
                f'.BI "{roff(name)} " {roff(value)}' if value else f".B {roff(name)}",
                roff(meaning),
            ]
    parts.append(".SH EXIT STATUS")
    for code, meaning in d.codes:
        parts += [".TP", f".B {code}", roff(meaning)]
    return page(
        "democles",
        1,
        title,
        [*parts, ".SH SEE ALSO", ".BR democles-scene (5),", ".BR democles-tools (1)"],
    )


def scene_page(d):
    parts = [
        ".SH DESCRIPTION",
        "A scene is a YAML file with these keys. A list is marked by [], a name of your choice by "
        "NAME.",
        ".SH KEYS",
    ]
    for key, kind, unit, default, meaning in d.keys:
        about = kind + (f" [{unit}]" if unit else "") + (f", {default}" if default != "-" else "")
        parts += [".TP", f".B {roff(key)}", f".I {roff(about)}", ".br", roff(meaning)]
    notes = [
        part
        for line in d.notes.splitlines()
        for part in ([".EX", roff(line), ".EE"] if line.startswith(" ") else [roff(line)])
    ]
    return page(
        "democles-scene",
        5,
        "the scene language of democles",
        [*parts, ".SH NOTES", *notes, ".SH SEE ALSO", ".BR democles (1)"],
    )


def tools_page(_):
    parts = [".SH DESCRIPTION", "Each tool lists its options with", ".BR \\-\\-help ."]
    for path in sorted(TOOLS.glob("*.py")):
        tree = ast.parse(path.read_text())
        if any(isinstance(node, ast.FunctionDef) and node.name == "main" for node in tree.body):
            name = "democles-" + path.stem.replace("_", "-")
            text = re.sub(
                r"\b(?:scripts/)?(\w+)\.py\b",
                lambda m: "democles-" + m[1].replace("_", "-"),
                ast.get_docstring(tree),
            )
            parts += [f".SS {roff(name)}"]
            for paragraph in text.split("\n\n"):
                parts += [
                    ".PP",
                    *(
                        [".EX", roff(paragraph), ".EE"]
                        if paragraph.startswith(" ")
                        else [roff(paragraph)]
                    ),
                ]
    return page(
        "democles-tools",
        1,
        "pictures, plots and studies of what democles computes",
        [*parts, ".SH SEE ALSO", ".BR democles (1)"],
    )


def completion(d):
    plain = [re.sub(r"\[\]", "", row[0]) for row in d.keys]
    settable = [
        row[0] + "="
        for row in d.keys
        if "[]" not in row[0]
        and "NAME" not in row[0]
        and not row[1].startswith(("mapping", "list of map"))
    ]
    switch = "\n".join(
        f'        {name}) options="{" ".join(o for o, _, _ in options)}" ;;'
        for name, (_, _, options) in d.commands.items()
    )
    return f"""# Completion of bash for democles.
_democles()
{{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} options=""
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ]; then
        mapfile -t COMPREPLY < <(compgen -W "{' '.join(d.commands)} --version --help" -- "$word")
        return
    fi
    case ${{COMP_WORDS[1]}} in
{switch}
    esac
    case $before in
        -o) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
        --precision)
            mapfile -t COMPREPLY < <(compgen -W "{' '.join(d.words('precision'))}" -- "$word")
            ;;
        --set)
            mapfile -t COMPREPLY < <(compgen -W "{' '.join(settable)}" -- "$word")
            compopt -o nospace ;;
        *)
            if [[ $word == -* ]]; then
                mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
            elif [ "${{COMP_WORDS[1]}}" = explain ]; then
                mapfile -t COMPREPLY < <(compgen -W "{' '.join(plain)}" -- "$word")
            elif [ "${{COMP_WORDS[1]}}" = resume ]; then
                mapfile -t COMPREPLY < <(compgen -d -- "$word")
            else
                compopt -o filenames
                mapfile -t COMPREPLY < <(compgen -d -- "$word"; compgen -f -X '!*.yaml' -- "$word")
            fi ;;
    esac
}}
complete -F _democles democles
"""


MAKERS = {
    "program": program_page,
    "scene": scene_page,
    "tools": tools_page,
    "completion": completion,
}
if __name__ == "__main__":
    print(MAKERS[sys.argv[1]](Description(pathlib.Path(sys.argv[2]).read_text())), end="")
