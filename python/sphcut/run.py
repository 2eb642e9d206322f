"""Runs: forces over time, means with intervals, particles."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from sphcut import _native
from sphcut.errors import FileError

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from matplotlib.axes import Axes
    from numpy.typing import NDArray
    from pyvista import PolyData


def _pyvista() -> Any:
    """The module, or what to do without it."""
    try:
        import pyvista
    except ImportError as error:
        raise ImportError("particles for pyvista need pyvista: pip install pyvista") from error
    return pyvista


class Snapshot:
    """The particles and the tool at one instant, as numpy arrays: `snapshot.temperature`, `snapshot["temperature"]`.

    SI units; `units` and `meanings` say which. Vectors have the shape (particles, 3), stress (particles, 6): xx, yy, zz, xy, yz, xz.
    """

    def __init__(self, native: _native.Run, number: int) -> None:
        """Use :attr:`Run.snapshots`."""
        import numpy as np

        particles, tool = native.fields
        time, step, _ = native.snapshots[number]
        spacing, arrays = native.snapshot(number)
        self.time: float = time
        """Simulated time in s."""
        self.step: int = step
        """Steps since the start."""
        self.particle_spacing: float = spacing
        """Initial spacing of the particles in m."""
        self.dimension: int = native.dimension
        """2 (plane strain) or 3."""
        self.units: dict[str, str] = {name: unit for name, unit, _ in particles + tool}
        """Unit of each array; empty for numbers without one."""
        self.meanings: dict[str, str] = {name: meaning for name, _, meaning in particles + tool}
        """What each array is."""
        self.names: list[str] = [name for name, _, _ in particles]
        """Names of the arrays of the particles; those of the tool begin with `tool`."""
        self._arrays: dict[str, NDArray[Any]] = {
            name: np.frombuffer(data, dtype=kind).reshape((-1, width) if width > 1 else -1)
            for name, kind, width, data in arrays
        }

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._arrays[name]

    def __getattr__(self, name: str) -> NDArray[Any]:
        arrays = self.__dict__.get("_arrays", {})
        if name in arrays:
            found: NDArray[Any] = arrays[name]
            return found
        raise AttributeError(f"a snapshot has no {name!r}; it has {', '.join(arrays)}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._arrays]

    def __len__(self) -> int:
        return len(self._arrays["id"])

    def __repr__(self) -> str:
        return f"<sphcut.Snapshot at {self.time:.4g} s: {len(self)} particles>"

    def to_pyvista(self) -> PolyData:
        """The particles as points with all their quantities (SI), for pyvista."""
        pv = _pyvista()
        cloud: PolyData = pv.PolyData(self._arrays["position"])
        for name in self.names:
            if name != "position":
                cloud.point_data[name] = self._arrays[name]
        return cloud

    def tool_to_pyvista(self) -> PolyData:
        """The tool, for pyvista: in the plane its outline as one polygon, in space its triangles."""
        import numpy as np

        pv = _pyvista()
        points = self._arrays["tool"]
        if self.dimension == 2:
            faces = np.concatenate(([len(points)], np.arange(len(points))))
        else:
            triangles = np.arange(len(points)).reshape(-1, 3)
            faces = np.insert(triangles, 0, 3, axis=1).ravel()
        tool: PolyData = pv.PolyData(points, faces=faces if len(points) else None)
        return tool


class Snapshots(Sequence[Snapshot]):
    """The snapshots of a run in the order of time. Particles are read when one is asked for."""

    def __init__(self, native: _native.Run) -> None:
        """Use :attr:`Run.snapshots`."""
        self._native = native

    @property
    def times(self) -> list[float]:
        """When each was taken, in s."""
        return [time for time, _, _ in self._native.snapshots]

    def __len__(self) -> int:
        return len(self._native.snapshots)

    @overload
    def __getitem__(self, number: int) -> Snapshot: ...
    @overload
    def __getitem__(self, number: slice) -> list[Snapshot]: ...
    def __getitem__(self, number: int | slice) -> Snapshot | list[Snapshot]:
        if isinstance(number, slice):
            return [self[one] for one in range(*number.indices(len(self)))]
        place = number + len(self) if number < 0 else number
        if not 0 <= place < len(self):
            raise IndexError(f"snapshot {number} of {len(self)}")
        return Snapshot(self._native, place)

    def __iter__(self) -> Iterator[Snapshot]:
        return (self[number] for number in range(len(self)))

    def __repr__(self) -> str:
        return f"<sphcut.Snapshots: {len(self)}>"


class Run:
    """A run in its folder: what `sphcut run` and :meth:`sphcut.Scenario.run` leave behind."""

    def __init__(self, native: _native.Run) -> None:
        """Use :meth:`open`."""
        self._native = native

    @classmethod
    def open(cls, folder: str | PathLike[str]) -> Run:
        """The run in `folder`, finished or interrupted."""
        return cls(_native.Run.open(folder))

    @property
    def folder(self) -> Path:
        """Where its files are."""
        return Path(self._native.folder)

    @property
    def report(self) -> Path:
        """The page to look at."""
        return self.folder / "report.html"

    @property
    def title(self) -> str:
        """What was simulated, in one line."""
        return self._native.title

    @property
    def outcome(self) -> str:
        """`finished`, `steady` (stopped early because the mean force was known), `interrupted` or `diverged: ...`."""
        return self._native.outcome

    @property
    def warnings(self) -> list[str]:
        """What to know before trusting it; those of the results are in `summary["warnings"]`."""
        return self._native.warnings

    @property
    def scenario_text(self) -> str:
        """The scenario it was computed from, word for word."""
        return self._native.scenario_text

    @property
    def forces(self) -> pd.DataFrame:
        """`forces.csv`: time, travel, forces, energies and temperatures. Each column has its unit in its name, and in
        `attrs["units"]`; the numbers are those of the file, bit for bit."""
        import numpy as np
        import pandas as pd

        path = self.folder / "forces.csv"
        try:
            with path.open(encoding="utf-8") as lines:
                names = next(lines).rstrip("\n").split(",")
                # Reads each number to the nearest double, which some versions of pandas do not.
                table = pd.DataFrame(np.loadtxt(lines, delimiter=",", ndmin=2), columns=names)
        except OSError as error:
            raise FileError(f"cannot read `{path}`: {error.strerror}") from error
        table.attrs["units"] = {name: name[name.rindex("[") + 1 : -1] for name in table.columns}
        return table

    @property
    def channels(self) -> pd.DataFrame:
        """All channels over time in SI units, which are in `attrs["units"]`, with what they are in `attrs["meanings"]`. In a plane run
        forces and energies are per metre of width."""
        import numpy as np
        import pandas as pd

        named = self._native.channels
        columns = zip(named, self._native.samples(), strict=True)
        table = pd.DataFrame({name: np.frombuffer(data, dtype="f8") for (name, _, _), data in columns})
        table.attrs["units"] = {name: unit for name, unit, _ in named}
        table.attrs["meanings"] = {name: meaning for name, _, meaning in named}
        return table

    @property
    def summary(self) -> dict[str, Any]:
        """The results as numbers, units in the names: `summary.json`, documented in `docs/summary_json.md`."""
        path = self.folder / "summary.json"
        if not path.is_file():
            raise FileError(f"`{path}` is not there: a run that was interrupted has no summary")
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        return found

    @property
    def snapshots(self) -> Snapshots:
        """The particles at some instants: `run.snapshots[-1].temperature`."""
        return Snapshots(self._native)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Cutting and feed force in N over the travel in mm, the window of the means shaded. Needs matplotlib."""
        try:
            import matplotlib.pyplot as plt
        except ImportError as error:
            raise ImportError("plot needs matplotlib: pip install matplotlib") from error
        axes = plt.subplots()[1] if ax is None else ax
        forces = self.forces
        for column, label in [("cutting_force [N]", "$F_c$"), ("feed_force [N]", "$F_f$")]:
            axes.plot(forces["travel [mm]"], forces[column], label=label)
        if (self.folder / "summary.json").is_file():
            start, end = self.summary["steady"]["window_mm"]
            axes.axvspan(start, end, alpha=0.15, label="means")
        axes.set_xlabel("travel [mm]")
        axes.set_ylabel("force [N]")
        axes.set_title(self.title)
        axes.legend()
        return axes

    def __repr__(self) -> str:
        particles, steps, seconds = self._native.cost
        return f"<sphcut.Run {str(self.folder)!r}: {self.outcome}, {particles} particles, {steps} steps in {seconds:.3g} s>"

    def _repr_html_(self) -> str:
        rows = [("outcome", self.outcome)]
        if (self.folder / "summary.json").is_file():
            summary = self.summary
            for name, key in [("F<sub>c</sub>", "cutting"), ("F<sub>f</sub>", "feed")]:
                force = summary["forces"][key]
                half = force["ci95_n"]
                rows.append((name, f"{force['mean_n']:.1f}" + (f" &plusmn; {half:.1f}" if half else "") + " N"))
            # That it is not steady is a warning.
            rows += [("steady", "yes")] if summary["steady"]["reached"] else []
            rows += [("warning", escape(warning["message"])) for warning in summary["warnings"]]
        cell = "<td style='text-align: left'>"
        body = "".join(f"<tr><th>{name}</th>{cell}{value}</td></tr>" for name, value in rows)
        page = escape(str(self.report))
        return f"<b>{escape(self.title)}</b><table>{body}</table><a href='{page}'>{page}</a>"
