#!/usr/bin/env python3
"""Print the lines of include and source by room as the table of checks.md. A function is
a body in braces at the indentation of its head, which deal.II's format gives no other
statement."""
import collections
import pathlib
import re
import statistics

kinds = ("statements", "braces alone", "comments", "blank")
counts = collections.defaultdict(collections.Counter)
lengths = []
for path in sorted(p for d in ("include", "source") for p in pathlib.Path(d).rglob("*")
                   if p.suffix in (".h", ".cc")):
    folder = path.parent.name
    room = "programs" if folder in ("source", "greville") else folder
    head, begin = [], None  # the lines before a brace, and the head of a function
    for n, line in enumerate(path.read_text().splitlines()):
        text, indent = line.strip(), len(line) - len(line.lstrip())
        comment = re.match(r"//|/\*|\*( |$|/)", text)
        kind = (kinds[3] if not text else kinds[2] if comment else
                kinds[1] if re.fullmatch(r"[{}]+;?", text) else kinds[0])
        counts[room][kind] += 1
        if (begin is None and text == "{" and head and indent == head[0][1]
                and any("(" in h[2] for h in head)
                and not re.match(r"(namespace|class|struct|enum|union)\b", head[0][2])):
            begin = head[0][0], indent
        elif begin and text == "}" and indent == begin[1]:
            lengths.append(n - begin[0] + 1)
            begin = None
        ends = not text or comment or text.endswith((";", "{", "}", ":"))
        head = [] if ends else head + [(n, indent, text)]
print("| room | lines |", " | ".join(kinds), "|")
print("| --- " * 6 + "|")
counts["all"] = sum(counts.values(), collections.Counter())
for room, count in counts.items():
    print(f"| {room} | {sum(count.values())} |",
          " | ".join(str(count[kind]) for kind in kinds), "|")
print(f"\n{len(lengths)} functions, median {statistics.median(lengths):g} lines, mean "
      f"{statistics.mean(lengths):.1f}, {sum(n > 60 for n in lengths)} above 60 lines")
