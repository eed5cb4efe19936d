"""Draws charts: energies of several runs, errors of sweeps, solves, element tests."""
from .drawing import COLOURS, LINES, FormatStrFormatter, label_energy, np, plt
from .results import ResultsError, Run, read_table


def draw_all_energies(folders, place):
    """Draw kinetic and total energy of several runs."""
    figure, axes = plt.subplots(1, 2, figsize=(7.2, 2.9 + 0.17 * (len(folders) // 3)), dpi=200)
    for k, folder in enumerate(folders):
        run = Run(folder)
        statistics = run.statistics
        for axis, name in zip(axes, ("kinetic", "total")):
            axis.plot(statistics["time"], statistics[name], LINES[k // len(COLOURS) % len(LINES)],
                      color=COLOURS[k % len(COLOURS)], label=folder.resolve().name.replace("_", " "))
            axis.set(xlabel="time, s")
            label_energy(axis, f"{name} energy", run)
            axis.margins(x=0)
    columns = min(3, len(folders))
    room = 0.2 * -(-len(folders) // columns) + 0.1
    figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=columns)
    figure.tight_layout(rect=(0, room / figure.get_figheight(), 1, 1))
    figure.savefig(place / "energies.png")
    print(place / "energies.png")


def draw_convergence(folder):
    table = read_table(folder / "convergence.csv")
    p, cells, error = (table[name] for name in ("p", "cells", "error_l2"))
    kinds = list(zip(table["formulation"], table["mass"]))
    # Equal values in all rows need no label.
    told = [k for k in range(2) if len({kind[k] for kind in kinds}) > 1] or [1]
    names, orders = list(dict.fromkeys(kinds)), sorted(set(p.astype(int)))
    figure, axes = plt.subplots(figsize=(5.4, 3.8), dpi=200)
    for m, order in enumerate(orders):
        colour = COLOURS[m % len(COLOURS)]
        best = []
        for n, name in enumerate(names):
            mine = [k for k in range(len(p)) if kinds[k] == name and p[k] == order and error[k] > 0]
            mine.sort(key=lambda k: cells[k])
            if mine:
                label = ", ".join([name[k] for k in told] + [f"$p$ = {order}"])
                axes.plot(cells[mine], error[mine], "os^Dv"[n % 5] + LINES[n % len(LINES)],
                          color=colour, markersize=4.5, markerfacecolor="white", label=label)
                best.append((error[mine[0]], cells[mine]))
        if best:
            first, x = min(best, key=lambda pair: pair[0])
            axes.plot(x, 0.6 * first * (x / x[0])**-(order + 1.), ":", color=colour, linewidth=0.9)
    axes.plot([], [], ":", color="0.4", linewidth=0.9, label="order $p$ + 1")
    axes.set(xscale="log", yscale="log", xlabel="cells", ylabel="relative $L_2$ error of the displacement")
    axes.set_xticks(sorted(set(cells)), [f"{int(n)}" for n in sorted(set(cells))])
    axes.minorticks_off()
    axes.grid(True, color="0.9", linewidth=0.5)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    figure.tight_layout()
    figure.savefig(folder / "convergence.png")
    print(folder / "convergence.png")


def variant(row):
    parts = [row["solver"], row["cycle"], row["smoother"]]
    return ", ".join(part for part in parts if part)


def draw_solves(folder):
    rows = [row for row in read_table(folder / "solves.csv").rows() if row["converged"] == 1]
    if not rows:
        raise ResultsError(f"{folder}/solves.csv has no solve that converged.")

    # The finest mesh of the largest dimension.
    dim = max(int(row["dim"]) for row in rows)
    rows = [row for row in rows if int(row["dim"]) == dim]
    cells = max(int(row["cells"]) for row in rows)
    rows = [row for row in rows if int(row["cells"]) == cells]

    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    styles = ["o-", "s--", "^:", "D-.", "v-", "x--"]
    for k, name in enumerate(dict.fromkeys(variant(row) for row in rows)):
        style = styles[k % len(styles)]
        mine = sorted((r for r in rows if variant(r) == name), key=lambda r: int(r["p"]))
        orders = [int(row["p"]) for row in mine]
        if all(isinstance(row["iterations"], float) and row["iterations"] > 0 for row in mine):
            axes[0].plot(orders, [int(row["iterations"]) for row in mine], style, label=name)
        cost = [
            1e9 * (float(row["assembly_s"]) + float(row["setup_s"]) + float(row["solve_s"]))
            / int(row["unknowns"])
            for row in mine
        ]
        axes[1].plot(orders, cost, style, label=name)
    axes[0].set_ylabel("iterations")
    axes[1].set_ylabel("time per unknown, ns")
    for axis in axes:
        axis.set_yscale("log")
        axis.set_xlabel("order p")
        axis.xaxis.get_major_locator().set_params(integer=True)
        axis.grid(True, which="both", alpha=0.3)
    axes[1].legend(fontsize=8)
    figure.suptitle(f"{folder.name}: {dim}D, {cells} cells per direction, processes: {int(rows[0]['processes'])}")
    figure.tight_layout()
    figure.savefig(folder / "solves.png", dpi=110)
    print(folder / "solves.png")


def draw_element_test(folder):
    table = read_table(folder / "element_test.csv")
    # The test controls the strain that grows most.
    axial, shear = table["strain_axial"], table["strain_shear"]
    is_shear = np.ptp(shear) > 1.5 * np.ptp(axial)
    strain, label = (shear, "shear strain") if is_shear else (axial, "axial strain")
    p, q, u = table["p"] / 1e3, table["q"] / 1e3, table["pore_pressure"] / 1e3
    figure, axes = plt.subplots(2, 2, figsize=(8, 6.4))
    axes[0, 0].plot(p, q, color=COLOURS[0], label="effective")
    if np.ptp(u) > 0.:
        axes[0, 0].plot(p + u, q, LINES[1], color=COLOURS[1], label="total")
        axes[0, 0].legend()
    axes[0, 0].plot(p[:1], q[:1], "o", color=COLOURS[0], markersize=4)
    axes[0, 0].set(xlabel="p, kPa", ylabel="q, kPa")
    axes[0, 1].plot(strain, q, color=COLOURS[0])
    axes[0, 1].set(xlabel=label, ylabel="q, kPa")
    if np.ptp(u) > 0.:
        axes[1, 0].plot(strain, u, color=COLOURS[0])
        axes[1, 0].set(xlabel=label, ylabel="pore pressure, kPa")
    else:
        axes[1, 0].plot(strain, table["strain_volumetric"], color=COLOURS[0])
        axes[1, 0].set(xlabel=label, ylabel="volumetric strain (compression)")
    axes[1, 1].plot(p, table["void_ratio"], color=COLOURS[0])
    axes[1, 1].plot(p[:1], table["void_ratio"][:1], "o", color=COLOURS[0], markersize=4)
    axes[1, 1].set(xlabel="p, kPa", ylabel="void ratio e")
    if p.min() > 0.:
        axes[1, 1].set_xscale("log")
        plain = FormatStrFormatter("%g")
        axes[1, 1].xaxis.set_major_formatter(plain)
        axes[1, 1].xaxis.set_minor_formatter(plain)
    for axis in axes.flat:
        axis.grid(True, which="both", alpha=0.3)
    figure.suptitle(folder.name)
    figure.tight_layout()
    figure.savefig(folder / "element_test.png", dpi=110)
    print(folder / "element_test.png")
