# SPDX-License-Identifier: BSD-3-Clause
"""The picture of docs/performance/scaling.md: where a core's time goes, by ranks."""

PARTS = [  # of a step, from the bottom up
    ("alone", "particle-steps and lists, as one core alone", "#4c78a8"),
    ("twice", "pairs evaluated twice", "#9ecae9"),
    ("halo", "halo", "#f58518"),
    ("agree", "agreeing, waiting", "#e45756"),
    ("rebuild", "lists of ghosts, migration", "#b79a20"),
]
WIDTH, HEIGHT, LEFT, TOP, BOTTOM = 900, 420, 60, 20, 60
LEGEND = 290


def shares(point):
    """Parts of a step's time, summing up to 1."""
    step = point["time_per_step"]
    cores = point["ranks"] * point["cores"]
    lists_alone = point["alone"] - point["grains"] / cores * point["step_cost"]
    return {
        "alone": point["efficiency"],
        "twice": point["twice"] / step,
        "halo": point["halo"] / step,
        "agree": point["agree"] / step,
        "rebuild": (point["rebuild_share"] - lists_alone) / step,
    }


def efficiency_plot(points):
    bottom = HEIGHT - BOTTOM
    tall = bottom - TOP
    slot = (WIDTH - LEFT - LEGEND) / len(points)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           f'font-family="sans-serif" font-size="13">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for percent in range(0, 101, 20):
        y = bottom - tall * percent / 100
        out.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - LEGEND}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{percent} %</text>')
    for at, point in enumerate(points):
        x = LEFT + slot * (at + 0.12)
        level = 0.0
        parts = shares(point)
        for name, _, colour in PARTS:
            share = max(parts[name], 0.0)
            level += share
            out.append(f'<rect x="{x:.1f}" y="{bottom - tall * level:.1f}" '
                       f'width="{slot * 0.76:.1f}" height="{tall * share:.1f}" fill="{colour}"/>')
        middle = x + slot * 0.38
        out.append(f'<text x="{middle:.1f}" y="{bottom - tall * parts["alone"] + 16:.1f}" '
                   f'text-anchor="middle" fill="white">{100 * parts["alone"]:.0f}</text>')
        out.append(f'<text x="{middle:.1f}" y="{bottom + 17}" text-anchor="middle">'
                   f'{point["ranks"] * point["part"]}</text>')
        if point["part"] > 1:
            out.append(f'<text x="{middle:.1f}" y="{bottom + 32}" text-anchor="middle" '
                       f'font-size="9">by 1/{point["part"]}</text>')
    y = bottom - tall * 0.9
    out.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - LEGEND}" stroke="black" '
               f'stroke-dasharray="5 4"/>')
    out.append(f'<text x="{LEFT}" y="{HEIGHT - 8}">simulated ranks; share of each core\'s time '
               f'(broken line: the goal, 90 %)</text>')
    for row, (_, text, colour) in enumerate(reversed(PARTS)):
        y = TOP + 20 + 24 * row
        out.append(f'<rect x="{WIDTH - LEGEND + 14}" y="{y - 11}" width="14" height="14" '
                   f'fill="{colour}"/>')
        out.append(f'<text x="{WIDTH - LEGEND + 34}" y="{y}" font-size="12">{text}</text>')
    out.append("</svg>")
    return "\n".join(out) + "\n"
