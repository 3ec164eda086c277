#!/usr/bin/python3
"""seeds.py DIR: small inputs for the fuzz targets to begin with, DIR/seeds/TARGET/*, the words that
they are made of, DIR/seeds/TARGET.dict, and folders for what is found, DIR/found/TARGET."""
import pathlib
import random
import re
import struct
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TRIANGLES = [
    [(0, 0, 0), (0, 1, 0), (1, 0, 0)],
    [(0, 0, 0), (1, 0, 0), (0, 0, 1)],
    [(0, 0, 0), (0, 0, 1), (0, 1, 0)],
    [(1, 0, 0), (0, 1, 0), (0, 0, 1)],
]
LARGEST = 4096  # [byte]


def scenes():
    paths = [*ROOT.glob("cases/*/*.yaml"), *ROOT.glob("tests/scene/*.yaml")]
    paths += ROOT.glob("docs/examples/*.yaml")
    for path in sorted(paths):
        text = re.sub(r"(?m)\s*#.*$", "", path.read_text())
        if len(text) <= LARGEST:
            yield text.encode()
    contact = "{between: [a, a], normal: {law: hertz, restitution: 0.5}}"
    yield (
        "method: particles\ntime: {end: 1 s, step: auto}\n"
        "materials: {a: {density: 2500, young: 1 MPa, poisson: 0.2}}\n"
        f"contacts: [{contact}]\n"
        "elements: [{name: e, material: a, shape: {sphere: {diameter: 1 mm}},"
        " fill: {region: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, count: 3}}]\n"
        "output: {every: 0.1}\n"
    ).encode()
    yield b"materials: {a: &a {density: 1}, b: *a}\ncontacts: &c [{between: [a, b]}, *c]\n"


def surfaces():
    text = "solid s\n"
    binary = b"\0" * 80 + struct.pack("<I", len(TRIANGLES))
    for triangle in TRIANGLES:
        text += "facet normal 0 0 1\n outer loop\n"
        text += "".join("  vertex {} {} {}\n".format(*corner) for corner in triangle)
        text += " endloop\nendfacet\n"
        binary += struct.pack("<12fH", 0, 0, 1, *sum(triangle, ()), 0)
    yield (text + "endsolid s\n").encode()
    yield re.sub(r"\s+", " ", text + "end solid").replace("0", "1D-3").encode()
    yield binary
    yield binary + b"more"
    yield b"solid" + binary[5:]
    yield binary[:-2] + struct.pack("<H3s", 3, b"rgb")  # attributes behind the last triangle


def elements():
    yield b"x,y,z,radius\n0,0,0,1e-3\n1,0,0,2e-3\n"
    yield b"radius, z ,vx,y,x,wz\r\n0.5,3,-7,2,1,9\r\n\r\n 0.25,\t6,8e0,5,4,-0.5"
    yield b"\xef\xbb\xbfx,y,z,radius,vx,vy,vz,wx,wy,wz\n" + b"1,2,3,4,5,6,7,8,9,10\n" * 3
    yield b"x,y,z,radius\n-1e300,1e-300,1e15,1e300\n0x1p3,inf,nan,0\n"


def histories():
    yield b"time,factor\n0,0\n1,1\n2,0.5\n"
    yield b"-1e3 , 1e-300\r\n\r\n0 , 2\r\n1e3,-2"
    yield b"0,1\n"
    yield b"0,1e308\n1e-308,-1e308\n2,0\n"


def frames(chance):
    """Lists of changes, each a kind, names, types, shapes, numbers (fuzz_frame.c)."""
    for kind in range(4):
        for n in (3, 12, 40):
            yield bytes([kind]) + chance.randbytes(n)
    yield b""


def damages(chance):
    """Places and bits (fuzz_damage.c)."""
    for n in (1, 1, 1, 2, 8):
        yield b"".join(
            struct.pack("<I", chance.randrange(1 << 16))[:3] + bytes([1 << chance.randrange(8)])
            for _ in range(n)
        )


def words(inputs):
    found = set()
    for data in inputs:
        found.update(re.findall(rb"[A-Za-z][A-Za-z_]{2,30}", data))
    if any(b"&" in data for data in inputs):
        found.update((b"&a ", b"*a", b"&a [*a]"))
    found.update((b"1e308", b"1e-308", b"1e15", b"-1", b"nan", b"inf", b"9223372036854775808"))
    return sorted(found)


def main():
    folder = pathlib.Path(sys.argv[1])
    chance = random.Random(1)
    inputs = {
        "scene": scenes(),
        "stl": surfaces(),
        "elements": elements(),
        "history": histories(),
        "frame": frames(chance),
        "damage": damages(chance),
    }
    for name, made in inputs.items():
        made = list(made)
        (folder / "seeds" / name).mkdir(parents=True, exist_ok=True)
        (folder / "found" / name).mkdir(parents=True, exist_ok=True)
        for k, data in enumerate(made):
            (folder / "seeds" / name / f"{k:02}").write_bytes(data)
        with open(folder / "seeds" / f"{name}.dict", "w") as file:
            file.writelines(f'"{word.decode()}"\n' for word in words(made))


main()
