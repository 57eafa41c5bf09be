#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes docs/pictures/wheel_71cm.svg from the demo's report: the bed at 20 % slip and the pull curve.

tools/update_picture.py runs/wheel_71cm_slip_sweep/report/report.html
"""
import re
import sys
from pathlib import Path


def figure(page, label, place):
    """The svg element with this label, put at a place of the picture."""
    found = re.search(r'<svg ([^>]*aria-label="' + re.escape(label) + r'"[^>]*>.*?</svg>)', page, re.S)
    if not found:
        sys.exit(f"the report has no figure '{label}'")
    return f"<svg {place} {found[1]}"


page = Path(sys.argv[1]).read_text(encoding="utf-8")
style = re.search(r"<style>(.*?)</style>", page, re.S)[1]
colours = style[style.index(":root"):style.index("}\n}") + 4]
rules = "\n".join(re.findall(r"^(?:svg (?:text|\.)|path\.grid|\.(?:zero|band|mean|seed|towed|lab|paper|bar|bed|grains)\b)[^{\n]*\{[^}]*\}",
                             style, re.M))
picture = f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 400" font-family="system-ui, sans-serif">
<style>
{colours}
{rules}
</style>
{figure(page, "slip_20-s1: bed and wheel, coloured by displacement", 'x="0" y="0" width="530" height="400"')}
{figure(page, "Pull coefficient over slip", 'x="560" y="50" width="440" height="300"')}
</svg>
"""
target = Path(__file__).parent.parent / "docs" / "pictures" / "wheel_71cm.svg"
target.write_text(picture, encoding="utf-8")
