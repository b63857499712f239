#!/usr/bin/env python3
"""The choice between the plans of the staircase demonstration, and its page.

usage: staircase_report.py choose FOLDER            prints the viewpoint of the higher utility, and the table on stderr
       staircase_report.py report FOLDER VIEWPOINT  writes FOLDER/staircase.html
"""
import base64
import html
import json
import pathlib
import sys

VIEWPOINTS = ("red", "green")


def plans(folder):
    return {name: json.loads((folder / "plans" / f"{name}.json").read_text()) for name in VIEWPOINTS}


def rows(folder):
    for name, plan in plans(folder).items():
        yield name, plan["risk"], plan["reward"], plan["utility"], len(plan["states"])


def choose(folder):
    for name, risk, reward, utility, states in rows(folder):
        print(f"{name:6} risk {risk:.3f}  reward {reward:.1f}  utility {utility:.3f}  {states} states", file=sys.stderr)
    print(max(rows(folder), key=lambda row: row[3])[0])


def picture(file, caption):
    data = base64.b64encode(file.read_bytes()).decode()
    return f'<figure><img src="data:image/svg+xml;base64,{data}" alt=""><figcaption>{html.escape(caption)}</figcaption></figure>\n'


def report(folder, chosen):
    table = "".join(
        f"<tr{' class=chosen' if name == chosen else ''}><td>{name}</td><td>{risk:.3f}</td><td>{reward:.1f}</td>"
        f"<td>{utility:.3f}</td><td>{states}</td></tr>\n"
        for name, risk, reward, utility, states in rows(folder))
    page = (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Staircase</title>\n'
        "<style>body{font:16px sans-serif;margin:2em auto;max-width:60em}td,th{padding:.3em 1em;text-align:right;"
        "border-bottom:1px solid #ccc}.chosen{background:#e6f4ea;font-weight:bold}img{max-width:100%}</style></head><body>\n"
        "<h1>Staircase</h1>\n<p>The paths of least risk to both viewpoints; the one of the higher utility (reward / risk) is flown.</p>\n"
        "<table><tr><th>viewpoint</th><th>risk</th><th>reward</th><th>utility</th><th>states</th></tr>\n" + table + "</table>\n")
    for name in VIEWPOINTS:
        page += picture(folder / "plans" / f"{name}.svg", f"Plan to the {name} viewpoint, coloured by state risk")
    for view, side in (("top", "above"), ("front", "the front")):
        page += picture(folder / f"{view}.svg", f"The flight to the {chosen} viewpoint, from {side}")
    page += '<p><a href="report.html">Report of the flight</a></p></body></html>\n'
    (folder / "staircase.html").write_text(page)


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "choose":
        choose(pathlib.Path(arguments[1]))
    elif len(arguments) == 3 and arguments[0] == "report":
        report(pathlib.Path(arguments[1]), arguments[2])
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
