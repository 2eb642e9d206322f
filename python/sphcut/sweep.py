"""Many runs of one scenario, kept in a store: nothing is computed twice."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sphcut.progress import ProgressLine
from sphcut.scenario import Scenario, literal

if TYPE_CHECKING:
    import pandas as pd


def sweep(
    cut: Scenario,
    values: Mapping[str, Sequence[Any]],
    *,
    workers: int | None = None,
    store: str | PathLike[str] | None = None,
    out: str | PathLike[str] | None = None,
    progress: bool = True,
) -> pd.DataFrame:
    """Runs `cut` with every combination of `values`, and gives a row for each, with its forces and every number of its summary.

    >>> table = sphcut.sweep(cut, {"process.cutting_speed": ["100 m/min", "200 m/min"]}, workers=2)
    >>> table[["v_c [m/min]", "F_c [N]", "F_c_ci95 [N]"]]

    workers: runs at once, each a process on a core of its own; default: all cores.
    store: folder of the results, by the address of the resolved scenario; default: `<out>/store`. It is that of `sphcut sweep`:
        runs that are there already, from whatever sweep, are not computed again.
    out: folder of `sweep.html` (the page), `table.csv` and `simulated.csv`; default: `out/<name>_sweep`.

    The columns are those of `table.csv`, each with its unit in its name; `attrs["units"]` has them, too, `attrs["folder"]` is `out`.
    `folder` of a row is that of its run, for :meth:`sphcut.Run.open`. A run that fails is a row with its reason. All combinations
    are checked before the first one starts. Ctrl-C writes checkpoints; the same call goes on.
    """
    import pandas as pd

    folder = Path("out") / f"{cut.name}_sweep" if out is None else Path(out)
    kept = folder / "store" if store is None else Path(store)
    runs = [[literal(one) for one in point] for point in itertools.product(*values.values())]
    line = ProgressLine("sweep") if progress else None
    told = ""
    try:
        computed, there, failed, stopped = cut._native.sweep(
            f"{cut.title}: {', '.join(values)}", list(values), runs, folder, kept, workers, line
        )
        told = f"{computed} runs computed, {there} there already, {failed} failed: {folder / 'sweep.html'}"
    finally:
        if line is not None:
            line.end(told)
    if stopped:
        raise KeyboardInterrupt(f"{stopped} runs are left: checkpoints are written; the same call goes on")
    table = pd.read_csv(folder / "table.csv")
    table["folder"] = [str(one if one.is_absolute() else folder / one) for one in map(Path, table["folder"])]
    table.attrs["units"] = {name: name[name.rindex("[") + 1 : -1] for name in table.columns if name.endswith("]")}
    table.attrs["folder"] = str(folder)
    return table
