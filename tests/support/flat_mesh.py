"""Meshes that tests make for themselves."""


def plate(columns=6, rows=4):
    """A flat rectangle of triangles, as OFF text."""
    points = [f"{x} {y} 0" for y in range(rows + 1) for x in range(columns + 1)]
    faces = []
    for y in range(rows):
        for x in range(columns):
            a, b = y * (columns + 1) + x, (y + 1) * (columns + 1) + x
            faces += [f"3 {a} {a + 1} {b + 1}", f"3 {a} {b + 1} {b}"]
    return "\n".join([f"OFF\n{len(points)} {len(faces)} 0", *points, *faces, ""]).encode()
