"""What the checks share: the C and OpenCL files of this checkout, and their text without comments,
strings and preprocessor lines."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("src", "comm", "partition", "kernels", "tests")


def files(*suffixes):
    return sorted(
        p for folder in FOLDERS for p in (ROOT / folder).rglob("*") if p.suffix in suffixes
    )


def name(path):
    return path.relative_to(ROOT).as_posix()


def blank(match):
    """Blanks of the same shape, so that line numbers stay."""
    return re.sub(r"[^\n]", " ", match.group())


def code(text, keep_strings=False):
    """Text without comments, and without what stands in quotes unless keep_strings."""

    def replace(match):
        quoted = match.group()[0] in "\"'"
        return match.group() if quoted and keep_strings else blank(match)

    return re.sub(
        r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', replace, text, flags=re.S
    )


def without_preprocessor(text):
    """Code without preprocessor lines, and of an #if only the first branch:
    so that braces balance."""
    out, skip = [], []
    continued = False
    for line in text.split("\n"):
        word = re.match(r"\s*#\s*(\w+)", line)
        directive = word.group(1) if word and not continued else ""
        if directive in ("if", "ifdef", "ifndef"):
            skip.append(False)
        elif directive in ("else", "elif") and skip:
            skip[-1] = True
        elif directive == "endif" and skip:
            skip.pop()
        drop = directive or continued or any(skip)
        continued = line.endswith("\\") and bool(directive or continued)
        out.append("" if drop else line)
    return "\n".join(out)


def includes(path):
    """(line, 'quote' or 'angle', what) of each #include."""
    text = code(path.read_text(), keep_strings=True)
    for match in re.finditer(
        r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"\n]+)"|<([^>\n]+)>)', text, flags=re.M
    ):
        line = text.count("\n", 0, match.start()) + 1
        yield line, "quote" if match.group(1) else "angle", match.group(1) or match.group(2)


def resolve(path, include):
    """The file of this checkout that an #include "..." means, or None (a generated header)."""
    for folder in (path.parent, *(ROOT / f for f in FOLDERS[:-1]), ROOT):
        if (folder / include).is_file():
            return (folder / include).resolve()
    return None
