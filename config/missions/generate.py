#!/usr/bin/env python3
"""Writes the missions of this folder. `generate.py --check` only compares and exits with 1 if a file differs.

Positions are in W (metres, y up, origin at the reel outlet). The contact missions put their contact points on the pillar edges
of config/scenes and change the active contact where reel (or contact), next contact and drone are in line, so that the free
tether neither jumps nor cuts through a pillar.
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
SPEED = 0.3  # m/s


def number(value):
    """Shortest decimal text that reads back to the same number, as common/toml writes it."""
    text = repr(round(float(value), 4) + 0.0)
    return text


def vector(p):
    return "[" + ", ".join(number(c) for c in p) + "]"


def fnv1a(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) % 2**64
    return f"{value:016x}"


def mission_text(name, description, scene, reel, contacts, waypoints):
    scene_bytes = (HERE.parent / "scenes" / scene).read_bytes()
    lines = [
        "version = 1",
        f'name = "{name}"',
        f'description = "{description}"',
        'frame = "W"',
        f"reel_position_m = {vector(reel)}",
        f'map = "../scenes/{scene}"',
        f'map_hash = "{fnv1a(scene_bytes)}"',
    ]
    if contacts:
        lines += ["", "contacts = ["]
        lines += [f"  {{ id = {i}, position_m = {vector(p)} }}," for i, p in contacts]
        lines += ["]"]
    lines += ["", "waypoints = ["]
    for p, contact in waypoints:
        lines.append(f"  {{ position_m = {vector(p)}, contact = {contact}, speed_mps = {number(SPEED)} }},")
    return "\n".join(lines + ["]", ""])


def subdivide(corners, interval):
    """Points along the corners, `interval` apart on the axis that moves most, corners included."""
    points = [corners[0]]
    for a, b in zip(corners, corners[1:]):
        steps = max(1, round(max(abs(q - p) for p, q in zip(a, b)) / interval))
        points += [tuple(p + (q - p) * k / steps for p, q in zip(a, b)) for k in range(1, steps + 1)]
    return points


def beyond(anchor, contact, distance):
    """The point in line with both, `distance` behind the contact."""
    chord = math.dist(anchor, contact)
    return tuple(c + (c - a) / chord * distance for a, c in zip(anchor, contact))


def on_edge(anchor, edge, elevation_deg):
    """Where a straight tether from the anchor at this elevation meets the vertical edge (x, z)."""
    reach = math.hypot(edge[0] - anchor[0], edge[1] - anchor[2])
    return (edge[0], round(anchor[1] + reach * math.tan(math.radians(elevation_deg)), 4), edge[1])


def open_room_missions():
    reel = (3.0, 0.3, 3.0)
    square = [(0, 1.2, 1.2), (0.8, 1.2, 1.2), (0.8, 1.2, 2.4), (-0.8, 1.2, 2.4), (-0.8, 1.2, 1.2), (0, 1.2, 1.2)]
    yield "square", "open.scene.toml", reel, [], [(p, 0) for p in square], "level rectangle in front of the reel"
    paths = {
        "path1": ([(-1.5, 1.0, 1.5), (1.5, 1.0, 1.5), (1.5, 1.9, -1.5)], "dissertation's path 1: level, then climbing"),
        "path2": ([(1.5, 1.5, 1.5), (-1.5, 1.5, -1.5)], "dissertation's path 2: level over the reel"),
    }
    for path, (corners, description) in paths.items():
        for interval in ("0.2", "0.5", "1", "1.5", "3"):
            points = subdivide(corners, float(interval))
            yield (f"{path}_{interval}", "open.scene.toml", reel, [], [(p, 0) for p in points],
                   f"{description}, waypoints every {interval} m")


def one_contact_mission():
    reel = (1.2, 0.3, 1.2)
    origin = (0.0, 0.0, 0.0)
    c1 = on_edge(origin, (1.0, 1.8), 22.0)
    waypoints = [
        ((0.4, 0.95, 1.6), 0),
        ((0.7, 1.0, 2.3), 0),
        (beyond(origin, c1, 0.9), 0),  # the tether touches the pillar here
        ((2.1, 1.45, 2.6), 1),
        ((2.5, 1.6, 2.35), 1),
        ((2.2, 1.6, 2.8), 1),
        (beyond(origin, c1, 1.2), 1),  # and leaves it here
        ((0.8, 1.15, 2.5), 0),
        ((0.4, 0.95, 1.7), 0),
    ]
    return "one_contact", "one_contact.scene.toml", reel, [(1, c1)], waypoints, "one contact formed and relaxed again"


def two_contacts_mission():
    reel = (1.2, 0.3, 1.2)
    origin = (0.0, 0.0, 0.0)
    c1 = on_edge(origin, (1.0, 1.8), 20.0)
    c2 = on_edge(c1, (1.9, 2.6), 20.0)
    waypoints = [
        ((0.4, 0.95, 1.6), 0),
        ((0.8, 1.1, 2.5), 0),
        (beyond(origin, c1, 1.4), 0),  # touches the near pillar
        ((2.0, 1.35, 3.2), 1),
        (beyond(c1, c2, 0.9), 1),  # touches the far pillar
        ((3.1, 1.65, 3.0), 2),
        ((3.4, 1.75, 3.2), 2),
        (beyond(c1, c2, 1.1), 2),  # leaves the far pillar
        ((2.1, 1.4, 3.25), 1),
        (beyond(origin, c1, 1.5), 1),  # leaves the near pillar
        ((0.8, 1.1, 2.5), 0),
        ((0.4, 0.95, 1.7), 0),
    ]
    return ("two_contacts", "two_contacts.scene.toml", reel, [(1, c1), (2, c2)], waypoints,
            "two contacts formed and both relaxed again")


def main():
    check = sys.argv[1:] == ["--check"]
    different = []
    for name, scene, reel, contacts, waypoints, description in [
            *open_room_missions(), one_contact_mission(), two_contacts_mission()]:
        path = HERE / f"{name}.mission.toml"
        text = mission_text(name, description, scene, reel, contacts, waypoints)
        if check:
            if not path.exists() or path.read_text() != text:
                different.append(path.name)
        else:
            path.write_text(text)
    if different:
        print("differ from what generate.py writes: " + ", ".join(different))
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
