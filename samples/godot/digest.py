"""The digest of a PLY's positions, as the plug-in makes it of a simulation's vertices: FNV-1a of their bits. digest.py FINAL.PLY"""

import sys


def positions(file):
    with open(file, "rb") as ply:
        count = stride = 0
        in_vertices = False
        while (line := ply.readline().decode().split()) != ["end_header"]:
            if line[:1] == ["element"]:
                in_vertices = line[1] == "vertex"
                count = int(line[2]) if in_vertices else count
            elif line[:1] == ["property"] and in_vertices:
                stride += {"float": 4, "int": 4, "uchar": 1}[line[1]]
        rows = ply.read(count * stride)
    return (rows[k:k + 12] for k in range(0, count * stride, stride))


def main():
    digest = 0xcbf29ce484222325
    for row in positions(sys.argv[1]):
        for byte in row:
            digest = (digest ^ byte) * 0x100000001b3 & 0xffffffffffffffff
    print(f"{digest:016x}")


main()
